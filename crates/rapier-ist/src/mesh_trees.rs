//! Search trees of the triangle meshes that colliders use.
//!
//! A shape has no place for them, so they are kept beside it, found by the mesh's address: as long as a tree is kept so is its
//! mesh, unchanged, as Rapier copies a shape that others hold before it changes it. Results are the same with a tree and without.

use crate::triangle_tree::TriangleTree;
use rapier3d::geometry::SharedShape;
use rapier3d::parry::shape::TriMesh;
use std::collections::BTreeMap;
use std::ptr::from_ref;
use std::sync::{Arc, PoisonError, RwLock};

/// A mesh gets its tree when bodies have been near it for so many steps in succession: one that changes in every step is not
/// worth it.
const STEPS: u32 = 10;

static TREES: RwLock<BTreeMap<usize, Kept>> = RwLock::new(BTreeMap::new());

/// A mesh with its tree, `None` until it is built.
struct Kept {
    mesh: SharedShape,
    tree: Option<Arc<TriangleTree>>,
}

/// The tree of a mesh, if it has one by now.
pub(crate) fn tree_of(mesh: &TriMesh) -> Option<Arc<TriangleTree>> {
    let trees = TREES.read().unwrap_or_else(PoisonError::into_inner);
    trees.get(&address(mesh))?.tree.clone()
}

/// The meshes that bodies of a world are near to, by address, and for how many steps.
#[derive(Clone, Debug, Default)]
pub(crate) struct NearbyMeshes(BTreeMap<usize, u32>);

impl NearbyMeshes {
    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    /// Counts a step with these shapes near bodies. Has trees made, in the background, and forgets those of meshes that nobody
    /// else has any more.
    pub(crate) fn update<'a>(&mut self, shapes: impl Iterator<Item = &'a SharedShape>) {
        let mut now = BTreeMap::new();
        for shape in shapes {
            let Some(address) = shape.as_trimesh().map(address) else { continue };
            let steps = self.0.get(&address).map_or(1, |steps| steps.saturating_add(1));
            if now.insert(address, steps).is_none() && steps == STEPS {
                keep(shape);
            }
        }
        self.0 = now;
        let is_unused = |kept: &Kept| Arc::strong_count(&kept.mesh.0) == 1;
        if TREES.read().unwrap_or_else(PoisonError::into_inner).values().any(is_unused) {
            TREES.write().unwrap_or_else(PoisonError::into_inner).retain(|_, kept| !is_unused(kept));
        }
    }
}

/// Makes a tree for a mesh that has none, on a thread of its own where there are threads.
fn keep(shape: &SharedShape) {
    let Some(mesh) = shape.as_trimesh() else { return };
    let address = address(mesh);
    let mut trees = TREES.write().unwrap_or_else(PoisonError::into_inner);
    if trees.contains_key(&address) {
        return;
    }
    trees.insert(address, Kept { mesh: shape.clone(), tree: None });
    drop(trees);
    let shape = shape.clone();
    let make = move || {
        let tree = shape.as_trimesh().and_then(TriangleTree::new).map(Arc::new);
        let mut trees = TREES.write().unwrap_or_else(PoisonError::into_inner);
        if let Some(kept) = trees.get_mut(&address) {
            kept.tree = tree;
        }
    };
    let thread = std::thread::Builder::new().name("triangle tree".to_owned()).spawn(make);
    if let Err(error) = thread {
        log::debug!("a triangle mesh goes without its search tree: {error}");
    }
}

fn address(mesh: &TriMesh) -> usize {
    from_ref(mesh).addr()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rapier3d::math::Vector;
    use rapier3d::parry::shape::Cuboid;
    use std::time::{Duration, Instant};

    fn mesh() -> SharedShape {
        let (vertices, triangles) = Cuboid::new(Vector::ONE).to_trimesh();
        SharedShape::trimesh(vertices, triangles).unwrap()
    }

    fn has_tree(shape: &SharedShape) -> bool {
        shape.as_trimesh().and_then(tree_of).is_some()
    }

    /// Trees are made on another thread.
    fn becomes(mut is_so: impl FnMut() -> bool) -> bool {
        let start = Instant::now();
        while !is_so() {
            if start.elapsed() > Duration::from_secs(20) {
                return false;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        true
    }

    #[test]
    fn a_mesh_that_stays_near_gets_a_tree_and_loses_it_with_its_last_owner() {
        let (shape, ball) = (mesh(), SharedShape::ball(1.0));
        let mut nearby = NearbyMeshes::default();
        for _ in 1..STEPS {
            nearby.update([&shape, &ball, &shape].into_iter());
            assert!(!has_tree(&shape));
        }
        // A step away from all bodies: counted anew.
        nearby.update(std::iter::empty());
        for _ in 1..STEPS {
            nearby.update([&shape].into_iter());
        }
        assert!(!has_tree(&shape));
        nearby.update([&shape].into_iter());
        assert!(becomes(|| has_tree(&shape)));
        let place = address(shape.as_trimesh().unwrap());
        drop(shape);
        assert!(becomes(|| {
            nearby.update(std::iter::empty());
            !TREES.read().unwrap().contains_key(&place)
        }));
    }

    /// A mesh that is changed is another one.
    #[test]
    fn a_changed_mesh_has_no_tree() {
        let mut shape = mesh();
        let mut nearby = NearbyMeshes::default();
        for _ in 0..STEPS {
            nearby.update([&shape].into_iter());
        }
        assert!(becomes(|| has_tree(&shape)));
        let kept = shape.clone();
        let changed = shape.make_mut().as_trimesh_mut().unwrap();
        *changed = changed.clone().scaled(Vector::splat(2.0));
        assert!(has_tree(&kept) && !has_tree(&shape));
    }
}
