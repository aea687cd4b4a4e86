//! What the frame needs to know of a scene.

use super::Check;
use crate::figures::Summary;
use crate::palette;
use crate::render::{CutPlane, Scene, Section};
use glam::Vec3;
use ist::SpherePacking;
use packer::Solid;
use rapier_ist::IstPlugin;
use rapier3d::dynamics::RigidBodyHandle;
use rapier3d::pipeline::PhysicsWorld;

/// A scene that can be stepped, recorded, drawn and checked.
pub trait Simulation {
    /// The scene in a few words, for the head of the report.
    fn title(&self) -> String;

    /// The Rapier world.
    fn world(&self) -> &PhysicsWorld;

    /// What steps it.
    fn plugin(&self) -> &IstPlugin;

    /// One step of the world, with all that the scene adds to it and measures on the way.
    fn step(&mut self);

    /// All bodies to record and draw.
    fn bodies(&self) -> Vec<Body<'_>>;

    /// What the example asserts, after the run; `summary` are the figures that all runs have. A run that is too short
    /// for an assertion leaves it out.
    fn checks(&self, summary: &Summary) -> Vec<Check>;

    /// Figures of its own, for the summary file.
    fn figures(&self) -> serde_json::Value {
        serde_json::Value::Null
    }

    /// Lines of its own, for the report.
    fn remarks(&self) -> String {
        String::new()
    }

    /// Where the picture is taken from.
    fn view(&self) -> View {
        View::default()
    }

    /// Adds to the picture what is no body.
    fn decorate(&self, _picture: &mut Scene<'_>) {}

    /// Parameters, for the recording's metadata.
    fn metadata(&self) -> Vec<(&'static str, String)> {
        Vec::new()
    }

    /// Bodies that are not where they could be: here those whose pose is not finite.
    fn lost(&self) -> usize {
        self.world().bodies.iter().filter(|(_, body)| !body.position().is_finite()).count()
    }
}

/// How a body is recorded and drawn. Its collider has the pose of the body.
#[derive(Clone, Debug)]
pub struct Body<'a> {
    /// In the world.
    pub handle: RigidBodyHandle,
    /// In recordings.
    pub name: String,
    /// Its mesh.
    pub solid: &'a Solid,
    /// Its spheres, if it is an inner sphere tree.
    pub packing: Option<&'a SpherePacking>,
    /// Its size in units of solid and packing.
    pub scale: f32,
    /// sRGB, 0 to 1 each.
    pub color: [f32; 3],
    /// In recordings, 0 to 1.
    pub opacity: f32,
    /// What the view's cut does to it.
    pub section: Section,
    /// Whether the camera frames it; else it may reach out of the picture.
    pub framed: bool,
}

impl<'a> Body<'a> {
    /// A grey body without spheres, as large as its solid.
    #[must_use]
    pub fn new(handle: RigidBodyHandle, name: impl Into<String>, solid: &'a Solid) -> Self {
        Self {
            handle,
            name: name.into(),
            solid,
            packing: None,
            scale: 1.0,
            color: palette::NEUTRAL,
            opacity: 1.0,
            section: Section::Whole,
            framed: true,
        }
    }

    /// Its spheres.
    #[must_use]
    pub fn packing(mut self, packing: &'a SpherePacking) -> Self {
        self.packing = Some(packing);
        self
    }

    /// Its size in units of solid and packing.
    #[must_use]
    pub fn scale(mut self, scale: f32) -> Self {
        self.scale = scale;
        self
    }

    /// Its colour, sRGB, 0 to 1 each.
    #[must_use]
    pub fn color(mut self, color: [f32; 3]) -> Self {
        self.color = color;
        self
    }

    /// Its opacity in recordings, 0 to 1.
    #[must_use]
    pub fn opacity(mut self, opacity: f32) -> Self {
        self.opacity = opacity;
        self
    }

    /// What the view's cut does to it.
    #[must_use]
    pub fn section(mut self, section: Section) -> Self {
        self.section = section;
        self
    }

    /// Lets it reach out of the picture.
    #[must_use]
    pub fn unframed(mut self) -> Self {
        self.framed = false;
        self
    }
}

/// Where a picture is taken from. The camera frames the bodies by itself.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Direction from the scene to the camera.
    pub from: Vec3,
    /// Height of the ground (m).
    pub ground: Option<f32>,
    /// Cuts bodies open, as each body's section says.
    pub cut: Option<CutPlane>,
}

impl Default for View {
    fn default() -> Self {
        Self { from: Vec3::new(0.45, 1.0, 0.8), ground: None, cut: None }
    }
}
