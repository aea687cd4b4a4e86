//! Engines of this workspace.

use crate::engine::{Answer, Engine};
use crate::pair::MeshPair;
use glamx::Pose3;
use ist::reference::{self, ReferenceOverlap};
use ist::{InnerSphereTree, Overlap, OverlapCache, OverlapQuery, OverlapWorkspace};
use std::error::Error;
use std::time::Instant;

/// Inner sphere trees, or their grids; volume, centroid, gradients, force, torque and deepest pair.
pub(crate) struct Spheres {
    name: String,
    query: OverlapQuery,
    /// What the pair remembers from query to query.
    cache: Option<OverlapCache>,
    build_seconds: f64,
    trees: [InnerSphereTree; 2],
    workspace: OverlapWorkspace,
    overlap: Overlap,
}

impl Spheres {
    pub(crate) fn tree(pair: &MeshPair, spheres: usize) -> Result<Self, Box<dyn Error>> {
        Self::new(format!("tree, {spheres} spheres"), ist::Engine::Tree, trees(pair, spheres)?)
    }

    pub(crate) fn cached(pair: &MeshPair, spheres: usize) -> Result<Self, Box<dyn Error>> {
        let name = format!("tree with a cache, {spheres} spheres");
        let cache = Some(OverlapCache::default());
        Ok(Self { cache, ..Self::new(name, ist::Engine::Tree, trees(pair, spheres)?)? })
    }

    pub(crate) fn grid(pair: &MeshPair, spheres: usize) -> Result<Self, Box<dyn Error>> {
        let (trees, seconds) = trees(pair, spheres)?;
        let start = Instant::now();
        let trees = trees.map(|tree| tree.with_grid());
        let seconds = seconds + start.elapsed().as_secs_f64();
        Self::new(format!("grid, {spheres} spheres"), ist::Engine::Grid, (trees, seconds))
    }

    fn new(
        name: String,
        engine: ist::Engine,
        (trees, build_seconds): ([InnerSphereTree; 2], f64),
    ) -> Result<Self, Box<dyn Error>> {
        let query = OverlapQuery { engine, ..OverlapQuery::default() };
        let (workspace, overlap) = Default::default();
        Ok(Self { name, query, cache: None, build_seconds, trees, workspace, overlap })
    }
}

impl Engine for Spheres {
    fn name(&self) -> &str {
        &self.name
    }

    fn build_seconds(&self) -> f64 {
        self.build_seconds
    }

    fn jump(&mut self) {
        self.cache = self.cache.take().map(|_| OverlapCache::default());
    }

    fn query(&mut self, pose: &Pose3) {
        let ([a, b], workspace) = (&self.trees, &mut self.workspace);
        self.overlap = match &mut self.cache {
            Some(cache) => a.overlap_cached(b, pose, self.query, (cache, workspace)),
            None => a.overlap_with(b, pose, self.query, workspace),
        };
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
    let packed = pair.packed(spheres)?;
    let start = Instant::now();
    let [a, b] = packed.packings.each_ref().map(InnerSphereTree::new);
    let trees = [a, b.scaled(pair.scale_b).ok_or("the scale is positive")?];
    Ok((trees, packed.seconds + start.elapsed().as_secs_f64()))
}
