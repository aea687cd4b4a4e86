//! The surface of the union, where a closed surface cuts or covers itself.
//!
//! The winding number counts how often the surface winds around a point (A. Jacobson, L. Kavan and O.
//! Sorkine-Hornung, *Robust inside-outside segmentation using generalized winding numbers*, 2013). Inside is where
//! it is not zero. The surface is closed here, so the number is an integer and crossings of rays count it exactly;
//! the hierarchical sums of G. Barill et al., *Fast winding numbers for soups and clouds* (2018), are for surfaces
//! that are not.
//!
//! A triangle bounds the union where the number is zero on one side of it and not on the other. Elsewhere it is a
//! sheet inside, which nothing that lies in the solid can feel. So triangles are cut along those that they meet, and
//! sheets are left out: neither distances nor volumes know of them. Components of triangles that meet none are
//! told apart as a whole.

use super::bvh::Bvh;
use super::meetings::Meeting;
use super::plane::{TrianglePlane, margin};
use super::topology::Neighbours;
use super::trapezoids::trapezoids;
use crate::TriangleMesh;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

/// A part of the surface of the union, facing outwards.
#[derive(Clone, Debug, Default)]
pub(super) struct Visible {
    pub(super) mesh: TriangleMesh,
    /// The triangle of the whole surface of which each triangle is a part.
    pub(super) parents: Vec<u32>,
    /// Whether a triangle is its parent, cut by no other and facing the same way.
    pub(super) is_whole: Vec<bool>,
    /// Triangles that enclose the volume: those of `mesh`, but for what could not be cut.
    pub(super) enclosing: Vec<[DVec3; 3]>,
    /// Triangles that lie inside the union.
    pub(super) hidden: usize,
    /// Triangles of which parts lie inside.
    pub(super) cut: usize,
    /// Triangles that too many others meet: they are left whole.
    pub(super) uncut: usize,
}

/// What is left of one triangle.
enum Remains {
    /// It lies inside.
    Nothing,
    All(Side),
    /// It is left whole, but only these parts count for the volume.
    Barrier(Vec<[DVec3; 3]>),
    Parts(Vec<[DVec3; 3]>),
}

/// Which side of a triangle is outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Front,
    Back,
}

/// Corners of a triangle in its own coordinates.
const CORNERS: [DVec2; 3] = [DVec2::ZERO, DVec2::X, DVec2::Y];

/// Weights of the corners of a triangle, and of a trapezoid, at the point inside it that is asked for all of it. That is not the
/// middle, where modelled corners may lie: it has no side where one touches it.
const IN_TRIANGLE: [f64; 3] = [0.334_937, 0.345_217, 0.319_846];
const IN_TRAPEZOID: [f64; 4] = [0.270_916, 0.237_405, 0.257_683, 0.233_996];

/// The point of such weights.
fn inside<const N: usize>(corners: [DVec2; N], weights: [f64; N]) -> DVec2 {
    corners.into_iter().zip(weights).map(|(corner, weight)| corner * weight).sum()
}

/// Strips that a triangle which cannot be cut is sampled in, a side.
const STRIPS: u32 = 8;

/// Keeps of the closed and consistently oriented `mesh` what bounds its union.
pub(super) fn visible(
    mesh: &TriangleMesh,
    neighbours: &Neighbours,
    bvh: &Bvh,
    meetings: &[Meeting],
) -> Visible {
    let whole = Whole::new(mesh, bvh, meetings);
    let sides = whole.sides_by_component(neighbours);
    let remains: Vec<Remains> = (0..mesh.triangles.len() as u32)
        .into_par_iter()
        .map(|triangle| match sides[triangle as usize] {
            Some(side) => side.map_or(Remains::Nothing, Remains::All),
            None => whole.remains(triangle),
        })
        .collect();
    let mut out = Visible::default();
    let mut place_of = vec![u32::MAX; mesh.vertices.len()];
    for (triangle, remains) in remains.into_iter().enumerate() {
        match remains {
            Remains::Nothing => out.hidden += 1,
            Remains::All(side) => {
                let corners = mesh.triangles[triangle].map(|vertex| {
                    let place = &mut place_of[vertex as usize];
                    if *place == u32::MAX {
                        *place = out.mesh.vertices.len() as u32;
                        out.mesh.vertices.push(mesh.vertices[vertex as usize]);
                    }
                    *place
                });
                let is_whole = side == Side::Front;
                out.push(
                    triangle,
                    if is_whole { corners } else { [corners[0], corners[2], corners[1]] },
                    is_whole,
                );
                out.enclosing.push(out.mesh.corners(out.mesh.triangles.len() - 1));
            }
            Remains::Barrier(parts) => {
                out.uncut += 1;
                out.push_part(triangle, mesh.corners(triangle));
                out.enclosing.extend(parts);
            }
            Remains::Parts(parts) => {
                out.cut += 1;
                out.enclosing.extend(&parts);
                parts.into_iter().for_each(|part| out.push_part(triangle, part));
            }
        }
    }
    out
}

impl Visible {
    fn push(&mut self, parent: usize, corners: [u32; 3], is_whole: bool) {
        self.mesh.triangles.push(corners);
        self.parents.push(parent as u32);
        self.is_whole.push(is_whole);
    }

    fn push_part(&mut self, parent: usize, corners: [DVec3; 3]) {
        let first = self.mesh.vertices.len() as u32;
        self.mesh.vertices.extend(corners);
        self.push(parent, [first, first + 1, first + 2], false);
    }
}

/// The surface with its inner sheets.
struct Whole<'a> {
    mesh: &'a TriangleMesh,
    bvh: &'a Bvh,
    meets: FxHashMap<u32, Meets>,
}

/// What one triangle meets.
#[derive(Default)]
struct Meets {
    cuts: Vec<[DVec2; 2]>,
    /// Triangles in the same plane that cover a part of it, in ascending order.
    covers: Vec<u32>,
}

impl<'a> Whole<'a> {
    fn new(mesh: &'a TriangleMesh, bvh: &'a Bvh, meetings: &[Meeting]) -> Self {
        let mut meets: FxHashMap<u32, Meets> = FxHashMap::default();
        for Meeting { first, second, contact } in meetings {
            for (triangle, other, cuts) in
                [(first, second, &contact.cuts[0]), (second, first, &contact.cuts[1])]
            {
                let entry = meets.entry(*triangle).or_default();
                entry.cuts.extend(cuts);
                if contact.kind == super::contact::Kind::Cover {
                    entry.covers.push(*other);
                }
            }
        }
        Self { mesh, bvh, meets }
    }

    /// For triangles that meet no other, which side of them is outside, if one is. All triangles that are connected
    /// through such ones have the same answer; none is given for triangles too flat to meet any.
    fn sides_by_component(&self, neighbours: &Neighbours) -> Vec<Option<Option<Side>>> {
        let is_apart: Vec<bool> = (0..self.mesh.triangles.len())
            .map(|triangle| {
                self.meets.contains_key(&(triangle as u32))
                    || TrianglePlane::new(&self.mesh.corners(triangle)).is_none()
            })
            .collect();
        let mut sides = vec![None; is_apart.len()];
        let mut component = Vec::new();
        for seed in (0..is_apart.len()).filter(|seed| !is_apart[*seed]) {
            if sides[seed].is_some() {
                continue;
            }
            let side = TrianglePlane::new(&self.mesh.corners(seed))
                .and_then(|plane| self.side(seed as u32, &plane, inside(CORNERS, IN_TRIANGLE)));
            sides[seed] = Some(side);
            component.push(seed);
            while let Some(triangle) = component.pop() {
                for other in neighbours[triangle].map(|other| other as usize) {
                    if sides[other].is_none() && !is_apart[other] {
                        sides[other] = Some(side);
                        component.push(other);
                    }
                }
            }
        }
        sides
    }

    /// Which side of `triangle` is outside at one of its points, if one is. Of triangles that cover each other the
    /// first answers for all.
    fn side(&self, triangle: u32, plane: &TrianglePlane, at: DVec2) -> Option<Side> {
        let point = plane.point(at);
        let mut here = vec![triangle];
        let mut step = 1;
        for other in self.meets.get(&triangle).iter().flat_map(|meets| &meets.covers) {
            let Some(cover) = TrianglePlane::new(&self.mesh.corners(*other as usize)) else { continue };
            if margin(cover.project(point)) > 0.0 {
                if *other < triangle {
                    return None;
                }
                here.push(*other);
                step += if cover.normal().dot(plane.normal()) > 0.0 { 1 } else { -1 };
            }
        }
        let front = self.winding_in_front(point, plane.normal().normalize_or_zero(), &here);
        match (front == 0, front + step == 0) {
            (true, false) => Some(Side::Front),
            (false, true) => Some(Side::Back),
            _ => None,
        }
    }

    /// How often the surface winds around a point just in front of `p`, by the majority of three rays.
    fn winding_in_front(&self, p: DVec3, normal: DVec3, here: &[u32]) -> i32 {
        // Oblique to the normal, so that no ray grazes the plane; no modelled edge has their directions.
        let winding = |x, y, z| self.bvh.winding(p, normal + DVec3::new(x, y, z), here);
        let first = winding(0.265_851, 0.137_081, 0.400_672);
        let second = winding(-0.330_665, 0.361_229, 0.100_856);
        if first == second { first } else { winding(0.086_172, -0.406_465, -0.278_131) }
    }

    /// What remains of a triangle that meets others.
    fn remains(&self, triangle: u32) -> Remains {
        let corners = self.mesh.corners(triangle as usize);
        let (Some(plane), Some(meets)) = (TrianglePlane::new(&corners), self.meets.get(&triangle)) else {
            return Remains::All(Side::Front);
        };
        let Some(trapezoids) = trapezoids(&meets.cuts) else {
            return Remains::Barrier(self.sampled(triangle, &plane));
        };
        let sides: Vec<Option<Side>> = trapezoids
            .iter()
            .map(|trapezoid| self.side(triangle, &plane, inside(*trapezoid, IN_TRAPEZOID)))
            .collect();
        match sides.first() {
            Some(first) if sides.iter().all(|side| side == first) => {
                return first.map_or(Remains::Nothing, Remains::All);
            }
            _ => {}
        }
        let mut parts = Vec::new();
        for ([a, b, c, d], side) in trapezoids.into_iter().zip(sides) {
            for part in [[a, b, c], [a, c, d]] {
                // Trapezoids that end in a point have one triangle only.
                if (part[1] - part[0]).perp_dot(part[2] - part[0]) > 0.0 {
                    parts.extend(side.map(|side| facing(side, part.map(|at| plane.point(at)))));
                }
            }
        }
        Remains::Parts(parts)
    }

    /// Parts of a triangle that bound the union by a test at the centroid of each.
    fn sampled(&self, triangle: u32, plane: &TrianglePlane) -> Vec<[DVec3; 3]> {
        let at = |i: u32, j: u32| DVec2::new(f64::from(i), f64::from(j)) / f64::from(STRIPS);
        let cells = (0..STRIPS).flat_map(|i| (0..STRIPS - i).map(move |j| (i, j)));
        cells
            .flat_map(|(i, j)| {
                let lower = [at(i, j), at(i + 1, j), at(i, j + 1)];
                let upper = [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                // On the slanted side of the triangle there is no upper one.
                [Some(lower), (i + j + 2 <= STRIPS).then_some(upper)]
            })
            .flatten()
            .filter_map(|part| {
                let side = self.side(triangle, plane, inside(part, IN_TRIANGLE))?;
                Some(facing(side, part.map(|at| plane.point(at))))
            })
            .collect()
    }
}

/// The triangle, turned where its back is outside.
fn facing(side: Side, [a, b, c]: [DVec3; 3]) -> [DVec3; 3] {
    match side {
        Side::Front => [a, b, c],
        Side::Back => [a, c, b],
    }
}
