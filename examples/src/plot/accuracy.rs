//! Error of the overlap volume by how much two solids overlap, with power cells and of plain inner spheres.

use super::{FONT, color};
use anyhow::Result;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Bands of overlap, as a share of the smaller solid.
pub const BAND_NAMES: [&str; 3] = ["shallow", "mid", "deep"];

/// Errors on one pair of solids.
#[derive(Clone, Debug)]
pub struct Group {
    /// The pair.
    pub name: String,
    /// Median relative errors of the volume per band, with power cells and of plain inner spheres; none where no pose is in the
    /// band.
    pub errors: [[Option<f64>; 2]; 3],
}

/// What is compared.
const METHODS: [&str; 2] = ["power cells", "plain inner spheres"];
const PANEL: (u32, u32) = (310, 330);
/// Per cent, on a logarithmic scale.
const ERRORS: std::ops::Range<f64> = 0.05..150.0;
/// Half the width of a bar, and its distance from the middle of its band.
const BAR: [f64; 2] = [0.17, 0.19];

/// One panel per pair with two bars per band, as the text of an SVG file.
///
/// # Errors
/// Never for a string; the library's own otherwise.
pub fn accuracy(groups: &[Group]) -> Result<String> {
    let mut text = String::new();
    {
        let size = (PANEL.0 * groups.len().max(1) as u32, PANEL.1 + 34);
        let root = SVGBackend::with_string(&mut text, size).into_drawing_area();
        root.fill(&WHITE)?;
        let (head, body) = root.split_vertically(34);
        for (index, name) in METHODS.iter().enumerate() {
            let x = 56 + 105 * index as i32;
            head.draw(&Rectangle::new([(x, 12), (x + 14, 26)], color(index).filled()))?;
            head.draw(&Text::new((*name).to_owned(), (x + 20, 11), (FONT, 15)))?;
        }
        for (panel, group) in body.split_evenly((1, groups.len().max(1))).iter().zip(groups) {
            draw(panel, group)?;
        }
        root.present()?;
    }
    Ok(text)
}

fn draw(panel: &DrawingArea<SVGBackend, Shift>, group: &Group) -> Result<()> {
    let mut chart = ChartBuilder::on(panel)
        .caption(&group.name, (FONT, 16))
        .margin(8)
        .x_label_area_size(24)
        .y_label_area_size(56)
        .build_cartesian_2d(-0.5..2.5, ERRORS.log_scale())?;
    chart
        .configure_mesh()
        .disable_x_mesh()
        .x_labels(3)
        .x_label_formatter(&|x: &f64| {
            BAND_NAMES.get(x.round().max(0.0) as usize).copied().unwrap_or("").to_owned()
        })
        .y_desc("median error of the volume (%)")
        .y_label_formatter(&|error| format!("{error}"))
        .bold_line_style(BLACK.mix(0.15))
        .light_line_style(TRANSPARENT)
        .axis_desc_style((FONT, 13))
        .label_style((FONT, 12))
        .draw()?;
    let style = TextStyle::from((FONT, 12)).pos(Pos::new(HPos::Center, VPos::Bottom));
    for (band, errors) in group.errors.iter().enumerate() {
        for (method, error) in errors.iter().enumerate() {
            let Some(error) = error else { continue };
            let percent = (100.0 * error).clamp(ERRORS.start, ERRORS.end);
            let [half, shift] = BAR;
            let middle = band as f64 + if method == 0 { -shift } else { shift };
            let corners = [(middle - half, ERRORS.start), (middle + half, percent)];
            chart.draw_series([Rectangle::new(corners, color(method).filled())])?;
            let label = if 100.0 * error < 9.95 {
                format!("{:.1}", 100.0 * error)
            } else {
                format!("{:.0}", 100.0 * error)
            };
            chart.draw_series([Text::new(label, (middle, percent * 1.04), style.clone())])?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_error_stands_in_the_plot() {
        let errors = [[Some(0.027), Some(0.6)], [Some(0.001), Some(0.37)], [None, None]];
        let text = accuracy(&[Group { name: "this pair".to_owned(), errors }]).unwrap();
        for word in ["this pair", "2.7", "60", "0.1", "37", "shallow", "deep", METHODS[0], METHODS[1]] {
            assert!(text.contains(word), "{word}");
        }
    }
}
