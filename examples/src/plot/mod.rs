//! Plots as SVG files.
//!
//! Text stays text, in whatever sans-serif font the viewer has: nothing is asked of the system that makes the plot.

mod accuracy;
mod course;

pub use accuracy::{BAND_NAMES, Group, accuracy};
pub use course::course;

use crate::palette;
use plotters::style::RGBColor;

const FONT: &str = "sans-serif";

/// Colour number `index` of the palette.
fn color(index: usize) -> RGBColor {
    let [red, green, blue] = palette::color(index).map(|channel| (channel * 255.0).round() as u8);
    RGBColor(red, green, blue)
}
