//! Six-dimensional vectors of rigid motion and the symmetric matrices between them.

use rapier3d::glamx::{DMat3, DVec3};
use std::ops::{Add, AddAssign, Mul, Neg, Sub};

/// Velocity or force of a rigid body at a point: a twist (m/s, rad/s) or a wrench (N, N·m).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Screw {
    pub(crate) linear: DVec3,
    pub(crate) angular: DVec3,
}

impl Screw {
    pub(crate) const ZERO: Self = Self { linear: DVec3::ZERO, angular: DVec3::ZERO };

    pub(crate) fn dot(self, other: Self) -> f64 {
        self.linear.dot(other.linear) + self.angular.dot(other.angular)
    }

    pub(crate) fn is_finite(self) -> bool {
        self.linear.is_finite() && self.angular.is_finite()
    }

    /// Whether it is finite in the precision of Rapier, too.
    pub(crate) fn fits_f32(self) -> bool {
        self.linear.as_vec3().is_finite() && self.angular.as_vec3().is_finite()
    }

    /// The same motion as a point displaced by `arm` sees it.
    pub(crate) fn twist_at(self, arm: DVec3) -> Self {
        Self { linear: self.linear + self.angular.cross(arm), angular: self.angular }
    }

    /// The wrench about a point from which this one's point of reference is displaced by `arm`.
    pub(crate) fn wrench_from(self, arm: DVec3) -> Self {
        Self { linear: self.linear, angular: self.angular + arm.cross(self.linear) }
    }
}

impl Add for Screw {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { linear: self.linear + other.linear, angular: self.angular + other.angular }
    }
}

impl AddAssign for Screw {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sub for Screw {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { linear: self.linear - other.linear, angular: self.angular - other.angular }
    }
}

impl Neg for Screw {
    type Output = Self;
    fn neg(self) -> Self {
        Self { linear: -self.linear, angular: -self.angular }
    }
}

impl Mul<f64> for Screw {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self { linear: self.linear * factor, angular: self.angular * factor }
    }
}

/// A symmetric 6×6 matrix `[A B; Bᵀ C]` from twists to wrenches.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Symmetric6 {
    pub(crate) linear: DMat3,
    pub(crate) mixed: DMat3,
    pub(crate) angular: DMat3,
}

impl Symmetric6 {
    pub(crate) const ZERO: Self = Self { linear: DMat3::ZERO, mixed: DMat3::ZERO, angular: DMat3::ZERO };

    /// Adds a damper of the given symmetric matrix that sits at `arm` from the point of reference.
    ///
    /// With `u(p) = v + ω×r` the force `D u` makes `A = D`, `B = −D[r]×`, `C = −[r]×D[r]×`.
    #[cfg(test)]
    pub(crate) fn add_damper(&mut self, damper: DMat3, arm: DVec3) {
        let cross = cross_matrix(arm);
        let mixed = -(damper * cross);
        self.linear += damper;
        self.mixed += mixed;
        self.angular += cross * mixed;
    }

    /// The same matrix for twists at a point from which this one's point of reference is displaced by `arm`.
    pub(crate) fn moved(&self, arm: DVec3) -> Self {
        let cross = cross_matrix(arm);
        let mixed = self.mixed - self.linear * cross;
        let angular = self.angular + cross * mixed - self.mixed.transpose() * cross;
        Self { linear: self.linear, mixed, angular }
    }

    /// `Lᵀ K L` with the block-diagonal `L` of `linear` (a diagonal) and `angular`.
    pub(crate) fn scaled_by(&self, linear: DVec3, angular: DMat3) -> Self {
        let diagonal = DMat3::from_diagonal(linear);
        Self {
            linear: diagonal * self.linear * diagonal,
            mixed: diagonal * self.mixed * angular,
            angular: angular.transpose() * self.angular * angular,
        }
    }
}

impl AddAssign for Symmetric6 {
    fn add_assign(&mut self, other: Self) {
        self.linear += other.linear;
        self.mixed += other.mixed;
        self.angular += other.angular;
    }
}

impl Mul<f64> for Symmetric6 {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self { linear: self.linear * factor, mixed: self.mixed * factor, angular: self.angular * factor }
    }
}

impl Mul<Screw> for Symmetric6 {
    type Output = Screw;
    fn mul(self, v: Screw) -> Screw {
        Screw {
            linear: self.linear * v.linear + self.mixed * v.angular,
            angular: self.mixed.transpose() * v.linear + self.angular * v.angular,
        }
    }
}

/// `[r]×`, the matrix of `r × ·`.
pub(crate) fn cross_matrix(r: DVec3) -> DMat3 {
    DMat3::from_cols(DVec3::new(0.0, r.z, -r.y), DVec3::new(-r.z, 0.0, r.x), DVec3::new(r.y, -r.x, 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> (Symmetric6, Screw) {
        let mut k = Symmetric6::ZERO;
        for (n, r) in [
            (DVec3::X, DVec3::Y),
            (DVec3::new(0.6, 0.8, 0.0), DVec3::new(1.0, -2.0, 0.5)),
            (DVec3::Z, DVec3::ONE),
        ] {
            let outer = DMat3::from_cols(n * n.x, n * n.y, n * n.z);
            k.add_damper(outer * 3.0 + DMat3::IDENTITY * 0.5, r);
        }
        (k, Screw { linear: DVec3::new(0.3, -1.0, 2.0), angular: DVec3::new(-0.7, 0.2, 0.9) })
    }

    fn close(a: Screw, b: Screw) -> bool {
        let d = a - b;
        d.dot(d) < 1e-18 * (1.0 + a.dot(a))
    }

    #[test]
    fn dampers_answer_the_velocity_at_their_place() {
        let (n, r) = (DVec3::new(0.6, 0.0, 0.8), DVec3::new(0.1, 0.7, -0.3));
        let damper = DMat3::from_cols(n * n.x, n * n.y, n * n.z) * 4.0;
        let mut k = Symmetric6::ZERO;
        k.add_damper(damper, r);
        let (_, v) = sample();
        let force = damper * (v.linear + v.angular.cross(r));
        assert!(close(k * v, Screw { linear: force, angular: r.cross(force) }));
    }

    #[test]
    fn moving_the_reference_commutes_with_moving_the_twist() {
        let (k, v) = sample();
        let arm = DVec3::new(0.4, -1.1, 0.2);
        assert!(close(k.moved(arm) * v, (k * v.twist_at(arm)).wrench_from(arm)));
    }
}
