//! A machine part: a mesh at its own size and place, and its spheres.

use anyhow::{Context, Result};
use ist::SpherePacking;
use packer::{PackOptions, Solid, TriangleMesh, pack};
use rapier_ist::IstShape;

/// A solid in its own frame and its packing.
#[derive(Clone, Debug)]
pub struct Part {
    /// Its mesh.
    pub solid: Solid,
    /// Its spheres.
    pub packing: SpherePacking,
}

impl Part {
    /// Packs `mesh` with `spheres` spheres; `name` is for errors and the packing's provenance.
    ///
    /// # Errors
    /// Where the mesh encloses no volume or `spheres` is zero; names the part.
    pub fn new(name: &str, mesh: &TriangleMesh, spheres: usize) -> Result<Self> {
        let build = || -> Result<_> {
            let solid = Solid::new(mesh)?;
            let packing = pack(&solid, &PackOptions::balanced().spheres(spheres).source(name))?.packing;
            Ok(Self { solid, packing })
        };
        build().with_context(|| format!("cannot use the {name}"))
    }

    /// What stands for it in the simulation.
    #[must_use]
    pub fn shape(&self) -> IstShape {
        IstShape::from_packing(&self.packing)
    }
}
