//! Pictures are checked by their pixels.

use super::*;
use crate::shapes;
use glam::{DVec3, Vec3};
use glamx::Pose3;

const SIZE: PictureSize = PictureSize { width: 160, height: 120 };
const RED: [f32; 3] = [0.9, 0.1, 0.1];
const GREEN: [f32; 3] = [0.1, 0.8, 0.1];
const BLUE: [f32; 3] = [0.1, 0.1, 0.9];

/// Which of red, green and blue stands out at the picture's middle, if one does.
fn middle(image: &Image) -> Option<usize> {
    let index = image.height() / 2 * image.width() + image.width() / 2;
    let pixel = image.pixels()[index as usize].map(i32::from);
    (0..3).find(|&k| (0..3).all(|other| other == k || pixel[k] > pixel[other] + 40))
}

/// What the camera in front (+z) sees in the middle.
fn seen_from_front(scene: &Scene) -> Option<usize> {
    middle(&scene.render(&Camera::new(Vec3::Z * 10.0, Vec3::ZERO), SIZE))
}

#[test]
fn the_nearest_thing_wins() {
    let mesh = Mesh::new(&shapes::cuboid(DVec3::ONE));
    let mut scene = Scene::new();
    assert_eq!(seen_from_front(&scene), None);
    scene.add_balls([(Vec3::ZERO, 1.2)], Pose3::IDENTITY, Surface::new(GREEN));
    assert_eq!(seen_from_front(&scene), Some(1));
    scene.add_mesh(&mesh, Pose3::translation(0.0, 0.0, 0.5), Surface::new(RED));
    assert_eq!(seen_from_front(&scene), Some(0));
    scene.add_balls([(Vec3::Z * 2.0, 0.5)], Pose3::IDENTITY, Surface::new(BLUE));
    assert_eq!(seen_from_front(&scene), Some(2));
}

#[test]
fn a_cut_opens_what_asks_for_it() {
    let shell = Mesh::new(&shapes::sphere(1.0, 3));
    let front = CutPlane { point: Vec3::ZERO, normal: Vec3::Z };
    for (section, depth, seen) in
        [(Section::Whole, -0.3, 0), (Section::Hollow, -0.3, 1), (Section::Capped, -1.5, 0)]
    {
        let mut scene = Scene::new();
        scene.add_mesh(&shell, Pose3::IDENTITY, Surface::new(RED).section(section));
        scene.add_balls([(Vec3::Z * depth, 0.2)], Pose3::IDENTITY, Surface::new(GREEN));
        scene.set_cut(front);
        assert_eq!(seen_from_front(&scene), Some(seen), "{section:?}");
    }
}

#[test]
fn cut_balls_go_wholly_or_get_a_flat_face() {
    let front = CutPlane { point: Vec3::ZERO, normal: Vec3::Z };
    for (section, seen) in [(Section::Whole, Some(1)), (Section::Hollow, None), (Section::Capped, Some(1))] {
        let mut scene = Scene::new();
        scene.add_balls([(Vec3::Z * 0.1, 1.0)], Pose3::IDENTITY, Surface::new(GREEN).section(section));
        scene.set_cut(front);
        assert_eq!(seen_from_front(&scene), seen, "{section:?}");
    }
}

/// Things of every kind, many of them.
fn crowd<'a>(mesh: &'a Mesh, copies: usize, balls: usize) -> Scene<'a> {
    let mut scene = Scene::new();
    let spot = |index: usize, count: usize| {
        let (ring, turn) = (index as f32 / count as f32, index as f32 * 2.4);
        Vec3::new(turn.cos(), 0.0, turn.sin()) * (0.5 + 6.0 * ring.sqrt())
    };
    for copy in 0..copies {
        let color = crate::palette::color(copy);
        scene.add_mesh(mesh, Pose3::from_translation(spot(copy, copies)), Surface::new(color));
    }
    let placed = (0..balls).map(|ball| (spot(ball, balls) + Vec3::Y * 0.6, 0.03));
    scene.add_balls(placed, Pose3::IDENTITY, Surface::new(crate::palette::NEUTRAL));
    scene.set_ground(-0.2);
    scene
}

#[test]
fn pictures_do_not_depend_on_the_number_of_threads() {
    let mesh = Mesh::new(&shapes::ring(0.4, 0.15, [32, 16]));
    let mut scene = crowd(&mesh, 20, 100);
    scene.set_cut(CutPlane { point: Vec3::ZERO, normal: Vec3::X });
    let camera = scene.framed_from(Vec3::new(0.3, 0.6, 1.0), SIZE);
    let picture = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| scene.render(&camera, SIZE))
    };
    let alone = picture(1);
    assert_eq!(alone, picture(2));
    assert_eq!(alone, picture(5));
}

#[test]
fn nothing_and_nonsense_are_drawn_without_a_panic() {
    let mesh = Mesh::new(&shapes::cuboid(DVec3::new(1.0, f64::NAN, f64::INFINITY)));
    let mut scene = Scene::new();
    let tiny = PictureSize { width: 0, height: 1 };
    let camera = scene.framed_from(Vec3::ZERO, tiny);
    assert_eq!(scene.render(&camera, tiny).pixels().len(), 1);
    scene.add_mesh(&mesh, Pose3::IDENTITY, Surface::new(RED));
    scene.add_mesh(&mesh, Pose3::translation(f32::NAN, 0.0, 0.0), Surface::new(RED));
    let balls = [(Vec3::NAN, 1.0), (Vec3::ZERO, f32::NAN), (Vec3::ZERO, f32::INFINITY), (Vec3::ZERO, -1.0)];
    scene.add_balls(balls, Pose3::IDENTITY, Surface::new(GREEN));
    scene.set_cut(CutPlane { point: Vec3::NAN, normal: Vec3::ZERO });
    scene.set_ground(f32::NAN);
    for eye in [Vec3::ZERO, Vec3::Y, Vec3::NAN, Vec3::splat(1e30)] {
        let _ = scene.render(&Camera::new(eye, Vec3::ZERO), SIZE);
    }
}
