//! Dense 6×6 blocks of the linear system.

use super::twist::{Screw, Symmetric6};
use rapier3d::glamx::{DMat3, DVec3};
use std::cmp::Ordering;
use std::ops::{AddAssign, Neg};

/// A 6×6 matrix by columns: loops over them become vector instructions, which 3×3 matrices do not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Block([[f64; 6]; 6]);

impl Block {
    pub(crate) const ZERO: Self = Self([[0.0; 6]; 6]);

    /// `[A B; C D]`.
    pub(crate) fn new([[a, b], [c, d]]: [[DMat3; 2]; 2]) -> Self {
        let column = |upper: DVec3, lower: DVec3| [upper.x, upper.y, upper.z, lower.x, lower.y, lower.z];
        let columns = |upper: DMat3, lower: DMat3| {
            [(upper.x_axis, lower.x_axis), (upper.y_axis, lower.y_axis), (upper.z_axis, lower.z_axis)]
                .map(|(upper, lower)| column(upper, lower))
        };
        let ([x, y, z], [u, v, w]) = (columns(a, c), columns(b, d));
        Self([x, y, z, u, v, w])
    }

    pub(crate) fn transposed(&self) -> Self {
        let mut out = Self::ZERO;
        for (i, column) in self.0.iter().enumerate() {
            for (row, value) in out.0.iter_mut().zip(column) {
                row[i] = *value;
            }
        }
        out
    }

    /// `sum + self · v`.
    #[inline]
    pub(crate) fn add_product(&self, v: &[f64; 6], sum: &mut [f64; 6]) {
        for (column, v) in self.0.iter().zip(v) {
            for (sum, value) in sum.iter_mut().zip(column) {
                *sum += value * v;
            }
        }
    }

    /// `selfᵀ · v`.
    #[inline]
    pub(crate) fn transposed_times(&self, v: &[f64; 6]) -> [f64; 6] {
        std::array::from_fn(|i| self.0[i].iter().zip(v).map(|(a, b)| a * b).sum())
    }

    /// `self · other`.
    pub(crate) fn product(&self, other: &Self) -> Self {
        let mut out = Self::ZERO;
        for (column, v) in out.0.iter_mut().zip(&other.0) {
            self.add_product(v, column);
        }
        out
    }

    /// Subtracts `a · bᵀ`, in place: to hand products on takes longer than to make them.
    pub(crate) fn subtract_product(&mut self, a: &Self, b: &Self) {
        for (j, sum) in self.0.iter_mut().enumerate() {
            for (column, row) in a.0.iter().zip(&b.0) {
                sum.iter_mut().zip(column).for_each(|(sum, value)| *sum -= value * row[j]);
            }
        }
    }

    /// Inverse of a symmetric matrix that has no eigenvalue below 1, by the decomposition `L D Lᵀ` with ones on the diagonal of L:
    /// G. H. Golub and C. F. Van Loan, *Matrix Computations* (2013), section 4.1.
    ///
    /// Then no number in D is below 1 either. Where stiff contacts leave less of one than rounding, it counts as 1 or as much as a
    /// rounding, so that the result is positive definite whatever the matrix, as conjugate gradients need it. By cofactors the
    /// inverse for one body between contacts of 1e9 was off by more than itself, and the body left the step at 1e26 m/s.
    pub(crate) fn inverse(&self) -> Self {
        let (mut lower, mut diagonal) = ([[0.0; 6]; 6], [0.0; 6]);
        for j in 0..6 {
            let taken = |i: usize| (0..j).map(|k| lower[i][k] * lower[j][k] * diagonal[k]).sum::<f64>();
            let column: [f64; 6] = std::array::from_fn(|i| self.0[j][i] - taken(i));
            // Four roundings: not tuned.
            diagonal[j] = column[j].max(1.0).max(4.0 * f64::EPSILON * self.0[j][j]);
            for i in j + 1..6 {
                lower[i][j] = column[i] / diagonal[j];
            }
        }
        // L⁻¹, by rows.
        let mut inverse = [[0.0_f64; 6]; 6];
        for i in 0..6 {
            let entry = |j: usize| match j.cmp(&i) {
                Ordering::Less => -(j..i).map(|k| lower[i][k] * inverse[k][j]).sum::<f64>(),
                Ordering::Equal => 1.0,
                Ordering::Greater => 0.0,
            };
            inverse[i] = std::array::from_fn(entry);
        }
        let weights = diagonal.map(|value| 1.0 / value);
        let mut out = Self::ZERO;
        for (i, j) in (0..6).flat_map(|i| (0..=i).map(move |j| (i, j))) {
            let entry = (i..6).map(|k| inverse[k][i] * inverse[k][j] * weights[k]).sum();
            (out.0[i][j], out.0[j][i]) = (entry, entry);
        }
        out
    }

    #[inline]
    pub(crate) fn times(&self, v: &[f64; 6]) -> [f64; 6] {
        let mut out = [0.0; 6];
        self.add_product(v, &mut out);
        out
    }
}

impl AddAssign<&Self> for Block {
    fn add_assign(&mut self, other: &Self) {
        for (sum, column) in self.0.iter_mut().zip(&other.0) {
            sum.iter_mut().zip(column).for_each(|(sum, value)| *sum += value);
        }
    }
}

impl Neg for Block {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.map(|column| column.map(|value| -value)))
    }
}

impl From<&Symmetric6> for Block {
    fn from(m: &Symmetric6) -> Self {
        Self::new([[m.linear, m.mixed], [m.mixed.transpose(), m.angular]])
    }
}

impl Screw {
    pub(crate) fn to_array(self) -> [f64; 6] {
        let (l, a) = (self.linear, self.angular);
        [l.x, l.y, l.z, a.x, a.y, a.z]
    }

    pub(crate) fn from_array([x, y, z, u, v, w]: [f64; 6]) -> Self {
        Self { linear: DVec3::new(x, y, z), angular: DVec3::new(u, v, w) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The identity and `gain` times a few dyads, which leave some directions free.
    fn stiff(gain: f64, dyads: &[[f64; 6]]) -> Block {
        let entry = |i: usize, j: usize| {
            let sum: f64 = dyads.iter().map(|v| v[i] * v[j]).sum();
            f64::from(u8::from(i == j)) + gain * sum
        };
        Block(std::array::from_fn(|j| std::array::from_fn(|i| entry(i, j))))
    }

    fn vector() -> impl Strategy<Value = [f64; 6]> {
        prop::array::uniform6(-1.0..1.0)
    }

    proptest! {
        #[test]
        fn issue_the_inverse_of_a_stiff_block_is_accurate(
            gain in 0.0_f64..9.0, dyads in prop::collection::vec(vector(), 0..6), v in vector(),
        ) {
            let block = stiff(10.0_f64.powf(gain), &dyads);
            // Its least eigenvalue is 1, so that its trace bounds its condition; of 100,000 blocks the worst took a tenth.
            let room = 1e-13 * (0..6).map(|i| block.0[i][i]).sum::<f64>();
            for (v, back) in v.iter().zip(block.inverse().times(&block.times(&v))) {
                prop_assert!((v - back).abs() <= room, "{v} {back}");
            }
        }

        #[test]
        fn the_inverse_is_positive_definite_whatever_rounding_leaves(
            gain in 0.0_f64..40.0, dyads in prop::collection::vec(vector(), 0..6), v in vector(),
        ) {
            let inverse = stiff(10.0_f64.powf(gain), &dyads).inverse();
            let products = |k: usize| (0..6).map(move |i| (i, k));
            let (mut square, mut size) = (0.0, 0.0);
            for (i, k) in (0..6).flat_map(products) {
                square += v[i] * inverse.0[k][i] * v[k];
                size += (v[i] * inverse.0[k][i] * v[k]).abs();
            }
            prop_assert!(square >= -1e-14 * size, "{square} of {size}");
            prop_assert_eq!(inverse, inverse.transposed());
        }
    }

    #[test]
    fn products_are_those_of_the_quarters() {
        let m = |k: f64| {
            DMat3::from_cols(DVec3::new(k, 1.0, 2.0), DVec3::new(-k, 0.5, 3.0), DVec3::new(0.1, k * k, -1.0))
        };
        let (a, b, c, d) = (m(1.0), m(2.0), m(-3.0), m(0.5));
        let block = Block::new([[a, b], [c, d]]);
        let v = Screw { linear: DVec3::new(1.0, -2.0, 0.3), angular: DVec3::new(0.7, 4.0, -1.0) };
        let product = Screw::from_array(block.times(&v.to_array()));
        let expected = Screw { linear: a * v.linear + b * v.angular, angular: c * v.linear + d * v.angular };
        let error = product - expected;
        assert!(error.dot(error) < 1e-24, "{error:?}");
        let quarters = [[a.transpose(), c.transpose()], [b.transpose(), d.transpose()]];
        assert_eq!(block.transposed(), Block::new(quarters));
    }
}
