//! Sums of dampers that are stiffer along a direction than across it.

use super::twist::{Symmetric6, cross_matrix};
use rapier3d::glamx::{DMat3, DVec3};

/// The sum of dampers `c_n n nᵀ + c_t (1 − n nᵀ)`, each at its arm r from one point of reference, from twists to wrenches.
///
/// With the screw `w = (n, r × n)` the part along n is `(c_n − c_t) w wᵀ`, and the rest, the same in all directions, needs no more
/// than the moments of c_t. To linearise the pairs of a pile of 250 bodies takes a sixth less than with 3×3 matrices that are
/// moved from r, one by one.
#[derive(Clone, Debug)]
pub(super) struct DamperSum {
    /// Σ (c_n − c_t) w wᵀ, by columns: of the first three all rows, of the others the lower three.
    full: [[f64; 6]; 3],
    lower: [[f64; 3]; 3],
    /// Σ c_t, Σ c_t r and Σ c_t r rᵀ.
    weight: f64,
    moment: DVec3,
    second: DMat3,
}

impl DamperSum {
    // Not by default: that of a matrix is the identity.
    pub(super) const ZERO: Self = Self {
        full: [[0.0; 6]; 3],
        lower: [[0.0; 3]; 3],
        weight: 0.0,
        moment: DVec3::ZERO,
        second: DMat3::ZERO,
    };

    /// Adds a damper that sits at `arm` (m), with `coefficients` along the unit vector `normal` and across it (N·s/m).
    #[inline]
    pub(super) fn add(&mut self, normal: DVec3, arm: DVec3, coefficients: [f64; 2]) {
        let [along, across] = coefficients;
        let turned = arm.cross(normal);
        let screw = [normal.x, normal.y, normal.z, turned.x, turned.y, turned.z];
        let scaled = screw.map(|value| (along - across) * value);
        for (column, value) in self.full.iter_mut().zip(screw) {
            column.iter_mut().zip(scaled).for_each(|(sum, scaled)| *sum += scaled * value);
        }
        for (column, value) in self.lower.iter_mut().zip(&screw[3..]) {
            column.iter_mut().zip(&scaled[3..]).for_each(|(sum, scaled)| *sum += scaled * value);
        }
        let weighted = arm * across;
        self.weight += across;
        self.moment += weighted;
        self.second += DMat3::from_cols(weighted * arm.x, weighted * arm.y, weighted * arm.z);
    }

    /// The sum.
    pub(super) fn matrix(&self) -> Symmetric6 {
        let [x, y, z] = self.full;
        let upper = |column: [f64; 6]| DVec3::new(column[0], column[1], column[2]);
        let lower = |column: [f64; 6]| DVec3::new(column[3], column[4], column[5]);
        let trace = self.second.x_axis.x + self.second.y_axis.y + self.second.z_axis.z;
        let linear = DMat3::from_cols(upper(x), upper(y), upper(z));
        let turning = DMat3::from_cols_array_2d(&self.lower);
        Symmetric6 {
            linear: linear + DMat3::from_diagonal(DVec3::splat(self.weight)),
            mixed: DMat3::from_cols(lower(x), lower(y), lower(z)).transpose() - cross_matrix(self.moment),
            angular: turning + DMat3::from_diagonal(DVec3::splat(trace)) - self.second,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn vector() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-1.0_f64..1.0).prop_map(DVec3::from)
    }

    proptest! {
        #[test]
        fn the_sum_is_that_of_moved_matrices(
            dampers in prop::collection::vec((vector(), vector(), 0.0_f64..10.0, 0.0_f64..10.0), 0..20),
        ) {
            let (mut sum, mut expected) = (DamperSum::ZERO, Symmetric6::ZERO);
            for (direction, arm, along, across) in dampers {
                let n = direction.try_normalize().unwrap_or(DVec3::X);
                sum.add(n, arm, [along, across]);
                let outer = DMat3::from_cols(n * n.x, n * n.y, n * n.z);
                expected.add_damper(outer * along + (DMat3::IDENTITY - outer) * across, arm);
            }
            let found = sum.matrix();
            for (found, expected) in
                [(found.linear, expected.linear), (found.mixed, expected.mixed), (found.angular, expected.angular)]
            {
                prop_assert!(found.abs_diff_eq(expected, 1e-12), "{found} instead of {expected}");
            }
        }
    }
}
