//! Volume contacts in a Rapier world.

use crate::candidates::candidates;
use crate::contact_law::ContactLaw;
use crate::force_events::ForceEvents;
use crate::hooks::{PenaltyHooks, switch_filters_off, switch_filters_on};
use crate::kinematic::KinematicTargets;
use crate::memory::Memory;
use crate::mesh_trees::NearbyMeshes;
use crate::response::respond;
use crate::stiffness::StiffnessTable;
use crate::touching::Touching;
use crate::user_forces::{Pushes, UserForces};
use crate::{
    ContactModel, IstDispatcher, IstShape, Remembered, StepReport, StiffnessContext, VolumePenalty,
    WorldParts,
};
use ist::{InnerSphere, SolidProperties, SpherePacking};
use rapier3d::dynamics::IntegrationParameters;
use rapier3d::geometry::{ColliderHandle, NarrowPhase};
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::query::{DefaultQueryDispatcher, QueryDispatcher};
use rapier3d::pipeline::{EventHandler, PhysicsHooks, PhysicsWorld};
use std::sync::{Arc, LazyLock};
use std::time::Instant;

/// Makes colliders with an [`IstShape`] collide: call [`Self::step`] where you called `world.step()`.
///
/// Between steps the plugin remembers settings, which pairs touch, how their contacts began and the forces in them. Bodies
/// and colliders may be added, moved and removed at will. A clone goes on bit for bit where the plugin stood; a new one
/// differs in that it begins solves without a guess, and takes contacts under way for ones that began slowly. Results do not
/// depend on the number of threads.
///
/// A triangle mesh that bodies have been near for ten steps gets a search tree, of about 100 bytes a triangle, which all plugins
/// share. It is made on a thread of its own, and goes at the next step of any plugin once nobody else holds the mesh; results
/// are the same without.
///
/// # What Rapier's settings do
/// - Friction, restitution, combine rules, contact skin, collision and solver groups, `ActiveCollisionTypes`, sensors,
///   locked axes, dominance groups, gravity scale, `length_unit` and joints with and without contacts: as in Rapier.
/// - `PhysicsHooks::filter_contact_pair` is asked as in Rapier, before the volume contact is looked for and by Rapier.
///   Name all hooks of a collider when you change them: the plugin switches that filter on for colliders with an [`IstShape`],
///   and one that is added with `|` to what `active_hooks` says looks as the plugin's own, which nobody is asked about.
///   A pair whose contacts `modify_solver_contacts` removes is not pushed; that hook sees Rapier's manifolds of the
///   step before, so where colliders ask for it pushing begins a step late. Friction, restitution and tangent velocity
///   (a conveyor belt) that it sets are felt, for a pair those of its first manifold; normals and distances are not.
/// - Joints hold and drive as in Rapier. Bodies that joints connect with what touches get their final velocities at the
///   beginning of the step; motors of their impulse joints are off while Rapier steps, which hooks and events during the
///   step see, and impulses of joints and motors are then what they did.
/// - Rapier's own contacts of these bodies carry and rub as without the plugin. They and links of multibodies are solved by Rapier
///   once more, within what the plugin expects of them.
/// - `CollisionEvent`s come from Rapier, when a pair overlaps at the start of a step. Contact-force events come from the
///   volume contacts, with one manifold and one contact for each [`crate::PatchContact`]: as in Rapier, their forces are normal
///   ones, and friction is in the tangent impulses of the contacts.
///
/// # Bad input
/// - A body with a velocity, force or torque that is not finite does not give way in that step and passes nothing on;
///   Rapier then disables it. So does a body whose mass is not a number that f32 can divide by.
/// - A collider with a pose that is not finite touches nothing.
/// - A body without mass is not moved by contacts, and carries like a fixed one.
/// - Friction that is NaN or negative counts as 0, over 100 as 100; restitution counts as the nearest from 0 to 1, NaN
///   as 0.
/// - Stiffness over `1e8 m/(h² L²)`, with the mass m of the lighter body that contacts move, the time step h and the smaller body's size L,
///   counts as that: more cannot be told from rigid. Without stiffness bodies fall through each other.
/// - Time steps in which a body falls farther than its own size, 1 s or 1/60 s for bodies under some millimetres: all
///   stays finite, but bodies sink in and bounce. Use [`Self::substeps`], and `length_unit` for small bodies.
/// - Bodies in exactly the same place come apart in some direction.
/// - A time step that is zero, negative or NaN: no contact is looked for, the report has none, and
///   Rapier does what it does for such a step.
/// - See [`VolumePenalty`] for its parameters.
#[derive(Clone, Debug)]
pub struct IstPlugin {
    /// How overlap turns into motion; may be changed between steps.
    pub model: ContactModel,
    /// Into how many parts each step is divided, 1 by default; 0 counts as 1.
    ///
    /// Every substep is a whole step of `dt` over this number: queries, solve, Rapier's step with its events.
    /// Forces of the user act in each, and position-based kinematic bodies go their way evenly. The report is
    /// that of the last substep, but times, candidates and the dispatcher's replacement are of the whole step; `stopped`
    /// compares with the whole step before.
    pub substeps: u32,
    report: StepReport,
    memory: Memory,
    stiffness: StiffnessTable,
    touching: Touching,
    force_events: ForceEvents,
    meshes: NearbyMeshes,
}

impl Default for IstPlugin {
    fn default() -> Self {
        Self {
            model: ContactModel::default(),
            substeps: 1,
            report: StepReport::default(),
            memory: Memory::default(),
            stiffness: StiffnessTable::default(),
            touching: Touching::default(),
            force_events: ForceEvents::default(),
            meshes: NearbyMeshes::default(),
        }
    }
}

impl IstPlugin {
    /// Teaches `world` about [`IstShape`] and returns the plugin that steps it.
    ///
    /// Replaces the world's query dispatcher unless it knows [`IstShape`] already; with a dispatcher of your own, chain it
    /// first: `world.narrow_phase.set_query_dispatcher(IstDispatcher.chain(yours))`.
    pub fn install(world: &mut PhysicsWorld) -> Self {
        Self::for_narrow_phase(&mut world.narrow_phase)
    }

    /// As [`Self::install`], for those who keep their own sets.
    pub fn for_narrow_phase(narrow_phase: &mut NarrowPhase) -> Self {
        ensure_dispatcher(narrow_phase);
        Self::default()
    }

    /// Steps `world` by its `dt`, volume contacts included, and reports them.
    pub fn step(&mut self, world: &mut PhysicsWorld) -> &StepReport {
        self.step_with_events(world, &(), &())
    }

    /// As [`Self::step`], with the user's hooks and event handler.
    pub fn step_with_events(
        &mut self,
        world: &mut PhysicsWorld,
        hooks: &dyn PhysicsHooks,
        events: &dyn EventHandler,
    ) -> &StepReport {
        self.step_parts(world.into(), hooks, events)
    }

    /// As [`Self::step_with_events`], for those who keep their own sets.
    ///
    /// Where the narrow phase's query dispatcher does not know [`IstShape`], because it was replaced or the world comes
    /// from a snapshot, bodies would fall through each other without an error. The step then installs
    /// `IstDispatcher.chain(DefaultQueryDispatcher)`, warns through the `log` crate, and says so in
    /// [`StepReport::dispatcher_replaced`].
    pub fn step_parts(
        &mut self,
        mut world: WorldParts<'_>,
        hooks: &dyn PhysicsHooks,
        events: &dyn EventHandler,
    ) -> &StepReport {
        let start = Instant::now();
        self.report.clear();
        self.report.dispatcher_replaced = ensure_dispatcher(world.narrow_phase);
        if self.report.dispatcher_replaced {
            log::warn!(
                "the query dispatcher of this world did not know inner sphere trees, and bodies would have fallen \
                 through each other: IstDispatcher.chain(DefaultQueryDispatcher) has been installed"
            );
        }
        self.stiffness.retain_existing(world.colliders);
        if self.substeps <= 1 {
            self.substep(&mut world, hooks, events);
        } else {
            let count = self.substeps as Real;
            let whole = *world.integration_parameters;
            let parameters = IntegrationParameters { dt: whole.dt / count, ..whole };
            let targets = KinematicTargets::new(world.bodies);
            for index in 1..=self.substeps {
                targets.aim(world.bodies, index as Real / count);
                self.substep(&mut world.with_parameters(&parameters), hooks, events);
            }
        }
        if has_length(&world) {
            self.touching.update(&world, &mut self.report);
        }
        self.report.step_seconds = start.elapsed().as_secs_f64();
        &self.report
    }

    /// What happened in the last step.
    #[must_use]
    pub fn report(&self) -> &StepReport {
        &self.report
    }

    /// How much the plugin remembers, for those who watch a world that runs for long.
    #[must_use]
    pub fn remembered(&self) -> Remembered {
        Remembered {
            pairs: self.memory.len(),
            touching: self.touching.len(),
            stiffnesses: self.stiffness.len(),
            meshes: self.meshes.len(),
        }
    }

    /// Gives a collider a stiffness (N/m³) of its own, or takes it away with `None`.
    ///
    /// Two colliders with stiffnesses `a` and `b` make a pair of `a b / (a + b)`, as springs in series. A collider
    /// without one is rigid beside one that has. Pairs of colliders without one have the stiffness of the model.
    /// Negative values and NaN count as 0. Forgotten when the collider is removed.
    pub fn set_collider_stiffness(&mut self, collider: ColliderHandle, stiffness: Option<Real>) {
        self.stiffness.set_collider(collider, stiffness);
    }

    /// The stiffness (N/m³) that [`Self::set_collider_stiffness`] gave to a collider.
    #[must_use]
    pub fn collider_stiffness(&self, collider: ColliderHandle) -> Option<Real> {
        self.stiffness.collider(collider)
    }

    /// Asks `law` for the stiffness (N/m³) of every pair that overlaps: once in a step, and again, up to three times in each
    /// substep, where a pair is measured anew. What it says counts, up to the greatest stiffness that is solved, see
    /// [`Stiffness`](crate::Stiffness).
    ///
    /// Negative values and NaN count as 0. Pairs are asked one after the other, in the order of their handles.
    ///
    /// ```
    /// # let mut plugin = rapier_ist::IstPlugin::default();
    /// // Soft against the ground, which has no body.
    /// plugin.set_pair_stiffness(|pair| match pair.body_a.and(pair.body_b) {
    ///     Some(_) => pair.stiffness,
    ///     None => 0.1 * pair.stiffness,
    /// });
    /// ```
    pub fn set_pair_stiffness(
        &mut self,
        law: impl Fn(&StiffnessContext<'_>) -> Real + Send + Sync + 'static,
    ) {
        self.stiffness.set_law(Some(Arc::new(law)));
    }

    /// Takes back [`Self::set_pair_stiffness`].
    pub fn clear_pair_stiffness(&mut self) {
        self.stiffness.set_law(None);
    }

    fn substep(&mut self, world: &mut WorldParts<'_>, hooks: &dyn PhysicsHooks, events: &dyn EventHandler) {
        self.report.clear_contacts();
        let ContactModel::VolumePenalty(penalty) = self.model else {
            switch_filters_off(world);
            world.step(hooks, events);
            return;
        };
        switch_filters_on(world);
        let has_length = has_length(world);
        let forces =
            if has_length { self.respond(world, hooks, &penalty.in_range()) } else { Pushes::default() };
        let user_forces = UserForces::suspend(world, forces);
        world.step(&PenaltyHooks { user: hooks }, events);
        user_forces.restore(world);
        if has_length {
            self.force_events.send(world, &self.report, events);
        }
    }

    fn respond(
        &mut self,
        world: &mut WorldParts<'_>,
        hooks: &dyn PhysicsHooks,
        penalty: &VolumePenalty,
    ) -> Pushes {
        let start = Instant::now();
        let candidates = candidates(world, hooks);
        self.report.candidates += candidates.len();
        let near = candidates.iter().flat_map(|candidate| candidate.colliders);
        self.meshes.update(near.filter_map(|handle| Some(world.colliders.get(handle)?.shared_shape())));
        self.report.query_seconds += start.elapsed().as_secs_f64();
        let law = ContactLaw { penalty, stiffness: &self.stiffness };
        respond(world, candidates, law, (&mut self.report, &mut self.memory))
    }
}

/// Whether time passes in the step.
fn has_length(world: &WorldParts<'_>) -> bool {
    world.integration_parameters.dt > 0.0
}

/// Installs the dispatcher unless the one in place knows inner sphere trees, and tells whether it did.
fn ensure_dispatcher(narrow_phase: &mut NarrowPhase) -> bool {
    let known = PROBE.as_ref().is_none_or(|probe| {
        narrow_phase.query_dispatcher().intersection_test(&Pose::IDENTITY, probe, probe).is_ok()
    });
    if !known {
        narrow_phase.set_query_dispatcher(IstDispatcher.chain(DefaultQueryDispatcher));
    }
    !known
}

/// A unit ball to ask a dispatcher about.
static PROBE: LazyLock<Option<IstShape>> = LazyLock::new(|| {
    let ball = InnerSphere::solid_ball(Vector::ZERO, 1.0, Vector::X);
    Some(IstShape::from_packing(&SpherePacking::new(vec![ball], SolidProperties::ball(1.0)).ok()?))
});
