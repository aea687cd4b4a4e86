//! Dense 6×6 blocks of the linear system.

use super::twist::{Screw, Symmetric6};
use rapier3d::glamx::{DMat3, DVec3};

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

    #[inline]
    pub(crate) fn times(&self, v: &[f64; 6]) -> [f64; 6] {
        let mut out = [0.0; 6];
        self.add_product(v, &mut out);
        out
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
