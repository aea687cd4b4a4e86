//! Draws the generated shapes, whole and cut open.
//!
//! `cargo run --release -p rapier-ist-examples --bin gallery -- [FOLDER]` writes `shapes.png` and `cut.png`.

use glam::{DVec3, Quat, Vec3};
use glamx::Pose3;
use packer::TriangleMesh;
use rapier_ist_examples::render::{CutPlane, ImageError, Mesh, PictureSize, Scene, Section, Surface};
use rapier_ist_examples::{palette, shapes};
use std::path::PathBuf;
use std::time::Instant;

fn main() -> Result<(), ImageError> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| ".".into()));
    shapes_picture(&folder.join("shapes.png"))?;
    cut_picture(&folder.join("cut.png"))
}

/// All shapes in and around a bowl.
fn shapes_picture(path: &std::path::Path) -> Result<(), ImageError> {
    let bowl = Mesh::new(&shapes::bowl(1.0, 0.08, 0.9, 160));
    let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
    let things: [(TriangleMesh, Vec3, Vec3); 9] = [
        (shapes::ring(0.3, 0.1, [96, 48]), at(-0.02, -0.5, 0.22), at(0.45, 0.0, 0.1)),
        (shapes::hexagonal_nut(0.6, 0.16, 0.3, 0.03, 96), at(0.48, -0.42, 0.0), at(0.3, 0.3, 0.9)),
        (shapes::torus_knot(2, 3, [0.28, 0.12, 0.06], [384, 32]), at(0.05, -0.42, -0.45), at(0.9, 0.0, 0.0)),
        (shapes::cross(0.36, 0.09), at(-0.4, -0.25, -0.1), at(0.6, 0.4, 0.2)),
        (shapes::ring(0.45, 0.14, [128, 64]), at(1.7, -0.94, 0.5), Vec3::ZERO),
        (shapes::torus_knot(3, 4, [0.42, 0.16, 0.06], [512, 32]), at(-1.75, -0.86, 0.35), Vec3::ZERO),
        (shapes::cross(0.45, 0.12), at(0.95, -0.63, 1.35), at(0.0, 0.4, 0.0)),
        (shapes::cuboid(DVec3::new(0.3, 0.22, 0.2)), at(-0.25, -0.86, 1.65), at(0.0, 0.6, 0.0)),
        (shapes::sphere(0.3, 4), at(-1.15, -0.78, 1.3), Vec3::ZERO),
    ];
    let meshes: Vec<Mesh> = things.iter().map(|(mesh, ..)| Mesh::new(mesh)).collect();
    let mut scene = Scene::new();
    scene.add_mesh(&bowl, Pose3::IDENTITY, Surface::new(palette::NEUTRAL));
    for (index, (mesh, (_, translation, turn))) in meshes.iter().zip(&things).enumerate() {
        let pose = Pose3::from_parts(*translation, Quat::from_scaled_axis(*turn));
        scene.add_mesh(mesh, pose, Surface::new(palette::color(index)));
    }
    scene.set_ground(-1.08);
    save(&scene, Vec3::new(0.25, 0.75, 1.0), path)
}

/// Balls in a knot cut open.
fn cut_picture(path: &std::path::Path) -> Result<(), ImageError> {
    let ring = Mesh::new(&shapes::ring(1.0, 0.4, [192, 96]));
    let bowl = Mesh::new(&shapes::bowl(1.0, 0.15, 1.0, 160));
    let sphere = Mesh::new(&shapes::sphere(0.9, 5));
    let mut scene = Scene::new();
    scene.set_cut(CutPlane { point: Vec3::new(0.0, 0.0, 0.1), normal: Vec3::Z });
    let surface = |index| Surface::new(palette::color(index));
    let lifted = |x, y| Pose3::translation(x, y, 0.0);
    scene.add_mesh(&ring, lifted(0.0, 0.4), surface(4).section(Section::Hollow));
    scene.add_balls(balls_in_a_ring(), lifted(0.0, 0.4), surface(1).section(Section::Hollow));
    scene.add_mesh(&bowl, lifted(2.9, 1.15), surface(2).section(Section::Capped));
    scene.add_mesh(&sphere, lifted(-2.7, 0.9), surface(3).section(Section::Hollow));
    scene.add_balls(balls_in_a_sphere(), lifted(-2.7, 0.9), surface(0).section(Section::Hollow));
    scene.set_ground(0.0);
    save(&scene, Vec3::new(0.1, 0.45, 1.0), path)
}

fn save(scene: &Scene, from: Vec3, path: &std::path::Path) -> Result<(), ImageError> {
    let camera = scene.framed_from(from, PictureSize::HD);
    let start = Instant::now();
    let image = scene.render(&camera, PictureSize::HD);
    println!("{}: {:.0} ms", path.display(), start.elapsed().as_secs_f64() * 1e3);
    image.save_png(path)
}

/// Disjoint balls inside the ring above.
fn balls_in_a_ring() -> Vec<(Vec3, f32)> {
    disjoint_balls(4000, |p| 0.4 - Vec3::new(Vec3::new(p.x, 0.0, p.z).length() - 1.0, p.y, 0.0).length())
}

/// Disjoint balls inside the sphere above.
fn balls_in_a_sphere() -> Vec<(Vec3, f32)> {
    disjoint_balls(4000, |p| 0.9 - p.length())
}

/// Random balls that touch neither each other nor the surface that `clearance` is the distance from.
fn disjoint_balls(tries: u32, clearance: impl Fn(Vec3) -> f32) -> Vec<(Vec3, f32)> {
    let mut balls: Vec<(Vec3, f32)> = Vec::new();
    let mut state = 1_u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 23) as f32 - 1.0
    };
    for smallest in [0.12, 0.08, 0.05, 0.03] {
        for _ in 0..tries {
            let p = Vec3::new(random(), random(), random()) * 1.4;
            let free = balls.iter().map(|(c, r)| c.distance(p) - r).fold(clearance(p), f32::min);
            if free > smallest {
                balls.push((p, free.min(0.16)));
            }
        }
    }
    balls
}
