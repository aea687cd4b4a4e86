//! A whole packing as JSON.

use super::ExportError;
use ist::{InnerSphere, SpherePacking};
use serde::Serialize;

#[derive(Serialize)]
struct Packing<'a> {
    provenance: Provenance<'a>,
    coverage: f64,
    solid: Solid,
    spheres: Vec<Sphere>,
}

#[derive(Serialize)]
struct Provenance<'a> {
    generator: &'a str,
    source: &'a str,
    options: &'a str,
}

#[derive(Serialize)]
struct Solid {
    volume: f64,
    centroid: [f64; 3],
    unit_inertia: [[f64; 3]; 3],
}

#[derive(Serialize)]
struct Sphere {
    center: [f32; 3],
    radius: f32,
    cell_volume: f32,
    cell_centroid: [f32; 3],
    normal: [f32; 3],
}

impl From<&InnerSphere> for Sphere {
    fn from(sphere: &InnerSphere) -> Self {
        let InnerSphere { center, radius, cell_volume, cell_centroid, normal } = *sphere;
        Self {
            center: center.to_array(),
            radius,
            cell_volume,
            cell_centroid: cell_centroid.to_array(),
            normal: normal.to_array(),
        }
    }
}

/// The packing as one JSON object.
///
/// `spheres` is a list of `center` (m), `radius` (m), `cell_volume` (m³), `cell_centroid` (m) and `normal`, in the order
/// in which they were placed; `solid` holds `volume` (m³), `centroid` (m) and `unit_inertia` (kg·m², about the centroid, for
/// 1 kg/m³); `provenance` tells the generator, the mesh and the options. Takes time linear in the number of spheres.
///
/// # Errors
/// [`ExportError::Write`] where the writer fails, which no valid packing makes it do.
pub fn to_json(packing: &SpherePacking) -> Result<String, ExportError> {
    let (solid, provenance) = (packing.solid(), packing.provenance());
    let packing = Packing {
        provenance: Provenance {
            generator: &provenance.generator,
            source: &provenance.source,
            options: &provenance.options,
        },
        coverage: packing.coverage(),
        solid: Solid {
            volume: solid.volume,
            centroid: solid.centroid.to_array(),
            unit_inertia: solid.unit_inertia.to_cols_array_2d(),
        },
        spheres: packing.spheres().iter().map(Sphere::from).collect(),
    };
    serde_json::to_string(&packing)
        .map_err(|error| ExportError::Write { format: "JSON", what: error.to_string() })
}
