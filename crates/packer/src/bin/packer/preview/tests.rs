//! Pictures by their pixels.

use super::*;
use glam::{DVec3, Vec3};
use ist::{InnerSphere, SolidProperties};
use packer::TriangleMesh;

fn packing(balls: &[(Vec3, f32)]) -> SpherePacking {
    let spheres = balls.iter().map(|(c, r)| InnerSphere::solid_ball(*c, *r, Vec3::Z)).collect();
    SpherePacking::new(spheres, SolidProperties::ball(1.0)).unwrap()
}

fn picture(packing: &SpherePacking, solid: Option<&Solid>) -> Vec<[u8; 3]> {
    let file = png(packing, solid).unwrap();
    let mut reader = ::png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    assert_eq!((info.width as usize, info.height as usize), (WIDTH, HEIGHT));
    bytes.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect()
}

/// A cube of side 2 about the origin.
fn cube() -> Solid {
    let vertices =
        (0..8).map(|i| 2.0 * DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) - 1.0);
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    Solid::new(&TriangleMesh { vertices: vertices.collect(), triangles }).unwrap()
}

/// Columns in which something stands in the middle row, from the first to the last.
fn extent(pixels: &[[u8; 3]]) -> (usize, usize) {
    let row = &pixels[375 * WIDTH..376 * WIDTH];
    let is_thing = |x: &usize| (0..3).any(|c| row[*x][c].abs_diff(row[0][c]) > 20);
    let mut columns = (0..WIDTH).filter(is_thing);
    (columns.next().unwrap(), columns.next_back().unwrap())
}

/// Greatest difference to the pixel in the middle, of any channel, in a square around it.
fn unevenness(pixels: &[[u8; 3]], reach: usize) -> u8 {
    let (row, column) = (375, 500);
    let middle = pixels[row * WIDTH + column];
    let square =
        (row - reach..row + reach).flat_map(|y| &pixels[y * WIDTH..][column - reach..column + reach]);
    square.flat_map(|pixel| (0..3).map(|c| pixel[c].abs_diff(middle[c]))).max().unwrap()
}

#[test]
fn a_cut_ball_fills_the_picture_and_shows_a_flat_face() {
    let pixels = picture(&packing(&[(Vec3::ZERO, 1.0)]), None);
    let (first, last) = extent(&pixels);
    let height = HEIGHT - 50 - 2 * 40;
    assert!((last - first).abs_diff(height) < height / 10, "{first} to {last}");
    assert!(unevenness(&pixels, 150) < 12, "a flat face is evenly lit");
}

#[test]
fn a_ball_behind_the_plane_is_round() {
    let across = [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y].map(|center| (center, 0.4));
    let behind = (Vec3::new(0.0, 0.0, -0.6), 0.4);
    let packing = packing(&[across.as_slice(), &[behind]].concat());
    let pixels = picture(&packing, None);
    let scene = Scene::new(&packing, None);
    let camera = Camera::on(&scene, &CutPlane::largest_section(&scene));
    let (place, _) = camera.project(scene.balls[4].center);
    let reach = camera.scale * scene.balls[4].radius;
    let light = |down: f32| {
        let [column, row] = [place.x, place.y + down * reach].map(|c| c as usize / camera::FACTOR);
        pixels[row * WIDTH + column].iter().map(|c| u32::from(*c)).sum::<u32>()
    };
    assert!(light(-0.4) > light(0.4) + 60 && light(0.4) > light(0.8) + 60, "darker and darker downwards");
}

#[test]
fn the_mesh_is_drawn_where_it_is_at_hand() {
    let ball = packing(&[(Vec3::ZERO, 0.9)]);
    let (with, without) = (picture(&ball, Some(&cube())), picture(&ball, None));
    let dark = |pixels: &[[u8; 3]]| pixels.iter().filter(|p| p.iter().all(|c| *c < 60)).count();
    assert!(dark(&with) > 2_000, "the edge of the section is a dark line: {}", dark(&with));
    assert!(dark(&without) < 200, "{}", dark(&without));
}

#[test]
fn pictures_are_the_same_for_any_number_of_threads() {
    let balls: Vec<_> = (0..300)
        .map(|i| {
            let x = i as f32;
            (Vec3::new((0.7 * x).sin(), (1.3 * x).cos(), (2.1 * x).sin()), 0.01 + 0.1 * (x * 0.37).fract())
        })
        .collect();
    let (packing, solid) = (packing(&balls), cube());
    let with_threads = |count| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
        pool.install(|| png(&packing, Some(&solid)).unwrap())
    };
    assert!(with_threads(1) == with_threads(3));
}

#[test]
fn extreme_sizes_and_places_are_drawn() {
    for scale in [1e-12_f32, 1e-6, 1.0, 1e6, 1e12] {
        let ball = packing(&[(Vec3::ZERO, scale), (Vec3::X * 2.0 * scale, 0.5 * scale)]);
        let (first, last) = extent(&picture(&ball, None));
        assert!(last - first > 600, "{scale}: {first} to {last}");
    }
    let far = packing(&[(Vec3::splat(1e7), 3.0)]);
    let far = SpherePacking::new(
        far.spheres().to_vec(),
        SolidProperties { centroid: DVec3::splat(1e7), ..SolidProperties::ball(3.0) },
    );
    let (first, last) = extent(&picture(&far.unwrap(), None));
    assert!(last - first > 600, "{first} to {last}");
}
