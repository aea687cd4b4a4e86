//! Still water: what it does to a body made of spheres.

use ist::InnerSphereTree;
use rapier3d::dynamics::RigidBody;
use rapier3d::math::Vector;

/// Water with its surface at y = 0.
#[derive(Clone, Copy, Debug)]
pub struct Water {
    /// Density (kg/m³).
    pub density: f32,
    /// Rate at which a floating body loses momentum and angular momentum (1/s): stands for the waves that it makes. The
    /// force of the water is that at the beginning of a step, which feeds pitching of long bodies by about 0.35 /s at
    /// 60 Hz: with less than twice that, a beam rocks forever.
    pub damping: f32,
    /// Drag coefficient on the area V^⅔ of the submerged volume V.
    pub drag: f32,
}

impl Default for Water {
    fn default() -> Self {
        Self { density: 1000.0, damping: 2.0, drag: 1.0 }
    }
}

/// The part of a body that is under water.
#[derive(Clone, Copy, Debug, Default)]
pub struct Submerged {
    /// Its volume (m³).
    pub volume: f32,
    /// Its centroid in the world (m).
    pub centroid: Vector,
}

impl Water {
    /// The part of a body at `body`'s pose that is under water, by the volume balls of its tree.
    #[must_use]
    pub fn submerged(&self, body: &RigidBody, tree: &InnerSphereTree) -> Submerged {
        let pose = body.position();
        // In the body's frame the water is all x with up · x ≤ −height.
        let up = pose.rotation.inverse() * Vector::Y;
        let overlap = tree.overlap_with_half_space(up, -pose.translation.y);
        Submerged { volume: overlap.volume, centroid: *pose * overlap.centroid }
    }

    /// Sets the forces on `body` for the next step: buoyancy ρ g V upwards at the centroid of the displaced water
    /// (Archimedes), and what slows the body down. The water that moves along with the body, its added mass, is left
    /// out: it changes how long the body bobs and not where it comes to rest.
    ///
    /// Replaces all forces that the user has set, as Rapier keeps them from step to step.
    pub fn act_on(&self, body: &mut RigidBody, tree: &InnerSphereTree, gravity: Vector) {
        body.reset_forces(false);
        body.reset_torques(false);
        let Submerged { volume, centroid } = self.submerged(body, tree);
        if volume <= 0.0 {
            return;
        }
        let displaced = self.density * volume;
        let velocity = body.velocity_at_point(centroid);
        let area = volume.powf(2.0 / 3.0);
        let slowing = displaced * self.damping + 0.5 * self.density * self.drag * area * velocity.length();
        body.add_force_at_point(-gravity * displaced - velocity * slowing, centroid, true);
        let share = displaced / body.mass();
        body.add_torque(angular_momentum(body) * (-self.damping * share), true);
    }
}

/// About the centre of mass (kg·m²/s).
fn angular_momentum(body: &RigidBody) -> Vector {
    let properties = body.mass_properties().local_mprops;
    let axes = body.rotation() * properties.principal_inertia_local_frame;
    axes * (properties.principal_inertia() * (axes.inverse() * body.angvel()))
}
