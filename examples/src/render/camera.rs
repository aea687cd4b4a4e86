//! Views: the camera's perspective and the light's parallel projection.

use super::PictureSize;
use glam::{Vec2, Vec3};

/// Where the picture is taken from: a perspective camera with y upwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    eye: Vec3,
    right: Vec3,
    up: Vec3,
    forward: Vec3,
    /// Half the picture's height at distance 1.
    half_height: f32,
}

/// A wide angle would distort balls at the border into eggs; 30° is a portrait lens.
const FIELD_OF_VIEW_DEGREES: f32 = 30.0;
/// Share of the picture that a framed scene fills.
const FILL: f32 = 0.86;

impl Camera {
    /// A camera at `eye` that looks at `target` (m), with 30° from the bottom to the top of the picture.
    #[must_use]
    pub fn new(eye: Vec3, target: Vec3) -> Self {
        let forward = (target - eye).normalize_or(Vec3::NEG_Z);
        // Looking straight up or down, any right is as good as another.
        let right = forward.cross(Vec3::Y).normalize_or(Vec3::X);
        let half_height = (FIELD_OF_VIEW_DEGREES / 2.0).to_radians().tan();
        Self { eye, right, up: right.cross(forward), forward, half_height }
    }

    /// A camera in direction `from` of the points, far enough away that all of them are in the picture.
    #[must_use]
    pub fn framing(points: &[Vec3], from: Vec3, size: PictureSize) -> Self {
        let (lower, upper) = bounds(points).unwrap_or((Vec3::NEG_ONE, Vec3::ONE));
        let from = from.normalize_or(Vec3::Z);
        let mut target = (lower + upper) / 2.0;
        let mut camera = Self::new(target + from, target);
        let half_width = camera.half_height * size.aspect();
        // The nearest points look larger: shift the target until both sides have the same margin.
        for _ in 0..4 {
            let [x, y] = [(camera.right, half_width), (camera.up, camera.half_height)]
                .map(|(axis, half)| fit(points, target, axis, from, half * FILL));
            let distance = x.distance.max(y.distance).max(1e-3 * (upper - lower).length());
            target += camera.right * x.shift + camera.up * y.shift;
            camera = Self::new(target + from * distance, target);
        }
        camera
    }

    /// Distance of `point` in front of the camera (m).
    pub(super) fn depth(&self, point: Vec3) -> f32 {
        (point - self.eye).dot(self.forward)
    }

    /// Unit vector along the rows of the picture.
    pub(super) fn right(&self) -> Vec3 {
        self.right
    }

    /// Unit vector towards a light high behind the photographer's left shoulder.
    pub(super) fn over_left_shoulder(&self) -> Vec3 {
        let behind = self.right.cross(Vec3::Y).normalize_or(Vec3::Z);
        (Vec3::Y * 1.3 - self.right * 0.7 + behind * 0.55).normalize()
    }
}

/// What one direction of the picture asks for.
struct Fit {
    distance: f32,
    shift: f32,
}

/// Distance from `target`, and shift of it along `axis`, at which all points lie within ± `half` at distance 1.
fn fit(points: &[Vec3], target: Vec3, axis: Vec3, from: Vec3, half: f32) -> Fit {
    // A point is inside where |x| ≤ half (D − z): each side gives D ≥ ±x/half + z.
    let side = |sign: f32| {
        let needs = |p: &Vec3| (*p - target).dot(axis) * sign / half + (*p - target).dot(from);
        points.iter().map(needs).fold(f32::NEG_INFINITY, f32::max)
    };
    let (plus, minus) = (side(1.0), side(-1.0));
    if !(plus.is_finite() && minus.is_finite()) {
        return Fit { distance: 0.0, shift: 0.0 };
    }
    Fit { distance: (plus + minus) / 2.0, shift: (plus - minus) / 2.0 * half }
}

/// Smallest box around the points.
pub(super) fn bounds(points: &[Vec3]) -> Option<(Vec3, Vec3)> {
    let first = *points.first()?;
    Some(points.iter().fold((first, first), |(lower, upper), &p| (lower.min(p), upper.max(p))))
}

/// A projection onto a grid of samples.
///
/// *Nearness* grows towards the viewer and is linear across a projected triangle: 1/depth in perspective, −depth
/// in parallel projection.
pub(super) trait View: Sync {
    /// Column, row and nearness of a point; `None` behind the viewer.
    fn project(&self, point: Vec3) -> Option<Vec3>;
    /// Factor that makes a quantity that is linear in space linear across the grid.
    fn weight(&self, nearness: f32) -> f32;
    /// Origin and direction of the ray through a place on the grid.
    fn ray(&self, place: Vec2) -> (Vec3, Vec3);
    /// Nearness of the point at `t` directions along a ray.
    fn nearness(&self, t: f32) -> f32;
    /// Columns and rows that a ball can cover: lowest and highest of each.
    fn ball_bounds(&self, center: Vec3, radius: f32) -> Option<[f32; 4]>;
}

/// A camera with its grid.
pub(super) struct Perspective {
    camera: Camera,
    /// Samples per unit at distance 1, and the middle of the grid.
    focal: f32,
    middle: Vec2,
}

impl Perspective {
    pub(super) fn new(camera: Camera, width: usize, height: usize) -> Self {
        let middle = Vec2::new(width as f32, height as f32) / 2.0;
        Self { camera, focal: middle.y / camera.half_height, middle }
    }

    /// Samples that `length` (m) covers at the given nearness.
    pub(super) fn samples(&self, length: f32, nearness: f32) -> f32 {
        length * nearness * self.focal
    }

    /// The point seen at a place on the grid.
    pub(super) fn point(&self, place: Vec2, nearness: f32) -> Vec3 {
        let (origin, direction) = self.ray(place);
        origin + direction / nearness
    }

    /// Extent of a ball along one axis of the grid, by the two tangents from the eye in the plane of the axis and
    /// the view direction.
    fn tangents(&self, across: f32, depth: f32, radius: f32) -> Option<[f32; 2]> {
        let distance_squared = across * across + depth * depth;
        let tangent = (distance_squared - radius * radius).max(0.0).sqrt();
        let [low, high] = [radius, -radius].map(|r| {
            let (x, z) = (across * tangent - depth * r, depth * tangent + across * r);
            (z > 0.0).then(|| x / z * self.focal)
        });
        Some([low?, high?])
    }
}

/// What is nearer to the eye than this many metres is not drawn.
const NEAR: f32 = 1e-4;

impl View for Perspective {
    fn project(&self, point: Vec3) -> Option<Vec3> {
        let depth = self.camera.depth(point);
        if depth < NEAR {
            return None;
        }
        let (offset, scale) = (point - self.camera.eye, self.focal / depth);
        let column = self.middle.x + offset.dot(self.camera.right) * scale;
        let row = self.middle.y - offset.dot(self.camera.up) * scale;
        Some(Vec3::new(column, row, depth.recip()))
    }

    fn weight(&self, nearness: f32) -> f32 {
        nearness
    }

    fn ray(&self, place: Vec2) -> (Vec3, Vec3) {
        let across = (place.x - self.middle.x) / self.focal;
        let upwards = (self.middle.y - place.y) / self.focal;
        let Camera { eye, right, up, forward, .. } = self.camera;
        (eye, forward + right * across + up * upwards)
    }

    fn nearness(&self, t: f32) -> f32 {
        t.recip()
    }

    fn ball_bounds(&self, center: Vec3, radius: f32) -> Option<[f32; 4]> {
        let offset = center - self.camera.eye;
        let depth = offset.dot(self.camera.forward);
        if depth - radius < NEAR {
            return None;
        }
        let [left, right] = self.tangents(offset.dot(self.camera.right), depth, radius)?;
        let [top, bottom] = self.tangents(-offset.dot(self.camera.up), depth, radius)?;
        let Vec2 { x, y } = self.middle;
        Some([x + left, x + right, y + top, y + bottom])
    }
}

/// The parallel projection of a far light onto a square grid.
pub(super) struct Parallel {
    center: Vec3,
    right: Vec3,
    up: Vec3,
    /// The way the light goes.
    forward: Vec3,
    scale: f32,
    middle: f32,
}

impl Parallel {
    /// A view along `forward` with the ball of `radius` around `center` inside its `size` × `size` samples, and
    /// `across` along its rows as far as possible.
    pub(super) fn new((center, radius): (Vec3, f32), forward: Vec3, across: Vec3, size: usize) -> Self {
        let level = across.reject_from_normalized(forward).try_normalize();
        let right = level.unwrap_or_else(|| forward.any_orthonormal_vector());
        let middle = size as f32 / 2.0;
        Self { center, right, up: right.cross(forward), forward, scale: middle / radius, middle }
    }

    /// Samples per metre.
    pub(super) fn scale(&self) -> f32 {
        self.scale
    }
}

impl View for Parallel {
    fn project(&self, point: Vec3) -> Option<Vec3> {
        let offset = point - self.center;
        let column = self.middle + offset.dot(self.right) * self.scale;
        let row = self.middle - offset.dot(self.up) * self.scale;
        Some(Vec3::new(column, row, -offset.dot(self.forward)))
    }

    fn weight(&self, _: f32) -> f32 {
        1.0
    }

    fn ray(&self, place: Vec2) -> (Vec3, Vec3) {
        let across = (place.x - self.middle) / self.scale;
        let upwards = (self.middle - place.y) / self.scale;
        (self.center + self.right * across + self.up * upwards, self.forward)
    }

    fn nearness(&self, t: f32) -> f32 {
        -t
    }

    fn ball_bounds(&self, center: Vec3, radius: f32) -> Option<[f32; 4]> {
        let Vec3 { x, y, .. } = self.project(center)?;
        let reach = radius * self.scale;
        Some([x - reach, x + reach, y - reach, y + reach])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [Vec3; 4] =
        [Vec3::ZERO, Vec3::new(3.0, 1.0, 0.5), Vec3::new(-1.0, 2.0, 4.0), Vec3::new(0.5, -2.0, -1.0)];

    #[test]
    fn a_framed_scene_touches_the_margin_and_stays_inside() {
        for size in [PictureSize::HD, PictureSize { width: 300, height: 900 }] {
            let camera = Camera::framing(&CORNERS, Vec3::new(1.0, 0.7, 1.5), size);
            let view = Perspective::new(camera, size.width as usize, size.height as usize);
            let reach = |p: Vec3| {
                let seen = view.project(p).unwrap();
                let Vec2 { x, y } = view.middle;
                ((seen.x - x).abs() / x).max((seen.y - y).abs() / y)
            };
            let most = CORNERS.map(reach).into_iter().fold(0.0, f32::max);
            assert!((most - FILL).abs() < 0.02, "{most}");
        }
    }

    #[test]
    fn rays_lead_back_to_the_projected_point() {
        let camera = Camera::new(Vec3::new(4.0, 3.0, 8.0), Vec3::ZERO);
        let perspective = Perspective::new(camera, 640, 480);
        let parallel = Parallel::new((Vec3::ONE, 5.0), Vec3::new(-1.0, -2.0, -0.5).normalize(), Vec3::X, 256);
        for point in CORNERS {
            let seen = perspective.project(point).unwrap();
            assert!(perspective.point(seen.truncate(), seen.z).distance(point) < 1e-4);
            let seen = parallel.project(point).unwrap();
            let (origin, direction) = parallel.ray(seen.truncate());
            assert!((origin - direction * seen.z).distance(point) < 1e-4);
        }
    }
}
