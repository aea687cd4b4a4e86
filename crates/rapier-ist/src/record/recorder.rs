//! The recorder.

use super::contacts::{ArrowScale, contact_list, force_arrows, is_finite};
use super::convert::timestamp;
use super::metrics::{metrics, timings};
use super::names::Names;
use super::poses::{PoseEvent, TrackedBody, frame_transforms};
use super::scene::Scene;
use super::sink::Sink;
use super::{BodyDescription, RecordError, RecordOptions};
use crate::StepReport;
use foxglove::messages::Log;
use foxglove::messages::log::Level;
use rapier3d::dynamics::RigidBodyHandle;
use rapier3d::geometry::ColliderHandle;
use rapier3d::pipeline::PhysicsWorld;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::fs::File;
use std::io::{BufWriter, Seek, Write};
use std::path::Path;

/// Writes a simulation into an MCAP file, step by step.
///
/// Dropped without [`Recorder::finish`], it still completes the file, but errors go unnoticed; a killed run keeps
/// every chunk written before.
pub struct Recorder<W: Write + Seek> {
    sink: Sink<W>,
    options: RecordOptions,
    names: Names,
    bodies: Vec<TrackedBody>,
    body_index: HashMap<RigidBodyHandle, usize>,
    /// Sum of the radii of the described bodies (m) and how many have one.
    radii: (f64, u32),
    scene: Scene,
    attached: HashSet<Vec<u8>>,
    arrow_scale: Option<ArrowScale>,
    /// Time of the last step (ns).
    time: u64,
    started: bool,
    statistics: RecordStatistics,
}

/// What a finished recording holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RecordStatistics {
    /// Steps seen, recorded or skipped by [`RecordOptions::every`].
    pub steps: u64,
    /// Messages written on all topics.
    pub messages: u64,
    /// Size of the file (bytes).
    pub bytes: u64,
    /// Times a body's pose stopped being finite.
    pub poses_refused: u64,
    /// Contacts left out because they were not finite.
    pub contacts_refused: u64,
}

impl Recorder<BufWriter<File>> {
    /// Creates the file at `path`, replacing one that is there.
    ///
    /// # Errors
    /// [`RecordError::Create`] or [`RecordError::Write`] with the path.
    pub fn create(path: impl AsRef<Path>, options: RecordOptions) -> Result<Self, RecordError> {
        let path = path.as_ref();
        let file = File::create(path).map_err(|source| RecordError::Create { path: path.into(), source })?;
        Self::start(BufWriter::new(file), path.display().to_string(), options)
    }
}

impl<W: Write + Seek> Recorder<W> {
    /// Records into `writer`.
    ///
    /// # Errors
    /// [`RecordError::Write`] where the writer fails.
    pub fn new(writer: W, options: RecordOptions) -> Result<Self, RecordError> {
        Self::start(writer, "the given writer".into(), options)
    }

    fn start(writer: W, target: String, options: RecordOptions) -> Result<Self, RecordError> {
        let mut recorder = Self {
            sink: Sink::new(writer, target, &options)?,
            names: Names::default(),
            bodies: Vec::new(),
            body_index: HashMap::new(),
            radii: (0.0, 0),
            scene: Scene::default(),
            attached: HashSet::new(),
            arrow_scale: None,
            time: 0,
            started: false,
            statistics: RecordStatistics::default(),
            options,
        };
        let mut metadata = std::mem::take(&mut recorder.options.metadata);
        metadata.insert("rapier-ist".into(), env!("CARGO_PKG_VERSION").into());
        metadata.insert("rapier3d".into(), rapier3d::VERSION.into());
        recorder.sink.metadata("recording", metadata)?;
        Ok(recorder)
    }

    /// Describes a body, whose pose is recorded from now on; returns the name of its frame: the given one, with
    /// `_` for what a topic cannot hold and a number where it is taken.
    ///
    /// # Errors
    /// [`RecordError::Body`] for geometry that cannot be drawn or a body described before, [`RecordError::Write`]
    /// where the file cannot be written.
    pub fn add_body(&mut self, body: &BodyDescription) -> Result<String, RecordError> {
        body.check()?;
        if self.body_index.contains_key(&body.handle) {
            let what = "this body has been described already; describe every body once";
            return Err(RecordError::Body { name: body.name.to_owned(), what });
        }
        let name = self.names.unique(body.name);
        if let Some(entity) = body.entity(&name, self.time) {
            self.scene.add(entity);
        }
        if self.options.packings {
            self.write_packing(body, &name)?;
        }
        let radius = body.radius();
        if radius > 0.0 {
            self.radii = (self.radii.0 + radius, self.radii.1 + 1);
        }
        self.body_index.insert(body.handle, self.bodies.len());
        self.bodies.push(TrackedBody::new(body.handle, name.clone()));
        Ok(name)
    }

    /// The packing as points, and as a file unless an equal one is attached already.
    fn write_packing(&mut self, body: &BodyDescription, name: &str) -> Result<(), RecordError> {
        let Some(packing) = body.spheres else { return Ok(()) };
        if let Some(cloud) = body.point_cloud(name, self.time) {
            self.sink.write(&format!("/{name}/spheres"), self.time, &cloud)?;
        }
        let bytes = packing.to_bytes();
        if !self.attached.contains(&bytes) {
            self.sink.attach(format!("{name}.ist"), self.time, &bytes)?;
            self.attached.insert(bytes);
        }
        Ok(())
    }

    /// Records the poses before the first step, at time 0; later calls do nothing.
    ///
    /// # Errors
    /// [`RecordError::Write`].
    pub fn record_start(&mut self, world: &PhysicsWorld) -> Result<(), RecordError> {
        if self.started {
            return Ok(());
        }
        self.write_start(world)?;
        self.write_poses(world)
    }

    /// Records the world after a step, with what the step reported.
    ///
    /// A pose that is not finite is recorded as the body's last finite one, with a line in the log.
    ///
    /// # Errors
    /// [`RecordError::Write`].
    pub fn record(&mut self, world: &PhysicsWorld, report: &StepReport) -> Result<(), RecordError> {
        if !self.started {
            self.write_start(world)?;
        }
        self.time = self.time.saturating_add(step_nanoseconds(world));
        self.statistics.steps += 1;
        if !self.statistics.steps.is_multiple_of(self.options.every) {
            return Ok(());
        }
        self.write_poses(world)?;
        if self.options.contacts {
            self.write_contacts(world, report)?;
        }
        Ok(())
    }

    /// Completes the file: summary, indices, statistics.
    ///
    /// # Errors
    /// [`RecordError::Write`].
    pub fn finish(mut self) -> Result<RecordStatistics, RecordError> {
        self.write_scene()?;
        self.log(Level::Info, format!("end after {} steps", self.statistics.steps))?;
        let written = self.sink.finish()?;
        Ok(RecordStatistics { messages: written.messages, bytes: written.bytes, ..self.statistics })
    }

    /// What holds for the whole run.
    fn write_start(&mut self, world: &PhysicsWorld) -> Result<(), RecordError> {
        self.started = true;
        let parameters = &world.integration_parameters;
        let gravity = world.gravity;
        let metadata = BTreeMap::from([
            ("time_step".into(), parameters.dt.to_string()),
            ("gravity".into(), format!("{} {} {}", gravity.x, gravity.y, gravity.z)),
            ("solver_iterations".into(), parameters.num_solver_iterations.to_string()),
        ]);
        self.sink.metadata("simulation", metadata)?;
        self.arrow_scale = Some(self.arrow_scale(world));
        self.log(Level::Info, format!("start with {} bodies", self.bodies.len()))
    }

    fn write_poses(&mut self, world: &PhysicsWorld) -> Result<(), RecordError> {
        let mut notable = Vec::new();
        for body in &mut self.bodies {
            match body.follow(&world.bodies) {
                Some(PoseEvent::Removed) => {
                    self.scene.remove(&body.name);
                    notable.push((Level::Info, format!("{} left the world", body.name)));
                }
                Some(PoseEvent::NotFinite) => {
                    self.statistics.poses_refused += 1;
                    let text = format!("the pose of {} is not finite; its last one is kept", body.name);
                    notable.push((Level::Error, text));
                }
                None => {}
            }
        }
        for (level, text) in notable {
            self.log(level, text)?;
        }
        self.write_scene()?;
        let transforms = frame_transforms(&self.bodies, self.options.up, self.time);
        self.sink.write("/tf", self.time, &transforms)
    }

    fn write_scene(&mut self) -> Result<(), RecordError> {
        match self.scene.take_update(self.time) {
            Some(update) => self.sink.write("/scene", self.time, update),
            None => Ok(()),
        }
    }

    fn write_contacts(&mut self, world: &PhysicsWorld, report: &StepReport) -> Result<(), RecordError> {
        let contacts = || report.contacts.iter().filter(|contact| is_finite(contact));
        let refused = (report.contacts.len() - contacts().count()) as u64;
        if refused > 0 {
            self.statistics.contacts_refused += refused;
            self.log(Level::Error, format!("{refused} contacts are not finite and left out"))?;
        }
        let list = contact_list(contacts(), |collider| self.collider_name(world, collider));
        self.sink.write("/contacts", self.time, &list)?;
        let scale = self.arrow_scale.unwrap_or_else(|| self.arrow_scale(world));
        self.sink.write("/scene/contacts", self.time, &force_arrows(contacts(), scale, self.time))?;
        let mut sums = metrics(world, report, self.statistics.steps);
        sums.timings = self.options.timings.then(|| timings(report));
        self.sink.write("/metrics", self.time, &sums)
    }

    fn log(&mut self, level: Level, message: String) -> Result<(), RecordError> {
        let log = Log {
            timestamp: Some(timestamp(self.time)),
            level: level as i32,
            message,
            name: "rapier-ist".into(),
            ..Default::default()
        };
        self.sink.write("/log", self.time, &log)
    }

    /// Name of the body that a collider belongs to, else one made of the collider's handle.
    fn collider_name(&self, world: &PhysicsWorld, collider: ColliderHandle) -> String {
        let parent = world.colliders.get(collider).and_then(|collider| collider.parent());
        match parent.and_then(|body| self.body_index.get(&body)) {
            Some(&index) => self.bodies[index].name.clone(),
            None => format!("collider_{}", collider.into_raw_parts().0),
        }
    }

    /// The scale of [`RecordOptions::arrow_length_per_newton`]: as asked for, or so that the mean weight of the
    /// dynamic bodies is as long as the mean body radius.
    fn arrow_scale(&self, world: &PhysicsWorld) -> ArrowScale {
        let (sum, count) = self.radii;
        let body_radius = if count > 0 { sum / f64::from(count) } else { 0.5 };
        let masses = || world.bodies.iter().map(|(_, body)| f64::from(body.mass())).filter(|m| *m > 0.0);
        let mass = masses().sum::<f64>() / masses().count().max(1) as f64;
        // Without gravity, what the bodies would weigh on Earth.
        let gravity = f64::from(world.gravity.length());
        let weight = mass * if gravity > 0.0 { gravity } else { 9.81 };
        let automatic = if weight > 0.0 && weight.is_finite() { body_radius / weight } else { body_radius };
        let length_per_newton = self.options.arrow_length_per_newton.unwrap_or(automatic);
        ArrowScale { length_per_newton, body_radius }
    }
}

/// The time step in whole nanoseconds, 0 for one that is negative or not a number.
fn step_nanoseconds(world: &PhysicsWorld) -> u64 {
    (f64::from(world.integration_parameters.dt) * 1e9).round() as u64
}
