//! Two meshes and the poses at which their overlap is known.

use glam::Vec3;
use glamx::Pose3;
use ist::SpherePacking;
use packer::{PackError, PackOptions, Solid, TriangleMesh, pack};
use rapier_ist_examples::scenes::asset_folder;
use rapier_ist_tests::{Band, TruePose, Truth};
use rayon::ThreadPoolBuilder;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::error::Error;
use std::time::Instant;

/// Pairs with exact overlaps in `tests/data`.
pub(crate) const NAMES: [&str; 2] = ["bunny_bunny", "gears"];

/// How much the solids overlap; poses that only touch are left out.
pub(crate) const BANDS: [PoseBand; 4] = [
    PoseBand::Apart,
    PoseBand::Overlapping(Band::Shallow),
    PoseBand::Overlapping(Band::Mid),
    PoseBand::Overlapping(Band::Deep),
];

/// Poses that are measured together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum PoseBand {
    /// The meshes have no volume in common.
    Apart,
    /// They overlap in a certain share of the smaller solid.
    Overlapping(Band),
}

impl PoseBand {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Apart => "apart",
            Self::Overlapping(Band::Shallow) => "shallow",
            Self::Overlapping(Band::Mid) => "mid",
            Self::Overlapping(Band::Deep) => "deep",
        }
    }
}

/// One pose with what is known about it.
pub(crate) struct ExactPose {
    /// B in A's frame.
    pub(crate) pose: Pose3,
    /// Overlap volume (m³).
    pub(crate) volume: f64,
    /// Direction in which the volume shrinks fastest when B moves there.
    pub(crate) descent: Option<Vec3>,
}

/// Two meshes and the poses at which their overlap is known.
pub(crate) struct MeshPair {
    pub(crate) name: &'static str,
    pub(crate) solids: [Solid; 2],
    pub(crate) scale_b: f32,
    truth: Truth,
    packed: RefCell<BTreeMap<usize, Packed>>,
}

/// Packings of both solids, and the seconds that they took on all cores.
#[derive(Clone)]
pub(crate) struct Packed {
    pub(crate) packings: [SpherePacking; 2],
    pub(crate) seconds: f64,
}

impl MeshPair {
    pub(crate) fn load(name: &'static str) -> Result<Self, Box<dyn Error>> {
        let truth = Truth::load(name)?;
        let solid = |mesh: &str| -> Result<Solid, Box<dyn Error>> {
            Ok(Solid::new(&TriangleMesh::load(asset_folder().join(mesh))?)?)
        };
        let [a, b] = match name {
            "gears" => ["spider_gear.obj", "pinion_gear.obj"],
            _ => ["bunny.obj", "bunny.obj"],
        };
        Ok(Self {
            name,
            solids: [solid(a)?, solid(b)?],
            scale_b: truth.scale_b,
            truth,
            packed: RefCell::default(),
        })
    }

    /// Triangles of the larger mesh.
    pub(crate) fn triangles(&self) -> usize {
        self.solids.iter().map(|solid| solid.mesh().triangles.len()).max().unwrap_or(0)
    }

    /// Packings of both solids with `spheres` spheres each, at the size of their meshes; made once.
    pub(crate) fn packed(&self, spheres: usize) -> Result<Packed, Box<dyn Error>> {
        if let Some(packed) = self.packed.borrow().get(&spheres) {
            return Ok(packed.clone());
        }
        let start = Instant::now();
        let all_cores = ThreadPoolBuilder::new().build()?;
        let packing = |solid| -> Result<_, PackError> {
            Ok(pack(solid, &PackOptions::balanced().spheres(spheres))?.packing)
        };
        let [a, b] = &self.solids;
        let packings = all_cores.install(|| Ok::<_, PackError>([packing(a)?, packing(b)?]))?;
        let packed = Packed { packings, seconds: start.elapsed().as_secs_f64() };
        self.packed.borrow_mut().insert(spheres, packed.clone());
        Ok(packed)
    }

    /// The poses of a band, in the order of the file.
    pub(crate) fn poses_in(&self, band: PoseBand) -> Vec<ExactPose> {
        let is_in_band = |pose: &&TruePose| match band {
            PoseBand::Apart => pose.volume == 0.0,
            PoseBand::Overlapping(band) => self.truth.band(pose.volume) == Some(band),
        };
        let exact = |pose: &TruePose| ExactPose {
            pose: pose.pose(),
            volume: pose.volume,
            descent: pose.volume_gradient.map(|gradient| -Vec3::from_array(gradient)),
        };
        self.truth.poses.iter().filter(is_in_band).map(exact).collect()
    }
}
