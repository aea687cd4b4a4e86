//! The collider shape: an inner sphere tree as parry sees it.

use ist::{BallKind, FileError, InnerSphereTree, NearestSphere, SpherePacking};
use rapier3d::geometry::{ColliderBuilder, SharedShape};
use rapier3d::glamx::Mat3;
use rapier3d::math::{Real, Vector};
use rapier3d::parry::bounding_volume::{Aabb, BoundingSphere};
use rapier3d::parry::mass_properties::MassProperties;
use rapier3d::parry::query::{PointProjection, PointQuery, Ray, RayCast, RayIntersection};
use rapier3d::parry::shape::{FeatureId, Shape, ShapeType, TypedShape};
use std::path::Path;

/// A solid of any form, as a Rapier collider shape.
///
/// Rapier itself knows nothing of it: install [`crate::IstPlugin`] on the world, or bodies fall through.
/// Cloning is O(1). Its mass properties are those of the solid, not of the spheres.
#[derive(Clone, Debug)]
pub struct IstShape {
    tree: InnerSphereTree,
    bounds: Aabb,
    thickness: Real,
}

impl IstShape {
    /// The solid of `packing`.
    #[must_use]
    pub fn from_packing(packing: &SpherePacking) -> Self {
        Self::new(InnerSphereTree::new(packing))
    }

    /// The solid of an `.ist` file, as the packer writes it.
    ///
    /// # Errors
    /// Where the file cannot be read or is damaged.
    pub fn from_file(path: impl AsRef<Path>) -> Result<Self, FileError> {
        Ok(Self::from_packing(&SpherePacking::load(path)?))
    }

    /// The solid of `tree`.
    #[must_use]
    pub fn new(tree: InnerSphereTree) -> Self {
        let empty = Aabb::new_invalid();
        let bounds = tree.volume_balls().fold(empty, |bounds, (center, radius)| Aabb {
            mins: bounds.mins.min(center - Vector::splat(radius)),
            maxs: bounds.maxs.max(center + Vector::splat(radius)),
        });
        let thickness = thickness(&tree);
        Self { tree, bounds, thickness }
    }

    /// The tree that queries run against.
    #[must_use]
    pub fn tree(&self) -> &InnerSphereTree {
        &self.tree
    }

    /// The same solid `factor` times as large, in O(n log n) for n spheres; `None` unless `factor` is positive and finite, and
    /// where the solid would be too large or too small for f32.
    #[must_use]
    pub fn scaled(&self, factor: Real) -> Option<Self> {
        Some(Self::new(self.tree.scaled(factor)?))
    }

    /// The shape as Rapier's colliders hold it.
    #[must_use]
    pub fn into_shared(self) -> SharedShape {
        SharedShape::new(self)
    }

    /// A collider builder with this shape.
    pub fn into_collider(self) -> ColliderBuilder {
        ColliderBuilder::new(self.into_shared())
    }

    /// How thick the solid is (m): half of its volume is packed with inner spheres of this radius or less.
    pub(crate) fn thickness(&self) -> Real {
        self.thickness
    }

    /// The inner ball nearest to `point`; `None` where the point is not finite or too far away for f32.
    fn nearest_sphere(&self, point: Vector) -> Option<NearestSphere> {
        self.tree.nearest_sphere(point, BallKind::Inner)
    }
}

/// Features are spheres, by their index in the packing.
fn feature(sphere: usize) -> FeatureId {
    FeatureId::Face(sphere as u32)
}

/// Radius below which the inner spheres of `tree` hold half of their volume.
fn thickness(tree: &InnerSphereTree) -> Real {
    let mut radii: Vec<Real> = tree.inner_balls().map(|(_, radius, _)| radius).collect();
    radii.sort_unstable_by(Real::total_cmp);
    let volume = |radius: &Real| radius * radius * radius;
    let half: Real = 0.5 * radii.iter().map(volume).sum::<Real>();
    let mut below = 0.0;
    let reaches_half = |radius: &&Real| {
        below += volume(radius);
        below >= half
    };
    radii.iter().find(reaches_half).copied().unwrap_or(Real::MAX)
}

/// Point queries see the union of the inner balls, in expected time logarithmic in their number.
///
/// A point that is not finite, or farther away than 10¹⁸ times the solid's size, is its own projection and outside.
impl PointQuery for IstShape {
    fn project_local_point(&self, point: Vector, solid: bool) -> PointProjection {
        let Some(nearest) = self.nearest_sphere(point) else { return PointProjection::new(false, point) };
        let is_inside = nearest.distance <= 0.0;
        PointProjection::new(is_inside, if is_inside && solid { point } else { nearest.point })
    }

    fn project_local_point_and_get_feature(&self, point: Vector) -> (PointProjection, FeatureId) {
        let Some(nearest) = self.nearest_sphere(point) else {
            return (PointProjection::new(false, point), FeatureId::Unknown);
        };
        (PointProjection::new(nearest.distance <= 0.0, nearest.point), feature(nearest.sphere))
    }

    fn contains_local_point(&self, point: Vector) -> bool {
        self.tree.contains_point(point, BallKind::Inner)
    }
}

/// Rays see the union of the inner balls, in expected time logarithmic in their number. Nothing is hit where a number is NaN.
impl RayCast for IstShape {
    fn cast_local_ray_and_get_normal(
        &self,
        ray: &Ray,
        max_time_of_impact: Real,
        solid: bool,
    ) -> Option<RayIntersection> {
        let ray = ist::Ray { origin: ray.origin, direction: ray.dir, max_time: max_time_of_impact };
        let hit = self.tree.cast_ray(&ray, solid, BallKind::Inner)?;
        Some(RayIntersection::new(hit.time, hit.normal, feature(hit.sphere)))
    }
}

impl From<IstShape> for SharedShape {
    fn from(shape: IstShape) -> Self {
        shape.into_shared()
    }
}

impl From<IstShape> for ColliderBuilder {
    fn from(shape: IstShape) -> Self {
        shape.into_collider()
    }
}

impl Shape for IstShape {
    fn compute_local_aabb(&self) -> Aabb {
        self.bounds
    }

    fn compute_local_bounding_sphere(&self) -> BoundingSphere {
        let (center, radius) = self.tree.bounding_ball();
        BoundingSphere::new(center, radius)
    }

    fn clone_dyn(&self) -> Box<dyn Shape> {
        Box::new(self.clone())
    }

    /// Uniform positive scales only.
    fn scale_dyn(&self, scale: Vector, _: u32) -> Option<Box<dyn Shape>> {
        let uniform = (scale - Vector::splat(scale.x)).abs().max_element() <= 1e-6 * scale.x.abs();
        if !uniform {
            return None;
        }
        Some(Box::new(self.scaled(scale.x)?))
    }

    /// Exact for the mesh that was packed, however few spheres fill it.
    fn mass_properties(&self, density: Real) -> MassProperties {
        let solid = self.tree.solid();
        let density = f64::from(density);
        let inertia = solid.unit_inertia * density;
        let columns = [inertia.x_axis, inertia.y_axis, inertia.z_axis].map(|c| c.as_vec3());
        MassProperties::with_inertia_matrix(
            solid.centroid.as_vec3(),
            (solid.volume * density) as Real,
            Mat3::from_cols(columns[0], columns[1], columns[2]),
        )
    }

    fn shape_type(&self) -> ShapeType {
        ShapeType::Custom
    }

    fn as_typed_shape(&self) -> TypedShape<'_> {
        TypedShape::Custom(self)
    }

    /// The normal of the sphere of packing index `feature`, a [`FeatureId::Face`], at `point`.
    fn feature_normal_at_point(&self, _: u32, feature: FeatureId, point: Vector) -> Option<Vector> {
        let FeatureId::Face(sphere) = feature else { return None };
        let is_it = |i: &usize| self.tree.packing_index(*i) == sphere as usize;
        let position = (0..self.tree.len()).find(is_it)?;
        let (center, _, normal) = self.tree.inner_balls().nth(position)?;
        (point - center).try_normalize().or(Some(normal))
    }

    fn ccd_thickness(&self) -> Real {
        self.thickness
    }

    fn ccd_angular_thickness(&self) -> Real {
        core::f32::consts::FRAC_PI_4
    }
}
