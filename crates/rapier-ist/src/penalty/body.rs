//! A body as the penalty solve sees it.

use super::twist::Screw;
use rapier3d::dynamics::{RigidBody, RigidBodyType};
use rapier3d::glamx::{DMat3, DVec3};
use rapier3d::math::{Real, Vector};

/// Position, velocity and inverse mass of one body, all about its centre of mass, world frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SolverBody {
    pub(crate) center_of_mass: DVec3,
    /// Twist before the step.
    pub(crate) velocity: Screw,
    /// Twist that the step would end with if nothing touched: gravity and the user's forces.
    pub(crate) predicted: Screw,
    /// Square root `L` of the inverse mass matrix, `M⁻¹ = L Lᵀ`. Zero rows for locked axes; zero for bodies that the
    /// solve may not move.
    pub(crate) root_linear: DVec3,
    pub(crate) root_angular: DMat3,
    /// Force and torque that act on the body besides contacts: gravity and the user's own.
    pub(crate) external: Screw,
    /// The `y` for which `predicted + L y` is the twist before the step: a body at rest stays at rest, which is
    /// where the solve of a resting pile should start.
    pub(crate) unchanged: Screw,
}

impl SolverBody {
    /// The world itself: a collider without a body.
    pub(crate) const FIXED: Self = Self {
        center_of_mass: DVec3::ZERO,
        velocity: Screw::ZERO,
        predicted: Screw::ZERO,
        root_linear: DVec3::ZERO,
        root_angular: DMat3::ZERO,
        external: Screw::ZERO,
        unchanged: Screw::ZERO,
    };

    /// The state of `body` before a step of `dt` seconds; `movable` where the solve may change its velocity.
    pub(crate) fn new(body: &RigidBody, movable: bool, gravity: Vector, dt: Real) -> Self {
        let center_of_mass = body.center_of_mass().as_dvec3();
        let velocity = Screw { linear: body.linvel().as_dvec3(), angular: body.angvel().as_dvec3() };
        if body.body_type() == RigidBodyType::KinematicPositionBased {
            let target = target_twist(body, dt);
            return Self { center_of_mass, velocity: target, predicted: target, ..Self::FIXED };
        }
        if !movable || !velocity.is_finite() {
            // A fixed body stays, whatever velocity it was given.
            let is_still = body.is_sleeping() || body.is_fixed() || !velocity.is_finite();
            let velocity = if is_still { Screw::ZERO } else { velocity };
            return Self { center_of_mass, velocity, predicted: velocity, ..Self::FIXED };
        }
        let mass = body.mass_properties();
        let inverse_mass = mass.effective_inv_mass.as_dvec3();
        let inverse_inertia = symmetric(&mass.effective_world_inv_inertia);
        let free = inverse_mass.cmpgt(DVec3::ZERO);
        let gravity = DVec3::select(free, gravity.as_dvec3() * f64::from(body.gravity_scale()), DVec3::ZERO);
        let (force, torque) = (body.user_force().as_dvec3(), body.user_torque().as_dvec3());
        let root_linear = inverse_mass.map(f64::sqrt);
        let root_angular = cholesky(inverse_inertia);
        let weight = DVec3::select(free, gravity / inverse_mass, DVec3::ZERO);
        let external = Screw { linear: weight + force, angular: torque };
        let acceleration =
            Screw { linear: gravity + inverse_mass * force, angular: inverse_inertia * torque };
        let predicted = velocity + acceleration * f64::from(dt);
        let still =
            Self { center_of_mass, velocity, predicted, root_linear, root_angular, external, ..Self::FIXED };
        let finite = predicted.is_finite() && external.is_finite();
        if !finite || !root_linear.is_finite() || !root_angular.is_finite() {
            // One such body in an island would spoil the solve for all others.
            return still.unyielding();
        }
        Self { unchanged: still.root_transpose_times(external) * -f64::from(dt), ..still }
    }

    /// Whether the solve may change anything about this body.
    pub(crate) fn is_movable(&self) -> bool {
        self.root_linear != DVec3::ZERO || self.root_angular != DMat3::ZERO
    }

    /// Trace of the inverse inertia (1/(kg·m²)).
    pub(crate) fn ease_of_turning(&self) -> f64 {
        let root = &self.root_angular;
        root.x_axis.length_squared() + root.y_axis.length_squared() + root.z_axis.length_squared()
    }

    /// The same body as one that it dominates sees it: it goes its way whatever touches it.
    pub(crate) fn unyielding(&self) -> Self {
        let Self { center_of_mass, velocity, .. } = *self;
        Self { center_of_mass, velocity, predicted: velocity, ..Self::FIXED }
    }

    /// `wᵀ M⁻¹ w` of a wrench `w` about `at`: the velocity along it that an impulse like it gives.
    pub(crate) fn compliance(&self, at: DVec3, wrench: Screw) -> f64 {
        let half = self.root_transpose_times(wrench.wrench_from(at - self.center_of_mass));
        half.dot(half)
    }

    /// Its twist at a place of the world, before the step.
    pub(crate) fn twist_at(&self, place: DVec3) -> Screw {
        self.velocity.twist_at(place - self.center_of_mass)
    }

    /// `L v`.
    pub(crate) fn root_times(&self, v: Screw) -> Screw {
        Screw { linear: self.root_linear * v.linear, angular: self.root_angular * v.angular }
    }

    /// `Lᵀ v`.
    pub(crate) fn root_transpose_times(&self, v: Screw) -> Screw {
        Screw { linear: self.root_linear * v.linear, angular: self.root_angular.transpose() * v.angular }
    }

    /// The impulse `p` with `Lᵀ p = v`, zero along locked axes: it changes the twist by `L v`.
    pub(crate) fn impulse_of(&self, v: Screw) -> Screw {
        let over = |value: f64, root: f64| if root > 0.0 { value / root } else { 0.0 };
        let mut angular = DVec3::ZERO;
        for i in (0..3).rev() {
            let below: f64 = (i + 1..3).map(|j| self.root_angular.col(i)[j] * angular[j]).sum();
            angular[i] = over(v.angular[i] - below, self.root_angular.col(i)[i]);
        }
        let [x, y, z] = [0, 1, 2].map(|i| over(v.linear[i], self.root_linear[i]));
        Screw { linear: DVec3::new(x, y, z), angular }
    }
}

/// The constant twist that takes a position-based kinematic body to its next position.
fn target_twist(body: &RigidBody, dt: Real) -> Screw {
    if dt <= 0.0 {
        return Screw::ZERO;
    }
    let Screw { linear, angular } = way_to_next_position(body);
    let screw = Screw { linear: linear / f64::from(dt), angular: angular / f64::from(dt) };
    if screw.is_finite() { screw } else { Screw::ZERO }
}

/// Translation of the centre of mass (m) and rotation vector (rad) that take a position-based kinematic body to its next
/// position.
pub(crate) fn way_to_next_position(body: &RigidBody) -> Screw {
    let (now, next) = (body.position(), body.next_position());
    let center = body.local_center_of_mass();
    Screw {
        linear: (*next * center - *now * center).as_dvec3(),
        angular: (next.rotation * now.rotation.inverse()).to_scaled_axis().as_dvec3(),
    }
}

pub(crate) fn symmetric(m: &rapier3d::math::AngularInertia) -> DMat3 {
    let [xx, xy, xz, yy, yz, zz] = [m.m11, m.m12, m.m13, m.m22, m.m23, m.m33].map(f64::from);
    DMat3::from_cols(DVec3::new(xx, xy, xz), DVec3::new(xy, yy, yz), DVec3::new(xz, yz, zz))
}

/// Lower triangular `L` with `L Lᵀ = m` for a positive semidefinite `m`; rows of zero pivots are zero.
fn cholesky(m: DMat3) -> DMat3 {
    let mut l = [[0.0_f64; 3]; 3];
    for i in 0..3 {
        for j in 0..=i {
            let rest = m.col(j)[i] - (0..j).map(|k| l[i][k] * l[j][k]).sum::<f64>();
            l[i][j] = if i == j {
                if rest > 0.0 { rest.sqrt() } else { 0.0 }
            } else if l[j][j] > 0.0 {
                rest / l[j][j]
            } else {
                0.0
            };
        }
    }
    DMat3::from_cols_array_2d(&l).transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cholesky_of_semidefinite_matrices() {
        let root = DMat3::from_cols(
            DVec3::new(1.0, 2.0, -0.5),
            DVec3::new(0.0, 0.7, 0.3),
            DVec3::new(0.0, 0.0, 1.1),
        );
        for locked in [DVec3::ONE, DVec3::new(1.0, 0.0, 1.0), DVec3::new(0.0, 0.0, 1.0), DVec3::ZERO] {
            let lock = DMat3::from_diagonal(locked);
            let m = lock * root * root.transpose() * lock;
            let l = cholesky(m);
            assert!((l * l.transpose()).abs_diff_eq(m, 1e-14), "{locked}");
        }
    }

    #[test]
    fn the_impulse_of_an_unknown_gives_its_change_of_twist() {
        let inverse_inertia = DMat3::from_cols(
            DVec3::new(4.0, -1.0, 0.5),
            DVec3::new(-1.0, 3.0, 0.2),
            DVec3::new(0.5, 0.2, 2.0),
        );
        let v = Screw { linear: DVec3::new(0.3, -2.0, 7.0), angular: DVec3::new(-1.0, 0.4, 5.0) };
        for locked in [DVec3::ONE, DVec3::new(1.0, 0.0, 1.0), DVec3::new(0.0, 0.0, 1.0), DVec3::ZERO] {
            let lock = DMat3::from_diagonal(locked);
            let root_angular = cholesky(lock * inverse_inertia * lock);
            let body = SolverBody { root_linear: 0.7 * locked, root_angular, ..SolverBody::FIXED };
            let impulse = body.impulse_of(v);
            let change = body.root_times(body.root_transpose_times(impulse));
            let left = change - body.root_times(v);
            assert!(left.dot(left) < 1e-24, "{locked} {left:?}");
            assert!(impulse.linear * (DVec3::ONE - locked) == DVec3::ZERO);
        }
    }
}
