//! Multibodies: their joints in generalised coordinates, and impulses on their links.

use crate::penalty::Screw;
use rapier3d::dynamics::{Multibody, MultibodyLink};
use rapier3d::na::{DVector, Vector6};

/// A link and its multibody.
#[derive(Clone, Copy)]
pub(crate) struct Link<'a> {
    pub(crate) multibody: &'a Multibody,
    pub(crate) link: &'a MultibodyLink,
}

impl Link<'_> {
    /// Whether the user moves its joint.
    pub(crate) fn is_kinematic(&self) -> bool {
        self.link.joint().kinematic
    }

    /// Along a free axis of its joint (m, rad); turns count on.
    pub(crate) fn coordinate(&self, axis: usize) -> f64 {
        f64::from(self.link.joint().coords()[axis])
    }

    /// Of a free axis of its joint (N·s/m, N·m·s).
    pub(crate) fn damping(&self, axis: usize) -> f64 {
        self.multibody.damping().get(self.degree_of_freedom(axis)).copied().map_or(0.0, f64::from)
    }

    /// The change of its velocity along a free axis of its joint by an impulse of 1 along it, all other joints free; none before
    /// Rapier's first step.
    pub(crate) fn compliance(&self, axis: usize) -> Option<f64> {
        let index = self.degree_of_freedom(axis);
        let count = self.multibody.ndofs();
        let inverse = self.multibody.inv_augmented_mass();
        if inverse.lu_internal().nrows() != count || index >= count {
            return None;
        }
        let mut unit = DVector::zeros(count);
        unit[index] = 1.0;
        (inverse.solve_mut(&mut unit) && unit[index] > 0.0).then(|| f64::from(unit[index]))
    }

    fn degree_of_freedom(&self, axis: usize) -> usize {
        let locked = self.link.joint().data.locked_axes.bits();
        self.link.assembly_id() + (0..axis).filter(|i| locked & (1 << i) == 0).count()
    }
}

/// Gives `multibody` an impulse on each link, about its centre of mass, at once: the generalised velocities change by
/// `M⁻¹ Σ Jᵀ p` (R. Featherstone, *Rigid Body Dynamics Algorithms*, 2008, chapter 11), with the mass matrix M and the Jacobians J of the links that Rapier last computed. Returns whether it could: before
/// Rapier's first step there are none, and where the user moves a joint the matrix is another one.
pub(crate) fn apply_impulses(multibody: &mut Multibody, impulses: &[(usize, Screw)]) -> bool {
    let count = multibody.ndofs();
    let inverse = multibody.inv_augmented_mass();
    if multibody.links().any(|link| link.joint().kinematic)
        || inverse.lu_internal().nrows() != count
        || count == 0
    {
        return false;
    }
    let mut change = DVector::zeros(count);
    for (link, impulse) in impulses {
        let jacobian = multibody.body_jacobian(*link);
        if jacobian.ncols() != count {
            return false;
        }
        let (l, a) = (impulse.linear.as_vec3(), impulse.angular.as_vec3());
        let impulse = Vector6::new(l.x, l.y, l.z, a.x, a.y, a.z);
        change.gemv_tr(1.0, jacobian, &impulse, 1.0);
    }
    if !inverse.solve_mut(&mut change) || change.iter().any(|value| !value.is_finite()) {
        return false;
    }
    let mut velocity = multibody.generalized_velocity_mut();
    velocity += &change;
    true
}
