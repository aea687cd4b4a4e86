//! Records become a replay.

use super::contact::{contact, metrics};
use super::scene::{Transform, mesh, spheres, transform};
use super::timeline::Timeline;
use super::{LogLine, Replay, ReplayBody, ReplayEnd, ReplayPacking};
use crate::record::messages::{Contacts, Metrics};
use crate::record::{PACKING_KEY, SCALE_KEY, UpAxis};
use foxglove::messages::log::Level;
use foxglove::messages::{FrameTransforms, Log, PointCloud, SceneUpdate};
use ist::SpherePacking;
use mcap::records::{Channel, Record};
use prost::Message;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// As many defects are told; a file that is no recording may have millions.
const MAX_DEFECTS: usize = 100;

/// What has been read so far.
#[derive(Default)]
pub(super) struct Builder {
    channels: HashMap<u16, Channel>,
    bodies: Vec<ReplayBody>,
    body_indices: HashMap<String, usize>,
    packings: HashMap<String, Arc<SpherePacking>>,
    timeline: Timeline,
    metadata: BTreeMap<String, BTreeMap<String, String>>,
    log: Vec<LogLine>,
    up: UpAxis,
    defects: Vec<String>,
}

impl Builder {
    pub(super) fn add(&mut self, record: Record) {
        match record {
            Record::Channel(channel) => {
                self.channels.insert(channel.id, channel);
            }
            Record::Message { header, data } => self.message(header.channel_id, header.log_time, &data),
            Record::Metadata(record) => self.metadata.entry(record.name).or_default().extend(record.metadata),
            Record::Attachment { header, data, .. } if header.name.ends_with(".ist") => {
                match SpherePacking::from_bytes(&data) {
                    Ok(packing) => drop(self.packings.insert(header.name, Arc::new(packing))),
                    Err(error) => self.defect(format!("the packing {}: {error}", header.name)),
                }
            }
            _ => {}
        }
    }

    pub(super) fn finish(self, end: ReplayEnd) -> Replay {
        Replay {
            bodies: self.bodies,
            body_indices: self.body_indices,
            timeline: self.timeline,
            metadata: self.metadata,
            log: self.log,
            up: self.up,
            defects: self.defects,
            end,
        }
    }

    fn message(&mut self, channel: u16, time: u64, data: &[u8]) {
        let Some(channel) = self.channels.get(&channel) else {
            return self
                .defect(format!("a message at {time} ns is on channel {channel}, which is not there"));
        };
        let topic = channel.topic.clone();
        let understood = match topic.as_str() {
            "/tf" => FrameTransforms::decode(data).map(|message| self.poses(time, &message)),
            "/scene" => SceneUpdate::decode(data).map(|message| self.scene(&message)),
            "/contacts" => Contacts::decode(data).map(|message| self.contacts(time, &message)),
            "/metrics" => Metrics::decode(data).map(|message| {
                self.timeline.add_metrics(time, metrics(&message));
            }),
            "/log" => Log::decode(data).map(|message| self.line(time, message)),
            _ => match topic.strip_prefix('/').and_then(|topic| topic.strip_suffix("/spheres")) {
                Some(name) => {
                    let (name, about) = (name.to_owned(), channel.metadata.clone());
                    PointCloud::decode(data).map(|cloud| self.spheres(&name, &about, &cloud))
                }
                None => Ok(()),
            },
        };
        if let Err(error) = understood {
            self.defect(format!("a message on {topic} at {time} ns: {error}"));
        }
    }

    fn poses(&mut self, time: u64, message: &FrameTransforms) {
        let mut poses = Vec::with_capacity(message.transforms.len());
        for frame in &message.transforms {
            match transform(frame) {
                Transform::Up(axis) => self.up = axis,
                Transform::Body(name, pose) => poses.push((self.body(name) as u32, pose)),
                Transform::Other => {}
            }
        }
        self.timeline.begin_step(time, poses);
    }

    /// A body's mesh never changes, but is written again when another body comes or goes.
    fn scene(&mut self, message: &SceneUpdate) {
        for entity in message.entities.iter().filter(|entity| entity.frame_locked) {
            let body = self.body(&entity.frame_id);
            if let Some(body) = self.bodies.get_mut(body).filter(|body| body.mesh.is_none()) {
                body.mesh = mesh(entity);
            }
        }
    }

    fn spheres(&mut self, name: &str, about: &BTreeMap<String, String>, cloud: &PointCloud) {
        let packing = about.get(PACKING_KEY).and_then(|file| self.packings.get(file)).cloned();
        let scale = about.get(SCALE_KEY).and_then(|scale| scale.parse().ok()).unwrap_or(1.0);
        let body = self.body(name);
        if let Some(body) = self.bodies.get_mut(body) {
            body.spheres = spheres(cloud);
            body.packing = packing.map(|packing| ReplayPacking { packing, scale });
        }
    }

    fn contacts(&mut self, time: u64, message: &Contacts) {
        let indices = &self.body_indices;
        let contacts = message.contacts.iter().map(|c| contact(c, |name| indices.get(name).copied()));
        self.timeline.add_contacts(time, contacts);
    }

    fn line(&mut self, time: u64, log: Log) {
        let is_error = log.level >= Level::Error as i32;
        self.log.push(LogLine { time: time as f64 / 1e9, is_error, message: log.message });
    }

    /// Place of the body `name`, which is new where the file has not named it yet.
    fn body(&mut self, name: &str) -> usize {
        if let Some(&index) = self.body_indices.get(name) {
            return index;
        }
        let index = self.bodies.len();
        self.bodies.push(ReplayBody { name: name.to_owned(), ..ReplayBody::default() });
        self.body_indices.insert(name.to_owned(), index);
        index
    }

    fn defect(&mut self, what: String) {
        if self.defects.len() < MAX_DEFECTS {
            self.defects.push(what);
        }
    }
}
