//! Input that no simulation should get: nothing panics, what is finite stays finite.

use super::*;

/// A ball that rests on the ground and one that comes down on it.
fn stack() -> (PhysicsWorld, IstPlugin, [RigidBodyHandle; 2]) {
    let (mut world, plugin) = grounded();
    let bodies = [RADIUS, 3.5 * RADIUS].map(|y| world.insert(dynamic(Vector::Y * y), ball_collider()).0);
    (world, plugin, bodies)
}

#[test]
fn any_stiffness() {
    for stiffness in [0.0, 1e-3, 1e12, 1e30, f32::NAN, -1.0, f32::INFINITY] {
        let (mut world, mut plugin, bodies) = stack();
        plugin.model = uniform(stiffness);
        for _ in 0..120 {
            plugin.step(&mut world);
            assert_finite(&world, stiffness);
        }
        let lower = height(&world, bodies[0]);
        if stiffness >= 1e12 {
            assert!(lower > 0.09 && lower < 0.11, "{stiffness}: {lower}");
        } else {
            assert!(lower < 0.0, "{stiffness} holds nothing up: {lower}");
        }
    }
}

#[test]
fn any_parameter_of_the_penalty() {
    for bad in [0.0, -1.0, f32::NAN, f32::INFINITY, f32::MIN_POSITIVE] {
        for parameter in 0..3 {
            let (mut world, mut plugin, bodies) = stack();
            let mut penalty = VolumePenalty::default();
            match parameter {
                0 => penalty.dissipation = bad,
                1 => penalty.recovery_speed = bad,
                _ => penalty.creep_speed = bad,
            }
            plugin.model = ContactModel::VolumePenalty(penalty);
            for _ in 0..120 {
                plugin.step(&mut world);
                assert_finite(&world, (bad, parameter));
            }
            let lower = height(&world, bodies[0]);
            assert!(lower > 0.08 && lower < 0.11, "{bad} as parameter {parameter}: {lower}");
        }
    }
}

/// What Rapier makes of such a joint is its own; bodies that do not hang on it go on.
#[test]
fn any_number_in_a_joint() {
    for bad in [0.0, -1.0, f32::NAN, f32::INFINITY, f32::MIN_POSITIVE, 1e30] {
        for parameter in 0..8 {
            for is_link in [false, true] {
                let (mut world, mut plugin, bodies) = stack();
                let hand =
                    world.insert_body(RigidBodyBuilder::kinematic_velocity_based().translation(Vector::Y));
                let finger = world.insert(dynamic(Vector::new(RADIUS * 2.1, RADIUS, 0.0)), ball_collider()).0;
                let alone = world.insert(dynamic(Vector::new(-RADIUS * 4.0, RADIUS, 0.0)), ball_collider()).0;
                let mut joint = GenericJointBuilder::new(JointAxesMask::LOCKED_PRISMATIC_AXES)
                    .motor_position(JointAxis::LinX, -0.1, 1e3, 1e2)
                    .limits(JointAxis::LinX, [-0.2, 0.3])
                    .motor_max_force(JointAxis::LinX, 50.0)
                    .local_anchor1(Vector::new(RADIUS * 2.1, RADIUS - 1.0, 0.0))
                    .build();
                // Rapier itself panics at multibodies whose numbers are not finite, and whose limits leave no room.
                let is_usual = bad.abs() < 10.0;
                if is_link && (!is_usual || (parameter == 5 && bad < -0.2)) {
                    continue;
                }
                let motor = &mut joint.motors[0];
                match parameter {
                    0 => motor.target_pos = bad,
                    1 => motor.target_vel = bad,
                    2 => motor.stiffness = bad,
                    3 => motor.damping = bad,
                    4 => motor.max_force = bad,
                    5 => joint.limits[0].max = bad,
                    6 => joint.softness.natural_frequency = bad,
                    _ => joint.local_frame1.translation.x = bad,
                }
                if is_link {
                    world.insert_multibody_joint(hand, finger, joint);
                } else {
                    world.insert_impulse_joint(hand, finger, joint);
                }
                for _ in 0..60 {
                    plugin.step(&mut world);
                }
                let at_rest = [bodies[0], bodies[1], alone].map(|body| world.bodies[body].translation());
                assert!(
                    at_rest[2].is_finite() && (at_rest[2].y - RADIUS).abs() < 0.01,
                    "{bad} {parameter} {is_link}"
                );
                if is_usual {
                    assert!(
                        at_rest.iter().all(|place| place.is_finite()),
                        "{bad} {parameter} {is_link}: {at_rest:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn any_time_step() {
    for dt in [0.0, -1.0, f32::NAN, 1e-6, 1.0] {
        let (mut world, mut plugin, bodies) = stack();
        let before = bodies.map(|body| bits(&world, body));
        world.integration_parameters.dt = dt;
        for _ in 0..20 {
            let report = plugin.step(&mut world);
            let passes = dt > 0.0;
            assert!(passes || (report.contacts.is_empty() && report.stopped.is_empty()), "{dt}");
            if !dt.is_nan() {
                assert_finite(&world, dt);
            }
        }
        if dt == 0.0 {
            assert_eq!(before, bodies.map(|body| bits(&world, body)));
        }
        if dt == 1.0 {
            // It falls 9.81 m in a step before anything can stop it, and comes back.
            assert!(height(&world, bodies[0]).abs() < 10.0, "{}", height(&world, bodies[0]));
        }
    }
}

#[test]
fn any_mass() {
    for mass in [0.0, 1e-30, 1e-38, 1e30, 3e38, f32::INFINITY, f32::NAN] {
        let (mut world, mut plugin) = grounded();
        let odd = ball().into_collider().mass(mass);
        let odd = world.insert(dynamic(Vector::Y * RADIUS), odd).0;
        let other = world.insert(dynamic(Vector::Y * 0.32), ball_collider()).0;
        for _ in 0..120 {
            plugin.step(&mut world);
            assert_finite(&world, mass);
        }
        let (odd, other) = (height(&world, odd), height(&world, other));
        assert!(other.abs() < 10.0, "{mass}: {odd} {other}");
    }
}

/// A body that contacts do not move had a say in the stiffness: one without mass let everything through, and a light one that was held
/// fast was soft.
#[test]
fn issue_a_body_that_contacts_do_not_move_carries_however_light_it_is() {
    for (mass, model) in [
        (0.0, ContactModel::default()),
        (0.0, uniform(1e8)),
        (1e-6, ContactModel::default()),
        (1e-4, ContactModel::default()),
        (1e4, ContactModel::default()),
    ] {
        let mut world = PhysicsWorld::new();
        let mut plugin = IstPlugin::install(&mut world);
        plugin.model = model;
        let held = dynamic(Vector::ZERO).lock_translations().gravity_scale(0.0);
        world.insert(held, ball().into_collider().mass(mass));
        let above = world
            .insert(dynamic(Vector::Y * 2.1 * RADIUS).lock_rotations(), ball().into_collider().mass(100.0))
            .0;
        for _ in 0..120 {
            plugin.step(&mut world);
        }
        let height = height(&world, above);
        assert!((height / RADIUS - 2.0).abs() < 0.1, "on {mass} kg: {height}");
    }
}

/// Neither of two wheels that only turn is moved by contacts, and their own masses are all that tells how stiff they are.
#[test]
fn wheels_on_fixed_axles_feel_each_other() {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let mut plugin = IstPlugin::install(&mut world);
    let wheel = |x: f32, spin: f32| {
        dynamic(Vector::X * x).lock_translations().angvel(Vector::Z * spin).can_sleep(false)
    };
    let driving = world.insert(wheel(0.0, 4.0), ball_collider().friction(1.0)).0;
    let driven = world.insert(wheel(1.9 * RADIUS, 0.0), ball_collider().friction(1.0)).0;
    for _ in 0..60 {
        plugin.step(&mut world);
    }
    let [driving, driven] = [driving, driven].map(|body| world.bodies[body].angvel().z);
    assert!((driving - 2.0).abs() < 0.1 && (driven + 2.0).abs() < 0.1, "{driving} {driven}");
}

#[test]
fn without_gravity_and_with_more_than_enough() {
    for gravity in [0.0, 1e-20, 1e6, 1e20, f32::NAN, f32::INFINITY] {
        let (mut world, mut plugin, _) = stack();
        world.gravity = Vector::Y * -gravity;
        for _ in 0..60 {
            plugin.step(&mut world);
            assert_finite(&world, gravity);
        }
    }
}

#[test]
fn what_is_not_finite_stays_with_its_body() {
    let spoil: [fn(&mut RigidBody); 8] = [
        |body| body.set_linvel(Vector::NAN, true),
        |body| body.set_angvel(Vector::NAN, true),
        |body| body.set_linvel(Vector::X * f32::INFINITY, true),
        |body| body.add_force(Vector::NAN, true),
        |body| body.add_torque(Vector::NAN, true),
        |body| body.add_force(Vector::Y * f32::NEG_INFINITY, true),
        |body| body.set_translation(Vector::NAN, true),
        |body| body.set_gravity_scale(f32::NAN, true),
    ];
    for (index, spoil) in spoil.into_iter().enumerate() {
        let (mut world, mut plugin, [lower, upper]) = stack();
        let aside = world.insert(dynamic(Vector::new(0.15, RADIUS, 0.0)), ball_collider()).0;
        run(&mut plugin, &mut world, 30);
        spoil(&mut world.bodies[lower]);
        for _ in 0..30 {
            plugin.step(&mut world);
            assert_finite(&world, index);
        }
        assert!(!world.bodies[lower].is_enabled(), "{index}: Rapier takes it out");
        assert!(world.bodies[lower].user_force() == Vector::ZERO, "{index}: and its forces");
        for body in [upper, aside] {
            let body = &world.bodies[body];
            assert!(
                body.is_enabled() && body.translation().length() < 2.0,
                "{index}: {}",
                body.translation()
            );
        }
    }
}

#[test]
fn any_friction_and_restitution() {
    for value in [f32::NAN, -1.0, f32::INFINITY, 1e30] {
        let (mut world, mut plugin) = grounded();
        let collider = ball_collider().friction(value).restitution(value);
        let body = world.insert(dynamic(Vector::Y * 0.3).linvel(Vector::X), collider).0;
        for _ in 0..120 {
            plugin.step(&mut world);
            assert_finite(&world, value);
        }
        assert!(height(&world, body) > 0.05 && height(&world, body) < 0.5, "{value}");
    }
}

#[test]
fn two_bodies_in_the_same_place() {
    let (mut world, mut plugin) = weightless();
    let bodies = [0, 1].map(|_| world.insert(dynamic(Vector::ONE), ball_collider()).0);
    for _ in 0..120 {
        plugin.step(&mut world);
        assert_finite(&world, "same place");
    }
    let [a, b] = bodies.map(|body| world.bodies[body].translation());
    assert!((a + b).abs_diff_eq(Vector::ONE * 2.0, 1e-4), "momentum is kept: {a} {b}");
    assert!((a - b).length() < 3.0, "they are not thrown apart: {a} {b}");
}

#[test]
fn ten_thousand_to_one_both_ways_up() {
    for [below, above] in [[1e4, 1.0], [1.0, 1e4]] {
        let (mut world, mut plugin) = grounded();
        let axes = LockedAxes::TRANSLATION_LOCKED_X | LockedAxes::TRANSLATION_LOCKED_Z;
        let mut insert = |y: f32, density: f32| {
            let body = dynamic(Vector::Y * y).locked_axes(axes | LockedAxes::ROTATION_LOCKED);
            world.insert(body, ball().into_collider().density(density)).0
        };
        let (lower, upper) = (insert(0.1, below), insert(0.3, above));
        for _ in 0..300 {
            plugin.step(&mut world);
            assert_finite(&world, (below, above));
        }
        let (lower, upper) = (height(&world, lower), height(&world, upper));
        assert!(lower > 0.0 && upper > lower && upper < 0.35, "{below} below {above}: {lower} {upper}");
    }
}

#[test]
fn bodies_of_any_size() {
    for size in [1e-5, 1e-4, 1e3, 1e4] {
        let (mut world, mut plugin) = grounded();
        world.integration_parameters.length_unit = size;
        world.gravity *= size;
        let shape = ball_of(size);
        let body = dynamic(Vector::Y * (1.5 * size)).can_sleep(false);
        let body = world.insert(body, shape.into_collider().density(DENSITY)).0;
        for _ in 0..240 {
            plugin.step(&mut world);
            assert_finite(&world, size);
        }
        let y = height(&world, body) / size;
        assert!(y > 0.9 && y < 1.01, "a body of {size} m rests at {y} radii");
    }
}

#[test]
fn small_and_large_bodies_under_gravity() {
    for size in [5e-4, 1e3] {
        let (mut world, mut plugin) = grounded();
        if size < 1.0 {
            // A body of this size falls 3 mm in a sixtieth of a second.
            world.integration_parameters.length_unit = size;
            plugin.substeps = 16;
        }
        let body = dynamic(Vector::Y * (1.1 * size)).can_sleep(false);
        let body = world.insert(body, ball_of(size).into_collider().density(DENSITY)).0;
        for _ in 0..600 {
            plugin.step(&mut world);
            assert_finite(&world, size);
        }
        let y = height(&world, body) / size;
        assert!(y > 0.9 && y < 1.05, "a body of {size} m rests at {y} radii");
    }
}

#[test]
fn bodies_much_smaller_than_their_fall_in_a_step_stay_finite() {
    let (mut world, mut plugin) = grounded();
    let body = world.insert(dynamic(Vector::Y * 1.1e-3), ball_of(1e-3).into_collider().density(DENSITY)).0;
    for _ in 0..600 {
        plugin.step(&mut world);
        assert_finite(&world, "1 mm");
    }
    assert!(height(&world, body).abs() < 0.2, "{}", height(&world, body));
}

/// Forces are solved for in double precision, and were reported as infinite where single precision does not hold them.
#[test]
fn issue_forces_beyond_single_precision_are_left_out() {
    for (mass, speed) in [(1e6, 1e33), (1e20, 1e20), (1e30, 1e10), (1.0, 1e38)] {
        let (mut world, mut plugin) = weightless();
        let lifted = RigidBodyBuilder::kinematic_velocity_based().linvel(Vector::Y * speed);
        world.insert(lifted, ball_collider());
        world.insert(dynamic(Vector::Y * RADIUS), ball().into_collider().mass(mass));
        for _ in 0..3 {
            for contact in &plugin.step(&mut world).contacts {
                let vectors = [contact.force, contact.torque, contact.relative_velocity];
                assert!(vectors.iter().all(|v| v.is_finite()), "{mass} kg, {speed} m/s: {contact:?}");
            }
            assert_finite(&world, (mass, speed));
        }
    }
}
