//! Which cells of a level hold spheres.

use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;

/// A hash table from cells to ranges of entries, with linear probing, at most half full.
#[derive(Debug)]
pub(crate) struct CellTable {
    slots: Vec<Slot>,
    occupied: usize,
}

#[derive(Clone, Copy, Debug)]
struct Slot {
    cell: u64,
    start: u32,
    /// Zero marks an empty slot: no cell ends at the first entry.
    end: u32,
}

impl CellTable {
    /// From cells, each once, with their entries.
    pub(super) fn new(cells: &[(u64, Range<u32>)]) -> Self {
        let empty = Slot { cell: 0, start: 0, end: 0 };
        let mut slots = vec![empty; (2 * cells.len()).next_power_of_two()];
        for (cell, entries) in cells {
            let mut at = hash(*cell) & (slots.len() - 1);
            while slots[at].end != 0 {
                at = (at + 1) & (slots.len() - 1);
            }
            slots[at] = Slot { cell: *cell, start: entries.start, end: entries.end };
        }
        Self { slots, occupied: cells.len() }
    }

    /// The entries of `cell`, none if it is empty.
    #[inline(always)]
    pub(super) fn get(&self, cell: u64) -> Range<u32> {
        let mask = self.slots.len() - 1;
        let mut at = hash(cell) & mask;
        loop {
            let slot = self.slots[at & mask];
            if slot.cell == cell || slot.end == 0 {
                return slot.start..slot.end;
            }
            at += 1;
        }
    }

    /// Number of cells that hold spheres.
    pub(super) fn occupied(&self) -> usize {
        self.occupied
    }
}

/// Fibonacci hashing: neighbours spread over the table.
#[inline(always)]
fn hash(cell: u64) -> usize {
    (cell.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32) as usize
}

/// Interleaved bits of three numbers below 2²¹, the Morton code.
pub(super) fn morton([x, y, z]: [u32; 3]) -> u64 {
    spread_bits(x) | spread_bits(y) << 1 | spread_bits(z) << 2
}

/// The lower 21 bits of `v` with two zeros between neighbours.
#[inline(always)]
pub(super) fn spread_bits(v: u32) -> u64 {
    let mut v = u64::from(v) & 0x1F_FFFF;
    v = (v | v << 32) & 0x001F_0000_0000_FFFF;
    v = (v | v << 16) & 0x001F_0000_FF00_00FF;
    v = (v | v << 8) & 0x100F_00F0_0F00_F00F;
    v = (v | v << 4) & 0x10C3_0C30_C30C_30C3;
    (v | v << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn morton_interleaves() {
        assert_eq!(morton([1, 0, 0]), 1);
        assert_eq!(morton([0, 1, 0]), 2);
        assert_eq!(morton([0, 0, 1]), 4);
        assert_eq!(morton([3, 3, 3]), 63);
        assert_eq!(morton([0x1F_FFFF; 3]), (1 << 63) - 1);
    }

    #[test]
    fn every_cell_is_found_and_no_other() {
        let cells: Vec<_> = (0..1000_u32).map(|i| (u64::from(i) * 7919, i..i + 1)).collect();
        let table = CellTable::new(&cells);
        for i in 0..1000 {
            assert_eq!(table.get(i * 7919), i as u32..i as u32 + 1);
            assert!(table.get(i * 7919 + 1).is_empty());
        }
    }
}
