//! Volume contacts in a Rapier world.

use crate::candidates::candidates;
use crate::hooks::PenaltyHooks;
use crate::memory::Memory;
use crate::response::{UserForces, respond};
use crate::{ContactModel, IstDispatcher, IstShape, StepReport, WorldParts};
use ist::{InnerSphere, SolidProperties, SpherePacking};
use rapier3d::geometry::{ColliderHandle, NarrowPhase};
use rapier3d::math::{Pose, Vector};
use rapier3d::parry::query::{DefaultQueryDispatcher, QueryDispatcher};
use rapier3d::pipeline::{ActiveHooks, EventHandler, PhysicsHooks, PhysicsWorld};
use std::collections::HashSet;
use std::time::Instant;

/// Makes colliders with an [`IstShape`] collide: call [`Self::step`] where you called `world.step()`.
///
/// The plugin keeps nothing about bodies between steps, so bodies and colliders may be added, moved and removed
/// at will. Results do not depend on the number of threads.
#[derive(Clone, Debug, Default)]
pub struct IstPlugin {
    /// How overlap turns into motion; may be changed between steps.
    pub model: ContactModel,
    report: StepReport,
    memory: Memory,
    /// Colliders whose contact filter the plugin switched on.
    switched_on: HashSet<ColliderHandle>,
}

impl IstPlugin {
    /// Teaches `world` about [`IstShape`] and returns the plugin that steps it.
    ///
    /// Replaces the world's query dispatcher; with a dispatcher of your own, chain it:
    /// `world.narrow_phase.set_query_dispatcher(IstDispatcher.chain(yours))`.
    pub fn install(world: &mut PhysicsWorld) -> Self {
        let plugin = Self::default();
        ensure_dispatcher(&mut world.narrow_phase);
        plugin
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
    pub fn step_parts(
        &mut self,
        mut world: WorldParts<'_>,
        hooks: &dyn PhysicsHooks,
        events: &dyn EventHandler,
    ) -> &StepReport {
        let world = &mut world;
        let start = Instant::now();
        self.report = StepReport::default();
        ensure_dispatcher(world.narrow_phase);
        match self.model {
            ContactModel::VolumePenalty(penalty) => {
                self.switch_filters_on(world);
                let candidates = candidates(world, hooks, &self.switched_on);
                let forces = respond(world, candidates, &penalty, (&mut self.report, &mut self.memory));
                let user_forces = UserForces::suspend(world, forces);
                let hooks = PenaltyHooks { user: hooks, switched_on: &self.switched_on };
                world.step(&hooks, events);
                user_forces.restore(world);
            }
            ContactModel::VolumeManifold => {
                self.switch_filters_off(world);
                world.step(hooks, events);
            }
        }
        self.report.step_seconds = start.elapsed().as_secs_f64();
        &self.report
    }

    /// What happened in the last step.
    #[must_use]
    pub fn report(&self) -> &StepReport {
        &self.report
    }

    /// Rapier asks its hooks about a pair only where a collider wants that.
    fn switch_filters_on(&mut self, world: &mut WorldParts<'_>) {
        self.switched_on.retain(|handle| world.colliders.contains(*handle));
        let missing: Vec<_> =
            solids(world).filter(|(_, hooks)| !hooks.contains(ActiveHooks::FILTER_CONTACT_PAIRS)).collect();
        for (handle, hooks) in missing {
            if let Some(collider) = world.colliders.get_mut(handle) {
                collider.set_active_hooks(hooks | ActiveHooks::FILTER_CONTACT_PAIRS);
                self.switched_on.insert(handle);
            }
        }
    }

    fn switch_filters_off(&mut self, world: &mut WorldParts<'_>) {
        for handle in self.switched_on.drain() {
            if let Some(collider) = world.colliders.get_mut(handle) {
                collider.set_active_hooks(collider.active_hooks() - ActiveHooks::FILTER_CONTACT_PAIRS);
            }
        }
    }
}

/// Installs the dispatcher unless the one in place knows inner sphere trees. A world that was restored from a snapshot has
/// Rapier's default again, and its bodies would silently fall through each other.
fn ensure_dispatcher(narrow_phase: &mut NarrowPhase) {
    let probe = probe();
    let known = probe.as_ref().is_none_or(|probe| {
        narrow_phase.query_dispatcher().intersection_test(&Pose::IDENTITY, probe, probe).is_ok()
    });
    if !known {
        narrow_phase.set_query_dispatcher(IstDispatcher.chain(DefaultQueryDispatcher));
    }
}

/// Handles and hooks of the colliders with an [`IstShape`].
fn solids<'a>(world: &'a WorldParts<'_>) -> impl Iterator<Item = (ColliderHandle, ActiveHooks)> + 'a {
    let solid = |collider: &rapier3d::geometry::Collider| collider.shape().as_shape::<IstShape>().is_some();
    world.colliders.iter().filter(move |(_, c)| solid(c)).map(|(handle, c)| (handle, c.active_hooks()))
}

/// A unit ball to ask a dispatcher about.
fn probe() -> Option<IstShape> {
    let ball = InnerSphere::solid_ball(Vector::ZERO, 1.0, Vector::X);
    Some(IstShape::from_packing(&SpherePacking::new(vec![ball], SolidProperties::ball(1.0)).ok()?))
}
