//! Bodies under volume-penalty contacts, against closed forms and conservation laws.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod analytic;
mod bolt;
mod chain;
mod collision;
mod fingers;
mod friction;
mod gears;
mod inside;
mod joints;
mod limbs;
mod pile;
mod restitution;
mod rolling;
mod slender;
mod sliding;
mod slope;
mod soak;
mod stack;
mod supports;
mod towers;
mod turning;

use glam::{DVec3, Vec3};
use ist::{InnerSphere, SolidProperties, SpherePacking};
use packer::{PackOptions, Solid, TriangleMesh, pack};
use rapier_ist::{IstPlugin, IstShape, Stiffness, VolumePenalty};
use rapier_ist_examples::run::Simulation;
use rapier_ist_examples::scenes::{Pile, PileOptions};
use rapier_ist_examples::shapes;
use rapier3d::prelude::*;

const DENSITY: f32 = 1000.0;

/// A ball of radius 0.1 m that one sphere fills.
fn ball() -> IstShape {
    let sphere = InnerSphere::solid_ball(Vec3::ZERO, 0.1, Vec3::Y);
    IstShape::from_packing(&SpherePacking::new(vec![sphere], SolidProperties::ball(0.1)).unwrap())
}

fn packed(mesh: &TriangleMesh, spheres: usize) -> IstShape {
    let solid = Solid::new(mesh).unwrap();
    IstShape::from_packing(&pack(&solid, &PackOptions::balanced().spheres(spheres)).unwrap().packing)
}

/// A ring of 0.3 m across and 0.08 m thickness.
fn ring(spheres: usize) -> IstShape {
    packed(&shapes::ring(0.11, 0.04, [48, 24]), spheres)
}

/// A slab of 0.4 × 0.1 × 0.4 m.
fn slab() -> IstShape {
    packed(&shapes::cuboid(DVec3::new(0.2, 0.05, 0.2)), 1000)
}

fn stiff(plugin: &mut IstPlugin, stiffness: f32) {
    plugin.model = rapier_ist::ContactModel::VolumePenalty(VolumePenalty {
        stiffness: Stiffness::Uniform(stiffness),
        ..VolumePenalty::default()
    });
}

/// A world with a fixed ground, y up.
fn grounded() -> (PhysicsWorld, IstPlugin) {
    let mut world = PhysicsWorld::new();
    let plugin = IstPlugin::install(&mut world);
    world.insert(RigidBodyBuilder::fixed(), ColliderBuilder::new(SharedShape::halfspace(Vec3::Y)));
    (world, plugin)
}

#[test]
fn a_ball_sinks_until_stiffness_times_volume_is_its_weight() {
    for stiffness in [1e6, 1e7, 1e8] {
        let (mut world, mut plugin) = grounded();
        stiff(&mut plugin, stiffness);
        let body = RigidBodyBuilder::dynamic().translation(Vec3::Y * 0.11).can_sleep(false);
        let (handle, _) = world.insert(body, ball().into_collider().density(DENSITY));
        for _ in 0..300 {
            plugin.step(&mut world);
        }
        let body = &world.bodies[handle];
        // A cap of height h has volume πh²(3r−h)/3.
        let h = 0.1 - body.translation().y;
        let force = stiffness * std::f32::consts::PI * h * h * (0.3 - h) / 3.0;
        let weight = 9.81 * body.mass();
        assert!((force / weight - 1.0).abs() < 0.02, "{stiffness}: {force} N, weight {weight} N");
        assert!(body.linvel().length() < 1e-3);
    }
}

#[test]
fn a_ball_is_stopped_where_it_touches_at_any_stiffness() {
    for stiffness in [1e7, 1e9, 1e11] {
        let (mut world, mut plugin) = grounded();
        stiff(&mut plugin, stiffness);
        let body = RigidBodyBuilder::dynamic().translation(Vec3::Y * 1.0).linvel(Vec3::Y * -6.0);
        let (handle, _) = world.insert(body, ball().into_collider().density(DENSITY));
        for _ in 0..120 {
            plugin.step(&mut world);
            let body = &world.bodies[handle];
            assert!(body.translation().y > 0.05 && body.linvel().length() < 8.0, "{stiffness}");
        }
    }
}

#[test]
fn a_new_pair_is_pushed_in_its_first_step() {
    let mut world = PhysicsWorld { gravity: Vec3::ZERO, ..PhysicsWorld::new() };
    let mut plugin = IstPlugin::install(&mut world);
    let mut insert =
        |x: f32| world.insert(RigidBodyBuilder::dynamic().translation(Vec3::X * x), ball().into_collider()).0;
    let (left, right) = (insert(0.0), insert(0.18));
    assert_eq!(plugin.step(&mut world).contacts.len(), 1);
    assert!(world.bodies[left].linvel().x < 0.0 && world.bodies[right].linvel().x > 0.0);
}

#[test]
fn a_world_without_the_dispatcher_is_mended() {
    let (mut world, mut plugin) = grounded();
    let body = RigidBodyBuilder::dynamic().translation(Vec3::Y * 0.1);
    let (handle, _) = world.insert(body, ball().into_collider().density(DENSITY));
    // As after restoring a snapshot.
    world.narrow_phase.set_query_dispatcher(rapier3d::parry::query::DefaultQueryDispatcher);
    for _ in 0..60 {
        plugin.step(&mut world);
    }
    assert!(world.bodies[handle].translation().y > 0.08);
    assert!(world.narrow_phase.contact_pairs().count() == 1, "Rapier sees the pair again");
}

#[test]
fn the_users_forces_are_left_alone() {
    let (mut world, mut plugin) = grounded();
    let (handle, _) =
        world.insert(RigidBodyBuilder::dynamic().translation(Vec3::Y * 0.1), ball().into_collider());
    let force = Vec3::new(0.123, 0.0, 0.456);
    world.bodies[handle].add_force(force, true);
    for _ in 0..10 {
        plugin.step(&mut world);
        assert_eq!(world.bodies[handle].user_force(), force);
    }
}

#[test]
fn a_sleeping_body_wakes_when_it_is_hit() {
    let (mut world, mut plugin) = grounded();
    let (resting, _) =
        world.insert(RigidBodyBuilder::dynamic().translation(Vec3::Y * 0.1), ball().into_collider());
    for _ in 0..240 {
        plugin.step(&mut world);
    }
    assert!(world.bodies[resting].is_sleeping());
    let falling = RigidBodyBuilder::dynamic().translation(Vec3::new(0.02, 1.0, 0.0));
    world.insert(falling, ball().into_collider());
    let woke = (0..60).any(|_| {
        plugin.step(&mut world);
        !world.bodies[resting].is_sleeping()
    });
    assert!(woke);
}

#[test]
fn a_pile_comes_to_rest_in_the_bowl() {
    let options = PileOptions { bodies: 8, spheres: 500, ..PileOptions::default() };
    let mut pile = Pile::new(&options, |_| ()).unwrap();
    for _ in 0..360 {
        pile.step();
    }
    assert_eq!(pile.lost(), 0);
    for body in &pile.bodies {
        let body = &pile.world.bodies[body.handle];
        assert!(body.is_sleeping() || body.linvel().length() < 0.05, "{}", body.linvel());
    }
}

#[test]
fn equal_runs_are_equal_bit_for_bit_on_any_number_of_threads() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut pile =
                Pile::new(&PileOptions { bodies: 8, spheres: 200, ..PileOptions::default() }, |_| ())
                    .unwrap();
            for _ in 0..120 {
                pile.step();
            }
            let bits = |body: &rapier_ist_examples::scenes::PileBody| {
                let pose = pile.world.bodies[body.handle].position();
                (pose.translation.to_array().map(f32::to_bits), pose.rotation.to_array().map(f32::to_bits))
            };
            pile.bodies.iter().map(bits).collect::<Vec<_>>()
        })
    };
    let one = run(1);
    assert_eq!(one, run(2));
    assert_eq!(one, run(2));
}

#[test]
fn a_shape_from_a_mesh_weighs_what_the_mesh_weighs() {
    let mesh = shapes::cuboid(glam::DVec3::new(0.1, 0.2, 0.3));
    let vertices: Vec<Vec3> = mesh.vertices.iter().map(|v| v.as_vec3()).collect();
    let shape = IstShape::from_mesh(&vertices, &mesh.triangles, 50).unwrap();
    let mass = rapier3d::geometry::Shape::mass_properties(&shape, DENSITY);
    assert!((mass.mass() / 48.0 - 1.0).abs() < 1e-5);
    let inertia = mass.reconstruct_inertia_matrix();
    for (axis, square) in [0.04 + 0.09, 0.01 + 0.09, 0.01 + 0.04].into_iter().enumerate() {
        assert!((inertia.col(axis)[axis] / (48.0 * square / 3.0) - 1.0).abs() < 1e-4);
    }
    assert!(IstShape::from_mesh(&vertices, &mesh.triangles[1..], 50).is_err(), "an open mesh has no inside");
}

#[test]
fn bad_options_name_the_option() {
    let error = Pile::new(&PileOptions { spheres: 0, ..PileOptions::default() }, |_| ()).err().unwrap();
    assert!(error.to_string().contains("--spheres"));
    let missing = PileOptions { meshes: vec!["no/such/mesh.obj".into()], ..PileOptions::default() };
    let error = Pile::new(&missing, |_| ()).err().unwrap();
    assert!(format!("{error:#}").contains("no/such/mesh.obj"));
}
