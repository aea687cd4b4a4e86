//! Engines of this workspace.

use crate::engine::{Answer, Engine};
use crate::pair::MeshPair;
use glamx::Pose3;
use ist::reference::{self, ReferenceOverlap};
use ist::{InnerSphereTree, Overlap, OverlapWorkspace};
use std::error::Error;
use std::time::Instant;

/// Inner sphere trees; volume, centroid, gradients, force and torque.
pub(crate) struct Tree {
    name: String,
    build_seconds: f64,
    trees: [InnerSphereTree; 2],
    workspace: OverlapWorkspace,
    overlap: Overlap,
}

impl Tree {
    pub(crate) fn new(pair: &MeshPair, spheres: usize) -> Result<Self, Box<dyn Error>> {
        let (trees, build_seconds) = trees(pair, spheres)?;
        let (workspace, overlap) = Default::default();
        Ok(Self { name: format!("tree, {spheres} spheres"), build_seconds, trees, workspace, overlap })
    }
}

impl Engine for Tree {
    fn name(&self) -> &str {
        &self.name
    }

    fn build_seconds(&self) -> f64 {
        self.build_seconds
    }

    fn query(&mut self, pose: &Pose3) {
        self.overlap = self.trees[0].overlap(&self.trees[1], pose, &mut self.workspace);
    }

    fn answer(&self) -> Answer {
        Answer {
            volume: Some(f64::from(self.overlap.volume)),
            push: self.overlap.force,
            pairs: Some(self.overlap.pairs),
        }
    }
}

/// Every sphere of A against every sphere of B, in double precision; volume, centroid, gradients.
pub(crate) struct BruteForce {
    name: String,
    build_seconds: f64,
    trees: [InnerSphereTree; 2],
    overlap: ReferenceOverlap,
}

impl BruteForce {
    pub(crate) fn new(pair: &MeshPair, spheres: usize) -> Result<Self, Box<dyn Error>> {
        let (trees, build_seconds) = trees(pair, spheres)?;
        let name = format!("brute force, {spheres} spheres");
        Ok(Self { name, build_seconds, trees, overlap: ReferenceOverlap::default() })
    }
}

impl Engine for BruteForce {
    fn name(&self) -> &str {
        &self.name
    }

    fn build_seconds(&self) -> f64 {
        self.build_seconds
    }

    fn query(&mut self, pose: &Pose3) {
        self.overlap = reference::overlap(&self.trees[0], &self.trees[1], pose);
    }

    fn answer(&self) -> Answer {
        Answer {
            volume: Some(self.overlap.volume),
            push: -self.overlap.gradient.as_vec3(),
            pairs: Some(self.overlap.pairs),
        }
    }
}

fn trees(pair: &MeshPair, spheres: usize) -> Result<([InnerSphereTree; 2], f64), Box<dyn Error>> {
    let start = Instant::now();
    let [a, b] = pair.packings(spheres)?.each_ref().map(InnerSphereTree::new);
    let trees = [a, b.scaled(pair.scale_b).ok_or("the scale is positive")?];
    Ok((trees, start.elapsed().as_secs_f64()))
}
