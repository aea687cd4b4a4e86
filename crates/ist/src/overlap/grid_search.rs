//! Finding the overlapping pairs of two solids by their grids.
//!
//! Every pair is seen once, from its smaller sphere: spheres of B look in those levels of A whose largest radius is at least
//! that of their own level, and spheres of A in the other levels of B. Neighbours look together: the spheres near the box
//! around many groups, of all levels, make one list; it is filtered by the boxes of fewer and fewer of them, and what is left
//! for a group is tested against each sphere of it.

use super::lanes::{Ball, BlockLanes, live_lanes};
use super::leaf_lanes::LeafLanes;
use super::pairs::{NearSpheres, PairBuffer, PairSink, SphereBlock};
use super::relative_pose::RelativePose;
use super::workspace::{Blocks, Candidates};
use crate::grid::{GridData, Level};
use crate::tree::{BallBlock, Leaf, WIDTH};
use alloc::vec::Vec;
use core::cmp::Reverse;
use core::ops::Range;
use fearless_simd::{Simd, f32x8, mask32x8, prelude::*, u32x8};
use glam::{Mat3, Vec3};

/// Groups per task: enough work to be worth handing to another thread, about 500 spheres.
///
/// A solid of 1,000 / 8,000 / 27,000 spheres in itself, in µs: on one thread 130 / 1,210 / 4,330 with 64 groups, 0 / 6 / 5 %
/// more with 32; on two threads 71 / 705 / 2,280, the same with 32 as far as the machine's noise shows. With 128, two solids
/// of 1,000 spheres have too few tasks for two threads: twice the time.
const TASK: usize = 64;

/// Neighbours whose boxes narrow the list down, first so many at once and then so few, before each group's own box does.
///
/// Time per sphere, a cube of tiles in itself, 1,000 / 27,000 / 343,000 / 1,000,000 spheres: 56 / 67 / 76 / 80 ns. With lists
/// for up to 16 groups, from which those of single groups are made, 59 / 75 / 90 / 91 ns: more spheres, of which fewer lie at
/// the surface, have longer lists.
const MANY: usize = 16;
const FEW: usize = 4;

/// Widest extent of the centres of neighbours, in cells of their level.
///
/// Time per sphere, a rabbit in itself at an angle, 1,000 / 10,000 / 100,000 spheres: with cells as wide as 8 largest radii
/// 34 / 37 / 40 ns for 2 cells, 35 / 44 / 42 for 3, 42 / 46 / 48 for 4; with cells of 6 radii 33 / 40 / 49 ns for 2
/// cells, and of 4 radii 37 / 60 / 80. Without neighbours, every group for itself, 56 / 75 / 92 ns. All this with up to 16
/// groups; with 64, 3 cells of 6 or 8 radii are as good.
const WIDEST: f32 = 2.0;

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
    /// Where they are, along a curve through space.
    position: u64,
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
    neighbours: Vec<Group>,
    /// The other solid's spheres near all of the neighbours, near [`MANY`] and [`FEW`] of them, and near one group.
    near: Candidates,
    near_many: Candidates,
    near_few: Candidates,
    near_group: Candidates,
    cells: Vec<Range<u32>>,
    pairs: PairBuffer,
}

/// Up to eight neighbours of one level, in A's frame; what fills them up is far from everything.
#[derive(Clone, Debug)]
struct Group {
    balls: BallBlock,
    bounds: BallBox,
    /// The first of their entries.
    first: usize,
}

impl<'a> GridPair<'a> {
    /// Fills `tasks` with all work that there is, always in the same order: along a curve through space, whichever solid and
    /// level they belong to, so that neighbours find in the cache what they share. What is left of every level comes last, the
    /// largest first, so that threads end at the same time.
    ///
    /// A query of two solids of 1,000,000 spheres takes 12 % less time than with the levels one after another, of 343,000
    /// 8 %, and of 27,000, all of which the cache holds, the same. A second thread makes queries of
    /// 1,000 spheres 1.68 to 1.88 times as fast, and of 10,000 1.84 to 1.92 times; 1.56 to 1.82 and 1.77 to 1.81 with the rests
    /// wherever the curve has them.
    pub(super) fn list_tasks(self, tasks: &mut Vec<Task>) {
        tasks.clear();
        for (of_a, grid) in [(false, self.b), (true, self.a)] {
            for (level, Level { groups, .. }) in grid.levels.iter().enumerate() {
                tasks.extend(groups.clone().step_by(TASK).map(|first| {
                    let groups = first..groups.end.min(first + TASK);
                    Task { of_a, level, position: self.position(of_a, &groups), groups }
                }));
            }
        }
        tasks.sort_unstable_by_key(|task| {
            (Reverse(task.groups.len()), task.position, task.of_a, task.groups.start)
        });
    }

    /// Where along the curve a sphere in the middle of `groups` is.
    fn position(self, of_a: bool, groups: &Range<usize>) -> u64 {
        let grid = if of_a { self.a } else { self.b };
        let middle = grid.entries_of_group(groups.start.midpoint(groups.end)).start;
        let center = grid.entries[middle].center();
        self.a.along_curve(if of_a { center } else { self.pose.transform_point(center) })
    }

    /// Hands the pairs of `task` to the sink.
    #[inline(always)]
    pub(super) fn find_pairs<S: Simd>(
        self,
        simd: S,
        task: &Task,
        scratch: &mut GridScratch,
        sink: &mut impl PairSink,
    ) {
        let GridScratch { neighbours, near, near_many, near_few, near_group, cells, pairs, .. } = scratch;
        let (own, other) = if task.of_a { (self.a, self.b) } else { (self.b, self.a) };
        let levels = &other.levels[self.first_level(task)..];
        if levels.is_empty() {
            return;
        }
        let widest = own.levels[task.level].cell * if task.of_a { 1.0 } else { self.pose.scale };
        let mut next = task.groups.start;
        while next < task.groups.end {
            let around = self.next_neighbours(simd, task, (&mut next, widest), neighbours);
            cells.clear();
            for level in levels {
                let (center, half) = self.reach(&around, level, task.of_a);
                other.entries_near(level, center - half, center + half, cells);
            }
            near.clear();
            self.gather(simd, &around, (cells, task.of_a), near);
            for many in neighbours.chunks(MANY) {
                keep_near(simd, near, many, near_many);
                for few in many.chunks(FEW) {
                    keep_near(simd, near_many, few, near_few);
                    for group in few {
                        number_near(simd, near_few, &group.bounds, near_group);
                        let balls = BlockLanes::new(simd, &group.balls, 0);
                        let block = SphereBlock { balls, first: group.first, of_a: task.of_a };
                        let near = Listed { list: near_few.blocks(), numbers: near_group.indices() };
                        pairs.append(simd, &near, &block, sink);
                    }
                }
            }
        }
        pairs.flush(simd, sink);
    }

    /// Fills `neighbours` with groups of `task` from `next` on, which it moves behind them, and returns the box around all:
    /// as many as are not wider than `widest`.
    #[inline(always)]
    fn next_neighbours<S: Simd>(
        self,
        simd: S,
        task: &Task,
        (next, widest): (&mut usize, f32),
        neighbours: &mut Vec<Group>,
    ) -> BallBox {
        let grid = if task.of_a { self.a } else { self.b };
        let mut around = BallBox::EMPTY;
        neighbours.clear();
        while *next < task.groups.end {
            let entries = grid.entries_of_group(*next);
            let mut balls = self.block(simd, &grid.entries, entries.start, task.of_a).balls();
            balls.x[entries.len()..].copy_from_slice(&BallBlock::FAR.x[entries.len()..]);
            let bounds = BallBox::around(&balls, entries.len());
            let both = around.union(&bounds);
            if !neighbours.is_empty() && (both.upper - both.lower).max_element() > widest * WIDEST {
                break;
            }
            around = both;
            neighbours.push(Group { balls, bounds, first: entries.start });
            *next += 1;
        }
        around
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

    /// The box, in the other solid's unscaled frame, that holds the centre of every sphere of `level` that may meet one
    /// of `spheres`, which are A's if `of_a`: its centre and the halves of its sides.
    fn reach(self, spheres: &BallBox, level: &Level, of_a: bool) -> (Vec3, Vec3) {
        let (skin, scale) = if of_a { (self.pose.skin_b, self.pose.scale) } else { (self.pose.skin_a, 1.0) };
        let (center, half) = spheres.center_and_half();
        let half = half + spheres.radius + level.largest * scale + skin;
        let size = (center.abs() + half + self.pose.translation.abs()).max_element();
        let half = half + size * ROUNDING;
        if of_a { self.pose.box_in_b(center, half) } else { (center, half) }
    }

    /// Appends to `near` those entries in `cells` that may meet one of `spheres`, which are A's if `of_a`.
    #[inline(always)]
    fn gather<S: Simd>(
        self,
        simd: S,
        spheres: &BallBox,
        (cells, of_a): (&[Range<u32>], bool),
        near: &mut Candidates,
    ) {
        let lanes = BoxLanes::new(simd, spheres);
        let entries = if of_a { &self.b.entries } else { &self.a.entries };
        for cell in cells {
            near.make_room(cell.len());
            let mut tail = near.tail();
            for first in (cell.start as usize..cell.end as usize).step_by(WIDTH) {
                let block = self.block(simd, entries, first, !of_a);
                let mask = lanes.touched_by(&block) & live_lanes(simd, cell.end as usize, first);
                block.append_where(simd, mask, &mut tail);
            }
            near.len = tail.close();
        }
    }

    /// Eight entries from `first` on, in A's frame and with their skin.
    #[inline(always)]
    fn block<S: Simd>(self, simd: S, entries: &[Leaf], first: usize, of_a: bool) -> BlockLanes<S> {
        let LeafLanes { center, radius, .. } = LeafLanes::load(simd, entries, first);
        let (center, radius) =
            if of_a { (center, radius + self.pose.skin_a) } else { self.pose.place_lanes(center, radius) };
        let index = u32x8::load_array(simd, [0, 1, 2, 3, 4, 5, 6, 7]) + first as u32;
        BlockLanes { x: center.x, y: center.y, z: center.z, radius, index }
    }
}

/// Fills `kept` with those balls of `list` that may meet a sphere of `groups`.
#[inline(always)]
fn keep_near<S: Simd>(simd: S, list: &Candidates, groups: &[Group], kept: &mut Candidates) {
    kept.fit(list.len);
    let around = groups.iter().fold(BallBox::EMPTY, |around, group| around.union(&group.bounds));
    let bounds = BoxLanes::new(simd, &around);
    let mut tail = kept.tail();
    let blocks = list.blocks();
    for i in 0..blocks.x.len() {
        let block = BlockLanes::of(simd, blocks, i);
        block.append_where(simd, bounds.touched_by(&block), &mut tail);
    }
    kept.len = tail.close();
}

/// Fills `kept` with the numbers, in `list`, of those of its balls that may meet a sphere in `bounds`.
#[inline(always)]
fn number_near<S: Simd>(simd: S, list: &Candidates, bounds: &BallBox, kept: &mut Candidates) {
    kept.fit(list.len);
    let bounds = BoxLanes::new(simd, bounds);
    let numbers = u32x8::load_array(simd, [0, 1, 2, 3, 4, 5, 6, 7]);
    let mut tail = kept.tail();
    let blocks = list.blocks();
    for i in 0..blocks.x.len() {
        let block = BlockLanes { index: numbers + (i * WIDTH) as u32, ..BlockLanes::of(simd, blocks, i) };
        block.append_index_where(simd, bounds.touched_by(&block), &mut tail);
    }
    kept.len = tail.len;
}

/// Balls of a list by their numbers in it.
struct Listed<'a> {
    list: Blocks<'a>,
    numbers: &'a [u32],
}

impl NearSpheres for Listed<'_> {
    #[inline(always)]
    fn count(&self) -> usize {
        self.numbers.len()
    }

    #[inline(always)]
    fn get<S: Simd>(&self, simd: S, i: usize) -> (Ball<S>, u32x8<S>) {
        let (block, lane) = (self.numbers[i] as usize / WIDTH, self.numbers[i] as usize % WIDTH);
        let ball = Ball {
            x: f32x8::splat(simd, self.list.x[block][lane]),
            y: f32x8::splat(simd, self.list.y[block][lane]),
            z: f32x8::splat(simd, self.list.z[block][lane]),
            radius: f32x8::splat(simd, self.list.radius[block][lane]),
        };
        (ball, u32x8::splat(simd, self.list.index[block][lane]))
    }
}

/// A box around the centres of balls, in A's frame, and their largest radius.
#[derive(Clone, Copy, Debug)]
struct BallBox {
    lower: Vec3,
    upper: Vec3,
    radius: f32,
}

impl BallBox {
    const EMPTY: Self =
        Self { lower: Vec3::splat(f32::INFINITY), upper: Vec3::splat(f32::NEG_INFINITY), radius: 0.0 };

    fn around(balls: &BallBlock, count: usize) -> Self {
        (0..count).fold(Self::EMPTY, |around, lane| {
            let center = Vec3::new(balls.x[lane], balls.y[lane], balls.z[lane]);
            around.union(&Self { lower: center, upper: center, radius: balls.radius[lane] })
        })
    }

    fn union(&self, other: &Self) -> Self {
        Self {
            lower: self.lower.min(other.lower),
            upper: self.upper.max(other.upper),
            radius: self.radius.max(other.radius),
        }
    }

    fn center_and_half(&self) -> (Vec3, Vec3) {
        let center = 0.5 * (self.lower + self.upper);
        // From the rounded centre, so that the box holds every centre.
        (center, (self.upper - center).max(center - self.lower))
    }
}

/// A [`BallBox`] in every lane.
struct BoxLanes<S: Simd> {
    center: [f32x8<S>; 3],
    half: [f32x8<S>; 3],
    radius: f32x8<S>,
}

#[inline(always)]
fn splat<S: Simd>(simd: S, v: Vec3) -> [f32x8<S>; 3] {
    [f32x8::splat(simd, v.x), f32x8::splat(simd, v.y), f32x8::splat(simd, v.z)]
}

impl<S: Simd> BoxLanes<S> {
    #[inline(always)]
    fn new(simd: S, spheres: &BallBox) -> Self {
        let (center, half) = spheres.center_and_half();
        // A little more than the largest radius: the test must pass whatever passes that of any single sphere.
        let radius = spheres.radius + (center.abs() + half).max_element() * ROUNDING;
        Self { center: splat(simd, center), half: splat(simd, half), radius: f32x8::splat(simd, radius) }
    }

    /// Which balls come as close to the box as the largest radius.
    #[inline(always)]
    fn touched_by(&self, balls: &BlockLanes<S>) -> mask32x8<S> {
        let dx = ((balls.x - self.center[0]).abs() - self.half[0]).max(0.0);
        let dy = ((balls.y - self.center[1]).abs() - self.half[1]).max(0.0);
        let dz = ((balls.z - self.center[2]).abs() - self.half[2]).max(0.0);
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
