//! Controllers that cast rays at inner sphere trees.

use super::*;
use rapier3d::control::{DynamicRayCastVehicleController, WheelTuning};

#[test]
fn rays_of_the_world_hit() {
    let (mut world, mut plugin) = grounded();
    let collider = world.insert(RigidBodyBuilder::fixed().translation(Vector::Y), ball_collider()).1;
    plugin.step(&mut world);
    let ray = Ray::new(Vector::Y * 3.0, -Vector::Y);
    let (hit, distance) = world.cast_ray(&ray, 10.0, true, QueryFilter::default()).unwrap();
    assert_eq!(hit, collider);
    assert!((distance - 1.9).abs() < 1e-4);
}

#[test]
fn a_vehicle_stands_on_its_suspension() {
    let mut world = PhysicsWorld::new();
    let mut plugin = IstPlugin::install(&mut world);
    // A ball as large as a hill, flat under the vehicle.
    world.insert(RigidBodyBuilder::fixed().translation(Vector::Y * -50.0), ball_of(50.0).into_collider());
    let chassis = ColliderBuilder::cuboid(0.5, 0.1, 0.3).density(100.0);
    // Held over the top of the hill, where it would roll away.
    let upright = LockedAxes::TRANSLATION_LOCKED_X | LockedAxes::TRANSLATION_LOCKED_Z;
    let body = dynamic(Vector::Y * 0.6).locked_axes(upright | LockedAxes::ROTATION_LOCKED).can_sleep(false);
    let chassis = world.insert(body, chassis).0;
    let mut vehicle = DynamicRayCastVehicleController::new(chassis);
    let tuning = WheelTuning { suspension_stiffness: 30.0, ..WheelTuning::default() };
    for (x, z) in [(-0.4, -0.3), (-0.4, 0.3), (0.4, -0.3), (0.4, 0.3)] {
        vehicle.add_wheel(Vector::new(x, 0.0, z), -Vector::Y, Vector::Z, 0.3, 0.1, &tuning);
    }
    for _ in 0..300 {
        let queries = world.broad_phase.as_query_pipeline_mut(
            world.narrow_phase.query_dispatcher(),
            &mut world.bodies,
            &mut world.colliders,
            QueryFilter::exclude_dynamic().exclude_rigid_body(chassis),
        );
        vehicle.update_vehicle(1.0 / 60.0, queries);
        plugin.step(&mut world);
    }
    assert!(vehicle.wheels().iter().all(|wheel| wheel.raycast_info().is_in_contact));
    // Every spring carries a quarter of the weight: it gives way by g/(4 · 30/s²) = 0.08 m.
    let y = height(&world, chassis);
    assert!((y - (0.4 - 9.81 / 120.0)).abs() < 0.01, "{y} m");
}
