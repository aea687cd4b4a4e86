//! Outlines of spheres through Rapier's debug renderer.

use super::*;
use ist::BallKind;
use rapier_ist::debug_render::{OutlineColors, OutlineOptions, SphereOutlines};
use rapier3d::pipeline::{
    DebugColor, DebugRenderBackend, DebugRenderMode, DebugRenderObject, DebugRenderPipeline, DebugRenderStyle,
};

/// Keeps what it is asked to draw.
#[derive(Default)]
struct Lines {
    lines: Vec<(Vector, Vector, DebugColor)>,
    hidden: Option<ColliderHandle>,
}

impl DebugRenderBackend for Lines {
    fn filter_object(&self, object: DebugRenderObject) -> bool {
        !matches!(object, DebugRenderObject::Collider(handle, _) if Some(handle) == self.hidden)
    }

    fn draw_line(&mut self, _: DebugRenderObject, a: Vector, b: Vector, color: DebugColor) {
        self.lines.push((a, b, color));
    }
}

const BALLS: [(Vector, f32); 3] =
    [(Vector::ZERO, 0.3), (Vector::new(0.6, 0.1, 0.0), 0.25), (Vector::new(-0.1, 0.6, 0.2), 0.2)];

fn three() -> IstShape {
    let spheres = BALLS.map(|(center, radius)| InnerSphere::solid_ball(center, radius, Vector::Y));
    let packing = SpherePacking::new(spheres.to_vec(), SolidProperties::ball(0.5)).unwrap();
    IstShape::from_packing(&packing)
}

fn style() -> DebugRenderStyle {
    DebugRenderStyle { subdivisions: 24, ..DebugRenderStyle::default() }
}

/// A dynamic body of three balls, turned, and its pose.
fn scene() -> (PhysicsWorld, ColliderHandle, Pose) {
    let (mut world, _) = weightless();
    let body = dynamic(Vector::new(1.0, 2.0, 3.0)).rotation(Vector::new(0.4, -0.7, 0.2));
    let (body, collider) = world.insert(body, three().into_collider());
    let pose = *world.bodies[body].position();
    (world, collider, pose)
}

fn draw(outlines: &mut SphereOutlines, world: &PhysicsWorld, mode: DebugRenderMode) -> Lines {
    let mut lines = Lines::default();
    let pipeline = DebugRenderPipeline::new(style(), mode);
    outlines.render(&pipeline, &mut lines, &world.bodies, &world.colliders);
    lines
}

#[test]
fn every_line_lies_on_a_sphere_and_every_sphere_has_its_circles() {
    let (world, _, pose) = scene();
    let lines = draw(&mut SphereOutlines::default(), &world, DebugRenderMode::COLLIDER_SHAPES).lines;
    assert_eq!(lines.len(), 3 * 3 * 24);
    let mut counts = [0; 3];
    for (a, b, color) in lines {
        let on = |(center, radius): &(Vector, f32)| {
            [a, b].iter().all(|end| (end.distance(pose * *center) - radius).abs() < 1e-5)
        };
        let sphere = BALLS.iter().position(on).unwrap();
        counts[sphere] += 1;
        let chord = 2.0 * BALLS[sphere].1 * (std::f32::consts::PI / 24.0).sin();
        assert!((a.distance(b) - chord).abs() < 1e-5, "a closed circle of 24 parts");
        assert_eq!(color, style().collider_dynamic_color);
    }
    assert_eq!(counts, [72; 3]);
}

#[test]
fn the_largest_spheres_are_drawn_first() {
    let (world, ..) = scene();
    let mut outlines =
        SphereOutlines::from(OutlineOptions { max_spheres: 1, circles: 1, ..Default::default() });
    let lines = draw(&mut outlines, &world, DebugRenderMode::COLLIDER_SHAPES).lines;
    assert_eq!(lines.len(), 24);
    let chord = 2.0 * 0.3 * (std::f32::consts::PI / 24.0).sin();
    assert!(lines.iter().all(|(a, b, _)| (a.distance(*b) - chord).abs() < 1e-5));
}

#[test]
fn modes_and_filters_are_heeded() {
    let (world, collider, _) = scene();
    let mut outlines = SphereOutlines::default();
    let others = DebugRenderMode::all().difference(DebugRenderMode::COLLIDER_SHAPES);
    assert!(draw(&mut outlines, &world, others).lines.is_empty());
    let mut hidden = Lines { hidden: Some(collider), ..Lines::default() };
    let pipeline = DebugRenderPipeline::new(style(), DebugRenderMode::all());
    outlines.render(&pipeline, &mut hidden, &world.bodies, &world.colliders);
    assert!(hidden.lines.is_empty());
}

#[test]
fn colors_are_those_that_rapier_gives_to_a_ball_there() {
    let (mut world, mut plugin) = weightless();
    let builders = [
        RigidBodyBuilder::fixed(),
        RigidBodyBuilder::kinematic_position_based(),
        dynamic(Vector::X * 20.0),
        dynamic(Vector::X * 30.0).sleeping(true),
        dynamic(Vector::X * 40.0).enabled(false),
    ];
    let far = |i: usize| Vector::Z * 10.0 * i as f32;
    for (i, builder) in builders.into_iter().enumerate() {
        let body = world.insert(builder, ball_collider().translation(far(i))).0;
        world.insert_collider(ColliderBuilder::ball(RADIUS).translation(far(i) + Vector::Y), Some(body));
    }
    world.insert_collider(ball_collider().translation(far(9)), None);
    world.insert_collider(ColliderBuilder::ball(RADIUS).translation(far(9) + Vector::Y), None);
    for steps in [1, 60] {
        run(&mut plugin, &mut world, steps);
        let mut pipeline = DebugRenderPipeline::new(style(), DebugRenderMode::COLLIDER_SHAPES);
        let mut rapier = Lines::default();
        pipeline.render_colliders(&mut rapier, &world.bodies, &world.colliders);
        let ours = draw(&mut SphereOutlines::default(), &world, pipeline.mode);
        let colors = |lines: &Lines| {
            let mut colors: Vec<_> = lines.lines.iter().map(|line| line.2.map(f32::to_bits)).collect();
            colors.dedup();
            colors
        };
        assert_eq!(colors(&ours), colors(&rapier));
        assert!(colors(&ours).len() >= 5);
    }
}

#[test]
fn radii_have_hues_from_blue_to_red() {
    let (world, ..) = scene();
    let options = OutlineOptions {
        colors: OutlineColors::Radius,
        balls: BallKind::Volume,
        circles: 1,
        ..OutlineOptions::default()
    };
    let mut outlines = SphereOutlines::from(options);
    let lines = draw(&mut outlines, &world, DebugRenderMode::COLLIDER_SHAPES).lines;
    let hues: Vec<f32> = lines.chunks(24).map(|circle| circle[0].2[0]).collect();
    assert!(
        (hues[0]).abs() < 1e-3 && (hues[1] - 120.0).abs() < 1.0 && (hues[2] - 240.0).abs() < 1e-3,
        "{hues:?}"
    );
}

#[test]
fn parts_of_compounds_are_drawn_where_they_are() {
    let (mut world, _) = weightless();
    let at = Pose::translation(0.0, 5.0, 0.0);
    let parts = vec![(at, three().into_shared()), (Pose::IDENTITY, SharedShape::ball(0.1))];
    world.insert(RigidBodyBuilder::fixed(), ColliderBuilder::new(SharedShape::compound(parts)));
    let lines = draw(&mut SphereOutlines::default(), &world, DebugRenderMode::COLLIDER_SHAPES).lines;
    assert_eq!(lines.len(), 3 * 3 * 24);
    assert!(lines.iter().all(|(a, ..)| a.y > 4.0));
}
