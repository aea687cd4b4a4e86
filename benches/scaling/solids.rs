//! The solids that are measured: rows of growing sphere counts.
//!
//! Tiles are copies of one packing of a cube. In a bar, one behind the other, they have the same neighbours whatever their
//! number, so that this row shows the growth with the count and nothing else. In a cube more of them lie inside, where
//! spheres have more neighbours. Rabbits are packings of one mesh, as users have them: more spheres are smaller spheres
//! there, on more levels.

use crate::turn::Turn;
use crate::{ALLOCATOR, TURNS};
use glam::{DMat3, DVec3, Vec3};
use ist::{InnerSphere, InnerSphereTree, SolidProperties, SphereGrid, SpherePacking};
use packer::{PackOptions, Solid, TriangleMesh, pack, provenance};
use rapier_ist_examples::{scenes::asset_folder, shapes::cuboid};
use stats_alloc::Region;
use std::error::Error;
use std::path::Path;

/// Spheres of one tile.
const TILE: usize = 1_000;
/// Tiles along each edge of a cube; a bar has as many in all.
const TILES: [usize; 6] = [1, 2, 3, 5, 7, 10];
/// Spheres of the rabbits.
const RABBITS: [usize; 5] = [1_000, 3_000, 10_000, 30_000, 100_000];
/// Those that take minutes to pack.
const LARGE_RABBITS: [usize; 2] = [300_000, 1_000_000];

/// Solids of one kind.
pub(crate) struct Row {
    pub(crate) name: &'static str,
    /// How the two solids lie; the last is drawn.
    pub(crate) turns: &'static [Turn],
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
    pub(crate) fn bars() -> Result<Self, Box<dyn Error>> {
        let cases = tiled(|edge| [edge.pow(3), 1, 1])?;
        // By an angle the ends of a long bar would leave each other.
        Ok(Self { name: "bar of tiles", turns: &[Turn::Radii(0.2)], cases })
    }

    pub(crate) fn cubes() -> Result<Self, Box<dyn Error>> {
        Ok(Self { name: "cube of tiles", turns: &TURNS, cases: tiled(|edge| [edge; 3])? })
    }

    pub(crate) fn rabbits(large: bool) -> Result<Self, Box<dyn Error>> {
        let solid = Solid::new(&TriangleMesh::load(asset_folder().join("bunny.obj"))?)?;
        let large = if large { &LARGE_RABBITS[..] } else { &[] };
        let cases =
            RABBITS.iter().chain(large).map(|&count| Ok(Case::new(&packing("bunny", &solid, count)?)));
        Ok(Self { name: "rabbit", turns: &TURNS, cases: cases.collect::<Result<_, Box<dyn Error>>>()? })
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

/// For each of [`TILES`] as many tiles along the axes as `sides` says.
fn tiled(sides: impl Fn(usize) -> [usize; 3]) -> Result<Vec<Case>, Box<dyn Error>> {
    let cube = Solid::new(&cuboid(DVec3::splat(0.5)))?;
    let tile = packing("cube", &cube, TILE)?;
    TILES.into_iter().map(|edge| Ok(Case::new(&lattice(&tile, sides(edge))?))).collect()
}

/// So many copies of a packing of the cube from −½ to ½ along each axis.
fn lattice(tile: &SpherePacking, sides: [usize; 3]) -> Result<SpherePacking, Box<dyn Error>> {
    let count = sides.iter().product();
    let sizes = Vec3::from_array(sides.map(|side| side as f32));
    let mut spheres = Vec::with_capacity(tile.spheres().len() * count);
    for i in 0..count {
        let cell = [i % sides[0], i / sides[0] % sides[1], i / (sides[0] * sides[1])];
        let shift = Vec3::from_array(cell.map(|c| c as f32)) - 0.5 * (sizes - 1.0);
        spheres.extend(tile.spheres().iter().map(|sphere| InnerSphere {
            center: sphere.center + shift,
            cell_centroid: sphere.cell_centroid + shift,
            ..*sphere
        }));
    }
    let (volume, squares) = (count as f64, sizes.as_dvec3() * sizes.as_dvec3());
    // The inertia of a cuboid of mass m about an axis through its centroid is m/12 of the squares of the two other sides.
    let unit_inertia = DMat3::from_diagonal(volume / 12.0 * (squares.element_sum() - squares));
    let solid = SolidProperties { volume, centroid: DVec3::ZERO, unit_inertia };
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
