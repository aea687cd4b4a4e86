//! Finding the overlapping pairs of two solids by their grids.
//!
//! Every pair is seen once, from its smaller sphere: spheres of B look in those levels of A whose largest radius is at least
//! that of their own level, and spheres of A in the other levels of B. Groups of neighbours look together: the spheres near
//! a group's box, of all levels, make one list, and that is tested against each sphere of the group.

use super::lanes::{BlockLanes, live_lanes};
use super::pairs::{Lanes, PairBuffer, PairSink};
use super::relative_pose::RelativePose;
use super::workspace::Candidates;
use crate::grid::{Entries, GridData, Level};
use crate::tree::{BallBlock, WIDTH};
use core::ops::Range;
use fearless_simd::{Simd, f32x8, mask32x8, prelude::*, u32x8};
use glam::{Mat3, Vec3};

/// Groups per task: enough work to be worth handing to another thread, about 1,000 spheres.
const TASK: usize = 128;

/// Room for the rounding of centres that were transformed there and back, relative to their coordinates.
const ROUNDING: f32 = 4e-6;

/// Spheres of one solid that look for partners in the other.
#[derive(Clone, Debug)]
pub(super) struct Task {
    /// Whether they are A's.
    of_a: bool,
    /// Index of their level.
    level: usize,
    groups: Range<usize>,
}

/// Grids of two solids and where B stands.
#[derive(Clone, Copy)]
pub(super) struct GridPair<'a> {
    pub(super) a: &'a GridData,
    pub(super) b: &'a GridData,
    pub(super) pose: &'a RelativePose,
}

/// Scratch memory of a search.
#[derive(Clone, Debug, Default)]
pub(super) struct GridScratch {
    near: Candidates,
    pairs: PairBuffer,
}

impl<'a> GridPair<'a> {
    /// All work that there is, always in the same order.
    pub(super) fn tasks(self) -> impl Iterator<Item = Task> + 'a {
        [(false, self.b), (true, self.a)].into_iter().flat_map(|(of_a, grid)| {
            grid.levels.iter().enumerate().flat_map(move |(level, Level { groups, .. })| {
                groups.clone().step_by(TASK).map(move |first| Task {
                    of_a,
                    level,
                    groups: first..groups.end.min(first + TASK),
                })
            })
        })
    }

    /// Hands the pairs of `task` to `sink`; `placed` holds all of B's leaves in A's frame.
    #[inline(always)]
    pub(super) fn find_pairs<S: Simd>(
        self,
        simd: S,
        task: &Task,
        placed: &[BallBlock],
        scratch: &mut GridScratch,
        sink: &mut impl PairSink,
    ) {
        let GridScratch { near, pairs } = scratch;
        let (own, other) = if task.of_a { (self.a, self.b) } else { (self.b, self.a) };
        let first_level = self.first_level(task);
        if first_level == other.levels.len() {
            return;
        }
        for group in task.groups.clone() {
            let entries = own.entries_of_group(group);
            let balls = self.block(simd, &own.entries, entries.start, task.of_a);
            let spheres = GroupBox::around(&balls, entries.len());
            near.clear();
            for level in &other.levels[first_level..] {
                self.gather(simd, (other, level), &spheres, task.of_a, near);
            }
            let index = core::array::from_fn(|lane| own.entries.index[entries.start + lane]);
            let lanes = Lanes { balls: &balls, index, count: entries.len(), of_a: task.of_a };
            pairs.append(simd, near, &lanes, (placed, sink));
        }
        pairs.flush(simd, placed, sink);
    }

    /// The first of the other solid's levels in which the spheres of `task` look.
    fn first_level(self, task: &Task) -> usize {
        let scale = self.pose.scale;
        if task.of_a {
            let radius = self.a.levels[task.level].largest;
            self.b.levels.partition_point(|level| level.largest * scale <= radius)
        } else {
            let radius = self.b.levels[task.level].largest * scale;
            self.a.levels.partition_point(|level| level.largest < radius)
        }
    }

    /// Appends to `near` the spheres of a level that may meet one of `spheres`, which are A's if `of_a`.
    #[inline(always)]
    fn gather<S: Simd>(
        self,
        simd: S,
        (grid, level): (&GridData, &Level),
        spheres: &GroupBox,
        of_a: bool,
        near: &mut Candidates,
    ) {
        let (skin, scale) = if of_a { (self.pose.skin_b, self.pose.scale) } else { (self.pose.skin_a, 1.0) };
        let half = spheres.half + spheres.radius + level.largest * scale + skin;
        let half =
            half + (spheres.center.abs() + half + self.pose.translation.abs()).max_element() * ROUNDING;
        let (center, half) =
            if of_a { self.pose.box_in_b(spheres.center, half) } else { (spheres.center, half) };
        let lanes = GroupLanes::new(simd, spheres);
        grid.for_each_near(level, center - half, center + half, |entries| {
            near.make_room(entries.len());
            for first in entries.clone().step_by(WIDTH) {
                let balls = self.block(simd, &grid.entries, first, !of_a);
                let mut block = BlockLanes::new(simd, &balls, 0.0, 0);
                block.index = u32x8::from_slice(simd, &grid.entries.index[first..first + WIDTH]);
                let mask = lanes.touched_by(&block) & live_lanes(simd, entries.end, first);
                block.append_where(simd, mask, near);
            }
        });
    }

    /// Eight entries from `first` on, in A's frame and with their skin.
    #[inline(always)]
    fn block<S: Simd>(self, simd: S, entries: &Entries, first: usize, of_a: bool) -> BallBlock {
        let load = |array: &[f32]| f32x8::from_slice(simd, &array[first..first + WIDTH]).to_array();
        let (x, y, z) = (load(&entries.x), load(&entries.y), load(&entries.z));
        let radius = load(&entries.radius);
        if of_a {
            let radius = (f32x8::load_array(simd, radius) + self.pose.skin_a).to_array();
            BallBlock { x, y, z, radius }
        } else {
            self.pose.place(simd, &BallBlock { x, y, z, radius })
        }
    }
}

/// A box around the centres of a group, in A's frame, and the group's largest radius.
struct GroupBox {
    center: Vec3,
    half: Vec3,
    radius: f32,
}

impl GroupBox {
    fn around(balls: &BallBlock, count: usize) -> Self {
        let (mut lower, mut upper) = (Vec3::splat(f32::INFINITY), Vec3::splat(f32::NEG_INFINITY));
        let mut radius = 0.0_f32;
        for lane in 0..count {
            let center = Vec3::new(balls.x[lane], balls.y[lane], balls.z[lane]);
            (lower, upper) = (lower.min(center), upper.max(center));
            radius = radius.max(balls.radius[lane]);
        }
        let center = 0.5 * (lower + upper);
        // From the rounded centre, so that the box holds every centre.
        Self { center, half: (upper - center).max(center - lower), radius }
    }
}

/// A [`GroupBox`] in every lane.
struct GroupLanes<S: Simd> {
    center: [f32x8<S>; 3],
    half: [f32x8<S>; 3],
    radius: f32x8<S>,
}

impl<S: Simd> GroupLanes<S> {
    #[inline(always)]
    fn new(simd: S, spheres: &GroupBox) -> Self {
        let splat = |v: Vec3| v.to_array().map(|x| f32x8::splat(simd, x));
        // A little more than the largest radius: the test must pass whatever passes that of any single sphere.
        let radius = spheres.radius + (spheres.center.abs() + spheres.half).max_element() * ROUNDING;
        Self { center: splat(spheres.center), half: splat(spheres.half), radius: f32x8::splat(simd, radius) }
    }

    /// Which balls come as close to the box as the largest radius.
    #[inline(always)]
    fn touched_by(&self, balls: &BlockLanes<S>) -> mask32x8<S> {
        let beyond = |x: f32x8<S>, axis: usize| ((x - self.center[axis]).abs() - self.half[axis]).max(0.0);
        let (dx, dy, dz) = (beyond(balls.x, 0), beyond(balls.y, 1), beyond(balls.z, 2));
        let reach = balls.radius * (1.0 + ROUNDING) + self.radius;
        (dx * dx + dy * dy + dz * dz).simd_le(reach * reach)
    }
}

impl RelativePose {
    /// A box in B's unscaled frame around one in A's, by centres and halves of the sides.
    fn box_in_b(&self, center: Vec3, half: Vec3) -> (Vec3, Vec3) {
        let back = self.rotation.transpose();
        let spread = Mat3::from_cols(back.x_axis.abs(), back.y_axis.abs(), back.z_axis.abs());
        (back * (center - self.translation) / self.scale, spread * half / self.scale)
    }
}
