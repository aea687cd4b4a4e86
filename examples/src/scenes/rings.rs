//! Rings, stacked and linked.

use crate::run::Body;
use crate::{palette, shapes};
use anyhow::Result;
use glam::{Quat, Vec3};
use glamx::Pose3;
use ist::SpherePacking;
use packer::{PackOptions, Solid, pack};
use rapier_ist::{IstPlugin, IstShape};
use rapier3d::dynamics::{RigidBodyBuilder, RigidBodyHandle};
use rapier3d::geometry::{ColliderBuilder, SharedShape};
use rapier3d::pipeline::PhysicsWorld;

/// Radius of a ring's centre line (m).
pub const RING_MAJOR: f32 = 0.11;
/// Radius of its tube (m); the ring is twice as thick.
pub const RING_MINOR: f32 = 0.04;

/// A ring about the y axis and its spheres.
#[derive(Clone, Debug)]
pub struct Ring {
    /// Its mesh.
    pub solid: Solid,
    /// Its spheres.
    pub packing: SpherePacking,
}

impl Ring {
    /// Packs a ring with `spheres` spheres.
    ///
    /// # Errors
    /// If `spheres` is zero.
    pub fn new(spheres: usize) -> Result<Self> {
        let solid = Solid::new(&shapes::ring(f64::from(RING_MAJOR), f64::from(RING_MINOR), [96, 48]))?;
        let packing = pack(&solid, &PackOptions::balanced().spheres(spheres))?.packing;
        Ok(Self { solid, packing })
    }

    /// What stands for it in the simulation.
    #[must_use]
    pub fn shape(&self) -> IstShape {
        IstShape::from_packing(&self.packing)
    }
}

/// The shape of a ring about the y axis, packed with `spheres` spheres.
///
/// # Errors
/// If `spheres` is zero.
pub fn ring_shape(spheres: usize) -> Result<IstShape> {
    Ok(Ring::new(spheres)?.shape())
}

/// Rings that lie on each other on the ground.
pub struct Stack {
    /// The Rapier world.
    pub world: PhysicsWorld,
    /// Steps it.
    pub plugin: IstPlugin,
    /// From the ground up.
    pub rings: Vec<RigidBodyHandle>,
}

impl Stack {
    /// `count` rings of `shape`, each `gap` (m) above the one below.
    #[must_use]
    pub fn new(count: usize, shape: &IstShape, density: f32, gap: f32) -> Self {
        let mut world = PhysicsWorld::new();
        let plugin = IstPlugin::install(&mut world);
        world.insert(RigidBodyBuilder::fixed(), ColliderBuilder::new(SharedShape::halfspace(Vec3::Y)));
        let rings = (0..count).map(|i| {
            let height = RING_MINOR + (2.0 * RING_MINOR + gap) * i as f32 + gap;
            let body = RigidBodyBuilder::dynamic().translation(Vec3::Y * height);
            world.insert(body, shape.clone().into_collider().density(density)).0
        });
        let rings = rings.collect();
        Self { world, plugin, rings }
    }
}

/// Rings that hang from each other, the first one fixed.
pub struct Chain {
    /// The Rapier world.
    pub world: PhysicsWorld,
    /// Steps it.
    pub plugin: IstPlugin,
    /// From the top down; the first is fixed.
    pub rings: Vec<RigidBodyHandle>,
}

impl Chain {
    /// A fixed ring and `count` rings of `shape` under it, each of which just touches the one above.
    #[must_use]
    pub fn new(count: usize, shape: &IstShape, density: f32) -> Self {
        let mut world = PhysicsWorld::new();
        let plugin = IstPlugin::install(&mut world);
        let upright = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
        let rings = (0..=count).map(|i| {
            let turn = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2 * (i % 2) as f32);
            let pose = Pose3::from_parts(Vec3::NEG_Y * (Self::pitch() * i as f32), turn * upright);
            let body = if i == 0 { RigidBodyBuilder::fixed() } else { RigidBodyBuilder::dynamic() };
            world.insert(body.pose(pose), shape.clone().into_collider().density(density)).0
        });
        let rings = rings.collect();
        Self { world, plugin, rings }
    }

    /// The bodies with their meshes and spheres, in a colour each.
    pub(super) fn bodies<'a>(&self, ring: &'a Ring) -> Vec<Body<'a>> {
        let body = |(index, &handle)| {
            let color = if index == 0 { palette::NEUTRAL } else { palette::color(index - 1) };
            Body::new(handle, format!("ring_{index}"), &ring.solid).packing(&ring.packing).color(color)
        };
        self.rings.iter().enumerate().map(body).collect()
    }

    /// Distance of two neighbours' centres in a taut chain (m).
    #[must_use]
    pub fn pitch() -> f32 {
        2.0 * (RING_MAJOR - RING_MINOR)
    }

    /// Length of the line through the rings' centres (m).
    #[must_use]
    pub fn length(&self) -> f32 {
        let center = |handle: &RigidBodyHandle| self.world.bodies[*handle].translation();
        self.rings.windows(2).map(|pair| center(&pair[0]).distance(center(&pair[1]))).sum()
    }

    /// Whether every ring still goes through the next: its centre line crosses the other's disc once.
    #[must_use]
    pub fn is_linked(&self) -> bool {
        self.lost_links() == 0
    }

    /// Rings that do not go through the next.
    #[must_use]
    pub fn lost_links(&self) -> usize {
        let pose = |handle: &RigidBodyHandle| *self.world.bodies[*handle].position();
        let lost = |pair: &&[RigidBodyHandle]| !linked(&pose(&pair[0]).inv_mul(&pose(&pair[1])));
        self.rings.windows(2).filter(lost).count()
    }
}

/// Whether the centre line of a ring at `pose` crosses the disc inside that of a ring in its own frame once.
fn linked(pose: &Pose3) -> bool {
    const STEPS: u32 = 256;
    let point = |i: u32| {
        let (sin, cos) = (std::f32::consts::TAU * i as f32 / STEPS as f32).sin_cos();
        *pose * (Vec3::new(cos, 0.0, sin) * RING_MAJOR)
    };
    let crosses = |i: u32| {
        let (p, q) = (point(i), point(i + 1));
        (p.y < 0.0) != (q.y < 0.0) && {
            let at = p.lerp(q, p.y / (p.y - q.y));
            at.length() < RING_MAJOR
        }
    };
    (0..STEPS).filter(|&i| crosses(i)).count() % 2 == 1
}
