//! The recorder.

use super::contacts::{ArrowScale, contact_list, finite_contacts, force_arrows};
use super::convert::timestamp;
use super::metrics::{metrics, timings};
use super::names::Names;
use super::poses::{PoseEvent, Poses};
use super::scene::Scene;
use super::sink::Sink;
use super::{BodyDescription, PACKING_KEY, RecordError, RecordOptions, SCALE_KEY};
use crate::StepReport;
use foxglove::messages::Log;
use foxglove::messages::PointCloud;
use foxglove::messages::log::Level;
use rapier3d::dynamics::{RigidBody, RigidBodyHandle};
use rapier3d::geometry::ColliderHandle;
use rapier3d::pipeline::PhysicsWorld;
use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::{BufWriter, Seek, Write};
use std::path::Path;

/// How errors name a writer that has no path.
const GIVEN_WRITER: &str = "the given writer";

/// Writes a simulation into an MCAP file, step by step.
///
/// Dropped without [`Recorder::finish`], it still completes the file, but errors go unnoticed; a killed run keeps
/// every chunk written before.
pub struct Recorder<W: Write + Seek> {
    sink: Sink<W>,
    options: RecordOptions,
    names: Names,
    poses: Poses,
    body_index: HashMap<RigidBodyHandle, usize>,
    /// Sum of the radii of the described bodies (m) and how many have one.
    radii: (f64, u32),
    scene: Scene,
    /// Names of the attached packings by their content.
    attached: HashMap<Vec<u8>, String>,
    arrow_scale: Option<ArrowScale>,
    /// Time of the last step (ns).
    time: u64,
    started: bool,
    statistics: RecordStatistics,
}

/// What a finished recording holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
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
        Self::start_send(BufWriter::new(file), path.display().to_string(), options)
    }
}

impl<W: Write + Seek + Send + 'static> Recorder<W> {
    /// As [`Recorder::new`], for a writer that can move to the thread that [`RecordOptions::background`] asks for.
    ///
    /// # Errors
    /// [`RecordError::Write`] where the writer fails or there can be no thread.
    pub fn new_send(writer: W, options: RecordOptions) -> Result<Self, RecordError> {
        Self::start_send(writer, GIVEN_WRITER.into(), options)
    }

    fn start_send(writer: W, target: String, options: RecordOptions) -> Result<Self, RecordError> {
        let sink = match options.background {
            true => Sink::background(writer, target, &options)?,
            false => Sink::new(writer, target, &options)?,
        };
        Self::start(sink, options)
    }
}

impl<W: Write + Seek> Recorder<W> {
    /// Records into `writer`, on the calling thread whatever [`RecordOptions::background`] says.
    ///
    /// # Errors
    /// [`RecordError::Write`] where the writer fails.
    pub fn new(writer: W, options: RecordOptions) -> Result<Self, RecordError> {
        Self::start(Sink::new(writer, GIVEN_WRITER.into(), &options)?, options)
    }

    fn start(sink: Sink<W>, options: RecordOptions) -> Result<Self, RecordError> {
        let mut recorder = Self {
            sink,
            names: Names::default(),
            poses: Poses::new(options.up),
            body_index: HashMap::new(),
            radii: (0.0, 0),
            scene: Scene::default(),
            attached: HashMap::new(),
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
            return Err(RecordError::Body { name: body.name.to_string(), what });
        }
        let name = self.names.unique(&body.name);
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
        self.body_index.insert(body.handle, self.poses.len());
        self.poses.add(body.handle, &name);
        Ok(name)
    }

    /// Describes every body of `world` that has not been described yet, in the order of the world's set, as
    /// `describe` says; a body for which it says `None` is left out. Returns how many were described. To be called
    /// again when bodies have been added.
    ///
    /// # Errors
    /// As [`Self::add_body`], at the first body that has one; those before are described.
    pub fn add_bodies<'a>(
        &mut self,
        world: &PhysicsWorld,
        mut describe: impl FnMut(RigidBodyHandle, &RigidBody) -> Option<BodyDescription<'a>>,
    ) -> Result<usize, RecordError> {
        let before = self.poses.len();
        for (handle, body) in world.bodies.iter() {
            let known = self.body_index.contains_key(&handle);
            if let Some(description) = (!known).then(|| describe(handle, body)).flatten() {
                self.add_body(&description)?;
            }
        }
        Ok(self.poses.len() - before)
    }

    /// The packing as points, and as a file unless an equal one is attached already. The channel of the points says
    /// which file it is.
    fn write_packing(&mut self, body: &BodyDescription, name: &str) -> Result<(), RecordError> {
        let Some(packing) = body.spheres else { return Ok(()) };
        let bytes = packing.to_bytes();
        let file = match self.attached.get(&bytes) {
            Some(file) => file.clone(),
            None => {
                let file = format!("{name}.ist");
                self.sink.attach(file.clone(), self.time, bytes.clone())?;
                self.attached.insert(bytes, file.clone());
                file
            }
        };
        let Some(cloud) = body.point_cloud(name, self.time) else { return Ok(()) };
        let topic = format!("/{name}/spheres");
        let metadata =
            BTreeMap::from([(PACKING_KEY.into(), file), (SCALE_KEY.into(), body.scale.to_string())]);
        self.sink.add_channel::<PointCloud>(&topic, metadata)?;
        self.sink.write(&topic, self.time, &cloud)
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
        self.write_poses(world)?;
        self.sink.flush()
    }

    /// Records the world after a step, with what the step reported.
    ///
    /// A pose that is not finite is recorded as the body's last finite one, with a line in the log; as none where it had none yet.
    ///
    /// # Errors
    /// [`RecordError::Write`].
    pub fn record(&mut self, world: &PhysicsWorld, report: &StepReport) -> Result<(), RecordError> {
        if !self.started {
            self.write_start(world)?;
            self.write_scene()?;
            self.sink.flush()?;
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
        self.log(Level::Info, format!("start with {} bodies", self.poses.len()))
    }

    fn write_poses(&mut self, world: &PhysicsWorld) -> Result<(), RecordError> {
        for (event, name) in self.poses.follow(&world.bodies, self.time) {
            match event {
                PoseEvent::Removed => {
                    self.scene.remove(&name);
                    self.log(Level::Info, format!("{name} left the world"))?;
                }
                PoseEvent::NotFinite => {
                    self.statistics.poses_refused += 1;
                    self.log(
                        Level::Error,
                        format!("the pose of {name} is not finite; the last one that was, if any, is kept"),
                    )?;
                }
            }
        }
        self.write_scene()?;
        self.sink.write("/tf", self.time, self.poses.message())
    }

    fn write_scene(&mut self) -> Result<(), RecordError> {
        match self.scene.take_update(self.time) {
            Some(update) => self.sink.write("/scene", self.time, update),
            None => Ok(()),
        }
    }

    fn write_contacts(&mut self, world: &PhysicsWorld, report: &StepReport) -> Result<(), RecordError> {
        let contacts = || finite_contacts(report);
        let refused = (report.contacts.len() - contacts().count()) as u64;
        if refused > 0 {
            self.statistics.contacts_refused += refused;
            self.log(Level::Error, format!("{refused} contacts are not finite and left out"))?;
        }
        let list = contact_list(report, |collider| self.collider_name(world, collider));
        self.sink.write("/contacts", self.time, &list)?;
        let scale = self.arrow_scale.unwrap_or_else(|| self.arrow_scale(world));
        self.sink.write("/scene/contacts", self.time, &force_arrows(report, scale, self.time))?;
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

    /// Name of the body that a collider belongs to, else one made of the collider's handle, which no body has: names have no
    /// colons.
    fn collider_name(&self, world: &PhysicsWorld, collider: ColliderHandle) -> String {
        let parent = world.colliders.get(collider).and_then(|collider| collider.parent());
        match parent.and_then(|body| self.body_index.get(&body)) {
            Some(&index) => self.poses.name(index).to_owned(),
            None => format!("collider:{}", collider.into_raw_parts().0),
        }
    }

    /// The scale of [`RecordOptions::arrow_length_per_newton`]: as asked for, or so that the mean weight of the
    /// dynamic bodies is as long as the mean body radius.
    fn arrow_scale(&self, world: &PhysicsWorld) -> ArrowScale {
        let (sum, count) = self.radii;
        let body_radius = if count > 0 { sum / f64::from(count) } else { 0.5 };
        let dynamic = || world.bodies.iter().filter(|(_, body)| body.is_dynamic());
        let masses = || dynamic().map(|(_, body)| f64::from(body.mass())).filter(|m| *m > 0.0);
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
