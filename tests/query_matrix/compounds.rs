//! Inner sphere trees as parts of compounds, scaled trees, and trees with a skin.

use crate::{BALLS, apart, poses, shapes, solid};
use rapier_ist::{IstDispatcher, IstShape};
use rapier3d::math::{Pose, Real, Rotation, Vector};
use rapier3d::parry::query::details::ShapeCastOptions;
use rapier3d::parry::query::{
    ClosestPoints, ContactManifold, DefaultQueryDispatcher, NonlinearRigidMotion, PersistentQueryDispatcher,
    PointQuery, QueryDispatcher, QueryDispatcherChain, Ray, RayCast,
};
use rapier3d::parry::shape::{Shape, SharedShape};

fn dispatcher() -> QueryDispatcherChain<IstDispatcher, DefaultQueryDispatcher> {
    IstDispatcher.chain(DefaultQueryDispatcher)
}

/// Where the tree stands in its compound.
fn place() -> Pose {
    Pose::from_parts(Vector::new(0.3, -0.2, 0.1), Rotation::from_scaled_axis(Vector::new(0.2, 0.5, -0.3)))
}

fn compound() -> (IstShape, SharedShape) {
    let (tree, _) = solid(&BALLS);
    let compound = SharedShape::compound(vec![(place(), tree.clone().into_shared())]);
    (tree, compound)
}

/// The compound and a shape at `pose` in the tree's frame, in both orders.
fn orders<'a>(
    compound: &'a dyn Shape,
    shape: &'a dyn Shape,
    pose: &Pose,
) -> [(Pose, &'a dyn Shape, &'a dyn Shape); 2] {
    let pose = place() * *pose;
    [(pose, compound, shape), (pose.inverse(), shape, compound)]
}

#[test]
fn a_tree_in_a_compound_answers_as_the_tree_itself() {
    let ((tree, compound), both) = (compound(), dispatcher());
    for (name, shape) in shapes() {
        let shape = shape.as_ref();
        // In the very centre parry's projections hang on the last bit.
        for pose in poses().into_iter().filter(|pose| pose.translation.length() > 0.1) {
            let case = format!("{name} at {:?}", pose.translation);
            let meets = IstDispatcher.intersection_test(&pose, &tree, shape).unwrap().intersecting;
            let distance = IstDispatcher.distance(&pose, &tree, shape).unwrap().distance;
            let contact = IstDispatcher.contact(&pose, &tree, shape, 0.5).unwrap();
            for (pos12, g1, g2) in orders(compound.as_ref(), shape, &pose) {
                if contact.is_none_or(|contact| contact.dist.abs() > 1e-5) {
                    assert_eq!(both.intersection_test(&pos12, g1, g2).unwrap().intersecting, meets, "{case}");
                }
                let error = both.distance(&pos12, g1, g2).unwrap().distance - distance;
                assert!(error.abs() < 1e-4, "{case}: {error}");
                // parry looks at heightfields from their side only, and at all of their triangles.
                if name != "heightfield" {
                    let ours = both.contact(&pos12, g1, g2, 0.5).unwrap();
                    assert_eq!(ours.is_some(), contact.is_some(), "{case}");
                    let error = ours.zip(contact).map_or(0.0, |(a, b)| a.dist - b.dist);
                    assert!(error.abs() < 1e-4, "{case}: {error}");
                }
                match both.closest_points(&pos12, g1, g2, 1.0).unwrap() {
                    ClosestPoints::Intersecting => assert!(distance < 1e-5, "{case}"),
                    ClosestPoints::Disjoint => assert!(distance > 1.0 - 1e-4, "{case}"),
                    ClosestPoints::WithinMargin(p1, p2) => {
                        assert!((apart(p1, pos12 * p2) - f64::from(distance)).abs() < 1e-4, "{case}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_tree_in_a_compound_is_cast_as_the_tree_itself() {
    let ((tree, compound), both) = (compound(), dispatcher());
    let mut hits = 0;
    for (name, shape) in shapes() {
        let shape = shape.as_ref();
        for pose in poses().into_iter().filter(|pose| pose.translation.length() > 0.9) {
            let case = format!("{name} at {:?}", pose.translation);
            let velocity = Vector::new(0.1, -0.2, 0.15) - 0.7 * pose.translation;
            let options = ShapeCastOptions { max_time_of_impact: 3.0, ..Default::default() };
            let alone = IstDispatcher.cast_shapes(&pose, velocity, &tree, shape, options).unwrap();
            let pos12 = place() * pose;
            let turned = place().rotation * velocity;
            let ours = both.cast_shapes(&pos12, turned, compound.as_ref(), shape, options).unwrap();
            assert_eq!(ours.is_some(), alone.is_some(), "{case}");
            let still = NonlinearRigidMotion::constant_position(Pose::IDENTITY);
            let moves = NonlinearRigidMotion::new(pos12, Vector::ZERO, turned, Vector::ZERO);
            let nonlinear =
                both.cast_shapes_nonlinear(&still, compound.as_ref(), &moves, shape, 0.0, 3.0, true).unwrap();
            let swapped =
                both.cast_shapes_nonlinear(&moves, shape, &still, compound.as_ref(), 0.0, 3.0, true).unwrap();
            for other in [nonlinear, swapped, ours] {
                let (Some(alone), Some(other)) = (alone, other) else { continue };
                hits += 1;
                let error = alone.time_of_impact - other.time_of_impact;
                // Nonlinear casts stop a thousandth of the thickness early.
                assert!(error.abs() < 2e-3, "{case}: {error}");
            }
        }
    }
    assert!(hits > 100, "{hits}");
}

#[test]
fn rays_and_points_see_a_tree_in_a_compound() {
    let (tree, compound) = compound();
    for i in 0..300 {
        let i = i as Real;
        let point = Vector::new((i * 0.7).sin(), (i * 1.3).cos(), (i * 2.1).sin());
        let (ours, alone) = (
            compound.project_point(&Pose::IDENTITY, place() * point, true),
            tree.project_local_point(point, true),
        );
        assert_eq!(ours.is_inside, alone.is_inside);
        assert!(ours.point.distance(place() * alone.point) < 1e-5);
        let towards = Vector::new(0.2, 0.1, -0.1) - point;
        let alone = tree.cast_local_ray(&Ray::new(point * 2.0, towards), 10.0, true);
        let ray = Ray::new(place() * (point * 2.0), place().rotation * towards);
        let ours = compound.cast_local_ray(&ray, 10.0, true);
        assert_eq!(ours.is_some(), alone.is_some());
        assert!(ours.zip(alone).is_none_or(|(a, b)| (a - b).abs() < 1e-4));
    }
}

#[test]
fn the_nearest_part_of_a_compound_counts() {
    let ((tree, _), both) = (solid(&BALLS), dispatcher());
    let far = Pose::translation(0.0, 3.0, 0.0);
    let parts = vec![(Pose::IDENTITY, tree.clone().into_shared()), (far, SharedShape::ball(0.5))];
    let compound = SharedShape::compound(parts);
    let ball = SharedShape::ball(0.1);
    for height in [0.0, 1.0, 1.5, 2.0, 3.0, 4.0] {
        let pose = Pose::translation(0.3, height, 0.1);
        let of_tree = IstDispatcher.distance(&pose, &tree, ball.as_ref()).unwrap().distance;
        let of_ball = (pose.translation.distance(far.translation) - 0.6).max(0.0);
        let ours = both.distance(&pose, compound.as_ref(), ball.as_ref()).unwrap().distance;
        assert!((ours - of_tree.min(of_ball)).abs() < 1e-4, "{height}: {ours} {of_tree} {of_ball}");
    }
}

#[test]
fn parts_have_manifolds_with_every_shape() {
    let ((_, compound), both) = (compound(), dispatcher());
    for (name, shape) in shapes() {
        let mut met = 0;
        for pose in poses() {
            for (pos12, g1, g2) in orders(compound.as_ref(), shape.as_ref(), &pose) {
                let mut manifolds: Vec<ContactManifold<(), ()>> = Vec::new();
                both.contact_manifolds(&pos12, g1, g2, 0.01, &mut manifolds, &mut None).unwrap();
                for manifold in &manifolds {
                    let [p1, p2] = [manifold.subshape_pos1(), manifold.subshape_pos2()]
                        .map(|p| p.copied().unwrap_or_default());
                    for point in &manifold.points {
                        met += 1;
                        let between = pos12 * (p2 * point.local_p2) - p1 * point.local_p1;
                        let normal = p1.rotation * manifold.local_n1;
                        assert!((between.dot(normal) - point.dist).abs() < 1e-4, "{name}: {point:?}");
                        let other = pos12.rotation * (p2.rotation * manifold.local_n2);
                        assert!(apart(other, -normal) < 1e-4, "{name}");
                    }
                }
            }
        }
        assert!(met > 0, "{name} has no contacts");
    }
}

#[test]
fn custom_shapes_of_others_are_left_to_others() {
    let ((_, compound), other) = (compound(), Foreign);
    assert!(IstDispatcher.distance(&Pose::IDENTITY, compound.as_ref(), &other).is_err());
    assert!(IstDispatcher.distance(&Pose::IDENTITY, &other, compound.as_ref()).is_err());
}

#[test]
fn scaled_trees_answer_as_trees_of_scaled_balls() {
    for scale in [0.1, 3.0] {
        let scaled = solid(&BALLS).0.scaled(scale).unwrap();
        let (tree, _) = solid(&BALLS.map(|(center, radius)| (center * scale, radius * scale)));
        for (name, shape) in shapes() {
            for pose in poses() {
                let contacts = [&scaled, &tree].map(|tree| {
                    IstDispatcher.contact(&pose, tree, shape.as_ref(), Real::MAX).unwrap().unwrap()
                });
                let error = contacts[0].dist - contacts[1].dist;
                assert!(error.abs() < 1e-5, "{name} at {}: {error}", pose.translation);
                let manifolds = [&scaled, &tree].map(|tree| deepest(tree, shape.as_ref(), &pose));
                assert_eq!(manifolds[0].is_some(), manifolds[1].is_some(), "{name} at {}", pose.translation);
                let error = manifolds[0].zip(manifolds[1]).map_or(0.0, |(a, b)| a - b);
                assert!(error.abs() < 1e-4, "{name} at {}: {error}", pose.translation);
            }
        }
    }
}

#[test]
fn a_skin_belongs_to_contact_manifolds_and_boxes_and_to_nothing_else() {
    let (bare, _) = solid(&BALLS);
    let skinned = IstShape::new(bare.tree().with_skin(0.05).unwrap());
    let growth = skinned.compute_local_aabb().extents() - bare.compute_local_aabb().extents();
    assert!(growth.distance(Vector::splat(0.1)) < 1e-5);
    let (mut gaps, mut reached) = (0, 0);
    for (name, shape) in shapes() {
        let shape = shape.as_ref();
        for pose in poses() {
            let [with, without] =
                [&skinned, &bare].map(|tree| IstDispatcher.distance(&pose, tree, shape).unwrap().distance);
            assert_eq!(with, without, "{name}");
            let [with, without] = [&skinned, &bare].map(|tree| deepest(tree, shape, &pose));
            match (with, without) {
                (Some(with), Some(without)) if with > 0.0 => {
                    gaps += 1;
                    assert!((without - with - 0.05).abs() < 1e-4, "{name}: {with} {without}");
                }
                (Some(with), Some(_)) => assert!(with <= 0.0, "{name}: {with}"),
                (Some(_), None) => reached += 1,
                (None, _) => assert_eq!(without, None, "{name}"),
            }
        }
    }
    assert!(gaps > 0 && reached > 0, "{gaps} {reached}");
}

/// Least distance of the manifolds' points within 0.1 m.
fn deepest(tree: &IstShape, shape: &dyn Shape, pose: &Pose) -> Option<Real> {
    let mut manifolds: Vec<ContactManifold<(), ()>> = Vec::new();
    IstDispatcher.contact_manifolds(pose, tree, shape, 0.1, &mut manifolds, &mut None).unwrap();
    manifolds.iter().flat_map(|m| m.points.iter().map(|point| point.dist)).min_by(Real::total_cmp)
}

/// A custom shape that is not ours: a ball.
#[derive(Clone, Debug)]
struct Foreign;

impl PointQuery for Foreign {
    fn project_local_point(&self, point: Vector, solid: bool) -> rapier3d::parry::query::PointProjection {
        SharedShape::ball(1.0).project_local_point(point, solid)
    }

    fn project_local_point_and_get_feature(
        &self,
        point: Vector,
    ) -> (rapier3d::parry::query::PointProjection, rapier3d::parry::shape::FeatureId) {
        SharedShape::ball(1.0).project_local_point_and_get_feature(point)
    }
}

impl RayCast for Foreign {
    fn cast_local_ray_and_get_normal(
        &self,
        _: &Ray,
        _: Real,
        _: bool,
    ) -> Option<rapier3d::parry::query::RayIntersection> {
        None
    }
}

impl Shape for Foreign {
    fn compute_local_aabb(&self) -> rapier3d::parry::bounding_volume::Aabb {
        SharedShape::ball(1.0).compute_local_aabb()
    }

    fn compute_local_bounding_sphere(&self) -> rapier3d::parry::bounding_volume::BoundingSphere {
        SharedShape::ball(1.0).compute_local_bounding_sphere()
    }

    fn clone_dyn(&self) -> Box<dyn Shape> {
        Box::new(self.clone())
    }

    fn scale_dyn(&self, _: Vector, _: u32) -> Option<Box<dyn Shape>> {
        None
    }

    fn mass_properties(&self, density: Real) -> rapier3d::parry::mass_properties::MassProperties {
        SharedShape::ball(1.0).mass_properties(density)
    }

    fn shape_type(&self) -> rapier3d::parry::shape::ShapeType {
        rapier3d::parry::shape::ShapeType::Custom
    }

    fn as_typed_shape(&self) -> rapier3d::parry::shape::TypedShape<'_> {
        rapier3d::parry::shape::TypedShape::Custom(self)
    }

    fn ccd_thickness(&self) -> Real {
        1.0
    }

    fn ccd_angular_thickness(&self) -> Real {
        0.0
    }
}
