//! Hierarchical uniform grids: the other way to find overlapping pairs, in linear time and on every core.
//!
//! After R. Weller, U. Frese and G. Zachmann, *Parallel collision detection in constant time* (VRIPHYS 2013). A disjoint
//! ball meets at most twelve disjoint balls that are at least as large, so each pair is looked for from its smaller
//! sphere and every sphere has a bounded amount to do. Spheres whose radii differ by less than a factor of two share a
//! level; each level has a grid of cells that are a few radii wide, and a sphere is stored in the cell of its centre.
//!
//! Departures from the paper: not single spheres but groups of up to eight neighbours of one level are looked up, so that
//! a walk over cells serves all of them and SIMD tests every candidate against them at once; cells are kept in
//! a hash table, in Morton order, so that neighbours are neighbours in memory.
//!
//! Time is linear in the spheres as long as the number of levels, the logarithm of the ratio of the radii, is bounded.

mod builder;
mod cells;

use crate::InnerSphereTree;
use crate::tree::Leaf;
use alloc::sync::Arc;
use alloc::vec::Vec;
use cells::{CellTable, morton, spread_bits};
use core::ops::Range;
use glam::{UVec3, Vec3};

/// Edge of a cell over the largest radius of its level; `overlap/grid_search.rs` has the measurement.
const CELL_WIDTH: f32 = 8.0;

/// Grids over the spheres of a tree. Building takes O(n log n), memory is about 35 bytes per sphere.
///
/// It belongs to the tree that it was made of and to all scaled copies of that, see [`InnerSphereTree::with_grid`].
#[derive(Clone, Debug)]
pub struct SphereGrid {
    data: Arc<GridData>,
}

/// All levels, from the smallest radii to the largest.
#[derive(Debug)]
pub(crate) struct GridData {
    pub(crate) levels: Vec<Level>,
    /// Volume balls by level and, within a level, in Morton order; eight far balls follow.
    pub(crate) entries: Vec<Leaf>,
    /// Where each group begins among the entries; the end of the last follows.
    pub(crate) groups: Vec<u32>,
    /// Corner from which cells are counted (m, unscaled).
    pub(crate) origin: Vec3,
}

/// Spheres of similar radius.
#[derive(Debug)]
pub(crate) struct Level {
    /// Largest radius (m, unscaled).
    pub(crate) largest: f32,
    /// Edge of a cell (m, unscaled).
    pub(crate) cell: f32,
    /// Its groups, as a range of [`GridData::groups`].
    pub(crate) groups: Range<usize>,
    /// Last cell along each axis that may hold a sphere.
    last_cell: UVec3,
    cells: CellTable,
}

impl SphereGrid {
    /// The grids of `tree`.
    pub(crate) fn new(tree: &InnerSphereTree) -> Self {
        Self { data: Arc::new(builder::build(tree.data())) }
    }

    /// Number of levels: at most the logarithm of the ratio of the largest radius to the smallest, to base two, plus one.
    #[must_use]
    pub fn levels(&self) -> usize {
        self.data.levels.len()
    }

    pub(crate) fn data(&self) -> &GridData {
        &self.data
    }
}

impl GridData {
    /// Appends to `ranges` entries of `level`, each in one range at most, among which is every sphere whose centre is in the box
    /// from `lower` to `upper` (m, unscaled).
    pub(crate) fn entries_near(&self, level: &Level, lower: Vec3, upper: Vec3, ranges: &mut Vec<Range<u32>>) {
        let cell = |corner: Vec3| ((corner - self.origin) / level.cell).floor();
        let (first, last) = (cell(lower), cell(upper));
        if last.min_element() < 0.0 {
            return;
        }
        let (first, last) = (first.as_uvec3(), last.as_uvec3().min(level.last_cell));
        let Some(sides) = last.checked_sub(first) else { return };
        let sides = sides + UVec3::ONE;
        let count = u64::from(sides.x) * u64::from(sides.y) * u64::from(sides.z);
        if count > level.cells.occupied() as u64 {
            // A wide box in a sparse level: there is less to be seen than to be skipped.
            return ranges.push(self.groups[level.groups.start]..self.groups[level.groups.end]);
        }
        for z in first.z..=last.z {
            let in_z = spread_bits(z) << 2;
            for y in first.y..=last.y {
                let in_yz = in_z | spread_bits(y) << 1;
                for x in first.x..=last.x {
                    let entries = level.cells.get(in_yz | spread_bits(x));
                    if !entries.is_empty() {
                        ranges.push(entries);
                    }
                }
            }
        }
    }

    /// Position of `point` (m, unscaled) along a curve that fills space: that of its cell in the finest level, or of the
    /// nearest cell.
    pub(crate) fn along_curve(&self, point: Vec3) -> u64 {
        let finest = &self.levels[0];
        let cell = ((point - self.origin) / finest.cell).max(Vec3::ZERO).as_uvec3().min(finest.last_cell);
        morton(cell.to_array())
    }

    /// The entries of `group`.
    #[inline(always)]
    pub(crate) fn entries_of_group(&self, group: usize) -> Range<usize> {
        self.groups[group] as usize..self.groups[group + 1] as usize
    }
}
