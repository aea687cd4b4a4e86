//! A picture of a simulation.

use super::{RunArguments, Simulation};
use crate::render::{Mesh, Scene, Surface};
use anyhow::{Context, Result};

/// Draws the simulation as it is now.
///
/// # Errors
/// Where the file cannot be written.
pub fn draw(simulation: &impl Simulation, arguments: &RunArguments) -> Result<()> {
    let bodies = simulation.bodies();
    let meshes: Vec<Mesh> =
        bodies.iter().map(|body| Mesh::new(body.solid.mesh()).scaled(body.scale)).collect();
    let (mut scene, mut framed) = (Scene::new(), Scene::new());
    let view = simulation.view();
    for scene in [&mut scene, &mut framed] {
        if let Some(plane) = view.cut {
            scene.set_cut(plane);
        }
    }
    for (body, mesh) in bodies.iter().zip(&meshes) {
        let surface = Surface::new(body.color).section(body.section);
        let pose = *simulation.world().bodies[body.handle].position();
        scene.add_mesh(mesh, pose, surface);
        if body.framed {
            framed.add_mesh(mesh, pose, surface);
        }
    }
    if let Some(height) = view.ground {
        scene.set_ground(height);
    }
    simulation.decorate(&mut scene);
    let size = arguments.picture_size();
    let camera = framed.framed_from(view.from, size);
    scene.render(&camera, size).save_png(&arguments.png).context("cannot draw the picture")
}
