//! Contact manifolds handed to Rapier's own solver.

use super::*;
use packer::{PackOptions, Solid, TriangleMesh, pack};
use rapier_ist::snapshot;
use rapier_ist_examples::shapes;
use rapier3d::glamx::{DQuat, DVec3};

/// A box of half extents `half` (m) about `center`, turned about z by `angle`.
struct Block {
    center: [f64; 3],
    half: [f64; 3],
    angle: f64,
}

const fn block(center: [f64; 3], half: [f64; 3]) -> Block {
    Block { center, half, angle: 0.0 }
}

/// The union of `blocks`, about its centroid.
fn solid_of(blocks: &[Block], spheres: usize) -> IstShape {
    let mut mesh = TriangleMesh { vertices: Vec::new(), triangles: Vec::new() };
    for Block { center, half, angle } in blocks {
        let part = shapes::cuboid(DVec3::from_array(*half));
        let first = mesh.vertices.len() as u32;
        let turn = DQuat::from_rotation_z(*angle);
        mesh.vertices.extend(part.vertices.iter().map(|v| turn * *v + DVec3::from_array(*center)));
        mesh.triangles.extend(part.triangles.iter().map(|t| t.map(|i| i + first)));
    }
    let solid = Solid::new(&mesh).unwrap();
    let centroid = solid.properties().centroid;
    let vertices = mesh.vertices.iter().map(|v| *v - centroid).collect();
    let solid = Solid::new(&TriangleMesh { vertices, triangles: mesh.triangles }).unwrap();
    IstShape::from_packing(&pack(&solid, &PackOptions::balanced().spheres(spheres)).unwrap().packing)
}

/// A bar of 1 m on two feet.
fn bar() -> IstShape {
    let foot = |x| block([x, -0.1, 0.0], [0.05, 0.06, 0.06]);
    solid_of(&[block([0.0, 0.0, 0.0], [0.5, 0.05, 0.06]), foot(-0.4), foot(0.4)], 600)
}

/// A plate of 0.6 m on four legs.
fn table() -> IstShape {
    let leg = |x, z| block([x, -0.12, z], [0.04, 0.1, 0.04]);
    let legs = [leg(-0.24, -0.24), leg(-0.24, 0.24), leg(0.24, -0.24), leg(0.24, 0.24)];
    let [a, b, c, d] = legs;
    solid_of(&[block([0.0; 3], [0.3, 0.03, 0.3]), a, b, c, d], 1000)
}

/// Two walls of 45° that meet below the origin.
fn groove() -> IstShape {
    let wall = |side: f64| Block {
        center: [side * 0.2, 0.0, 0.0],
        half: [0.3, 0.05, 0.4],
        angle: side * std::f64::consts::FRAC_PI_4,
    };
    solid_of(&[wall(-1.0), wall(1.0)], 3000)
}

fn ring() -> IstShape {
    let solid = Solid::new(&shapes::ring(0.11, 0.04, [48, 24])).unwrap();
    IstShape::from_packing(&pack(&solid, &PackOptions::balanced().spheres(500)).unwrap().packing)
}

fn plane() -> ColliderBuilder {
    ColliderBuilder::new(SharedShape::halfspace(Vector::Y))
}

/// How a body is after ten seconds that began with it in the air, a little tilted.
#[derive(Debug)]
struct Rest {
    /// Angle (degrees) of its y axis to the vertical.
    tilt: f32,
    /// Greatest speed in the last two seconds (m/s and rad/s).
    speed: f32,
    spin: f32,
    height: f32,
    /// Most manifolds in a step.
    manifolds: usize,
    bits: Vec<u32>,
}

fn rest(shape: &IstShape, ground: ColliderBuilder, drop: f32, clustering: bool) -> Rest {
    let mut world = PhysicsWorld::new();
    world.integration_parameters.contact_clustering = clustering;
    let mut plugin = IstPlugin::install(&mut world);
    plugin.model = ContactModel::VolumeManifold;
    let ground = world.insert(RigidBodyBuilder::fixed(), ground).1;
    let lowest = shape.clone().into_shared().compute_local_aabb().mins.y;
    let tilted = Vector::new(0.02, 0.0, 0.03);
    let body = dynamic(Vector::Y * (drop - lowest)).rotation(tilted).can_sleep(false);
    let (body, collider) = world.insert(body, shape.clone().into_collider().density(DENSITY));
    let mut rest = Rest { tilt: 0.0, speed: 0.0, spin: 0.0, height: 0.0, manifolds: 0, bits: Vec::new() };
    for step in 0..600 {
        plugin.step(&mut world);
        let moving = &world.bodies[body];
        if step >= 480 {
            rest.speed = rest.speed.max(moving.linvel().length());
            rest.spin = rest.spin.max(moving.angvel().length());
        }
        let pair = world.narrow_phase.contact_pair(ground, collider);
        let manifolds =
            pair.map_or(0, |pair| pair.manifolds().iter().filter(|m| !m.points.is_empty()).count());
        rest.manifolds = rest.manifolds.max(manifolds);
    }
    let pose = world.bodies[body].position();
    rest.tilt = (pose.rotation * Vector::Y).angle_between(Vector::Y).to_degrees();
    rest.height = pose.translation.y + lowest;
    rest.bits = bits(&world, body);
    rest
}

fn assert_level(rest: &Rest, tilt: f32) {
    println!("{rest:?}");
    assert!(rest.tilt < tilt && rest.speed < 0.01 && rest.spin < 0.05, "{rest:?}");
}

#[test]
fn a_bar_on_two_feet_comes_to_rest_level() {
    for clustering in [true, false] {
        let rest = rest(&bar(), plane(), 0.05, clustering);
        assert_level(&rest, 0.5);
        assert!(rest.manifolds >= 2, "{rest:?}");
    }
}

#[test]
fn a_plate_on_four_legs_comes_to_rest_level() {
    for clustering in [true, false] {
        let rest = rest(&table(), plane(), 0.05, clustering);
        assert_level(&rest, 0.5);
        assert!(rest.manifolds >= 4, "{rest:?}");
    }
}

#[test]
fn a_plate_on_four_legs_comes_to_rest_on_a_solid_floor() {
    let floor = solid_of(&[block([0.0, -0.1, 0.0], [0.5, 0.1, 0.5])], 3000);
    let floor = floor.into_collider().translation(Vector::Y * -0.1);
    let rest = rest(&table(), floor, 0.05, true);
    assert_level(&rest, 2.0);
}

#[test]
fn a_square_bar_lies_in_a_groove() {
    let angle = std::f64::consts::FRAC_PI_4;
    let bar = solid_of(&[Block { center: [0.0; 3], half: [0.06, 0.06, 0.25], angle }], 800);
    let rest = rest(&bar, groove().into_collider(), 0.0, true);
    assert_level(&rest, 2.0);
    assert!(rest.manifolds >= 2, "one for each wall, {rest:?}");
}

/// Level it has no equilibrium: like a rod in a groove, it is highest then.
#[test]
fn a_ring_comes_to_rest_in_a_groove() {
    let rest = rest(&ring(), groove().into_collider().friction(0.3), 0.15, true);
    assert_level(&rest, 90.0);
    assert!(rest.height.abs() < 0.1 && rest.manifolds >= 2, "{rest:?}");
}

#[test]
fn equal_runs_are_equal_bit_for_bit_on_any_number_of_threads() {
    let run = || rest(&table(), plane(), 0.1, true).bits;
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(run);
    let together = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap().install(run);
    assert_eq!(alone, together);
    assert_eq!(alone, run());
}

/// Tables thrown at each other: manifolds come and go.
fn turmoil(clustering: bool) -> (PhysicsWorld, IstPlugin) {
    let (mut world, mut plugin) = grounded();
    world.integration_parameters.contact_clustering = clustering;
    plugin.model = ContactModel::VolumeManifold;
    let table = table();
    for i in 0..6 {
        let at = Vector::new(0.3 * (i % 2) as f32, 0.4 + 0.35 * i as f32, 0.1 * i as f32);
        // Rapier wakes what is restored.
        let body = dynamic(at).rotation(Vector::new(0.5, 0.3, 0.7) * i as f32).can_sleep(false);
        world.insert(body, table.clone().into_collider().density(DENSITY));
    }
    (world, plugin)
}

#[test]
fn manifolds_may_come_and_go() {
    for clustering in [true, false] {
        let (mut world, mut plugin) = turmoil(clustering);
        let mut counts = [0; 2];
        for step in 0..400 {
            plugin.step(&mut world);
            assert_finite(&world, step);
            for pair in world.narrow_phase.contact_pairs() {
                counts[usize::from(pair.manifolds().len() > 1)] += 1;
            }
            // Models may be switched, and bodies removed, while there are many.
            match step {
                150 => plugin.model = ContactModel::default(),
                200 => plugin.model = ContactModel::VolumeManifold,
                250 => {
                    let any = world.bodies.iter().map(|(handle, _)| handle).last().unwrap();
                    world.remove_body(any);
                }
                _ => {}
            }
        }
        assert!(counts.iter().all(|&count| count > 50), "{counts:?}");
    }
}

#[test]
fn a_world_with_many_manifolds_is_saved_and_goes_on_bit_for_bit() {
    let (mut world, mut plugin) = turmoil(true);
    // Restored colliders have a new shape to Rapier, so it would recycle contacts of the saved world only.
    world.integration_parameters.contact_recycling = false;
    run(&mut plugin, &mut world, 60);
    assert!(world.narrow_phase.contact_pairs().any(|pair| pair.manifolds().len() > 1));
    let saved = snapshot::save(&mut world, |world| {
        let mut bytes = Vec::new();
        ciborium::into_writer(world, &mut bytes).unwrap();
        bytes
    });
    let mut restored: PhysicsWorld = ciborium::from_reader(saved.as_slice()).unwrap();
    let shape = |handle: ColliderHandle, _: &Collider| {
        world.colliders[handle].shape().as_shape::<IstShape>().cloned()
    };
    snapshot::restore(&mut restored.colliders, shape);
    let mut again = IstPlugin::install(&mut restored);
    again.model = ContactModel::VolumeManifold;
    run(&mut again, &mut restored, 30);
    run(&mut plugin, &mut world, 30);
    for (handle, _) in world.bodies.iter() {
        assert_eq!(bits(&world, handle), bits(&restored, handle));
    }
}

#[test]
fn manifolds_that_nothing_looks_at_tell_of_the_contact_and_no_more() {
    // Under the penalty Rapier's solver does nothing with manifolds.
    for looked_at in [false, true] {
        let mut world = PhysicsWorld::new();
        let mut plugin = IstPlugin::install(&mut world);
        let ground = world.insert(RigidBodyBuilder::fixed(), plane()).1;
        let shape = table();
        let lowest = shape.clone().into_shared().compute_local_aabb().mins.y;
        let hooks = if looked_at { ActiveHooks::MODIFY_SOLVER_CONTACTS } else { ActiveHooks::empty() };
        let collider = shape.into_collider().density(DENSITY).active_hooks(hooks);
        let collider = world.insert(dynamic(Vector::Y * -lowest).can_sleep(false), collider).1;
        for _ in 0..60 {
            plugin.step(&mut world);
        }
        let pair = world.narrow_phase.contact_pair(ground, collider).unwrap();
        let points: Vec<_> = pair.manifolds().iter().map(|m| m.points.len()).collect();
        assert!(pair.has_any_active_contact());
        if looked_at {
            assert!(points.len() >= 4, "{points:?}");
        } else {
            assert_eq!(points, [1]);
            let manifold = &pair.manifolds()[0];
            let up = if pair.collider1 == ground { manifold.local_n1 } else { -manifold.local_n1 };
            assert!(up.y > 0.99 && manifold.points[0].dist < 0.0, "{manifold:?}");
        }
    }
}
