//! From a solid to a packing.

mod ascent;
mod ball_grid;
mod cells;
mod error;
mod field;
mod noise;
mod options;
mod placing;
mod plateau;
mod power_cells;
mod progress;
mod quality;
mod report;
mod rounds;
mod samples;
mod search;
mod seeds;
mod stop_signal;
mod tangent_ball;
mod time_stop;
mod volume_stop;
mod voronoi;

pub use error::PackError;
pub use options::PackOptions;
pub use progress::{Progress, Stage};
pub use quality::{LargestGap, MassError, Quality, RadiusBin, SurfaceGap};
pub use report::{PackReport, StopReason};
pub use stop_signal::StopSignal;

use crate::Solid;
use ball_grid::{Ball, BallGrid};
use glam::DVec3;
use ist::{InnerSphere, Provenance, SpherePacking};
use placing::Placed;
use power_cells::PowerCell;
use progress::Reporter;
use rayon::prelude::*;
use stop_signal::Watch;

/// A packing and what there is to say about it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Packed {
    /// The spheres.
    pub packing: SpherePacking,
    /// Figures.
    pub report: PackReport,
}

/// Fills `solid` with disjoint balls, largest first, until a stop of `options` is reached.
///
/// The first `n` balls are those that a request for `n` would give, and the result is the same bit by bit for
/// any number of threads; rayon's current pool is used.
///
/// # Errors
/// [`PackError`] for options that cannot be met.
///
/// ```
/// use glam::DVec3;
/// use packer::{PackOptions, Solid, TriangleMesh, pack};
///
/// // A tetrahedron: four corners and four faces.
/// let mesh = TriangleMesh {
///     vertices: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
///     triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
/// };
/// let solid = Solid::new(&mesh)?;
/// let packed = pack(&solid, &PackOptions::fast().spheres(50))?;
/// assert_eq!(packed.packing.spheres().len(), 50);
/// // The first ball is the insphere.
/// let inradius = 1.0 / (3.0 + 3.0_f32.sqrt());
/// assert!((packed.packing.spheres()[0].radius - inradius).abs() < 1e-3 * inradius);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn pack(solid: &Solid, options: &PackOptions) -> Result<Packed, PackError> {
    pack_with_progress(solid, options, |_| {})
}

/// As [`pack`], telling `progress` now and then how far it has come; on the calling thread.
///
/// # Errors
/// As [`pack`].
pub fn pack_with_progress(
    solid: &Solid,
    options: &PackOptions,
    progress: impl FnMut(Progress),
) -> Result<Packed, PackError> {
    pack_interruptible(solid, options, &StopSignal::new(), progress)
}

/// As [`pack_with_progress`], for a program that lets its user end the work early: `signal` does so from any thread,
/// also from within `progress`.
///
/// # Errors
/// As [`pack`], and [`PackError::Cancelled`].
pub fn pack_interruptible(
    solid: &Solid,
    options: &PackOptions,
    signal: &StopSignal,
    mut progress: impl FnMut(Progress),
) -> Result<Packed, PackError> {
    options.validate()?;
    let watch = Watch::new(signal, options.time_limit);
    let mut reporter = Reporter::new(&mut progress);
    reporter.begin(Stage::Seeds);
    let Placed { balls, stop, cells, gap_samples } = placing::place(solid, options, &watch, &mut reporter)?;
    let mut report = PackReport::of_balls(&balls, solid.properties().volume, stop);
    let placed = watch.elapsed();
    reporter.kept(balls.len(), report.coverage);
    reporter.begin(Stage::Cells);
    let cells = cells.unwrap_or_else(|| power_cells::measure(solid, &balls, gap_samples, &watch));
    watch.go_on()?;
    let measured = watch.elapsed();
    reporter.begin(Stage::Report);
    let (spheres, depths): (Vec<_>, Vec<_>) =
        balls.par_iter().zip(&cells).map(|(ball, cell)| sphere(solid, ball, cell)).unzip();
    report.protrusion = deepest_protrusion(&balls, &depths);
    report.overlap = deepest_overlap(&balls);
    let packing =
        SpherePacking::new(spheres, *solid.properties())?.with_provenance(provenance(solid, options));
    watch.go_on()?;
    let checked = watch.elapsed();
    report.quality = options.measure_quality.then(|| Quality::measure(solid, &packing));
    watch.go_on()?;
    report.place_seconds = placed.as_secs_f64();
    report.cells_seconds = (measured - placed).as_secs_f64();
    report.finish_seconds = (checked - measured).as_secs_f64();
    report.quality_seconds = (watch.elapsed() - checked).as_secs_f64();
    reporter.begin(Stage::Finished);
    Ok(Packed { packing, report })
}

/// The provenance that packing `solid` with `options` gives: a packing that has it need not be made again.
#[must_use]
pub fn provenance(solid: &Solid, options: &PackOptions) -> Provenance {
    Provenance {
        generator: concat!("rapier-ist-packer ", env!("CARGO_PKG_VERSION")).into(),
        source: format!("{} {:016x}", options.source, solid.mesh().content_hash()).trim_start().into(),
        options: options.to_string(),
    }
}

/// The record of one ball, and the depth of its centre.
fn sphere(solid: &Solid, ball: &Ball, cell: &PowerCell) -> (InnerSphere, f64) {
    let surface = solid.closest_point(ball.center);
    let normal = (surface.point - ball.center).normalize_or(DVec3::Z).as_vec3();
    (InnerSphere { normal, ..record(ball, cell) }, surface.depth)
}

/// The record of one ball, without its normal.
fn record(ball: &Ball, cell: &PowerCell) -> InnerSphere {
    InnerSphere {
        center: ball.center.as_vec3(),
        radius: ball.radius as f32,
        cell_volume: cell.volume as f32,
        cell_centroid: cell.centroid.as_vec3(),
        normal: glam::Vec3::Z,
    }
}

/// Farthest that a ball sticks out, from the depths of their centres (m); zero or less where all are inside.
fn deepest_protrusion(balls: &[Ball], depths: &[f64]) -> f64 {
    balls.iter().zip(depths).map(|(ball, depth)| ball.radius - depth).fold(f64::NEG_INFINITY, f64::max)
}

/// The deepest overlap of any two balls (m): each against those placed before it.
fn deepest_overlap(balls: &[Ball]) -> f64 {
    let mut before = BallGrid::default();
    let mut deepest = f64::NEG_INFINITY;
    for ball in balls {
        deepest = deepest.max(ball.radius - before.clearance(ball.center, 2.0 * ball.radius));
        before.insert(*ball);
    }
    deepest
}
