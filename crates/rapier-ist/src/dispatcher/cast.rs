//! Shape casts, by conservative advancement.

use super::pair::{Other, Pair};
use super::parts::for_each_part;
use super::workspace::with_workspace;
use crate::IstShape;
use crate::against_shape::{surface_distance, surface_of};
use ist::{Impact, ImpactOptions, InnerSphereTree, RigidMotion, TimeOfImpact};
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::bounding_volume::Aabb;
use rapier3d::parry::query::{NonlinearRigidMotion, ShapeCastHit, ShapeCastStatus, Unsupported};
use rapier3d::parry::shape::Shape;

/// How far in front of a contact a body stops in continuous collision detection, in parts of the tree's thickness.
///
/// Poses at the time of impact are rounded to f32, and what meets at the start of a motion is passed over: a body that stopped in
/// contact could go through in the next step.
const MARGIN: Real = 1e-3;

/// What a body may enter by, in parts of its thickness, where it starts as near: Rapier counts no body as fast that moves by less in
/// a step.
///
/// Bodies that roll or slide meet what they are on with one sphere after the other, and Rapier shortens their way to the first
/// time of impact: a ring that rolled at 1 m/s moved at half of its velocity. To hold what does not go deep is the contact's business.
const SHALLOW: Real = 0.5;

/// A cast of a pair.
#[derive(Clone, Copy)]
pub(super) struct Cast {
    pub(super) motions: [RigidMotion; 2],
    pub(super) options: ImpactOptions,
}

/// A first contact, and whether it is certain.
#[derive(Clone, Copy)]
struct First {
    impact: Impact,
    status: ShapeCastStatus,
}

impl Cast {
    /// The first contact of a tree with another shape, in the world.
    fn run(&self, tree: &InnerSphereTree, other: Other) -> Option<First> {
        if !self.motions.iter().all(is_finite) {
            return None;
        }
        match other {
            Other::Tree(other) => self.first(tree, |options| {
                with_workspace(|workspace| {
                    tree.time_of_impact(other, &self.motions, options, &mut workspace.proximity)
                })
            }),
            Other::Shape(shape) if shape.as_trimesh().is_some() => self.against_mesh(tree, shape),
            Other::Shape(shape) => self.against_parts(tree, shape),
        }
    }

    /// The earliest contact with a part of `shape`.
    fn against_parts(&self, tree: &InnerSphereTree, shape: &dyn Shape) -> Option<First> {
        let region = self.swept_box(tree);
        let mut earliest: Option<First> = None;
        for_each_part(shape, &region, &mut |pose, part| {
            let mut cast = *self;
            cast.options.max_time = earliest.map_or(self.options.max_time, |first| first.impact.time);
            let carrier = &mut cast.motions[1];
            carrier.local_center = pose.inverse_transform_point(carrier.local_center);
            carrier.pose *= *pose;
            let first = match part.as_shape::<IstShape>() {
                Some(part) => cast.run(tree, Other::Tree(part.tree())),
                None => cast.against_convex(tree, part),
            };
            if let Some(first) = first
                && earliest.is_none_or(|earliest| first.impact.time < earliest.impact.time)
            {
                earliest = Some(first);
            }
        });
        earliest
    }

    /// Of a mesh only the nearest triangle is looked at, instead of all that may be in the way.
    fn against_mesh(&self, tree: &InnerSphereTree, shape: &dyn Shape) -> Option<First> {
        self.first(tree, |options| {
            with_workspace(|workspace| {
                let surface = surface_of(shape, &Pose::IDENTITY);
                tree.time_of_surface_impact(surface, &self.motions, options, &mut workspace.proximity)
            })
        })
    }

    fn against_convex(&self, tree: &InnerSphereTree, shape: &dyn Shape) -> Option<First> {
        let surface = |point| surface_distance(shape, point);
        self.first(tree, |options| {
            with_workspace(|workspace| {
                tree.time_of_convex_impact(surface, &self.motions, options, &mut workspace.proximity)
            })
        })
    }

    /// What `query` finds, with what is certain of it.
    fn first(&self, tree: &InnerSphereTree, query: impl Fn(&ImpactOptions) -> TimeOfImpact) -> Option<First> {
        match query(&self.options) {
            TimeOfImpact::NoHit => None,
            TimeOfImpact::Hit(impact) => {
                let starts_there = impact.time <= 0.0;
                let status = if starts_there {
                    ShapeCastStatus::PenetratingOrWithinTargetDist
                } else {
                    ShapeCastStatus::Converged
                };
                Some(First { impact, status })
            }
            TimeOfImpact::Undecided { safe_time } => {
                let place = self.motions[0].pose_at(safe_time) * tree.bounding_ball().0;
                let impact = Impact {
                    time: safe_time,
                    point_a: place,
                    point_b: place,
                    normal: Vector::X,
                    sphere_a: 0,
                    sphere_b: 0,
                };
                Some(First { impact, status: ShapeCastStatus::OutOfIterations })
            }
        }
    }

    /// A box around all places of the tree, in the other shape's frame.
    fn swept_box(&self, tree: &InnerSphereTree) -> Aabb {
        let [a, b] = &self.motions;
        if b.angular_velocity != Vector::ZERO {
            return Aabb::new(Vector::NEG_INFINITY, Vector::INFINITY);
        }
        let (center, radius) = tree.bounding_ball();
        let reach = center.distance(a.local_center) + radius + self.options.target_distance;
        let start = b.pose.inverse_transform_point(a.pose * a.local_center);
        let velocity = b.pose.rotation.inverse() * (a.linear_velocity - b.linear_velocity);
        // A component of 0 stays 0 however long it lasts.
        let way =
            Vector::select(velocity.cmpeq(Vector::ZERO), Vector::ZERO, velocity * self.options.max_time);
        let end = start + way;
        // Room for rounding and for the tolerance of the cast.
        let room = Vector::splat(1.001 * reach + 1e-5 * start.abs().max_element());
        Aabb::new(start.min(end) - room, start.max(end) + room)
    }
}

/// The first contact of a pair whose shapes move by `motions`, as parry tells it.
pub(super) fn cast_pair(
    (g1, g2): (&dyn Shape, &dyn Shape),
    motions: [RigidMotion; 2],
    options: ImpactOptions,
) -> Result<Option<ShapeCastHit>, Unsupported> {
    let pair = Pair::new(g1, g2)?;
    let [first, second] = motions;
    let motions = if pair.is_swapped { [second, first] } else { motions };
    let cast = Cast { motions, options };
    Ok(cast.run(pair.tree, pair.other).map(|first| {
        let hit = cast.hit(&first);
        if pair.is_swapped { hit.swapped() } else { hit }
    }))
}

impl Cast {
    /// Witnesses and normals in the frames of their shapes at the time of impact.
    fn hit(&self, first: &First) -> ShapeCastHit {
        let impact = &first.impact;
        let [pose1, pose2] = self.motions.map(|motion| motion.pose_at(impact.time));
        ShapeCastHit {
            time_of_impact: impact.time,
            witness1: pose1.inverse_transform_point(impact.point_a),
            witness2: pose2.inverse_transform_point(impact.point_b),
            normal1: pose1.rotation.inverse() * impact.normal,
            normal2: -(pose2.rotation.inverse() * impact.normal),
            status: first.status,
            subshape1: 0,
            subshape2: 0,
        }
    }
}

/// When two shapes whose motions take a time of 1 first touch, if they do and one of them is a tree. Where that cannot be
/// decided, a time until which they do not.
pub(crate) fn time_of_impact(
    [g1, g2]: [&dyn Shape; 2],
    motions: [RigidMotion; 2],
    options: ImpactOptions,
) -> Option<Real> {
    cast_pair((g1, g2), motions, options).ok()?.map(|hit| hit.time_of_impact)
}

/// A cast between `times` of motions that turn; the time of impact counts from 0 as `times` do.
pub(super) fn cast_nonlinear(
    (g1, g2): (&dyn Shape, &dyn Shape),
    motions: [&NonlinearRigidMotion; 2],
    (start, end): (Real, Real),
    stop_at_penetration: bool,
) -> Result<Option<ShapeCastHit>, Unsupported> {
    let motions = motions.map(|motion| RigidMotion {
        pose: motion.position_at_time(start),
        local_center: motion.local_center,
        linear_velocity: motion.linvel,
        angular_velocity: motion.angvel,
    });
    let thickness = |g: &dyn Shape| g.as_shape::<IstShape>().map_or(Real::INFINITY, IstShape::thickness);
    let thickness = thickness(g1).min(thickness(g2));
    let margin = MARGIN * thickness;
    let mut options = ImpactOptions { max_time: end - start, ..ImpactOptions::default() };
    if !stop_at_penetration {
        let shallow = SHALLOW * thickness;
        let at_once = ImpactOptions { max_time: 0.0, target_distance: shallow, ..options };
        if cast_pair((g1, g2), motions, at_once)?.is_some() {
            options.ignored_depth = shallow;
        }
        options.ignored_approach = g1.ccd_thickness() + g2.ccd_thickness();
        options.target_distance = margin;
    }
    let mut hit = cast_pair((g1, g2), motions, options)?;
    // Whatever is nearer than the margin at the start moves on until it touches.
    if !stop_at_penetration && hit.is_some_and(|hit| hit.time_of_impact <= 0.0) {
        options.target_distance = 0.0;
        hit = cast_pair((g1, g2), motions, options)?;
    }
    Ok(hit.map(|hit| ShapeCastHit { time_of_impact: start + hit.time_of_impact, ..hit }))
}

/// The motion of a body that keeps its rotation.
pub(super) fn straight(pose: Pose, velocity: Vector) -> RigidMotion {
    RigidMotion { linear_velocity: velocity, ..RigidMotion::at_rest(pose) }
}

fn is_finite(motion: &RigidMotion) -> bool {
    let vectors = [motion.local_center, motion.linear_velocity, motion.angular_velocity];
    let length = motion.pose.rotation.length();
    motion.pose.is_finite() && vectors.iter().all(|v| v.is_finite()) && length > 0.5 && length < 2.0
}
