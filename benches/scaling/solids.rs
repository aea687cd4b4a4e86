//! The solids that are measured: rows of growing sphere counts.
//!
//! Tiles: copies of one packing of a cube on a cubic lattice, which make a larger cube. Radii and shape are the same for
//! every count, so that the row shows the growth with the count and nothing else. Rabbits: packings of one mesh, as users
//! have them. More spheres are smaller spheres there, on more levels.

use crate::ALLOCATOR;
use glam::{DMat3, DVec3, Vec3};
use ist::{InnerSphere, InnerSphereTree, SolidProperties, SphereGrid, SpherePacking};
use packer::{PackOptions, Solid, TriangleMesh, pack, provenance};
use rapier_ist_examples::{scenes::asset_folder, shapes::cuboid};
use stats_alloc::Region;
use std::error::Error;
use std::path::Path;

/// Spheres of one tile.
const TILE: usize = 1_000;
/// Tiles along each edge.
const TILES: [usize; 6] = [1, 2, 3, 5, 7, 10];
/// Spheres of the rabbits.
const RABBITS: [usize; 5] = [1_000, 3_000, 10_000, 30_000, 100_000];
/// Those that take minutes to pack.
const LARGE_RABBITS: [usize; 2] = [300_000, 1_000_000];

/// Solids of one kind.
pub(crate) struct Row {
    pub(crate) name: &'static str,
    /// By growing number of spheres.
    pub(crate) cases: Vec<Case>,
}

/// One solid.
pub(crate) struct Case {
    /// With its grids.
    pub(crate) tree: InnerSphereTree,
    /// What its tree and its grids hold of the allocator's memory (bytes).
    pub(crate) tree_bytes: usize,
    pub(crate) grid_bytes: usize,
}

impl Row {
    pub(crate) fn tiles() -> Result<Self, Box<dyn Error>> {
        let cube = Solid::new(&cuboid(DVec3::splat(0.5)))?;
        let tile = packing("cube", &cube, TILE)?;
        let cases = TILES.into_iter().map(|edge| Ok(Case::new(&lattice(&tile, edge)?)));
        Ok(Self { name: "cube of tiles", cases: cases.collect::<Result<_, Box<dyn Error>>>()? })
    }

    pub(crate) fn rabbits(large: bool) -> Result<Self, Box<dyn Error>> {
        let solid = Solid::new(&TriangleMesh::load(asset_folder().join("bunny.obj"))?)?;
        let large = if large { &LARGE_RABBITS[..] } else { &[] };
        let cases =
            RABBITS.iter().chain(large).map(|&count| Ok(Case::new(&packing("bunny", &solid, count)?)));
        Ok(Self { name: "rabbit", cases: cases.collect::<Result<_, Box<dyn Error>>>()? })
    }
}

impl Case {
    fn new(packing: &SpherePacking) -> Self {
        let (bare, tree_bytes) = measured(|| InnerSphereTree::new(packing));
        let (tree, grid_bytes) = measured(|| bare.with_grid());
        Self { tree, tree_bytes, grid_bytes }
    }

    pub(crate) fn levels(&self) -> usize {
        self.tree.grid().map_or(0, SphereGrid::levels)
    }
}

/// What `build` gives, and the bytes that it holds.
fn measured<T>(build: impl FnOnce() -> T) -> (T, usize) {
    let region = Region::new(ALLOCATOR);
    let built = build();
    let change = region.change();
    (built, change.bytes_allocated - change.bytes_deallocated)
}

/// `edge`³ copies of a packing of the cube from −½ to ½.
fn lattice(tile: &SpherePacking, edge: usize) -> Result<SpherePacking, Box<dyn Error>> {
    let mut spheres = Vec::with_capacity(tile.spheres().len() * edge.pow(3));
    for i in 0..edge.pow(3) {
        let cell = [i % edge, i / edge % edge, i / (edge * edge)];
        let shift = Vec3::from_array(cell.map(|c| c as f32 - 0.5 * (edge as f32 - 1.0)));
        spheres.extend(tile.spheres().iter().map(|sphere| InnerSphere {
            center: sphere.center + shift,
            cell_centroid: sphere.cell_centroid + shift,
            ..*sphere
        }));
    }
    let edge = edge as f64;
    // The inertia of a cube of edge s and unit density is s⁵/6 about any axis through its centroid.
    let unit_inertia = DMat3::from_diagonal(DVec3::splat(edge.powi(5) / 6.0));
    let solid = SolidProperties { volume: edge.powi(3), centroid: DVec3::ZERO, unit_inertia };
    Ok(SpherePacking::new(spheres, solid)?)
}

/// The packing of `solid` with `count` spheres, from the last run if that made the same.
fn packing(name: &str, solid: &Solid, count: usize) -> Result<SpherePacking, Box<dyn Error>> {
    let options = PackOptions::balanced().spheres(count).source(name);
    let wanted = provenance(solid, &options);
    let file = format!("{name} {count} {}.ist", wanted.generator).replace(' ', "-");
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(file);
    // A file that is damaged or another packing is made again.
    if let Ok(packing) = SpherePacking::load(&path)
        && *packing.provenance() == wanted
    {
        return Ok(packing);
    }
    eprintln!("packing {name} with {count} spheres");
    let packing = pack(solid, &options)?.packing;
    std::fs::write(&path, packing.to_bytes())?;
    Ok(packing)
}
