//! Contact manifolds, for Rapier's solver and events.

use super::pair::{Other, Pair};
use super::patch::Patch;
use super::workspace::{Workspace, with_workspace};
use crate::against_shape;
use ist::{BallKind, InnerSphereTree};
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::query::Unsupported;
use rapier3d::parry::query::details::VoxelsShapeContactManifoldsWorkspace;
use rapier3d::parry::query::{ContactManifold, ContactManifoldsWorkspace, TrackedContact};
use rapier3d::parry::shape::{PackedFeatureId, Shape};

/// Where shapes do not overlap yet, what lies within this share of the solid's thickness of the nearest place belongs to the
/// contact. Not tuned.
const MARGIN: Real = 0.1;

/// Patches of one normal belong to one manifold: 45°, as samples that are near each other do.
const SAME_DIRECTION: Real = 0.7;

/// Whether a contact is divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Division {
    /// A patch for each connected region and direction.
    Regions,
    /// One for all.
    Whole,
}

/// Calls `act` with the patches of two shapes of which at least one is an inner sphere tree, in the first one's frame: of the
/// overlap of volume balls, and where there is none, of what is nearer than `prediction`.
pub(super) fn with_patches<T>(
    pos12: &Pose,
    (g1, g2): (&dyn Shape, &dyn Shape),
    prediction: Real,
    division: Division,
    act: impl FnOnce(&[Patch]) -> T,
) -> Result<T, Unsupported> {
    let pair = Pair::new(g1, g2)?;
    if !pos12.is_finite() {
        return Ok(act(&[]));
    }
    let pose = pair.pose(pos12);
    let overlaps = with_workspace(|workspace| {
        pair.measure(pair.tree, &pose, workspace);
        workspace.divide(division);
        !workspace.patches.is_empty()
    });
    let gap = if overlaps { None } else { pair.gap(pos12, BallKind::Volume, prediction) };
    Ok(with_workspace(|workspace| {
        if let Some(gap) = &gap {
            pair.find_near(&pose, gap.gap, workspace);
            workspace.divide(division);
            let least = workspace.patches.iter().map(Patch::least_distance).fold(Real::MAX, Real::min);
            for patch in &mut workspace.patches {
                *patch = patch.moved_apart(gap.gap.max(0.0) - least);
            }
        }
        if pair.is_swapped {
            for patch in &mut workspace.patches {
                *patch = patch.swapped(pos12);
            }
        }
        if let (Some(gap), true) = (gap, workspace.patches.is_empty()) {
            workspace.patches.push(Patch::single(gap.points, gap.normal, gap.gap.max(0.0)));
        }
        workspace.patches.retain(|patch| patch.least_distance() < prediction);
        act(&workspace.patches)
    }))
}

/// Where two shapes touch, or the nearest place within `prediction`, as a patch of one point. `last` has the points of the last
/// time, each in its shape's frame.
///
/// Tells that the shapes are in contact without measuring their overlap, and mostly without looking for the deepest place:
/// shapes that touched somewhere mostly still touch there.
pub(super) fn detected_patch(
    pos12: &Pose,
    (g1, g2): (&dyn Shape, &dyn Shape),
    prediction: Real,
    last: Option<[Vector; 2]>,
) -> Result<Option<Patch>, Unsupported> {
    let pair = Pair::new(g1, g2)?;
    let there = last.and_then(|last| pair.gap_at(pos12, last)).filter(|gap| gap.gap < prediction);
    let gap = match there {
        Some(gap) if gap.gap < 0.0 => there,
        Some(gap) => pair.gap(pos12, BallKind::Volume, gap.gap).or(there),
        None => pair.gap(pos12, BallKind::Volume, prediction),
    };
    Ok(gap.map(|gap| Patch::single(gap.points, gap.normal, gap.gap)))
}

impl Pair<'_> {
    /// Samples of the overlap of `tree`, in its frame.
    fn measure(&self, tree: &InnerSphereTree, pose: &Pose, workspace: &mut Workspace) {
        workspace.samples.clear();
        match self.other {
            Other::Tree(other) => {
                tree.flush_contact_samples(other, pose, &mut workspace.overlap, &mut workspace.samples);
            }
            Other::Shape(shape) => {
                against_shape::contact_samples(tree, shape, pose, &mut workspace.samples);
            }
        }
    }

    /// Samples of the overlap under a skin that reaches `gap` (m) and a margin farther.
    fn find_near(&self, pose: &Pose, gap: Real, workspace: &mut Workspace) {
        workspace.samples.clear();
        let skin = self.tree.skin() + gap.max(0.0) + MARGIN * self.thickness;
        if let Some(tree) = self.tree.with_skin(skin) {
            self.measure(&tree, pose, workspace);
        }
    }
}

impl Workspace {
    /// Finds the patches of its samples.
    fn divide(&mut self, division: Division) {
        let Self { samples, regions, patches, .. } = self;
        patches.clear();
        samples.retain(|sample| sample.volume > 0.0);
        match division {
            Division::Regions => regions.divide(samples, |region| patches.extend(Patch::of(region))),
            Division::Whole => patches.extend(Patch::of(samples)),
        }
    }
}

/// One manifold for each of `patches`, at least one, in the order of the patches: each the one of the last time that it continues.
pub(super) fn write_manifolds<ManifoldData, ContactData>(
    patches: &[Patch],
    (pos12, prediction): (&Pose, Real),
    manifolds: &mut Vec<ContactManifold<ManifoldData, ContactData>>,
    workspace: &mut Option<ContactManifoldsWorkspace>,
) where
    ManifoldData: Default + Clone,
    ContactData: Default + Copy,
{
    let is_one = manifolds.len() <= 1 && patches.len() <= 1;
    for (position, patch) in patches.iter().enumerate() {
        let found = continued(manifolds, (position, patch), is_one).unwrap_or_else(|| {
            manifolds.push(ContactManifold::new());
            manifolds.len() - 1
        });
        manifolds.swap(position, found);
        write_manifold(Some(patch), (pos12, prediction), &mut manifolds[position]);
    }
    if patches.is_empty() {
        manifolds.resize_with(1, ContactManifold::new);
        write_manifold(None, (pos12, prediction), &mut manifolds[0]);
    }
    manifolds.truncate(patches.len().max(1));
    if is_one {
        *workspace = None;
    } else {
        mark_unordered(workspace);
    }
}

/// Tells Rapier that the pair's manifolds are not those of the last time.
///
/// Rapier keeps positions of manifolds in their list from step to step, unless the pair has a workspace; then it looks
/// for them anew. So there must be one wherever the number of manifolds is or was not one. It is one of parry's, as worlds
/// with a custom one could be saved but not loaded; nothing is in it.
pub(super) fn mark_unordered(workspace: &mut Option<ContactManifoldsWorkspace>) {
    workspace.get_or_insert_with(|| VoxelsShapeContactManifoldsWorkspace::<2>::new().into());
}

/// Position of the manifold from `position` on that `patch` continues: of those that push in its direction the nearest. One
/// manifold of one patch always goes on.
fn continued<ManifoldData, ContactData>(
    manifolds: &[ContactManifold<ManifoldData, ContactData>],
    (position, patch): (usize, &Patch),
    is_one: bool,
) -> Option<usize> {
    let place = patch.points().first()?.middle;
    let distance = |index: usize| {
        let first = manifolds[index].points.first();
        first.map_or(Real::MAX, |first| first.local_p1.distance_squared(place))
    };
    (position..manifolds.len())
        .filter(|&index| is_one || manifolds[index].local_n1.dot(patch.normal) >= SAME_DIRECTION)
        .min_by(|&i, &j| distance(i).total_cmp(&distance(j)))
}

/// Replaces the points of `manifold` by those of `patch`, which keep the impulses of the nearest old ones, each of one that is
/// nearer than `prediction`.
pub(super) fn write_manifold<ManifoldData, ContactData>(
    patch: Option<&Patch>,
    (pos12, prediction): (&Pose, Real),
    manifold: &mut ContactManifold<ManifoldData, ContactData>,
) where
    ContactData: Default + Copy,
{
    let Some(patch) = patch else { return manifold.clear() };
    let normal = patch.normal;
    manifold.local_n1 = normal;
    manifold.local_n2 = -(pos12.rotation.inverse() * normal);
    let old = manifold.points.len();
    for point in patch.points().iter().filter(|point| point.distance < prediction) {
        let [p1, p2] = point.ends(normal);
        let p2 = pos12.inverse_transform_point(p2);
        let face = PackedFeatureId::face(0);
        manifold.points.push(TrackedContact::new(p1, p2, face, face, point.distance));
    }
    let (before, now) = manifold.points.split_at_mut(old);
    for point in now {
        let distance = |old: &TrackedContact<ContactData>| old.local_p1.distance_squared(point.local_p1);
        // Taken ones have been moved out of the way.
        let nearest = before.iter_mut().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        if let Some(nearest) = nearest.filter(|old| distance(old) < prediction * prediction) {
            point.data = nearest.data;
            nearest.local_p1 = rapier3d::math::Vector::INFINITY;
        }
    }
    manifold.points.drain(..old);
}
