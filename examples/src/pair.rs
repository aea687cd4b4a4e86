//! Two solids, one of which moves about the other: loaded, drawn and recorded.

use crate::palette;
use crate::render::{CutPlane, Mesh, PictureSize, Scene, Section, Surface};
use crate::scenes::single_precision;
use anyhow::{Context, Result};
use glam::Vec3;
use glamx::Pose3;
use ist::{InnerSphereTree, SpherePacking};
use packer::{PackOptions, Solid, TriangleMesh, pack};
use rapier_ist::StepReport;
use rapier_ist::record::{BodyDescription, RecordOptions, Recorder};
use rapier3d::dynamics::RigidBodyBuilder;
use rapier3d::pipeline::PhysicsWorld;
use std::path::Path;

/// A solid of a pair.
#[derive(Clone, Debug)]
pub struct PairSolid {
    /// Its spheres.
    pub packing: SpherePacking,
    /// Its mesh; an `.ist` file has none.
    pub solid: Option<Solid>,
    /// Its size in units of both.
    pub scale: f32,
}

impl PairSolid {
    /// Reads an `.ist` file, or a closed mesh and packs it with `spheres` spheres.
    ///
    /// # Errors
    /// Where the file cannot be read or packed; names it.
    pub fn load(path: &Path, spheres: usize) -> Result<Self> {
        let load = || -> Result<Self> {
            if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ist")) {
                return Ok(Self { packing: SpherePacking::load(path)?, solid: None, scale: 1.0 });
            }
            let solid = Solid::new(&TriangleMesh::load(path)?)?;
            let packing = pack(&solid, &PackOptions::balanced().spheres(spheres))?.packing;
            Ok(Self { packing, solid: Some(solid), scale: 1.0 })
        };
        load().with_context(|| format!("cannot use {}", path.display()))
    }

    /// Its tree.
    ///
    /// # Errors
    /// Where its scale is no size.
    pub fn tree(&self) -> Result<InnerSphereTree> {
        let scaled = InnerSphereTree::new(&self.packing).scaled(self.scale);
        scaled.with_context(|| format!("{} is no size: it must be a positive number", self.scale))
    }

    fn balls(&self) -> impl Iterator<Item = (Vec3, f32)> {
        self.packing.spheres().iter().map(|sphere| (sphere.center * self.scale, sphere.radius * self.scale))
    }
}

/// Where a pair is cut open.
#[derive(Clone, Copy, Debug)]
pub struct Cut {
    /// Pose of B in A's frame.
    pub pose: Pose3,
    /// A point of the plane, which faces along z, in A's frame (m).
    pub at: Vec3,
    /// Of the picture.
    pub size: PictureSize,
}

/// Draws both solids cut open, with their inner balls.
///
/// # Errors
/// Where the file cannot be written.
pub fn draw(solids: [&PairSolid; 2], cut: &Cut, path: &Path) -> Result<()> {
    let mesh = |solid: &PairSolid| solid.solid.as_ref().map(|s| Mesh::new(s.mesh()).scaled(solid.scale));
    let meshes = solids.map(mesh);
    let mut scene = Scene::new();
    scene.set_cut(CutPlane { point: cut.at, normal: Vec3::Z });
    for (index, ((solid, mesh), pose)) in
        solids.iter().zip(&meshes).zip([Pose3::IDENTITY, cut.pose]).enumerate()
    {
        let surface = Surface::new(palette::color(index)).section(Section::Hollow);
        scene.add_balls(solid.balls(), pose, surface);
        if let Some(mesh) = mesh {
            scene.add_mesh(mesh, pose, surface);
        }
    }
    let camera = scene.framed_from(Vec3::new(0.2, 0.25, 1.0), cut.size);
    scene.render(&camera, cut.size).save_png(path).context("cannot draw the picture")
}

/// Records B at all of `poses`, in A's frame, one after the other in steps of `dt` (s); of every `every` steps one.
///
/// # Errors
/// Where the file cannot be written.
pub fn record(solids: [&PairSolid; 2], poses: &[Pose3], [dt, every]: [f32; 2], path: &Path) -> Result<()> {
    let mut world = PhysicsWorld::new();
    world.integration_parameters.dt = dt;
    let start = poses.first().copied().unwrap_or_default();
    let a = world.insert_body(RigidBodyBuilder::fixed());
    let b = world.insert_body(RigidBodyBuilder::kinematic_position_based().pose(start));
    let mut recorder = Recorder::create(path, RecordOptions::everything().every(every as u32))?;
    for (index, (handle, solid)) in [a, b].into_iter().zip(solids).enumerate() {
        let [red, green, blue] = palette::color(index);
        let geometry = solid.solid.as_ref().map(single_precision);
        let mut description = BodyDescription::new(handle, ["a", "b"][index])
            .spheres(&solid.packing)
            .scale(solid.scale)
            .color([red, green, blue, 0.5]);
        if let Some((vertices, triangles)) = &geometry {
            description = description.mesh(vertices, triangles);
        }
        recorder.add_body(&description)?;
    }
    recorder.record_start(&world)?;
    let report = StepReport::default();
    for pose in poses {
        // Nothing acts on the bodies: the recording shows where the queries were asked.
        world.bodies[b].set_position(*pose, false);
        recorder.record(&world, &report)?;
    }
    recorder.finish()?;
    Ok(())
}
