//! Rapier's character controller among inner sphere trees.

use super::*;
use packer::{PackOptions, Solid, pack};
use rapier_ist_examples::shapes;
use rapier3d::control::{CharacterAutostep, CharacterLength, KinematicCharacterController};
use rapier3d::glamx::DVec3;

/// A box of spheres. Characters see the inner balls, so its surface is bumpy.
fn packed(half: [f64; 3], spheres: usize) -> IstShape {
    let solid = Solid::new(&shapes::cuboid(DVec3::from_array(half))).unwrap();
    IstShape::from_packing(&pack(&solid, &PackOptions::balanced().spheres(spheres)).unwrap().packing)
}

/// Walks by `stride` (m) and falls by 1 cm in each of `steps` steps; the path, and how often it was on the ground.
fn walk(
    world: &mut PhysicsWorld,
    plugin: &mut IstPlugin,
    (from, stride, steps): (Vector, Vector, usize),
    autostep: Option<CharacterAutostep>,
) -> (Vec<Vector>, usize) {
    let controller = KinematicCharacterController {
        autostep,
        offset: CharacterLength::Absolute(0.01),
        ..KinematicCharacterController::default()
    };
    let shape = SharedShape::capsule_y(0.15, 0.1);
    plugin.step(world);
    let (mut at, mut grounded, mut path) = (from, 0, Vec::new());
    for _ in 0..steps {
        let queries = world.broad_phase.as_query_pipeline(
            world.narrow_phase.query_dispatcher(),
            &world.bodies,
            &world.colliders,
            QueryFilter::default(),
        );
        let pose = Pose::from_translation(at);
        let wanted = stride - Vector::Y * 0.01;
        let moved = controller.move_shape(1.0 / 60.0, &queries, shape.as_ref(), &pose, wanted, |_| {});
        at += moved.translation;
        grounded += usize::from(moved.grounded);
        path.push(at);
        let pose = Pose::from_translation(at);
        for (_, collider) in world.colliders.iter() {
            let between = collider.position().inv_mul(&pose);
            let dispatcher = world.narrow_phase.query_dispatcher();
            let gap = dispatcher.contact(&between, collider.shape(), shape.as_ref(), 0.1).unwrap();
            let gap = gap.map_or(1.0, |contact| contact.dist);
            assert!(gap > -2e-3, "{gap} m inside at {at}");
        }
        plugin.step(world);
    }
    (path, grounded)
}

#[test]
fn a_character_slides_along_a_wall_and_does_not_enter_it() {
    let (mut world, mut plugin) = grounded();
    let wall = packed([0.1, 0.5, 1.0], 2000).into_collider().translation(Vector::new(0.6, 0.5, 0.0));
    world.insert(RigidBodyBuilder::fixed(), wall);
    let stride = Vector::new(0.02, 0.0, 0.02);
    let (path, grounded) = walk(&mut world, &mut plugin, (Vector::new(0.0, 0.3, -0.8), stride, 70), None);
    let end = path[69];
    // The wall's face is at 0.5 m; between its balls the character reaches a little deeper.
    assert!(end.x > 0.36 && end.x < 0.45, "it stops at the wall, {end}");
    assert!(end.z > 0.1, "and goes on along it, {end}");
    assert!(grounded > 40, "{grounded}");
}

#[test]
fn a_character_climbs_a_step_if_it_may_as_it_climbs_a_cuboid() {
    let autostep = CharacterAutostep {
        max_height: CharacterLength::Absolute(0.2),
        min_width: CharacterLength::Absolute(0.05),
        include_dynamic_bodies: false,
    };
    let steps = [packed([0.5, 0.03, 0.3], 3000).into_shared(), SharedShape::cuboid(0.5, 0.03, 0.3)];
    for autostep in [None, Some(autostep)] {
        let ends = [0, 1].map(|i| {
            let (mut world, mut plugin) = grounded();
            let step = ColliderBuilder::new(steps[i].clone()).translation(Vector::new(1.0, 0.03, 0.0));
            world.insert(RigidBodyBuilder::fixed(), step);
            walk(&mut world, &mut plugin, (Vector::Y * 0.3, Vector::X * 0.02, 60), autostep).0[59]
        });
        // Its feet are 0.25 m below its middle, and its offset is 1 cm.
        let (x, y) = if autostep.is_some() { (1.13, 0.32) } else { (0.4, 0.26) };
        for end in ends {
            assert!((end.x - x).abs() < 0.03 && (end.y - y).abs() < 5e-3 && end.z.abs() < 0.02, "{ends:?}");
        }
    }
}
