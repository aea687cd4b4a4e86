//! Shared by the project's tests: exact overlaps to compare with, and a small scene to record.

#[cfg(doctest)]
mod documents;
pub mod fuzzing;

use anyhow::{Context, Result};
use glam::{Quat, Vec3};
use glamx::Pose3;
use ist::{InnerSphere, InnerSphereTree, SpherePacking};
use packer::{PackOptions, Solid, TriangleMesh, pack};
use rapier_ist_examples::scenes::{Pile, PileOptions, asset_folder};
use serde::Deserialize;
use std::path::Path;

/// Exact overlaps of two meshes at many poses, from mesh booleans.
#[derive(Debug, Deserialize)]
pub struct Truth {
    mesh_a: String,
    mesh_b: String,
    /// Size of B relative to its mesh.
    pub scale_b: f32,
    volume_a: f64,
    volume_b: f64,
    /// One entry per pose.
    pub poses: Vec<TruePose>,
}

/// Exact overlap at one pose.
#[derive(Debug, Deserialize)]
pub struct TruePose {
    translation: [f32; 3],
    rotation_xyzw: [f32; 4],
    /// Overlap volume (m³).
    pub volume: f64,
    /// Derivative of the volume by a translation of B (m²), where the meshes overlap.
    pub volume_gradient: Option<[f32; 3]>,
}

/// How much two solids overlap, as a share of the smaller one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Band {
    /// 0.2 to 5 %.
    Shallow,
    /// 5 to 25 %.
    Mid,
    /// More than 25 %.
    Deep,
}

impl Truth {
    /// Reads `tests/data/NAME.json`.
    ///
    /// # Errors
    /// Where the file is missing or no truth file.
    pub fn load(name: &str) -> Result<Self> {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("data/{name}.json"));
        let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
        Ok(serde_json::from_str(&text)?)
    }

    /// Packings of both meshes with `spheres` spheres each.
    ///
    /// # Errors
    /// Where a mesh is missing or cannot be packed.
    pub fn packings(&self, spheres: usize) -> Result<[SpherePacking; 2]> {
        let packing = |mesh: &str| -> Result<SpherePacking> {
            let name = Path::new(mesh).file_name().context("a mesh has a name")?;
            let solid = Solid::new(&TriangleMesh::load(asset_folder().join(name))?)?;
            Ok(pack(&solid, &PackOptions::balanced().spheres(spheres))?.packing)
        };
        Ok([packing(&self.mesh_a)?, packing(&self.mesh_b)?])
    }

    /// Trees of both packings, B at its scale.
    #[must_use]
    pub fn trees(&self, packings: &[SpherePacking; 2]) -> Option<[InnerSphereTree; 2]> {
        let [a, b] = packings.each_ref().map(InnerSphereTree::new);
        Some([a, b.scaled(self.scale_b)?])
    }

    /// Whether an exact volume is that of the whole smaller body.
    #[must_use]
    pub fn is_contained(&self, volume: f64) -> bool {
        volume >= 0.9999 * self.volume_a.min(self.volume_b)
    }

    /// The band of an exact volume; none for touches under 0.2 % and bodies wholly inside.
    #[must_use]
    pub fn band(&self, volume: f64) -> Option<Band> {
        match volume / self.volume_a.min(self.volume_b) {
            share if !(0.002..0.9999).contains(&share) => None,
            share if share <= 0.05 => Some(Band::Shallow),
            share if share <= 0.25 => Some(Band::Mid),
            _ => Some(Band::Deep),
        }
    }
}

impl TruePose {
    /// Pose of B in A's frame.
    #[must_use]
    pub fn pose(&self) -> Pose3 {
        let rotation = Quat::from_array(self.rotation_xyzw).normalize();
        Pose3::from_parts(Vec3::from_array(self.translation), rotation)
    }
}

/// The packing with every power cell cut down to its inner ball: the plain method.
///
/// # Errors
/// Never for a valid packing.
pub fn plain(packing: &SpherePacking) -> Result<SpherePacking> {
    let ball = |s: &InnerSphere| InnerSphere::solid_ball(s.center, s.radius, s.normal);
    Ok(SpherePacking::new(packing.spheres().iter().map(ball).collect(), *packing.solid())?)
}

/// The middle value, or the upper of two; infinite where there is none.
#[must_use]
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::INFINITY)
}

/// Six bones of a hundred spheres each over a bowl, which reach it within a second: quick to make, for tests that make
/// many.
///
/// # Errors
/// Where the project's meshes are missing.
pub fn small_pile() -> Result<Pile> {
    let meshes = ["femur.obj", "pelvis.obj"].map(|name| asset_folder().join(name)).to_vec();
    Pile::new(&PileOptions { bodies: 6, spheres: 100, meshes, ..PileOptions::default() }, |_| ())
}
