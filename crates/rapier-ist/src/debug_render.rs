//! Outlines of the spheres, through Rapier's debug renderer (feature `debug-render`).
//!
//! Rapier draws no custom shapes. [`SphereOutlines`] draws them to the backend that Rapier's pipeline draws the rest to, in
//! its colours:
//!
//! ```no_run
//! use rapier_ist::debug_render::SphereOutlines;
//! use rapier3d::prelude::*;
//!
//! # fn example(world: &PhysicsWorld, pipeline: &mut DebugRenderPipeline, backend: &mut impl DebugRenderBackend) {
//! // Beside `pipeline.render(…)`, every frame; keep `outlines` between frames.
//! let mut outlines = SphereOutlines::default();
//! outlines.render(pipeline, backend, &world.bodies, &world.colliders);
//! # }
//! ```

use crate::IstShape;
use ist::BallKind;
use rapier3d::dynamics::{RigidBody, RigidBodySet};
use rapier3d::geometry::{Collider, ColliderSet, Shape};
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::pipeline::{
    DebugColor, DebugRenderBackend, DebugRenderMode, DebugRenderObject, DebugRenderPipeline, DebugRenderStyle,
};

/// What the colour of an outline tells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OutlineColors {
    /// The type and state of the body, by `DebugRenderStyle`, as Rapier's own outlines.
    #[default]
    Body,
    /// The radius: from blue for the smallest sphere of a solid to red for the largest, with the lightness and opacity of the body.
    Radius,
}

/// What is drawn, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutlineOptions {
    /// Most spheres drawn of one solid, the largest of it; 300 by default.
    pub max_spheres: usize,
    /// Which balls are drawn: the certified inner ones by default.
    pub balls: BallKind,
    /// Circles around each sphere, across the axes of the collider: from 0 to 3, the default.
    pub circles: usize,
    /// What colours tell.
    pub colors: OutlineColors,
}

impl Default for OutlineOptions {
    fn default() -> Self {
        Self { max_spheres: 300, balls: BallKind::Inner, circles: 3, colors: OutlineColors::Body }
    }
}

/// Draws every [`IstShape`] of a world, alone or as a part of a compound, as circles around its spheres.
#[derive(Clone, Debug, Default)]
pub struct SphereOutlines {
    /// May be changed between frames.
    pub options: OutlineOptions,
    /// Balls of one solid: its own frame.
    spheres: Vec<(Vector, Real)>,
    /// Circles of radius 1.
    circle_points: [Vec<Vector>; 3],
}

impl From<OutlineOptions> for SphereOutlines {
    fn from(options: OutlineOptions) -> Self {
        Self { options, ..Self::default() }
    }
}

impl SphereOutlines {
    /// Draws circles of `pipeline.style.subdivisions` lines (at least 3), if `pipeline.mode` has
    /// [`DebugRenderMode::COLLIDER_SHAPES`] and the backend's filter lets the collider through.
    ///
    /// Draws lines in proportion to the circles; O(n log n) for the n spheres of each solid, as the largest are found by sorting.
    pub fn render(
        &mut self,
        pipeline: &DebugRenderPipeline,
        backend: &mut impl DebugRenderBackend,
        bodies: &RigidBodySet,
        colliders: &ColliderSet,
    ) {
        if !pipeline.mode.contains(DebugRenderMode::COLLIDER_SHAPES) {
            return;
        }
        self.prepare(pipeline.style.subdivisions.max(3));
        for (handle, collider) in colliders.iter() {
            let object = DebugRenderObject::Collider(handle, collider);
            if !backend.filter_object(object) {
                continue;
            }
            let body = collider.parent().and_then(|parent| bodies.get(parent));
            let color = body_color(&pipeline.style, collider, body);
            let mut draw = |shape: &dyn Shape, pose: &Pose| self.draw((backend, object), shape, pose, color);
            match collider.shape().as_compound() {
                None => draw(collider.shape(), collider.position()),
                Some(compound) => compound
                    .shapes()
                    .iter()
                    .for_each(|(pose, part)| draw(part.as_ref(), &(*collider.position() * *pose))),
            }
        }
    }

    /// Draws the spheres of `shape`, if it has any.
    fn draw(
        &mut self,
        (backend, object): (&mut impl DebugRenderBackend, DebugRenderObject),
        shape: &dyn Shape,
        pose: &Pose,
        color: DebugColor,
    ) {
        let Some(tree) = shape.as_shape::<IstShape>().map(IstShape::tree) else { return };
        self.spheres.clear();
        let OutlineOptions { max_spheres, balls, circles, colors } = self.options;
        match balls {
            BallKind::Volume => self.spheres.extend(tree.volume_balls()),
            BallKind::Inner => {
                self.spheres.extend(tree.inner_balls().map(|(center, radius, _)| (center, radius)))
            }
        }
        // Stable, so that of equal spheres always the same are drawn.
        self.spheres.sort_by(|a, b| b.1.total_cmp(&a.1));
        let radius = |sphere: Option<&(Vector, Real)>| sphere.map_or(0.0, |sphere| sphere.1);
        let (largest, smallest) = (radius(self.spheres.first()), radius(self.spheres.last()));
        for &(center, radius) in self.spheres.iter().take(max_spheres) {
            let color = match colors {
                OutlineColors::Body => color,
                OutlineColors::Radius => {
                    let share = (radius - smallest) / (largest - smallest).max(Real::MIN_POSITIVE);
                    [BLUE * (1.0 - share), 1.0, color[2], color[3]]
                }
            };
            let at = *pose * Pose::from_translation(center);
            for points in self.circle_points.iter().take(circles) {
                backend.draw_line_strip(object, points, &at, Vector::splat(radius), color, true);
            }
        }
    }

    fn prepare(&mut self, subdivisions: u32) {
        if self.circle_points[0].len() == subdivisions as usize {
            return;
        }
        let planes = [[Vector::X, Vector::Y], [Vector::Y, Vector::Z], [Vector::Z, Vector::X]];
        self.circle_points = planes.map(|[u, v]| {
            let point = |i: u32| {
                let (sin, cos) = (std::f32::consts::TAU * i as Real / subdivisions as Real).sin_cos();
                u * cos + v * sin
            };
            (0..subdivisions).map(point).collect()
        });
    }
}

/// Hue (degrees).
const BLUE: f32 = 240.0;

/// The colour of Rapier's outlines.
fn body_color(style: &DebugRenderStyle, collider: &Collider, body: Option<&RigidBody>) -> DebugColor {
    let Some(body) = body else {
        let enabled = collider.is_enabled();
        return if enabled { style.collider_parentless_color } else { style.disabled_color_multiplier };
    };
    let color = if body.is_fixed() {
        style.collider_fixed_color
    } else if body.is_kinematic() {
        style.collider_kinematic_color
    } else {
        style.collider_dynamic_color
    };
    let multiplier = if !body.is_enabled() || !collider.is_enabled() {
        style.disabled_color_multiplier
    } else if body.is_sleeping() {
        style.sleep_color_multiplier
    } else if !body.is_fixed() && body.activation().is_eligible_for_sleep() {
        style.sleep_eligible_color_multiplier
    } else {
        [1.0; 4]
    };
    std::array::from_fn(|i| color[i] * multiplier[i])
}
