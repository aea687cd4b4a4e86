//! How overlap turns into motion.

use rapier3d::math::Real;

/// How colliders with an [`crate::IstShape`] respond to overlap.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum ContactModel {
    /// A force in proportion to the overlap volume, found by a linearly implicit solve, repeated at most twice where contacts
    /// end up far from where they were measured.
    VolumePenalty(VolumePenalty),
    /// Contact manifolds for Rapier's own constraint solver: one for each connected patch of the overlap that pushes in about
    /// one direction, of up to four points with the mean depth V/A along the mean normal.
    ///
    /// Rapier merges manifolds whose normals agree within 5° and takes four of their points, see
    /// `IntegrationParameters::contact_clustering`; points nearer to each other than a quarter of its prediction distance
    /// (5 mm times `length_unit`) are one to it.
    VolumeManifold,
}

impl Default for ContactModel {
    fn default() -> Self {
        Self::VolumePenalty(VolumePenalty::default())
    }
}

/// Parameters of the linearly implicit volume penalty.
///
/// Values out of range count as the nearest in range, NaN as the default.
#[derive(Clone, Copy, Debug)]
pub struct VolumePenalty {
    /// Force per overlap volume. Colliders and pairs can have their own, see
    /// [`crate::IstPlugin::set_collider_stiffness`] and [`crate::IstPlugin::set_pair_stiffness`].
    pub stiffness: Stiffness,
    /// Least Hunt–Crossley dissipation δ (s/m), from 0, the default, to 1e6: the normal force is `k V (1 + δ v)` at the
    /// speed of approach v (m/s). Impacts dissipate what their restitution asks for, and all other contacts at least
    /// the inverse of [`Self::recovery_speed`].
    pub dissipation: Real,
    /// Maximum depenetration speed: the fastest that overlap alone pushes bodies apart (m/s, times Rapier's `length_unit`),
    /// from 1e-6 to 1e6, 1 by default; never faster than by the smaller body's longest side in 0.45 s. Faster recovery is
    /// damped; the force on bodies at rest stays the same. Each sample of a contact is held to it along its own normal: where these
    /// differ, as in cubes that begin inside each other, bodies come apart up to 2.6 times as fast.
    pub recovery_speed: Real,
    /// Stiction tolerance: the slip speed (m/s, times Rapier's `length_unit`) under which Coulomb friction goes over into
    /// viscous creep, from 1e-6 to 1e6, 1e-3 by default.
    pub creep_speed: Real,
}

impl Default for VolumePenalty {
    fn default() -> Self {
        Self { stiffness: Stiffness::Automatic, dissipation: 0.0, recovery_speed: 1.0, creep_speed: 1e-3 }
    }
}

impl VolumePenalty {
    /// With all values in range.
    pub(crate) fn in_range(self) -> Self {
        let Self { dissipation, recovery_speed, creep_speed, .. } = Self::default();
        let or = |value: Real, default: Real| if value.is_nan() { default } else { value };
        Self {
            stiffness: self.stiffness,
            dissipation: or(self.dissipation, dissipation).clamp(0.0, 1e6),
            recovery_speed: or(self.recovery_speed, recovery_speed).clamp(1e-6, 1e6),
            creep_speed: or(self.creep_speed, creep_speed).clamp(1e-6, 1e6),
        }
    }
}

/// Force per overlap volume.
///
/// Contacts are rigid, and no stiffer, from 1e8 m/(h²L²) on, with the lighter body's mass m (kg), the time step h (s) and the
/// smaller body's size L (m).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Stiffness {
    /// `5e4 m g / s³` with the mass m (kg) of the lighter dynamic body, gravity g (m/s², at least 1) and the size s (m) of the
    /// smaller collider: the longest side L of its box in its own frame, and 4.5 times its thickness √(V/L) where that is less,
    /// as in bodies of a volume V below L³/20. Of triangle meshes, convex hulls and the like only the side counts. A contact that carries
    /// more than ten times `m g`, as of late and at most all that acts on the bodies it hangs together with, has a tenth of that instead
    /// of `m g`.
    #[default]
    Automatic,
    /// The same for every pair (N/m³), zero or positive; negative values and NaN count as zero.
    Uniform(Real),
}
