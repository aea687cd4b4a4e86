//! The readers of mesh files, and what becomes of what they read.
//!
//! Whatever the bytes: an error or triangles. Any triangles get a diagnosis; it says of exactly those that are refused that
//! they are. What bounds a solid bounds one when it is read again, of the same volume. In a packing balls are disjoint
//! and inside, and their cells sum to the solid's volume.

#[path = "../../../crates/packer/tests/common/surface.rs"]
#[allow(dead_code, reason = "the packer's tests need more of it")]
mod surface;

use packer::{MeshError, PackError, PackOptions, Packed, Solid, TriangleMesh, diagnose, pack};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::Duration;

const EXTENSIONS: [&str; 5] = ["obj", "stl", "ply", "gltf", "glb"];
/// Most triangles of a mesh that is packed.
const MOST_TRIANGLES: usize = 64;
/// Most triangles of a mesh that is diagnosed: the file is small, but a polygon of it or a mesh that glTF places many
/// times may have more.
const MOST_DIAGNOSED: usize = 4_096;

/// Reads the bytes as a file of each format.
pub fn check(data: &[u8]) {
    let path = folder().join("mesh");
    if std::fs::write(&path, data).is_err() {
        return;
    }
    for extension in EXTENSIONS {
        match TriangleMesh::load_unchecked(path.with_extension(extension)) {
            Ok(mesh) if mesh.triangles.len() <= MOST_DIAGNOSED => check_mesh(&mesh),
            Ok(_) => {}
            Err(error) => {
                let is_panic =
                    matches!(&error, MeshError::Parse { what, .. } if what == "its reader gave up");
                // The crate gltf is known to: see `load/mod.rs` of the packer, which makes an error of it.
                let may_panic = extension.starts_with("gl");
                assert!(!is_panic || may_panic, "the reader of .{extension} files panicked");
            }
        }
    }
}

/// A folder of this process with one file under a name for each format.
fn folder() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = std::env::temp_dir().join(format!("rapier-ist-fuzz-{}", std::process::id()));
        // Without it every file is missing, and the test for meshes that are read fails.
        let _ = std::fs::create_dir_all(&folder);
        #[cfg(unix)]
        for extension in EXTENSIONS {
            let _ = std::os::unix::fs::symlink(
                folder.join("mesh"),
                folder.join("mesh").with_extension(extension),
            );
        }
        folder
    })
}

/// Diagnosis, solid and packing of `mesh`.
pub fn check_mesh(mesh: &TriangleMesh) {
    let diagnosis = diagnose(mesh);
    let solid = match Solid::new(mesh) {
        Err(error) => {
            let refusal = diagnosis.refusal().map(|refusal| refusal.to_string());
            assert_eq!(refusal, Some(error.to_string()), "{mesh:?}");
            return;
        }
        Ok(solid) => solid,
    };
    assert!(diagnosis.refusal().is_none(), "{mesh:?}");
    assert_eq!(&diagnosis, solid.diagnosis());
    let properties = solid.properties();
    assert!(properties.volume > 0.0 && properties.volume.is_finite());
    assert!(properties.centroid.is_finite() && properties.unit_inertia.is_finite());
    check_again(&solid);
    if mesh.triangles.len() <= MOST_TRIANGLES {
        check_packing(&solid);
    }
}

/// The mended mesh bounds the same solid.
fn check_again(solid: &Solid) {
    let again = match Solid::new(solid.mesh()) {
        Ok(again) => again,
        Err(error) => unreachable!("{error}: what is mended is refused: {:?}", solid.mesh()),
    };
    let (volume, other) = (solid.properties().volume, again.properties().volume);
    let slack = 1e-9 * volume + 1e-13 * solid.size().powi(3);
    assert!((volume - other).abs() <= slack, "{volume} {other} {:?}", solid.mesh());
}

fn check_packing(solid: &Solid) {
    let mut options = PackOptions::fast().spheres(6).time_limit(Duration::from_millis(200));
    options.samples_per_sphere = 16;
    options.measure_quality = false;
    match pack(solid, &options) {
        Ok(packed) => check_certificates(solid, &packed),
        Err(PackError::NothingFits { .. } | PackError::NothingInTime { .. } | PackError::Packing(_)) => {}
        Err(error) => unreachable!("{error}"),
    }
}

fn check_certificates(solid: &Solid, packed: &Packed) {
    let spheres = packed.packing.spheres();
    assert!(packed.report.protrusion <= 0.0 && packed.report.overlap <= 0.0, "{:?}", packed.report);
    for (i, sphere) in spheres.iter().enumerate() {
        let (center, radius) = (sphere.center.as_dvec3(), f64::from(sphere.radius));
        let depth = solid.depth(center);
        assert!(depth >= radius, "ball {i} of {radius} stands at depth {depth}: {:?}", solid.mesh());
        let nearest = surface::distance(solid.surface(), center);
        assert!((nearest - depth).abs() <= 1e-9 * solid.size(), "{depth} is {nearest}: {:?}", solid.mesh());
        for other in &spheres[..i] {
            let gap = center.distance(other.center.as_dvec3()) - radius - f64::from(other.radius);
            assert!(gap >= -1e-12 * radius, "balls overlap by {}: {:?}", -gap, solid.mesh());
        }
    }
    let sum: f64 = spheres.iter().map(|s| f64::from(s.cell_volume)).sum();
    let volume = solid.properties().volume;
    assert!((sum / volume - 1.0).abs() < 1e-6, "cells sum to {sum}, not {volume}: {:?}", solid.mesh());
}
