//! Figures of a run: what the table and the summary file show.

use crate::run::{Body, Simulation};
use glam::DVec3;
use glamx::DPose3;
use packer::Solid;
use rapier3d::math::Pose;
use serde::Serialize;
use std::fmt;

/// The summary of a run; every example's summary has these names.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Summary {
    /// Moving bodies.
    pub bodies: usize,
    /// Spheres of all moving bodies.
    pub spheres: usize,
    /// Steps simulated.
    pub steps: usize,
    /// Median wall time of a step (ms).
    pub step_ms_median: f64,
    /// 95th percentile of the wall time of a step (ms).
    pub step_ms_p95: f64,
    /// Median wall time of the overlap queries of a step (ms).
    pub query_ms_median: f64,
    /// Greatest depth of a vertex of one mesh inside another at the end, as a fraction of the smaller body's
    /// longest side. Measured on the exact meshes, whatever stands for them in the simulation.
    pub deepest_overlap: f64,
    /// Largest speed of a body at the end (m/s).
    pub max_speed: f64,
    /// Bodies asleep at the end.
    pub asleep: usize,
    /// Bodies that left the scene, as out of the pile's bowl, or with a pose that is not finite.
    pub lost: usize,
}

/// Wall times of the steps of a run (ms).
#[derive(Clone, Debug, Default)]
pub struct Timings {
    /// Whole steps.
    pub step: Vec<f64>,
    /// Overlap queries.
    pub query: Vec<f64>,
}

impl Summary {
    /// Figures of `simulation` after a run.
    #[must_use]
    pub fn of(simulation: &impl Simulation, timings: &Timings) -> Self {
        let set = &simulation.world().bodies;
        let bodies = simulation.bodies();
        let moving: Vec<&Body> = bodies.iter().filter(|body| set[body.handle].is_dynamic()).collect();
        let spheres = |body: &&Body| body.packing.map_or(0, |packing| packing.spheres().len());
        let speed = |body: &&Body| f64::from(set[body.handle].linvel().length());
        // What has no collider, as a mark of a surface, is in nobody's way.
        let solid = |body: &&Body| !set[body.handle].colliders().is_empty();
        let finite = bodies.iter().filter(solid).filter(|body| set[body.handle].position().is_finite());
        let placed = finite
            .map(|body| PlacedSolid::new(body.solid, set[body.handle].position(), f64::from(body.scale)));
        Self {
            bodies: moving.len(),
            spheres: moving.iter().map(spheres).sum(),
            steps: timings.step.len(),
            step_ms_median: percentile(&timings.step, 0.5),
            step_ms_p95: percentile(&timings.step, 0.95),
            query_ms_median: percentile(&timings.query, 0.5),
            deepest_overlap: deepest_overlap(&placed.collect::<Vec<_>>()),
            max_speed: moving.iter().map(speed).fold(0.0, f64::max),
            asleep: moving.iter().filter(|body| set[body.handle].is_sleeping()).count(),
            lost: simulation.lost(),
        }
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut row = |name: &str, value: String| writeln!(f, "  {name:<18}{value:>22}");
        row("bodies", self.bodies.to_string())?;
        row("spheres", self.spheres.to_string())?;
        row("steps", self.steps.to_string())?;
        row("step time", format!("{:.2} ms, p95 {:.2} ms", self.step_ms_median, self.step_ms_p95))?;
        row("of it queries", format!("{:.2} ms", self.query_ms_median))?;
        row("deepest overlap", format!("{:.2} % of size", 100.0 * self.deepest_overlap))?;
        row("largest speed", format!("{:.3} m/s", self.max_speed))?;
        row("asleep", format!("{} of {}", self.asleep, self.bodies))?;
        row("lost", self.lost.to_string())
    }
}

/// The value below which `share` of `values` lie; 0 where there is none.
#[must_use]
pub fn percentile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted
        .get(((sorted.len() as f64 * share) as usize).min(sorted.len().saturating_sub(1)))
        .copied()
        .unwrap_or(0.0)
}

/// A solid somewhere in the world.
#[derive(Clone, Copy, Debug)]
pub struct PlacedSolid<'a> {
    solid: &'a Solid,
    /// From the solid's frame, after scaling, to the world.
    pose: DPose3,
    scale: f64,
    /// Centre and radius of a ball around it.
    bounds: (DVec3, f64),
}

impl<'a> PlacedSolid<'a> {
    /// `solid`, scaled by `scale` and then placed at `pose`.
    #[must_use]
    pub fn new(solid: &'a Solid, pose: &Pose, scale: f64) -> Self {
        let pose = DPose3::from_parts(pose.translation.as_dvec3(), pose.rotation.as_dquat().normalize());
        let (lower, upper) = solid.bounds();
        let center = pose * ((lower + upper) * (0.5 * scale));
        Self { solid, pose, scale, bounds: (center, (upper - lower).length() * 0.5 * scale) }
    }

    /// Longest side of its box in its own frame (m).
    fn size(&self) -> f64 {
        let (lower, upper) = self.solid.bounds();
        (upper - lower).max_element() * self.scale
    }

    /// Greatest depth (m) of a vertex of `other` under this surface; 0 where none is inside.
    fn deepest_vertex_of(&self, other: &Self) -> f64 {
        let into = self.pose.inverse() * other.pose;
        let (lower, upper) = self.solid.bounds();
        let inside = |p: DVec3| p.cmpge(lower).all() && p.cmple(upper).all();
        let vertices = other.solid.mesh().vertices.iter().map(|v| (into * (*v * other.scale)) / self.scale);
        vertices.filter(|p| inside(*p)).map(|p| self.solid.depth(p)).fold(0.0, f64::max) * self.scale
    }
}

/// Greatest depth of a vertex of one solid inside another, over all pairs, as a fraction of the smaller one's size.
#[must_use]
pub fn deepest_overlap(solids: &[PlacedSolid]) -> f64 {
    let mut deepest = 0.0_f64;
    for (i, a) in solids.iter().enumerate() {
        for b in &solids[i + 1..] {
            if a.bounds.0.distance(b.bounds.0) < a.bounds.1 + b.bounds.1 {
                let depth = a.deepest_vertex_of(b).max(b.deepest_vertex_of(a));
                deepest = deepest.max(depth / a.size().min(b.size()));
            }
        }
    }
    deepest
}
