//! Groups, collision types and sensors.

use super::*;

/// Whether two overlapping balls touch, as the plugin and as Rapier's collision events have it.
fn touch(change: impl Fn(ColliderBuilder, usize) -> ColliderBuilder) -> (bool, bool) {
    let (mut world, mut plugin) = weightless();
    let colliders = [0, 1].map(|i| {
        let collider = change(ball_collider(), i);
        world.insert(dynamic(Vector::X * 0.15 * i as f32), collider).1
    });
    let pushed = plugin.step(&mut world).contact(colliders[0], colliders[1]).is_some();
    let seen = world.narrow_phase.contact_pair(colliders[0], colliders[1]);
    (pushed, seen.is_some_and(|pair| pair.has_any_active_contact()))
}

#[test]
fn groups_are_heeded() {
    let groups = |memberships, filter| InteractionGroups::new(memberships, filter, InteractionTestMode::And);
    let one_way = [groups(Group::GROUP_1, Group::GROUP_1), groups(Group::GROUP_2, Group::ALL)];
    assert_eq!(touch(|collider, _| collider), (true, true));
    assert_eq!(touch(|collider, i| collider.collision_groups(one_way[i])), (false, false));
    // Rapier goes on to detect pairs whose forces are switched off.
    assert_eq!(touch(|collider, i| collider.solver_groups(one_way[i])), (false, true));
    let same = groups(Group::GROUP_3, Group::GROUP_3);
    assert_eq!(touch(|collider, _| collider.collision_groups(same).solver_groups(same)), (true, true));
}

#[test]
fn collision_types_are_heeded() {
    let none = ActiveCollisionTypes::empty();
    assert_eq!(touch(|collider, _| collider.active_collision_types(none)), (false, false));
    // One of the two that wants it is enough.
    assert_eq!(
        touch(|collider, i| if i == 0 { collider.active_collision_types(none) } else { collider }),
        (true, true)
    );
    let fixed_only = ActiveCollisionTypes::DYNAMIC_FIXED;
    assert_eq!(touch(|collider, _| collider.active_collision_types(fixed_only)), (false, false));
}

#[test]
fn sensors_tell_and_do_not_push() {
    let (mut world, mut plugin) = grounded();
    let ((collisions, events), (forces, _), (tears, _)) =
        (std::sync::mpsc::channel(), std::sync::mpsc::channel(), std::sync::mpsc::channel());
    let handler = ChannelEventCollector::new(collisions, forces, tears);
    let sensor = ball_of(0.3).into_collider().sensor(true).active_events(ActiveEvents::COLLISION_EVENTS);
    let sensor = world.insert_collider(sensor.translation(Vector::Y * 0.9), None);
    let (body, collider) = world.insert(dynamic(Vector::Y * 2.0), ball_collider());
    let mut inside = 0;
    for _ in 0..120 {
        let report = plugin.step_with_events(&mut world, &(), &handler);
        assert!(report.contacts.iter().all(|contact| !contact.colliders().contains(&sensor)));
        inside += usize::from(world.narrow_phase.intersection_pair(sensor, collider) == Some(true));
    }
    assert!(inside > 5 && (height(&world, body) - 0.1).abs() < 0.01, "it fell through");
    let events: Vec<_> = events.try_iter().collect();
    assert_eq!(events.iter().map(|event| event.started()).collect::<Vec<_>>(), [true, false]);
    assert!(events.iter().all(|event| event.sensor()));
}
