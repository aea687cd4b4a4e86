//! Exact solution of block systems whose bodies hang together like a chain or a tree, by `L D Lᵀ` with 6×6 blocks.
//!
//! Bodies are eliminated by least degree: A. George and J. Liu, *The Evolution of the Minimum Degree Ordering Algorithm* (1989).
//! A chain or a tree then takes two products of blocks for each body and no more, where conjugate gradients take the more iterations
//! the longer it is.

use super::block::Block;
use std::collections::BTreeSet;

/// The order in which bodies are eliminated, and what that couples.
#[derive(Clone, Debug)]
pub(crate) struct Elimination {
    /// The body at each place of the order.
    bodies: Vec<usize>,
    /// The place of each body.
    places: Vec<usize>,
    /// Of each place, the later ones that it is coupled with when its turn comes, in order.
    columns: Vec<Vec<usize>>,
}

/// `L D Lᵀ` of a matrix, by the places of an [`Elimination`].
#[derive(Clone, Debug)]
pub(crate) struct Factors {
    inverse: Vec<Block>,
    /// Blocks of L, in the order of [`Elimination::columns`].
    lower: Vec<Vec<Block>>,
}

impl Elimination {
    /// For `size` bodies and the given couplings; `None` where it takes more than `most` products of blocks.
    pub(crate) fn new(size: usize, couplings: &[[usize; 2]], most: usize) -> Option<Self> {
        let mut near = vec![BTreeSet::new(); size];
        for &[a, b] in couplings {
            near[a].insert(b);
            near[b].insert(a);
        }
        // The bodies that are left, by their degree.
        let mut left: BTreeSet<(usize, usize)> = near.iter().map(BTreeSet::len).zip(0..).collect();
        let (mut bodies, mut products) = (Vec::with_capacity(size), 0);
        while let Some((degree, body)) = left.pop_first() {
            // One for each block of its column, and one for each pair of them.
            products += degree + degree * (degree + 1) / 2;
            if products > most {
                return None;
            }
            bodies.push(body);
            let neighbours: Vec<usize> = near[body].iter().copied().collect();
            for &neighbour in &neighbours {
                let others = &mut near[neighbour];
                left.remove(&(others.len(), neighbour));
                others.extend(neighbours.iter().filter(|&&other| other != neighbour));
                others.remove(&body);
                left.insert((others.len(), neighbour));
            }
        }
        let mut places = vec![0; size];
        bodies.iter().enumerate().for_each(|(place, &body)| places[body] = place);
        let column = |body: &usize| {
            let mut column: Vec<usize> = near[*body].iter().map(|&other| places[other]).collect();
            column.sort_unstable();
            column
        };
        let columns = bodies.iter().map(column).collect();
        Some(Self { bodies, places, columns })
    }

    /// Factors a symmetric matrix without eigenvalues below 1: the blocks of all bodies on the diagonal, and all others with their
    /// row and column.
    pub(crate) fn factors<'a>(
        &self,
        diagonal: &[Block],
        couplings: impl Iterator<Item = (usize, usize, &'a Block)>,
    ) -> Factors {
        let mut diagonal: Vec<Block> = self.bodies.iter().map(|&body| diagonal[body]).collect();
        let mut lower: Vec<Vec<Block>> =
            self.columns.iter().map(|column| vec![Block::ZERO; column.len()]).collect();
        for (row, column, block) in couplings {
            let (row, column) = (self.places[row], self.places[column]);
            if row > column
                && let Ok(entry) = self.columns[column].binary_search(&row)
            {
                lower[column][entry] += block;
            }
        }
        let mut inverse = Vec::with_capacity(diagonal.len());
        for (place, column) in self.columns.iter().enumerate() {
            // What is coupled with this place is coupled with each other from now on, later ones in the columns of earlier ones.
            let own = diagonal[place].inverse();
            let coupled = std::mem::take(&mut lower[place]);
            let scaled: Vec<Block> = coupled.iter().map(|block| block.product(&own)).collect();
            for (i, (&first, block)) in column.iter().zip(&coupled).enumerate() {
                diagonal[first].subtract_product(&scaled[i], block);
                let mut entry = 0;
                for (second, scaled) in column.iter().zip(&scaled).skip(i + 1) {
                    entry += self.columns[first][entry..].partition_point(|place| place < second);
                    lower[first][entry].subtract_product(scaled, block);
                }
            }
            lower[place] = scaled;
            inverse.push(own);
        }
        Factors { inverse, lower }
    }

    /// Solves `L D Lᵀ z = r`.
    pub(crate) fn solve(&self, factors: &Factors, r: &[[f64; 6]], z: &mut [[f64; 6]]) {
        z.copy_from_slice(r);
        for (place, column) in self.columns.iter().enumerate() {
            let own = z[self.bodies[place]];
            for (&other, block) in column.iter().zip(&factors.lower[place]) {
                let product = block.times(&own);
                let other = &mut z[self.bodies[other]];
                other.iter_mut().zip(product).for_each(|(z, product)| *z -= product);
            }
        }
        for (place, column) in self.columns.iter().enumerate().rev() {
            let body = self.bodies[place];
            let mut own = factors.inverse[place].times(&z[body]);
            for (&other, block) in column.iter().zip(&factors.lower[place]) {
                let product = block.transposed_times(&z[self.bodies[other]]);
                own.iter_mut().zip(product).for_each(|(z, product)| *z -= product);
            }
            z[body] = own;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chains_and_trees_take_a_product_or_two_for_each_body() {
        let chain: Vec<[usize; 2]> = (1..50).map(|i| [i - 1, i]).collect();
        let tree: Vec<[usize; 2]> = (1..50).map(|i| [i / 3, i]).collect();
        for couplings in [chain, tree] {
            // Of each body but the last, the block of its column and its square.
            assert!(Elimination::new(50, &couplings, 98).is_some());
            assert!(Elimination::new(50, &couplings, 97).is_none());
        }
    }
}
