//! From a solid to a packing.

mod ascent;
mod ball_grid;
mod cells;
mod field;
mod noise;
mod options;
mod plateau;
mod power_cells;
mod report;
mod rounds;
mod samples;
mod search;
mod seeds;
mod voronoi;

pub use options::PackOptions;
pub use report::{PackReport, Progress, StopReason};

use crate::Solid;
use ball_grid::{Ball, BallGrid};
use glam::DVec3;
use ist::{InnerSphere, PackingError, Provenance, SpherePacking};
use power_cells::PowerCell;
use rayon::prelude::*;
use std::time::Instant;

/// Gap samples of the smallest packings, whose cells are to be as exact as those of larger ones.
const FEWEST_SAMPLES: usize = 200_000;
/// Balls placed between two reports of progress.
const BALLS_PER_PROGRESS: usize = 64;

/// Why no packing was made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PackError {
    /// Zero spheres were asked for.
    #[error("zero spheres asked for; ask for at least one")]
    NoSpheresAsked,
    /// The asked coverage is no share.
    #[error("coverage {coverage} asked for; it is a share of the volume, above 0 and at most 1")]
    CoverageOutOfRange {
        /// What was asked.
        coverage: f64,
    },
    /// The asked least radius is no length.
    #[error("minimum radius {radius} asked for; it is a length (m), zero or more and finite")]
    InvalidMinRadius {
        /// What was asked.
        radius: f64,
    },
    /// Not one ball was placed.
    #[error(
        "no ball of radius {smallest:e} m or more fits; ask for a smaller minimum radius, or move the mesh towards the origin if it lies far away: single precision must resolve it there"
    )]
    NothingFits {
        /// Least radius asked for, or representable (m).
        smallest: f64,
    },
    /// The packing could not be stored.
    #[error(transparent)]
    Packing(#[from] PackingError),
}

/// A packing and what there is to say about it.
#[derive(Clone, Debug)]
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

/// As [`pack`], telling `progress` now and then how far it has come.
///
/// # Errors
/// As [`pack`].
pub fn pack_with_progress(
    solid: &Solid,
    options: &PackOptions,
    mut progress: impl FnMut(Progress),
) -> Result<Packed, PackError> {
    options.validate()?;
    let started = Instant::now();
    let (grid, stop) = place(solid, options, &mut progress)?;
    let placed = Instant::now();
    let samples = (options.samples_per_sphere * grid.balls().len()).max(FEWEST_SAMPLES);
    let cells = power_cells::measure(solid, grid.balls(), samples);
    let measured = Instant::now();
    let (spheres, depths): (Vec<_>, Vec<_>) =
        grid.balls().par_iter().zip(&cells).map(|(ball, cell)| sphere(solid, ball, cell)).unzip();
    let mut report = PackReport::of_balls(grid.balls(), solid.properties().volume, stop);
    report.protrusion = deepest_protrusion(grid.balls(), &depths);
    report.overlap = deepest_overlap(grid.balls());
    report.place_seconds = (placed - started).as_secs_f64();
    report.cells_seconds = (measured - placed).as_secs_f64();
    report.finish_seconds = measured.elapsed().as_secs_f64();
    let packing =
        SpherePacking::new(spheres, *solid.properties())?.with_provenance(provenance(solid, options));
    Ok(Packed { packing, report })
}

/// Places balls until a stop of `options` is reached, and tells which it was.
fn place(
    solid: &Solid,
    options: &PackOptions,
    progress: &mut impl FnMut(Progress),
) -> Result<(BallGrid, StopReason), PackError> {
    let volume = solid.properties().volume;
    let asked = options.min_radius.unwrap_or(0.0);
    let smallest = asked.max(resolution(solid));
    let mut stop = if smallest > asked { StopReason::Exhausted } else { StopReason::MinRadius };
    let (mut count, mut filled) = (0, 0.0);
    let grid = rounds::place(solid, smallest, |ball| {
        if count == options.spheres {
            stop = StopReason::SphereCount;
            return false;
        }
        if options.coverage.is_some_and(|coverage| filled >= coverage * volume) {
            stop = StopReason::Coverage;
            return false;
        }
        count += 1;
        filled += ball.volume();
        if count % BALLS_PER_PROGRESS == 0 {
            let by_count = count as f64 / options.spheres as f64;
            let by_coverage = options.coverage.map_or(0.0, |coverage| filled / volume / coverage);
            let fraction = by_count.max(by_coverage);
            progress(Progress { spheres: count, coverage: filled / volume, fraction });
        }
        true
    });
    if count == 0 { Err(PackError::NothingFits { smallest }) } else { Ok((grid, stop)) }
}

fn provenance(solid: &Solid, options: &PackOptions) -> Provenance {
    Provenance {
        generator: concat!("rapier-ist-packer ", env!("CARGO_PKG_VERSION")).into(),
        source: format!("{} {:016x}", options.source, solid.mesh().content_hash()).trim_start().into(),
        options: options.to_string(),
    }
}

/// Radius under which single precision no longer resolves a ball's place (m): 16 units in the last place of
/// the largest coordinate.
fn resolution(solid: &Solid) -> f64 {
    let (lower, upper) = solid.bounds();
    let largest = lower.abs().max(upper.abs()).max_element();
    16.0 * largest * f64::from(f32::EPSILON)
}

/// The record of one ball, and the depth of its centre.
fn sphere(solid: &Solid, ball: &Ball, cell: &PowerCell) -> (InnerSphere, f64) {
    let surface = solid.closest_point(ball.center);
    let sphere = InnerSphere {
        center: ball.center.as_vec3(),
        radius: ball.radius as f32,
        cell_volume: cell.volume as f32,
        cell_centroid: cell.centroid.as_vec3(),
        normal: (surface.point - ball.center).normalize_or(DVec3::Z).as_vec3(),
    };
    (sphere, surface.depth)
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
