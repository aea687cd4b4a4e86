//! Rays against the balls of a tree.

use super::BallKind;
use super::placement::exact_ball;
use super::point::unscaled;
use super::side::{Bits, Side, nearest_last};
use super::stack::Stack;
use crate::InnerSphereTree;
use crate::simd_level::simd_level;
use crate::tree::WIDTH;
use fearless_simd::{Simd, dispatch, f32x8, prelude::*};
use glam::{DVec3, Vec3};

/// Room for rounding in f32, relative to the coordinates; balls that pass are tested again in f64.
const ROUNDING: f32 = 2e-6;

/// A half-line in the tree's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it begins (m).
    pub origin: Vec3,
    /// Where it goes; of any length. Its length is the way in one unit of time.
    pub direction: Vec3,
    /// The time at which it ends; may be infinite.
    pub max_time: f32,
}

/// Where a ray first crosses the surface of a ball, in the tree's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct RayHit {
    /// Time of the hit: the point is `origin + time * direction`.
    pub time: f32,
    /// Index of the sphere in its packing.
    pub sphere: usize,
    /// Where the hit is (m).
    pub point: Vec3,
    /// Unit normal of the ball at the hit, on the side that the ray comes from: outward, or inward for a ray that
    /// begins inside.
    pub normal: Vec3,
}

impl InnerSphereTree {
    /// The first hit of `ray` on the balls.
    ///
    /// If the ray begins inside a ball and `solid` holds, the hit is there, at time 0; without `solid` the first surface
    /// that the ray crosses counts, be it on the way in or out of a ball. A ray of direction zero hits
    /// the balls that it begins in, at time 0. `None` where nothing is hit until `ray.max_time`, where a number is NaN,
    /// and where the origin is beyond 10¹⁸ times the tree's size.
    ///
    /// Hits are computed in f64. Expected time is logarithmic in the number of spheres for rays that hit.
    #[must_use]
    pub fn cast_ray(&self, ray: &Ray, solid: bool, balls: BallKind) -> Option<RayHit> {
        let origin = unscaled(self, ray.origin)?;
        if !(ray.direction.is_finite() && ray.max_time >= 0.0) {
            return None;
        }
        let length = ray.direction.as_dvec3().length();
        if length == 0.0 {
            return self.inside_hit(ray, balls);
        }
        let exact = ExactRay {
            origin: ray.origin.as_dvec3(),
            direction: ray.direction.as_dvec3() / length,
            max_way: f64::from(ray.max_time) * length,
            solid,
        };
        let search = Search {
            side: Side::fixed(self, balls),
            origin,
            direction: exact.direction.as_vec3(),
            to_local: 1.0 / self.unit(),
        };
        let hit = |i: usize| exact.hit(exact_ball(self, balls, i));
        let (way, sphere) = dispatch!(simd_level(), simd => search.first(simd, exact.max_way, &hit))?;
        let point = exact.origin + way * exact.direction;
        let (center, radius) = exact_ball(self, balls, sphere);
        let outward = (point - center).try_normalize().unwrap_or(-exact.direction);
        let inside = exact.origin.distance_squared(center) <= radius * radius;
        Some(RayHit {
            time: ((way / length) as f32).min(ray.max_time),
            sphere: self.packing_index(sphere),
            point: point.as_vec3(),
            normal: if inside { -outward } else { outward }.as_vec3(),
        })
    }

    fn inside_hit(&self, ray: &Ray, balls: BallKind) -> Option<RayHit> {
        let nearest = self.nearest_sphere(ray.origin, balls).filter(|nearest| nearest.distance <= 0.0)?;
        Some(RayHit { time: 0.0, sphere: nearest.sphere, point: ray.origin, normal: -nearest.normal })
    }
}

/// A ray of unit direction, in metres.
struct ExactRay {
    origin: DVec3,
    direction: DVec3,
    max_way: f64,
    solid: bool,
}

impl ExactRay {
    /// The way to the first hit on a ball.
    fn hit(&self, (center, radius): (DVec3, f64)) -> Option<f64> {
        let from_origin = center - self.origin;
        let nearest = from_origin.dot(self.direction);
        // With the point of the line nearest to the centre nothing cancels for balls far away.
        let aside = (from_origin - nearest * self.direction).length_squared();
        let half = radius * radius - aside;
        if half < 0.0 {
            return None;
        }
        let half = libm::sqrt(half);
        let way = if from_origin.length_squared() > radius * radius {
            nearest - half
        } else if self.solid {
            0.0
        } else {
            nearest + half
        };
        // Outside and past the ball, the way in lies behind the origin.
        (way >= 0.0 && way <= self.max_way).then_some(way)
    }
}

/// The ray in the tree's unscaled frame.
struct Search<'a> {
    side: Side<'a>,
    origin: Vec3,
    direction: Vec3,
    /// From metres to the unscaled frame.
    to_local: f32,
}

impl Search<'_> {
    /// Way to the first hit (m) and its sphere.
    #[inline(always)]
    fn first<S: Simd>(
        &self,
        simd: S,
        max_way: f64,
        hit: &impl Fn(usize) -> Option<f64>,
    ) -> Option<(f64, usize)> {
        let height = self.side.data.height();
        if height == 0 {
            return hit(0).map(|way| (way, 0));
        }
        let (center, radius) = self.side.ball(height, 0);
        let slack = ROUNDING * (self.origin.abs().max_element() + center.abs().max_element() + radius);
        let mut best: Option<(f64, usize)> = None;
        let mut limit = max_way as f32 * self.to_local + slack;
        let mut stack = Stack::new((0.0, height, 0));
        while let Some((way, level, node)) = stack.pop() {
            if way > limit {
                continue;
            }
            let first = node * WIDTH;
            let (ways, live) = self.ways(simd, level - 1, first, slack);
            let mask = ways.simd_le(limit).to_bitmask() as u32 & live;
            if level == 1 {
                for lane in Bits(mask) {
                    let Some(way) = hit(first + lane) else { continue };
                    if best.is_none_or(|(best, _)| way < best) {
                        best = Some((way, first + lane));
                        limit = way as f32 * self.to_local + slack;
                    }
                }
                continue;
            }
            let ways = ways.to_array();
            for lane in nearest_last(&ways, mask) {
                stack.push((ways[lane], level - 1, first + lane));
            }
        }
        best
    }

    /// Lower bounds of the ways into eight balls; which balls the line meets and has not passed.
    #[inline(always)]
    fn ways<S: Simd>(&self, simd: S, level: usize, first: usize, slack: f32) -> (f32x8<S>, u32) {
        let (block, live) = self.side.block(simd, level, first);
        let (x, y, z) = (block.x - self.origin.x, block.y - self.origin.y, block.z - self.origin.z);
        let d = self.direction;
        let nearest = x * d.x + y * d.y + z * d.z;
        let (ax, ay, az) = (x - nearest * d.x, y - nearest * d.y, z - nearest * d.z);
        let aside = ax * ax + ay * ay + az * az;
        let radius = block.radius + slack;
        let meets = aside.simd_le(radius * radius).to_bitmask() as u32;
        // The ball reaches at most its radius towards the origin: cheap, and enough to order and to prune.
        let ways = nearest - radius;
        let ahead = (nearest + radius).simd_ge(0.0).to_bitmask() as u32;
        (ways, live & meets & ahead)
    }
}
