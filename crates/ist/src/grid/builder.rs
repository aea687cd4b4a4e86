//! From spheres to levels, cells and groups.

use super::cells::{CellTable, morton};
use super::{CELL_WIDTH, GridData, Level};
use crate::tree::{Balls, Leaf, TreeData, WIDTH};
use alloc::vec::Vec;
use glam::Vec3;

/// Sub-cells per axis of a cell: entries of one cell stand in their Morton order.
const SUBCELLS: f32 = 4.0;
/// Bits of a Morton code that tell sub-cells of one cell apart.
pub(super) const SUBCELL_BITS: u32 = 6;
/// Cells along the longest side, at most: a Morton code has 21 bits per axis, two of them for sub-cells.
const MOST_CELLS: f32 = 5e5;

/// Widest extent of a group's centres, in cells.
const WIDEST_GROUP: f32 = 1.0;

struct Placed {
    level: u32,
    code: u64,
    index: u32,
}

pub(super) fn build(tree: &TreeData) -> GridData {
    let balls = &tree.levels[0];
    let smallest = (0..balls.len()).map(|i| balls.get(i).1).fold(f32::INFINITY, f32::min);
    let level = |radius: f32| octave(radius / smallest);
    let mut largest = Vec::new();
    let mut corners = (Vec3::splat(f32::INFINITY), Vec3::splat(f32::NEG_INFINITY));
    for i in 0..balls.len() {
        let (center, radius) = balls.get(i);
        let level = level(radius) as usize;
        if largest.len() <= level {
            largest.resize(level + 1, 0.0_f32);
        }
        largest[level] = largest[level].max(radius);
        corners = (corners.0.min(center), corners.1.max(center));
    }
    let (origin, extent) = (corners.0, (corners.1 - corners.0).max_element());
    let cell_of = |largest: f32| (CELL_WIDTH * largest).max(extent / MOST_CELLS);
    let mut placed: Vec<Placed> = (0..balls.len())
        .map(|i| {
            let (center, radius) = balls.get(i);
            let level = level(radius);
            let at = (center - origin) / cell_of(largest[level as usize]);
            // Cells first and sub-cells then, so that a sphere's cell is that of its coordinates, whatever the rounding.
            let cell = at.floor();
            let sub = ((at - cell) * SUBCELLS).floor().min(Vec3::splat(SUBCELLS - 1.0));
            let code = morton(cell.as_uvec3().to_array()) << SUBCELL_BITS | morton(sub.as_uvec3().to_array());
            Placed { level, code, index: i as u32 }
        })
        .collect();
    placed.sort_unstable_by_key(|p| (p.level, p.code, p.index));

    let mut groups = Vec::new();
    let mut levels = Vec::new();
    let mut start = 0;
    for part in placed.chunk_by(|a, b| a.level == b.level) {
        let largest = largest[part[0].level as usize];
        let cell = cell_of(largest);
        let first_group = groups.len();
        split_groups(balls, part, start, WIDEST_GROUP * cell, &mut groups);
        let cells = CellTable::new(&occupied_cells(part, start));
        let last_cell = ((corners.1 - origin) / cell).floor().as_uvec3();
        levels.push(Level { largest, cell, groups: first_group..groups.len(), last_cell, cells });
        start += part.len();
    }
    groups.push(start as u32);
    let mut entries = Vec::with_capacity(placed.len() + WIDTH);
    entries.extend(placed.iter().map(|p| tree.leaves[p.index as usize]));
    entries.extend([Leaf::FAR; WIDTH]);
    GridData { levels, entries, groups, origin }
}

/// ⌊log₂ x⌋ for x ≥ 1, without a platform's logarithm.
fn octave(x: f32) -> u32 {
    (x.to_bits() >> 23).saturating_sub(127)
}

/// Appends where the groups of a level begin: up to eight entries in sequence that are not too far apart.
fn split_groups(balls: &Balls, part: &[Placed], start: usize, widest: f32, groups: &mut Vec<u32>) {
    let (mut lower, mut upper, mut count) = (Vec3::ZERO, Vec3::ZERO, WIDTH);
    for (i, p) in part.iter().enumerate() {
        let center = balls.get(p.index as usize).0;
        let (low, high) = (lower.min(center), upper.max(center));
        if count == WIDTH || (high - low).max_element() > widest {
            groups.push((start + i) as u32);
            (lower, upper, count) = (center, center, 1);
        } else {
            (lower, upper, count) = (low, high, count + 1);
        }
    }
}

fn occupied_cells(part: &[Placed], start: usize) -> Vec<(u64, core::ops::Range<u32>)> {
    let mut at = start as u32;
    part.chunk_by(|a, b| a.code >> SUBCELL_BITS == b.code >> SUBCELL_BITS)
        .map(|cell| {
            let begin = at;
            at += cell.len() as u32;
            (cell[0].code >> SUBCELL_BITS, begin..at)
        })
        .collect()
}
