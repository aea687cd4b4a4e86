//! Energy, deepest overlap and step time over the course of a recorded run.

use super::{FONT, color};
use anyhow::{Result, ensure};
use plotters::coord::Shift;
use plotters::prelude::*;
use rapier_ist::replay::{Replay, ReplayMetrics};

const WIDTH: u32 = 760;
const PANEL_HEIGHT: u32 = 210;

type Panel<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Something over the time.
struct Curve {
    name: &'static str,
    /// Time (s) and value.
    points: Vec<(f64, f64)>,
}

/// Curves that share their axes.
struct Chart {
    title: &'static str,
    curves: Vec<Curve>,
}

/// The plot of a recording, as the text of an SVG file. Step times are there if they were recorded.
///
/// # Errors
/// Where the recording has no figures, as those of poses only.
pub fn course(replay: &Replay) -> Result<String> {
    let known =
        |step: rapier_ist::replay::ReplayStep<'_>| step.metrics().map(|metrics| (step.time(), *metrics));
    let metrics: Vec<(f64, ReplayMetrics)> = replay.steps().filter_map(known).collect();
    ensure!(!metrics.is_empty(), "the recording has no figures to plot; record contacts or everything");
    let charts = charts(&metrics);
    let end = metrics.last().map_or(0.0, |(time, _)| *time).max(f64::MIN_POSITIVE);
    let mut text = String::new();
    {
        let size = (WIDTH, PANEL_HEIGHT * charts.len() as u32);
        let root = SVGBackend::with_string(&mut text, size).into_drawing_area();
        root.fill(&WHITE)?;
        for (index, (panel, chart)) in root.split_evenly((charts.len(), 1)).iter().zip(&charts).enumerate() {
            draw(panel, chart, end, index + 1 == charts.len())?;
        }
        root.present()?;
    }
    Ok(text)
}

fn charts(metrics: &[(f64, ReplayMetrics)]) -> Vec<Chart> {
    let curve = |name, value: &dyn Fn(&ReplayMetrics) -> f64| Curve {
        name,
        points: metrics.iter().map(|(time, metrics)| (*time, value(metrics))).collect(),
    };
    // Heights are over the origin, which is nowhere in particular.
    let total = |metrics: &ReplayMetrics| metrics.kinetic_energy + metrics.potential_energy;
    let at_the_end = metrics.last().map_or(0.0, |(_, metrics)| total(metrics));
    let mut charts = vec![
        Chart {
            title: "energy (J)",
            curves: vec![
                curve("kinetic", &|metrics| metrics.kinetic_energy),
                curve("kinetic and potential, over the end's", &|metrics| total(metrics) - at_the_end),
            ],
        },
        Chart {
            title: "deepest overlap (mm)",
            curves: vec![curve("", &|metrics| 1e3 * metrics.deepest_overlap)],
        },
    ];
    if metrics.iter().any(|(_, metrics)| metrics.timings.is_some()) {
        let timing = |value: fn(&rapier_ist::replay::ReplayTimings) -> f64| {
            move |metrics: &ReplayMetrics| {
                metrics.timings.as_ref().map_or(0.0, |timings| 1e3 * value(timings))
            }
        };
        let whole = curve("whole step", &timing(|timings| timings.step_seconds));
        let queries = curve("overlap queries", &timing(|timings| timings.query_seconds));
        charts.push(Chart { title: "step time (ms)", curves: vec![whole, queries] });
    }
    charts
}

fn draw(panel: &Panel, chart: &Chart, end: f64, is_last: bool) -> Result<()> {
    let values = || chart.curves.iter().flat_map(|curve| &curve.points).map(|(_, value)| *value);
    let finite = || values().filter(|value| value.is_finite());
    let (low, high) = (finite().fold(0.0, f64::min), finite().fold(0.0, f64::max));
    let margin = 0.06 * (high - low).max(1e-9);
    let mut context = ChartBuilder::on(panel)
        .caption(chart.title, (FONT, 16))
        .margin(8)
        .margin_right(24)
        .x_label_area_size(if is_last { 40 } else { 24 })
        .y_label_area_size(64)
        .build_cartesian_2d(0.0..end, low - if low < 0.0 { margin } else { 0.0 }..high + margin)?;
    context
        .configure_mesh()
        .x_desc(if is_last { "time (s)" } else { "" })
        .bold_line_style(BLACK.mix(0.15))
        .light_line_style(TRANSPARENT)
        .axis_desc_style((FONT, 14))
        .label_style((FONT, 12))
        .draw()?;
    for (index, curve) in chart.curves.iter().enumerate() {
        let color = color(index);
        let drawn =
            context.draw_series(LineSeries::new(curve.points.iter().copied(), color.stroke_width(2)))?;
        if !curve.name.is_empty() {
            drawn
                .label(curve.name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2)));
        }
    }
    if chart.curves.len() > 1 {
        context
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperRight)
            .label_font((FONT, 13))
            .background_style(WHITE.mix(0.8))
            .border_style(BLACK.mix(0.3))
            .draw()?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rapier_ist::IstPlugin;
    use rapier_ist::record::{RecordOptions, Recorder};
    use rapier3d::dynamics::RigidBodyBuilder;
    use rapier3d::pipeline::PhysicsWorld;
    use std::io::Cursor;

    fn replay(options: RecordOptions) -> Replay {
        let mut world = PhysicsWorld::new();
        let mut plugin = IstPlugin::install(&mut world);
        world.insert_body(RigidBodyBuilder::dynamic().additional_mass(2.0));
        let mut file = Cursor::new(Vec::new());
        let mut recorder = Recorder::new(&mut file, options).unwrap();
        for _ in 0..10 {
            plugin.step(&mut world);
            recorder.record(&world, plugin.report()).unwrap();
        }
        recorder.finish().unwrap();
        Replay::from_bytes(&file.into_inner()).unwrap()
    }

    #[test]
    fn what_was_recorded_is_plotted() {
        let titles = ["energy (J)", "deepest overlap (mm)", "step time (ms)"];
        let plain = course(&replay(RecordOptions::contacts())).unwrap();
        let timed = course(&replay(RecordOptions::contacts().timings(true))).unwrap();
        assert_eq!(titles.map(|title| plain.contains(title)), [true, true, false]);
        assert_eq!(titles.map(|title| timed.contains(title)), [true; 3]);
    }

    #[test]
    fn poses_alone_cannot_be_plotted() {
        assert!(course(&replay(RecordOptions::poses())).is_err());
    }
}
