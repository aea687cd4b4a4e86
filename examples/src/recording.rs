//! How recordings of the scenes name and colour their bodies.

use crate::run::Simulation;
use crate::scenes::single_precision;
use rapier_ist::record::{BodyDescription, RecordError, Recorder};
use std::io::{Seek, Write};

/// Describes the bodies of `simulation`, each with mesh, spheres and colour.
///
/// # Errors
/// Where the recording cannot be written.
pub fn describe<W: Write + Seek>(
    recorder: &mut Recorder<W>,
    simulation: &impl Simulation,
) -> Result<(), RecordError> {
    for body in simulation.bodies() {
        let (vertices, triangles) = single_precision(body.solid);
        let [r, g, b] = body.color;
        let mut description = BodyDescription::new(body.handle, body.name)
            .mesh(&vertices, &triangles)
            .scale(body.scale)
            .color([r, g, b, body.opacity]);
        if let Some(packing) = body.packing {
            description = description.spheres(packing);
        }
        recorder.add_body(&description)?;
    }
    Ok(())
}
