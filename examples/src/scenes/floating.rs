//! Bodies dropped into water, where they float.

use super::water::Water;
use super::{Model, ShapeKind, asset_folder};
use crate::figures::Summary;
use crate::render::{self, WaterBlock};
use crate::run::{Body, Check, Simulation, View, Wanted};
use crate::submerged::PlacedMesh;
use crate::{palette, shapes};
use anyhow::{Context, Result};
use glam::{DVec3, Quat, Vec3};
use glamx::Pose3;
use ist::InnerSphereTree;
use packer::{Solid, TriangleMesh};
use rapier_ist::IstPlugin;
use rapier3d::dynamics::{RigidBodyBuilder, RigidBodyHandle};
use rapier3d::pipeline::PhysicsWorld;
use serde::Serialize;

/// Half the side of the square pool, and its depth (m).
const POOL: [f32; 2] = [1.25, 0.45];
/// Height from which bodies fall (m).
const DROP: f32 = 0.45;
/// Steps after which they have to lie still.
const RESTS_AFTER: usize = 600;
/// Sizes of the box (m).
const BOX: [f64; 3] = [0.7, 0.25, 0.5];
/// Length and side of the beam (m).
const BEAM: [f64; 2] = [0.8, 0.22];

/// A body to drop.
struct Dropped {
    name: &'static str,
    mesh: TriangleMesh,
    /// Longest side (m).
    size: f32,
    /// kg/m³.
    density: f32,
    /// Of the pool's half side.
    place: [f32; 2],
    /// Its draught (m), where a formula gives it.
    draught: Option<f64>,
}

/// The pool and what floats in it.
pub struct Floating {
    world: PhysicsWorld,
    plugin: IstPlugin,
    water: Water,
    floats: Vec<Float>,
    /// A frame around the water's surface.
    rim: RigidBodyHandle,
    rim_solid: Solid,
    steps: usize,
}

/// A body in the water.
struct Float {
    handle: RigidBodyHandle,
    model: Model,
    tree: InnerSphereTree,
    size: f32,
    draught: Option<f64>,
}

/// How a body lies in the water.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Rest {
    /// Depth of its lowest point (m).
    pub draught: f64,
    /// The draught at which its mesh, as it is turned now, displaces its weight (m).
    pub exact_draught: f64,
    /// Mass of the water that its mesh displaces, relative to its own.
    pub displaced: f64,
    /// Volume of its spheres under water relative to that of its mesh.
    pub spheres: f64,
    /// Speed (m/s).
    pub speed: f64,
}

impl Floating {
    /// Packs five bodies with `spheres` spheres each and holds them over the water.
    ///
    /// # Errors
    /// Where a mesh is missing or cannot be packed.
    pub fn new(spheres: usize, mut progress: impl FnMut(&str)) -> Result<Self> {
        let mut world = PhysicsWorld::new();
        let plugin = IstPlugin::install(&mut world);
        let water = Water::default();
        let mut floats = Vec::new();
        for (index, dropped) in bodies(&water)?.into_iter().enumerate() {
            progress(&format!("packing {}", dropped.name));
            let Dropped { name, mesh, size, density, place: [x, z], draught } = dropped;
            let model = Model::new(name, mesh, spheres, ShapeKind::Ist)?;
            let place = Vec3::new(x * POOL[0], DROP, z * POOL[0]);
            let tilt = Quat::from_rotation_z(0.15) * Quat::from_rotation_y(0.4 * index as f32);
            // Rapier takes a body that turns in the swell for one at rest.
            let body = RigidBodyBuilder::dynamic().pose(Pose3::from_parts(place, tilt)).can_sleep(false);
            let (handle, _) = world.insert(body, model.collider(size, density)?);
            let tree = InnerSphereTree::new(&model.packing).scaled(size).context("a size is positive")?;
            floats.push(Float { handle, model, tree, size, draught });
        }
        // A ring of four corners is a square frame.
        let corner = f64::from(POOL[0]) * std::f64::consts::SQRT_2;
        let rim_solid = Solid::new(&shapes::ring(corner, 0.02, [4, 4]))?;
        let turned = Pose3::from_parts(Vec3::ZERO, Quat::from_rotation_y(std::f32::consts::FRAC_PI_4));
        let rim = world.insert_body(RigidBodyBuilder::fixed().pose(turned));
        Ok(Self { world, plugin, water, floats, rim, rim_solid, steps: 0 })
    }

    /// How each body lies in the water now.
    #[must_use]
    pub fn rests(&self) -> Vec<Rest> {
        let rest = |float: &Float| {
            let body = &self.world.bodies[float.handle];
            let mesh = PlacedMesh::new(float.model.solid.mesh(), body.position(), f64::from(float.size));
            let (density, mass) = (f64::from(self.water.density), f64::from(body.mass()));
            let volume = mesh.volume_below(0.0);
            Rest {
                draught: -mesh.lowest(),
                exact_draught: mesh.height_of(mass / density) - mesh.lowest(),
                displaced: density * volume / mass,
                spheres: f64::from(self.water.submerged(body, &float.tree).volume) / volume,
                speed: f64::from(body.linvel().length()),
            }
        };
        self.floats.iter().map(rest).collect()
    }
}

impl Simulation for Floating {
    fn title(&self) -> String {
        format!("{} bodies in water", self.floats.len())
    }

    fn world(&self) -> &PhysicsWorld {
        &self.world
    }

    fn plugin(&self) -> &IstPlugin {
        &self.plugin
    }

    fn step(&mut self) {
        let gravity = self.world.gravity;
        for float in &self.floats {
            self.water.act_on(&mut self.world.bodies[float.handle], &float.tree, gravity);
        }
        self.plugin.step(&mut self.world);
        self.steps += 1;
    }

    fn bodies(&self) -> Vec<Body<'_>> {
        let rim = Body::new(self.rim, "water_surface", &self.rim_solid).color([0.55, 0.7, 0.8]);
        let floats = self.floats.iter().enumerate().map(|(index, float)| {
            Body::new(float.handle, &float.model.name, &float.model.solid)
                .packing(&float.model.packing)
                .scale(float.size)
                .color(palette::color(index))
        });
        floats.chain(std::iter::once(rim)).collect()
    }

    fn checks(&self, _: &Summary) -> Vec<Check> {
        if self.steps < RESTS_AFTER {
            return Vec::new();
        }
        let mut checks = Vec::new();
        for (float, rest) in self.floats.iter().zip(self.rests()) {
            let name = &float.model.name;
            let mut draught = |what: &str, exact: f64| {
                let wanted = Wanted::Near { value: 1e3 * exact, tolerance: 0.02 };
                checks.push(Check::new(format!("{name}: draught, {what}"), 1e3 * rest.draught, "mm", wanted));
            };
            draught("by the mesh", rest.exact_draught);
            if let Some(exact) = float.draught {
                draught("by formula", exact);
            }
            let wanted = Wanted::Near { value: 1.0, tolerance: 0.01 };
            checks.push(Check::new(
                format!("{name}: displaced water over weight"),
                rest.displaced,
                "",
                wanted,
            ));
            checks.push(Check::new(format!("{name}: speed"), rest.speed, "m/s", Wanted::AtMost(0.01)));
        }
        checks
    }

    fn figures(&self) -> serde_json::Value {
        let named = self.floats.iter().zip(self.rests());
        named.map(|(float, rest)| (float.model.name.clone(), serde_json::json!(rest))).collect()
    }

    fn view(&self) -> View {
        View { from: Vec3::new(0.35, 0.3, 1.0), ground: Some(-POOL[1]), cut: None }
    }

    fn decorate(&self, picture: &mut render::Scene<'_>) {
        let [half, depth] = POOL;
        picture.set_water(WaterBlock {
            lower: Vec3::new(-half, -depth, -half),
            upper: Vec3::new(half, 0.0, half),
        });
    }

    fn metadata(&self) -> Vec<(&'static str, String)> {
        vec![("example", "buoyancy".to_owned()), ("water_density", self.water.density.to_string())]
    }
}

/// What is dropped: one body per corner and one in the middle.
fn bodies(water: &Water) -> Result<Vec<Dropped>> {
    let bunny = TriangleMesh::load(asset_folder().join("bunny.obj"))?;
    let half = DVec3::from(BOX) * 0.5;
    let share = |density: f32| f64::from(density / water.density);
    Ok(vec![
        Dropped { name: "bunny", mesh: bunny, size: 0.75, density: 550.0, place: [0.0, 0.05], draught: None },
        Dropped {
            name: "box",
            mesh: shapes::cuboid(half),
            size: BOX[0] as f32,
            density: 600.0,
            place: [-0.55, 0.55],
            draught: Some(share(600.0) * BOX[1]),
        },
        Dropped {
            name: "beam",
            mesh: shapes::cuboid(DVec3::new(0.5 * BEAM[0], 0.5 * BEAM[1], 0.5 * BEAM[1])),
            size: BEAM[0] as f32,
            density: 400.0,
            place: [0.55, 0.55],
            draught: Some(beam_draught(BEAM[1], share(400.0))),
        },
        Dropped {
            name: "ring",
            mesh: shapes::ring(0.37, 0.13, [96, 48]),
            size: 0.7,
            density: 400.0,
            place: [-0.55, -0.55],
            draught: None,
        },
        Dropped {
            name: "knot",
            mesh: shapes::torus_knot(2, 3, [0.3, 0.13, 0.07], [160, 20]),
            size: 0.8,
            density: 700.0,
            place: [0.55, -0.55],
            draught: None,
        },
    ])
}

/// Draught (m) of a square beam of side `side` (m) with `share` of the water's density, 0.28 to 0.5. It floats on its edge,
/// with a diagonal upright (E. N. Gilbert, *How things float*, Amer. Math. Monthly 98, 1991), and a right-angled corner of
/// depth d has the area d².
fn beam_draught(side: f64, share: f64) -> f64 {
    side * share.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::Timings;
    use crate::run::{Verdict, verdict};

    #[test]
    fn few_spheres_are_enough_to_float() {
        let mut floating = Floating::new(300, |_| ()).unwrap();
        for _ in 0..RESTS_AFTER {
            Simulation::step(&mut floating);
        }
        let checks = floating.checks(&Summary::of(&floating, &Timings::default()));
        assert_eq!(checks.len(), 17);
        assert_eq!(verdict(&checks), Verdict::Passed, "{checks:#?}");
    }

    #[test]
    fn a_beam_as_heavy_as_half_its_water_sinks_to_its_diagonal() {
        assert!((beam_draught(0.2, 0.5) - 0.1 * 2.0_f64.sqrt()).abs() < 1e-12);
    }
}
