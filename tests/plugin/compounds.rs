//! Inner sphere trees as parts of compounds, in a world.

use super::*;

/// Two balls side by side: a tree and a ball of Rapier's.
fn dumbbell() -> ColliderBuilder {
    let parts = vec![
        (Pose::translation(-0.15, 0.0, 0.0), ball().into_shared()),
        (Pose::translation(0.15, 0.0, 0.0), SharedShape::ball(RADIUS)),
    ];
    ColliderBuilder::new(SharedShape::compound(parts)).density(DENSITY)
}

fn flat_mesh() -> SharedShape {
    let corner = |x: f32, z: f32| Vector::new(x, 0.0, z);
    let corners = vec![corner(-2.0, -2.0), corner(2.0, -2.0), corner(2.0, 2.0), corner(-2.0, 2.0)];
    SharedShape::trimesh(corners, vec![[0, 2, 1], [0, 3, 2]]).unwrap()
}

#[test]
fn a_compound_with_a_tree_lies_on_every_ground_in_both_models() {
    let heights = rapier3d::parry::utils::Array2::new(3, 3, vec![0.0; 9]);
    let halves = vec![(Pose::IDENTITY, SharedShape::cuboid(2.0, 0.5, 2.0))];
    let top = Pose::translation(0.0, -0.5, 0.0);
    let grounds = [
        ("half-space", SharedShape::halfspace(Vector::Y), Pose::IDENTITY),
        ("cuboid", SharedShape::cuboid(2.0, 0.5, 2.0), top),
        ("compound", SharedShape::compound(halves), top),
        ("trimesh", flat_mesh(), Pose::IDENTITY),
        ("heightfield", SharedShape::heightfield(heights, Vector::new(4.0, 1.0, 4.0)), Pose::IDENTITY),
    ];
    for (name, ground, pose) in grounds {
        for model in [ContactModel::default(), ContactModel::VolumeManifold] {
            let mut world = PhysicsWorld::new();
            let mut plugin = IstPlugin::install(&mut world);
            plugin.model = model;
            world.insert(RigidBodyBuilder::fixed().pose(pose), ColliderBuilder::new(ground.clone()));
            let body = world.insert(dynamic(Vector::new(0.1, 0.15, 0.2)), dumbbell()).0;
            run(&mut plugin, &mut world, 240);
            let pose = world.bodies[body].position();
            let axis = pose.rotation * Vector::X;
            assert!((pose.translation.y - RADIUS).abs() < 0.01, "{name}: {}", pose.translation);
            assert!(axis.y.abs() < 0.05, "{name}: the tree carries as the ball does, {axis}");
        }
    }
}

#[test]
fn a_tree_lies_on_a_compound_of_trees() {
    let (mut world, mut plugin) = grounded();
    let places = [(-0.1, -0.1), (-0.1, 0.1), (0.1, -0.1), (0.1, 0.1)];
    let parts = places.map(|(x, z)| (Pose::translation(x, 0.1, z), ball().into_shared()));
    world.insert(RigidBodyBuilder::fixed(), ColliderBuilder::new(SharedShape::compound(parts.to_vec())));
    let body = world.insert(dynamic(Vector::Y * 0.3), ball_collider()).0;
    run(&mut plugin, &mut world, 240);
    // Over four balls at the corners of a square of one diameter.
    let expected = 0.1 + (0.04_f32 - 2.0 * 0.01).sqrt();
    assert!((height(&world, body) - expected).abs() < 0.01, "{} {expected}", height(&world, body));
}
