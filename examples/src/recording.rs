//! How recordings of the scenes name and colour their bodies.

use crate::palette;
use crate::scenes::{Pile, single_precision};
use rapier_ist::record::{BodyDescription, RecordError, Recorder};
use std::io::{Seek, Write};

/// Describes the bowl and the bodies of `pile`, each with mesh, packing and the colour of its model.
///
/// # Errors
/// Where the recording cannot be written.
pub fn describe_pile<W: Write + Seek>(recorder: &mut Recorder<W>, pile: &Pile) -> Result<(), RecordError> {
    let bowl = single_precision(&pile.bowl_solid);
    let [r, g, b] = palette::NEUTRAL;
    recorder
        .add_body(&BodyDescription::new(pile.bowl, "bowl").mesh(&bowl.0, &bowl.1).color([r, g, b, 0.35]))?;
    let meshes: Vec<_> = pile.models.iter().map(|model| single_precision(&model.solid)).collect();
    for (index, body) in pile.bodies.iter().enumerate() {
        let model = &pile.models[body.model];
        let [r, g, b] = palette::color(body.model);
        let (vertices, triangles) = &meshes[body.model];
        let description = BodyDescription::new(body.handle, format!("{}_{index}", model.name))
            .mesh(vertices, triangles)
            .spheres(&model.packing)
            .scale(body.size)
            .color([r, g, b, 1.0]);
        recorder.add_body(&description)?;
    }
    Ok(())
}
