//! The measurements as a log-log plot.

use crate::Measurement;
use crate::solids::Row;
use crate::table::{exponent, grouped};
use plotters::coord::Shift;
use plotters::prelude::*;
use std::error::Error;
use std::ops::Range;
use std::path::Path;

const SIZE: (u32, u32) = (1500, 470);
const SPHERES: Range<f64> = 700.0..1.5e6;
/// Milliseconds.
const TIMES: Range<f64> = 0.02..1000.0;
const FONT: &str = "sans-serif";

/// What is drawn: name, colour and time (s). Colours that the colour-blind tell apart, after M. Okabe and K. Ito.
type Line = (&'static str, RGBColor, fn(&Measurement) -> f64);
const LINES: [Line; 3] = [
    ("tree, one thread", RGBColor(213, 94, 0), |m| m.tree),
    ("grid, one thread", RGBColor(0, 114, 178), |m| m.grid_one_thread),
    ("grid, two threads", RGBColor(0, 158, 115), |m| m.grid_two_threads),
];

type Panel<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Writes one panel per row.
pub(crate) fn draw(path: &Path, rows: &[(&Row, Vec<Measurement>)]) -> Result<(), Box<dyn Error>> {
    let root = SVGBackend::new(path, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    for (panel, (row, measurements)) in root.split_evenly((1, rows.len())).iter().zip(rows) {
        draw_row(panel, row, measurements)?;
    }
    root.present()?;
    Ok(())
}

fn draw_row(panel: &Panel, row: &Row, measurements: &[Measurement]) -> Result<(), Box<dyn Error>> {
    let turn = row.turns.last().ok_or("a row has no turn")?;
    let mut chart = ChartBuilder::on(panel)
        .caption(format!("A {}, {turn}", row.name), (FONT, 13))
        .margin(12)
        .margin_right(24)
        .x_label_area_size(46)
        .y_label_area_size(62)
        .build_cartesian_2d(SPHERES.log_scale(), TIMES.log_scale())?;
    chart
        .configure_mesh()
        .x_desc("spheres of each solid")
        .y_desc("time of one query (ms)")
        .x_label_formatter(&|count| grouped(*count as usize))
        .y_label_formatter(&|time| time.to_string())
        .bold_line_style(BLACK.mix(0.15))
        .light_line_style(TRANSPARENT)
        .axis_desc_style((FONT, 15))
        .label_style((FONT, 13))
        .draw()?;
    for (name, color, time) in LINES {
        let points = || measurements.iter().map(move |m| (m.spheres as f64, 1e3 * time(m)));
        let e = exponent(measurements, time);
        chart
            .draw_series(LineSeries::new(points(), color.stroke_width(2)))?
            .label(format!("{name}: exponent {e:.2}"))
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], color.stroke_width(2)));
        chart.draw_series(points().map(|point| Circle::new(point, 4, color.filled())))?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .label_font((FONT, 14))
        .background_style(WHITE)
        .border_style(BLACK.mix(0.3))
        .draw()?;
    Ok(())
}
