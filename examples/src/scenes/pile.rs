//! Bodies of mixed shape and size dropped into a bowl.

use super::{Model, ShapeKind};
use crate::figures::Summary;
use crate::run::{Body, Check, Simulation, View, Wanted};
use crate::{palette, shapes};
use anyhow::{Result, ensure};
use glam::{DVec3, Quat, Vec3};
use packer::{Solid, TriangleMesh};
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rapier_ist::{IstPlugin, StepReport};
use rapier3d::dynamics::{RigidBodyBuilder, RigidBodyHandle};
use rapier3d::geometry::ColliderBuilder;
use rapier3d::pipeline::PhysicsWorld;
use rapier3d::prelude::TriMeshFlags;
use std::path::{Path, PathBuf};

/// Radius of the bowl's hollow (m).
const BOWL_RADIUS: f64 = 1.7;
/// Thickness of its wall (m): a body that falls from the top moves 0.13 m per step.
const BOWL_WALL: f64 = 0.3;
/// Height of its rim above its bottom (m).
const BOWL_HEIGHT: f64 = 1.4;
/// Bodies per layer: one, six around it and twelve around those.
const PER_LAYER: usize = 19;
/// Height of the lowest layer over the rim's sphere centre (m).
const FIRST_LAYER: f32 = -0.2;
/// Smallest and largest longest side of a body (m).
const SIZES: [f32; 2] = [0.28, 0.44];
/// Contact skin of a body, relative to its longest side: about as thick as the corners and teeth that a thousand spheres
/// do not reach.
const SKIN: f32 = 0.008;
/// Density of all bodies (kg/m³).
const DENSITY: f32 = 1000.0;
/// Deepest vertex of an exact mesh inside another that the example accepts, in per cent of the smaller body's size.
const DEEPEST_PERCENT: f64 = 6.0;
/// Steps after which everything has landed. Before, bodies that have just met at some metres per second are up to 14 % in each
/// other, and the figure is reported only.
const LANDED_AFTER: usize = 180;
/// Steps after which everything has to be asleep.
const RESTS_AFTER: usize = 600;

/// What the pile is made of.
#[derive(Clone, Debug)]
pub struct PileOptions {
    /// Number of bodies.
    pub bodies: usize,
    /// Seed of sizes, places and rotations.
    pub seed: u64,
    /// Spheres per body.
    pub spheres: usize,
    /// Meshes to use instead of the built-in ones.
    pub meshes: Vec<PathBuf>,
    /// What stands for the meshes in the simulation.
    pub shape: ShapeKind,
}

impl Default for PileOptions {
    fn default() -> Self {
        Self { bodies: 40, seed: 1, spheres: 1000, meshes: Vec::new(), shape: ShapeKind::Ist }
    }
}

/// One dropped body.
#[derive(Clone, Copy, Debug)]
pub struct PileBody {
    /// In the world.
    pub handle: RigidBodyHandle,
    /// Index into [`Pile::models`].
    pub model: usize,
    /// Longest side (m).
    pub size: f32,
}

/// The scene, ready to step at 60 Hz.
pub struct Pile {
    /// The Rapier world.
    pub world: PhysicsWorld,
    /// Steps it.
    pub plugin: IstPlugin,
    /// The different solids.
    pub models: Vec<Model>,
    /// The dropped bodies.
    pub bodies: Vec<PileBody>,
    /// The bowl, a fixed body.
    pub bowl: RigidBodyHandle,
    /// The bowl's exact solid.
    pub bowl_solid: Solid,
    /// As asked for.
    options: PileOptions,
}

impl Pile {
    /// Packs the meshes and places the bodies above the bowl; `progress` is told what is being done.
    ///
    /// # Errors
    /// Where a mesh cannot be loaded or packed.
    pub fn new(options: &PileOptions, mut progress: impl FnMut(&str)) -> Result<Self> {
        ensure!(options.spheres > 0, "zero spheres asked for; ask for at least one (--spheres)");
        let mut models = Vec::new();
        if options.meshes.is_empty() {
            for (name, mesh) in built_in_meshes()? {
                progress(&format!("packing {name}"));
                models.push(Model::new(name, mesh, options.spheres, options.shape)?);
            }
        }
        for path in &options.meshes {
            progress(&format!("packing {}", path.display()));
            models.push(Model::load(path, options.spheres, options.shape)?);
        }
        let mut world = PhysicsWorld::new();
        let plugin = IstPlugin::install(&mut world);
        let bowl_mesh = shapes::bowl(BOWL_RADIUS, BOWL_WALL, BOWL_HEIGHT, 96);
        let bowl_solid = Solid::new(&bowl_mesh)?;
        let vertices = bowl_solid.mesh().vertices.iter().map(|v| v.as_vec3()).collect();
        let flags = TriMeshFlags::ORIENTED | TriMeshFlags::FIX_INTERNAL_EDGES;
        let collider =
            ColliderBuilder::trimesh_with_flags(vertices, bowl_solid.mesh().triangles.clone(), flags)?;
        let (bowl, _) = world.insert(RigidBodyBuilder::fixed(), collider);
        let mut pile =
            Self { world, plugin, models, bodies: Vec::new(), bowl, bowl_solid, options: options.clone() };
        pile.drop_bodies(options)?;
        Ok(pile)
    }

    /// Steps the world once.
    pub fn step(&mut self) -> &StepReport {
        self.plugin.step(&mut self.world)
    }

    /// Places bodies in layers of two rings around one body, each with a free ball of space around it.
    fn drop_bodies(&mut self, options: &PileOptions) -> Result<()> {
        let mut random = Pcg64Mcg::seed_from_u64(options.seed);
        let spacing = SIZES[1] * 3.0_f32.sqrt() * 0.85;
        for index in 0..options.bodies {
            let (layer, place) = (index / PER_LAYER, index % PER_LAYER);
            let (ring, turn) = match place {
                0 => (0.0, 0.0),
                1..=6 => (spacing, place as f32 / 6.0),
                _ => (2.0 * spacing, place as f32 / 12.0),
            };
            let angle = (turn + 0.04 * layer as f32) * std::f32::consts::TAU;
            let jitter = Vec3::from_array(std::array::from_fn(|_| random.random_range(-0.02..0.02)));
            let height = FIRST_LAYER + layer as f32 * spacing;
            let (sin, cos) = libm::sincosf(angle);
            let position = Vec3::new(ring * cos, height, ring * sin) + jitter;
            self.add(position, index % self.models.len(), &mut random)?;
        }
        Ok(())
    }

    /// Adds a body of random size and rotation.
    pub(super) fn add(&mut self, position: Vec3, model: usize, random: &mut impl Rng) -> Result<()> {
        let size = random.random_range(SIZES[0]..SIZES[1]);
        let body = RigidBodyBuilder::dynamic().pose(glamx::Pose3::from_parts(position, rotation(random)));
        let collider = self.models[model].collider(size, DENSITY)?.contact_skin(SKIN * size);
        let (handle, _) = self.world.insert(body, collider);
        self.bodies.push(PileBody { handle, model, size });
        Ok(())
    }

    /// Takes the body at `index` of [`Self::bodies`] out of the world; the last one gets its index.
    pub(super) fn remove(&mut self, index: usize) {
        let body = self.bodies.swap_remove(index);
        self.world.remove_body(body.handle);
    }
}

impl Simulation for Pile {
    fn title(&self) -> String {
        format!("pile, {:?} shapes", self.options.shape)
    }

    fn world(&self) -> &PhysicsWorld {
        &self.world
    }

    fn plugin(&self) -> &IstPlugin {
        &self.plugin
    }

    fn step(&mut self) {
        Self::step(self);
    }

    fn bodies(&self) -> Vec<Body<'_>> {
        let body = |(index, body): (usize, &PileBody)| {
            let model = &self.models[body.model];
            Body::new(body.handle, format!("{}_{index}", model.name), &model.solid)
                .packing(&model.packing)
                .scale(body.size)
                .color(palette::color(body.model))
        };
        let bowl = Body::new(self.bowl, "bowl", &self.bowl_solid).opacity(0.35).unframed();
        std::iter::once(bowl).chain(self.bodies.iter().enumerate().map(body)).collect()
    }

    /// Rapier's own shapes are there to compare with: nothing is asserted of them.
    fn checks(&self, summary: &Summary) -> Vec<Check> {
        let (percent, most) = (100.0 * summary.deepest_overlap, Wanted::AtMost(DEEPEST_PERCENT));
        let deepest = Check::new("deepest overlap", percent, "% of size", most);
        let mut checks = vec![
            Check::new("bodies out of the bowl", summary.lost as f64, "", Wanted::AtMost(0.0)),
            if summary.steps >= LANDED_AFTER { deepest } else { deepest.reported() },
        ];
        if summary.steps >= RESTS_AFTER {
            let awake = (summary.bodies - summary.asleep) as f64;
            checks.push(Check::new("bodies still awake", awake, "", Wanted::AtMost(0.0)));
        }
        if self.options.shape == ShapeKind::Ist {
            return checks;
        }
        checks.into_iter().map(Check::reported).collect()
    }

    fn view(&self) -> View {
        View { ground: Some(self.bowl_solid.bounds().0.y as f32), ..View::default() }
    }

    fn metadata(&self) -> Vec<(&'static str, String)> {
        vec![
            ("example", "pile".to_owned()),
            ("seed", self.options.seed.to_string()),
            ("shape", format!("{:?}", self.options.shape)),
        ]
    }

    /// Bodies that lie below the bowl's bottom or beyond its rim, or whose pose is not finite.
    fn lost(&self) -> usize {
        let (lower, upper) = self.bowl_solid.bounds();
        let lost = |body: &&PileBody| {
            let position = self.world.bodies[body.handle].translation().as_dvec3();
            let sideways = DVec3::new(position.x, 0.0, position.z).length();
            !position.is_finite() || position.y < lower.y || sideways > upper.x
        };
        self.bodies.iter().filter(lost).count()
    }
}

/// A rotation drawn uniformly, after K. Shoemake, *Uniform random rotations* (Graphics Gems III, 1992).
fn rotation(random: &mut impl Rng) -> Quat {
    let [u, v, w]: [f32; 3] = std::array::from_fn(|_| random.random_range(0.0..1.0));
    let [(sin_v, cos_v), (sin_w, cos_w)] = [v, w].map(|turn| libm::sincosf(turn * std::f32::consts::TAU));
    let (a, b) = ((1.0 - u).sqrt(), u.sqrt());
    Quat::from_xyzw(a * sin_v, a * cos_v, b * sin_w, b * cos_w)
}

/// A handful of the assets and generated shapes.
fn built_in_meshes() -> Result<Vec<(&'static str, TriangleMesh)>> {
    let asset = |name: &str| TriangleMesh::load(asset_folder().join(format!("{name}.obj")));
    Ok(vec![
        ("ring", shapes::ring(0.37, 0.13, [48, 24])),
        ("spider_gear", asset("spider_gear")?),
        ("hexagonal_nut", shapes::hexagonal_nut(0.86, 0.25, 0.4, 0.06, 48)),
        ("femur", asset("femur")?),
        ("torus_knot", shapes::torus_knot(2, 3, [0.3, 0.13, 0.07], [160, 20])),
    ])
}

/// The folder of the project's meshes.
#[must_use]
pub fn asset_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets")
}
