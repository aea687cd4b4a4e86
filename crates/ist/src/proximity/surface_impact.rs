//! When a moving tree meets a moving solid of known distance.
//!
//! As for two trees ([`super::impact`]): nodes wait by the time before which they cannot meet the solid. A ball cannot meet it
//! before it has gone the distance between them in some direction. A convex solid lies behind the plane through its point
//! nearest to the ball's centre, and a ball cannot meet it before it meets that plane, which moves with the solid: a ball that
//! passes by close to a face is done in a few steps. Next to another solid it would take as many as it goes its distance from it: where
//! impacts that do not go deep are to be ignored, such balls are followed in steps of their size instead.

use super::impact::{Aim, Due, rounded_down};
use super::motion::{Mover, MovingBall, Snapshot};
use super::nearest::Nodes;
use super::safe_step::time_to_close;
use super::{Impact, ImpactOptions, ProximityWorkspace, RigidMotion, TimeOfImpact};
use crate::tree::WIDTH;
use crate::{InnerSphereTree, SignedDistance};
use alloc::collections::BinaryHeap;
use alloc::vec::Vec;
use glam::DVec3;

/// Tolerance of contact, relative to the radius of the tree's bounding ball, where none larger is asked for: distances of
/// shapes are computed in f32.
const CONTACT: f64 = 1e-5;

/// Room for rounding to f32, as a share.
const ROUNDING: f64 = 1e-6;

/// Nodes are opened when their gap is less than this part of their radius.
const CLOSE: f64 = 0.1;

/// How far a ball that grazes the solid goes in at most between two looks, as a share of its radius: what stands in its way must not be
/// behind its centre by then. Not tuned.
const GRAZING_DEPTH: f64 = 0.5;

/// Visits for all balls that graze the solid, see [`Cast::first_of_grazing`]. On a way w a ball of radius r takes about w / (gap + r/2).
///
/// A slab of 1,000 / 10,000 / 30,000 spheres that slides over a mesh at 10 m/s takes 3.0 / 12.0 / 31.8 ms a step, and 1.8 / 10.6 / 29.4 ms
/// if these balls are not followed at all. Bodies of that many have others, not next to the ground, that meet what stands in the way.
const GRAZING_VISITS: usize = 4096;

/// Halvings of the last step of a grazing ball before it hits something. Not tuned.
const HALVINGS: usize = 12;

/// How far ahead a step looks where the solid turns, in multiples of the time that the gap takes at the present speed.
const HORIZON: f64 = 4.0;

impl InnerSphereTree {
    /// When the balls of this solid (A) first come within the target distance of a solid B, which move by `motions` in the
    /// world.
    ///
    /// `surface` gives B's signed distance in B's frame. The result is that of
    /// [`Self::time_of_impact`] with 0 for B's sphere and the point of B nearest to the ball's centre. The time is not later
    /// than the first contact; it is as inexact as the distances are.
    ///
    /// A ball that passes by B at a small distance takes about as many visits as it goes that distance. Where B is convex
    /// use [`Self::time_of_convex_impact`]; else a tolerance bounds the visits, and so does [`ImpactOptions::ignored_depth`]: balls
    /// that come that near and go no deeper are followed in steps of their size. What they meet after 4,096 of these in all, or after they
    /// have gone in by half their radius, is not told.
    #[must_use]
    pub fn time_of_surface_impact(
        &self,
        surface: impl SignedDistance,
        motions: &[RigidMotion; 2],
        options: &ImpactOptions,
        workspace: &mut ProximityWorkspace,
    ) -> TimeOfImpact {
        self.cast_at_surface((surface, false), motions, options, workspace)
    }

    /// As [`Self::time_of_surface_impact`], in few visits, for a convex solid B.
    ///
    /// The time may be later than the first contact if B is not convex.
    #[must_use]
    pub fn time_of_convex_impact(
        &self,
        surface: impl SignedDistance,
        motions: &[RigidMotion; 2],
        options: &ImpactOptions,
        workspace: &mut ProximityWorkspace,
    ) -> TimeOfImpact {
        self.cast_at_surface((surface, true), motions, options, workspace)
    }

    fn cast_at_surface(
        &self,
        (surface, is_convex): (impl SignedDistance, bool),
        motions: &[RigidMotion; 2],
        options: &ImpactOptions,
        workspace: &mut ProximityWorkspace,
    ) -> TimeOfImpact {
        let (Some(a), Some(b)) = (Mover::new(&motions[0]), Mover::new(&motions[1])) else {
            return TimeOfImpact::Undecided { safe_time: 0.0 };
        };
        let aim = Aim::new(options, CONTACT * f64::from(self.bounding_ball().1));
        let mut cast = Cast { tree: self, surface, is_convex, movers: [a, b], aim };
        workspace.due.clear();
        workspace.grazing.clear();
        cast.run(options.max_visits, workspace)
    }
}

/// A tree and a solid on their way.
struct Cast<'a, F> {
    tree: &'a InnerSphereTree,
    surface: F,
    is_convex: bool,
    movers: [Mover; 2],
    aim: Aim,
}

/// A ball and the solid at one time, in the world.
struct Sight {
    /// Of the ball and the solid, less the target distance (m).
    gap: f64,
    /// Unit vector out of the solid.
    outward: DVec3,
    distance: f64,
    ball: MovingBall,
    /// From the solid's centre to the ball's.
    offset: DVec3,
}

impl<F: SignedDistance> Cast<'_, F> {
    fn run(&mut self, visits: usize, workspace: &mut ProximityWorkspace) -> TimeOfImpact {
        let ProximityWorkspace { due, grazing, .. } = workspace;
        let first = self.first(visits, due, grazing);
        let end = match &first {
            TimeOfImpact::Hit(impact) => f64::from(impact.time),
            TimeOfImpact::NoHit => self.aim.max_time,
            TimeOfImpact::Undecided { safe_time } => f64::from(*safe_time),
        };
        self.first_of_grazing(grazing, end).map_or(first, TimeOfImpact::Hit)
    }

    /// The first impact but for those of balls that graze the solid, which it appends to `grazing`.
    fn first(&mut self, visits: usize, heap: &mut BinaryHeap<Due>, grazing: &mut Vec<Due>) -> TimeOfImpact {
        let root = Nodes { level: [self.tree.data().height() as u8, 0], node: [0, 0] };
        heap.push(Due { time: 0.0, nodes: root });
        for _ in 0..visits {
            let Some(due) = heap.pop() else { return TimeOfImpact::NoHit };
            let Some(sight) = self.sight(&due) else { continue };
            let is_leaf = due.nodes.level[0] == 0;
            if is_leaf && sight.gap <= self.aim.close {
                if self.aim.counts(due.time, || -self.rate(&sight)) {
                    return TimeOfImpact::Hit(self.impact(&due, &sight));
                }
                continue;
            }
            if is_leaf && !self.is_convex && self.aim.graze(sight.gap, due.time, || -self.rate(&sight)) {
                grazing.push(due);
                continue;
            }
            if is_leaf || sight.gap > CLOSE * sight.ball.radius {
                let time = due.time + self.safe_step(&sight, self.aim.max_time - due.time);
                if time <= self.aim.max_time && time.is_finite() {
                    heap.push(Due { time, nodes: due.nodes });
                }
                continue;
            }
            let level = usize::from(due.nodes.level[0]) - 1;
            let first = due.nodes.node[0] as usize * WIDTH;
            let end = self.tree.data().levels[level].len().min(first + WIDTH);
            // Children are looked at when their turn comes, after what is due earlier.
            for child in first..end {
                heap.push(Due { time: due.time, nodes: due.nodes.descend(0, child) });
            }
        }
        let safe = heap.peek().map(|due| due.time);
        safe.map_or(TimeOfImpact::NoHit, |time| TimeOfImpact::Undecided { safe_time: rounded_down(time) })
    }

    /// The first impact before `end` (s) of balls that pass by close to the solid, as far as it is found in [`GRAZING_VISITS`].
    ///
    /// Advanced by their gap a slab of 10,000 spheres that slides over a mesh would use up all visits within centimetres. They do
    /// not go deep into what they pass by, so they may go in a little before they are looked at again: what stands in their way is found
    /// then.
    fn first_of_grazing(&mut self, grazing: &[Due], mut end: f64) -> Option<Impact> {
        let (mut first, mut visits) = (None, GRAZING_VISITS);
        for due in grazing {
            let (mut before, mut due) = (due.time, *due);
            while visits > 0 {
                visits -= 1;
                let Some(sight) = self.sight(&due) else { break };
                if self.hits(&due, &sight) {
                    let (last, sight) = self.first_hit(before, (due, sight));
                    end = last.time;
                    first = Some(self.impact(&last, &sight));
                    break;
                }
                let room = sight.gap + GRAZING_DEPTH * sight.ball.radius;
                if room <= 0.0 || due.time >= end {
                    break;
                }
                before = due.time;
                due.time = (due.time + self.time_to_go(&sight, room)).min(end);
            }
        }
        first
    }

    /// Whether a ball that grazed the solid is in contact with what it goes deep into by the end. How deep it is already counts as well.
    fn hits(&self, due: &Due, sight: &Sight) -> bool {
        sight.gap <= self.aim.close && !self.aim.graze(sight.gap, due.time, || -self.rate(sight))
    }

    /// When a ball that does not hit `before` (s), and does at `hit`, last does not, and what it hits.
    fn first_hit(&mut self, mut before: f64, mut hit: (Due, Sight)) -> (Due, Sight) {
        let nodes = hit.0.nodes;
        for _ in 0..HALVINGS {
            let middle = Due { time: before.midpoint(hit.0.time), nodes };
            match self.sight(&middle) {
                Some(sight) if self.hits(&middle, &sight) => hit = (middle, sight),
                _ => before = middle.time,
            }
        }
        (Due { time: before, nodes }, hit.1)
    }

    /// `None` where they cannot meet in the rest of the time.
    fn sight(&mut self, due: &Due) -> Option<Sight> {
        let now = Snapshot::new(self.tree, self.aim.kind, &self.movers[0], due.time);
        let ball = now.ball(due.nodes.level[0].into(), due.nodes.node[0] as usize);
        let (rotation, center, local_center) = self.movers[1].frame_at(due.time);
        let offset = ball.center - center;
        let local = (rotation.inverse() * offset + local_center).as_vec3();
        // A motion without an end leads out of single precision.
        if !local.is_finite() {
            return None;
        }
        let way = self.longest_way(&ball, offset, self.aim.max_time - due.time);
        let reach = ((ball.radius + self.aim.target + way) * (1.0 + ROUNDING)) as f32;
        let seen = self.surface.distance_within(local, reach);
        if seen.distance >= reach {
            return None;
        }
        let distance = f64::from(seen.distance);
        let outward = rotation * seen.outward.as_dvec3();
        Some(Sight { gap: distance - ball.radius - self.aim.target, outward, distance, ball, offset })
    }

    /// Velocity of the ball's centre relative to the solid along its outward direction (m/s).
    fn rate(&self, sight: &Sight) -> f64 {
        let [a, b] = &self.movers;
        let velocity = a.velocity + a.spin.cross(sight.ball.arm) - b.velocity - b.spin.cross(sight.offset);
        sight.outward.dot(velocity)
    }

    /// A bound of the way of a ball towards the solid in a time: see [`Self::safe_step`].
    fn longest_way(&self, ball: &MovingBall, offset: DVec3, time: f64) -> f64 {
        let speed = self.speed(ball);
        let spin = self.movers[1].spin.length();
        // What stands still goes nowhere, however long that takes.
        let way = |speed: f64| if speed == 0.0 { 0.0 } else { speed * time };
        way(speed + spin * offset.length()) + 0.5 * way(way(spin * speed))
    }

    /// A bound of the ball's speed relative to the solid's centre (m/s).
    fn speed(&self, ball: &MovingBall) -> f64 {
        let [a, b] = &self.movers;
        (a.velocity - b.velocity).length() + a.spin.cross(ball.arm).length()
    }

    /// A time, at most `rest`, in which the ball does not come within the target distance of the solid.
    ///
    /// In B's frame the centre is at `p = Rᵀ D`, with D from B's centre to the ball's. With V a bound of |D'|, the
    /// acceleration of p is at most `ω_a² |q| + 2 ω_b V + ω_b² |D|`, where |D| grows by no more than V s. Its speed, in
    /// whatever direction, is at most `V + ω_b |D|`.
    fn safe_step(&self, sight: &Sight, rest: f64) -> f64 {
        if sight.gap.is_nan() {
            return f64::INFINITY;
        }
        if sight.gap <= 0.0 {
            return 0.0;
        }
        if !self.is_convex {
            return self.time_to_go(sight, sight.gap);
        }
        let [a, b] = &self.movers;
        let turning = a.spin.cross(sight.ball.arm).length();
        let speed = self.speed(&sight.ball);
        let (spin, distance) = (b.spin.length(), sight.offset.length());
        let mut acceleration = a.spin.length() * turning;
        let mut horizon = f64::INFINITY;
        if spin > 0.0 {
            horizon = rest.min(HORIZON * sight.gap / (speed + spin * distance));
            acceleration += spin * (2.0 * speed + spin * (distance + speed * horizon));
        }
        let step = time_to_close(sight.gap, self.rate(sight), acceleration);
        // A step that ends at the horizon is no contact; beyond the motion's end there is nothing to see.
        if step <= horizon {
            step
        } else if horizon >= rest {
            f64::INFINITY
        } else {
            horizon
        }
    }

    /// A time in which the ball goes no farther than `way` (m), in B's frame.
    fn time_to_go(&self, sight: &Sight, way: f64) -> f64 {
        let (speed, spin) = (self.speed(&sight.ball), self.movers[1].spin.length());
        time_to_close(way, -(speed + spin * sight.offset.length()), spin * speed)
    }

    fn impact(&self, due: &Due, sight: &Sight) -> Impact {
        let Sight { outward, ball, distance, .. } = sight;
        Impact {
            time: rounded_down(due.time),
            point_a: (ball.center - ball.radius * *outward).as_vec3(),
            point_b: (ball.center - *distance * *outward).as_vec3(),
            normal: -outward.as_vec3(),
            sphere_a: self.tree.packing_index(due.nodes.node[0] as usize),
            sphere_b: 0,
        }
    }
}
