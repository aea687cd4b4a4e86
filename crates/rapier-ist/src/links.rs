//! Multibodies: their joints in generalised coordinates, and impulses on their links.

use crate::penalty::{Screw, symmetric};
use rapier3d::dynamics::{Multibody, MultibodyLink, RigidBodySet};
use rapier3d::math::Real;
use rapier3d::na::{DMatrix, DVector, Matrix6, Vector6};

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
/// `M⁻¹ Σ Jᵀ p` (R. Featherstone, *Rigid Body Dynamics Algorithms*, 2008, chapter 11), with the Jacobians J of the links and the mass matrix
/// `M = Σ Jᵀ diag(m, I) J`, to which the armature adds. Returns whether it could: before Rapier's first step there are no
/// Jacobians, and where the user moves a joint the matrix is another one.
///
/// Rapier keeps a mass matrix, too, but that of the substep before, and links may turn by half a radian in one.
pub(crate) fn apply_impulses(
    multibody: &mut Multibody,
    bodies: &RigidBodySet,
    impulses: &[(usize, Screw)],
) -> bool {
    let count = multibody.ndofs();
    if count == 0 || multibody.links().any(|link| link.joint().kinematic) {
        return false;
    }
    let mut mass = DMatrix::<f64>::from_diagonal(&multibody.armature().map(f64::from));
    let mut change = DVector::<f64>::zeros(count);
    for link in multibody.links() {
        let jacobian = multibody.body_jacobian(link.link_id());
        let Some(body) = bodies.get(link.rigid_body_handle()).filter(|_| jacobian.ncols() == count) else {
            return false;
        };
        let jacobian = jacobian.map(f64::from);
        let properties = body.mass_properties();
        let inertia = symmetric(&properties.effective_angular_inertia());
        let mut of_body = Matrix6::zeros();
        for (i, mass) in properties.effective_mass().to_array().into_iter().enumerate() {
            of_body[(i, i)] = f64::from(mass);
            of_body.fixed_view_mut::<3, 1>(3, 3 + i).copy_from_slice(&inertia.col(i).to_array());
        }
        mass.quadform(1.0, &of_body, &jacobian, 1.0);
        for (_, Screw { linear, angular }) in impulses.iter().filter(|(index, _)| *index == link.link_id()) {
            let impulse = Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z);
            change.gemv_tr(1.0, &jacobian, &impulse, 1.0);
        }
    }
    let Some(factors) = mass.cholesky() else { return false };
    factors.solve_mut(&mut change);
    if change.iter().any(|value| !(*value as Real).is_finite()) {
        return false;
    }
    let mut velocity = multibody.generalized_velocity_mut();
    velocity.iter_mut().zip(&change).for_each(|(velocity, change)| *velocity += *change as Real);
    true
}
