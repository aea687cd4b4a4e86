//! What is in the picture.

use super::{Camera, Image, Mesh};
use super::{camera, shade};
use glam::Vec3;
use glamx::Pose3;

/// Things to draw, in metres, y upwards.
#[derive(Clone, Debug, Default)]
pub struct Scene<'a> {
    pub(super) meshes: Vec<PlacedMesh<'a>>,
    pub(super) balls: Vec<Ball>,
    pub(super) surfaces: Vec<Surface>,
    pub(super) ground: Option<f32>,
    pub(super) cut: Option<CutPlane>,
    pub(super) water: Option<WaterBlock>,
}

#[derive(Clone, Debug)]
pub(super) struct PlacedMesh<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) pose: Pose3,
    pub(super) surface: u32,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    pub(super) center: Vec3,
    pub(super) radius: f32,
    pub(super) surface: u32,
}

/// Colour of a thing, and what the cut plane does to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    pub(super) color: [f32; 3],
    pub(super) section: Section,
}

/// What the cut plane does to a thing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Section {
    /// Nothing: it stays whole.
    #[default]
    Whole,
    /// What lies beyond the plane is taken away and the inside shows. Balls go wholly or stay wholly, by their
    /// centre.
    Hollow,
    /// What lies beyond the plane is taken away and the cut face closed, as through solid material. Whatever lies
    /// inside the material would show through.
    Capped,
}

/// The half-space that is taken away from things with a [`Section`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutPlane {
    /// A point of the plane (m).
    pub point: Vec3,
    /// Unit vector towards what is taken away.
    pub normal: Vec3,
}

/// A box of clear water.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaterBlock {
    /// Its lower corner (m).
    pub lower: Vec3,
    /// Its upper corner (m): the surface lies at this height.
    pub upper: Vec3,
}

/// Width and height of a picture in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureSize {
    /// Pixels from left to right.
    pub width: u32,
    /// Pixels from top to bottom.
    pub height: u32,
}

impl PictureSize {
    /// 1280 × 720.
    pub const HD: Self = Self { width: 1280, height: 720 };

    /// 16:9, `width` pixels wide.
    #[must_use]
    pub fn wide(width: u32) -> Self {
        Self { width, height: width * 9 / 16 }
    }

    pub(super) fn aspect(self) -> f32 {
        self.width.max(1) as f32 / self.height.max(1) as f32
    }
}

impl Surface {
    /// A matt surface of an sRGB colour, 0 to 1 each, that the cut plane leaves whole.
    #[must_use]
    pub fn new(color: [f32; 3]) -> Self {
        Self { color, section: Section::Whole }
    }

    /// The surface, cut as `section` says.
    #[must_use]
    pub fn section(mut self, section: Section) -> Self {
        self.section = section;
        self
    }
}

impl CutPlane {
    /// Distance of `point` beyond the plane (m); negative for what stays.
    pub(super) fn beyond(&self, point: Vec3) -> f32 {
        (point - self.point).dot(self.normal)
    }
}

impl<'a> Scene<'a> {
    /// Nothing yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Places a mesh.
    pub fn add_mesh(&mut self, mesh: &'a Mesh, pose: Pose3, surface: Surface) {
        if pose.is_finite() {
            let surface = self.add_surface(surface);
            self.meshes.push(PlacedMesh { mesh, pose, surface });
        }
    }

    /// Places balls, given as centre and radius (m) in the frame of `pose`.
    pub fn add_balls(&mut self, balls: impl IntoIterator<Item = (Vec3, f32)>, pose: Pose3, surface: Surface) {
        let surface = self.add_surface(surface);
        let placed = balls.into_iter().map(|(center, radius)| Ball {
            center: pose.transform_point(center),
            radius,
            surface,
        });
        self.balls.extend(placed.filter(|ball| ball.center.is_finite() && ball.radius.is_finite()));
    }

    fn add_surface(&mut self, surface: Surface) -> u32 {
        self.surfaces.push(surface);
        self.surfaces.len() as u32 - 1
    }

    /// Lays an endless ground at the given height (m), which catches shadows.
    pub fn set_ground(&mut self, height: f32) {
        self.ground = Some(height);
    }

    /// Cuts all things whose surface has a [`Section`].
    pub fn set_cut(&mut self, plane: CutPlane) {
        let normal = plane.normal.normalize_or_zero();
        self.cut = Some(CutPlane { normal, ..plane });
    }

    /// Fills a box with clear water. It tints what is seen through it, and casts no shadow.
    pub fn set_water(&mut self, water: WaterBlock) {
        self.water = Some(water);
    }

    /// A camera in direction `from` that has the whole scene in its picture.
    #[must_use]
    pub fn framed_from(&self, from: Vec3, size: PictureSize) -> Camera {
        Camera::framing(&self.outline(), from, size)
    }

    /// The picture that `camera` takes.
    #[must_use]
    pub fn render(&self, camera: &Camera, size: PictureSize) -> Image {
        shade::render(self, camera, size)
    }

    /// Points whose convex hull holds everything that is drawn but the ground, give or take a triangle.
    fn outline(&self) -> Vec<Vec3> {
        let vertices = self.meshes.iter().flat_map(|placed| {
            let vertices =
                placed.mesh.positions.iter().map(|&position| placed.pose.transform_point(position));
            vertices.map(|vertex| (vertex, placed.surface))
        });
        let corners = self.balls.iter().flat_map(|ball| {
            let ends = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| axis * ball.radius);
            ends.into_iter()
                .flat_map(|end| [(ball.center + end, ball.surface), (ball.center - end, ball.surface)])
        });
        let stays = |point: Vec3, surface: u32| {
            let whole = self.surfaces[surface as usize].section == Section::Whole;
            whole || self.cut.is_none_or(|plane| plane.beyond(point) <= 0.0)
        };
        let stays =
            |(point, surface): (Vec3, u32)| (point.is_finite() && stays(point, surface)).then_some(point);
        vertices.chain(corners).filter_map(stays).collect()
    }

    /// Centre and radius of a ball around everything but the ground.
    pub(super) fn extent(&self) -> (Vec3, f32) {
        let outline = self.outline();
        let (lower, upper) = camera::bounds(&outline).unwrap_or((Vec3::NEG_ONE, Vec3::ONE));
        let center = (lower + upper) / 2.0;
        let radius = outline.iter().map(|point| point.distance(center)).fold(0.0, f32::max);
        (center, radius.max(1e-6))
    }
}
