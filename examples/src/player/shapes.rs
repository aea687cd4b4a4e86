//! Meshes and packings in 16-bit numbers, shared by the bodies that differ in size only.

use glam::Vec3;
use serde::Serialize;
use std::collections::HashMap;

/// The largest number in a 16-bit coordinate.
const FULL: f32 = 32767.0;
/// Recorded sizes are rounded to f32, so equal shapes come out up to this many steps apart.
const TOLERANCE: i32 = 2;

/// Points as multiples of a body's own size about a centre of its own.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Placement {
    /// Index of the shape.
    pub(super) shape: usize,
    /// Where the shape's centre is in the body's frame (m).
    pub(super) center: [f32; 3],
    /// Length of the number 1 (m).
    pub(super) size: f32,
}

/// A shape: points with `width` numbers each, and triangles between them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Shape {
    pub(super) numbers: Vec<i16>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// All different shapes.
#[derive(Default)]
pub(super) struct Shapes {
    pub(super) list: Vec<Shape>,
    /// Shapes by their numbers of coordinates and triangles.
    by_counts: HashMap<(usize, usize), Vec<usize>>,
}

impl Shapes {
    /// The placement of a mesh; `None` for one without extent.
    pub(super) fn add_mesh(&mut self, vertices: &[Vec3], triangles: &[[u32; 3]]) -> Option<Placement> {
        let (center, size) = frame(vertices.iter().map(|vertex| (*vertex, 0.0)))?;
        let numbers =
            vertices.iter().flat_map(|v| ((*v - center) / size).to_array().map(quantised)).collect();
        let shape = self.find_or_add(Shape { numbers, triangles: triangles.to_vec() });
        Some(Placement { shape, center: center.to_array(), size })
    }

    /// The placement of spheres, four numbers each; `None` for none.
    pub(super) fn add_spheres(&mut self, spheres: &[(Vec3, f32)]) -> Option<Placement> {
        let (center, size) = frame(spheres.iter().copied())?;
        let numbers = spheres.iter().flat_map(|(position, radius)| {
            let [x, y, z] = ((*position - center) / size).to_array();
            [x, y, z, radius / size].map(quantised)
        });
        let shape = self.find_or_add(Shape { numbers: numbers.collect(), triangles: Vec::new() });
        Some(Placement { shape, center: center.to_array(), size })
    }

    fn find_or_add(&mut self, shape: Shape) -> usize {
        let alike = self.by_counts.entry((shape.numbers.len(), shape.triangles.len())).or_default();
        let is_equal = |other: &Shape| {
            let near = |(a, b): (&i16, &i16)| (i32::from(*a) - i32::from(*b)).abs() <= TOLERANCE;
            other.triangles == shape.triangles && other.numbers.iter().zip(&shape.numbers).all(near)
        };
        if let Some(&index) = alike.iter().find(|&&index| is_equal(&self.list[index])) {
            return index;
        }
        alike.push(self.list.len());
        self.list.push(shape);
        self.list.len() - 1
    }
}

/// Centre and half of the longest side of the box around balls; `None` for no balls, or balls in one point.
fn frame(balls: impl Iterator<Item = (Vec3, f32)>) -> Option<(Vec3, f32)> {
    let boxes = balls.map(|(center, radius)| (center - radius, center + radius));
    let (lower, upper) = boxes.reduce(|(a, b), (c, d)| (a.min(c), b.max(d)))?;
    let size = (upper - lower).max_element() / 2.0;
    (size > 0.0 && size.is_finite()).then_some(((lower + upper) / 2.0, size))
}

fn quantised(number: f32) -> i16 {
    (number * FULL).round() as i16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_share_a_shape_and_keep_their_points() {
        let vertices = [Vec3::ZERO, Vec3::new(1.0, 0.2, 0.0), Vec3::new(0.3, 0.9, -0.7), Vec3::Z];
        let triangles = [[0, 1, 2], [0, 2, 3]];
        let mut shapes = Shapes::default();
        for scale in [1.0, 0.371_23, 17.9] {
            let scaled: Vec<Vec3> = vertices.iter().map(|v| *v * scale).collect();
            let placement = shapes.add_mesh(&scaled, &triangles).unwrap();
            assert_eq!(placement.shape, 0);
            let numbers = &shapes.list[0].numbers;
            for (vertex, numbers) in scaled.iter().zip(numbers.chunks(3)) {
                let number = Vec3::new(numbers[0].into(), numbers[1].into(), numbers[2].into()) / FULL;
                let point = Vec3::from(placement.center) + number * placement.size;
                assert!(point.distance(*vertex) < 1e-4 * scale);
            }
        }
        assert_eq!(shapes.add_mesh(&vertices, &triangles[..1]).unwrap().shape, 1);
        assert!(shapes.add_mesh(&vertices[..1], &[]).is_none());
        assert!(shapes.add_spheres(&[]).is_none());
        assert_eq!(shapes.add_spheres(&[(Vec3::X, 0.5)]).unwrap().size, 0.5);
    }
}
