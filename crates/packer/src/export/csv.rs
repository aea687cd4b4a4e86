//! Spheres as a table.

use ist::SpherePacking;
use std::fmt::Write;

/// The spheres as comma-separated values, in the order in which they were placed.
///
/// The first line names the columns: `x,y,z,radius,cell_volume,nx,ny,nz`, in m, m, m, m, m³ and as a unit vector.
/// Takes time linear in the number of spheres.
#[must_use]
pub fn to_csv(packing: &SpherePacking) -> String {
    let mut csv = String::from("x,y,z,radius,cell_volume,nx,ny,nz\n");
    for s in packing.spheres() {
        let (c, n) = (s.center, s.normal);
        // Writing to a string does not fail.
        let _ =
            writeln!(csv, "{},{},{},{},{},{},{},{}", c.x, c.y, c.z, s.radius, s.cell_volume, n.x, n.y, n.z);
    }
    csv
}
