//! A packing as a robot of one link.
//!
//! The format is that of ROS, the Unified Robot Description Format: lengths in m, masses in kg, inertia in kg·m².
//! It is what tools that plan and simulate with spheres read.

use super::ExportError;
use ist::{InnerSphere, SpherePacking};
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, Event};
use std::io;

/// A URDF document: a robot and its only link, both called `name`.
///
/// Each inner ball is a `<collision>` with a `<sphere>`, in the frame of the mesh and in the order in which they
/// were placed. The `<inertial>` is that of the solid filled with `density` (kg/m³), from the mesh and not from the
/// balls, so that it is the same for any number of them. Takes time linear in the number of spheres.
///
/// Characters that XML cannot hold are replaced in `name`; an empty name becomes `packing`.
///
/// # Errors
/// [`ExportError::InvalidDensity`] unless the density is positive and finite.
///
/// ```
/// use ist::{InnerSphere, SolidProperties, SpherePacking};
/// use packer::export::to_urdf;
///
/// let ball = InnerSphere::solid_ball(glam::Vec3::ZERO, 0.5, glam::Vec3::Z);
/// let packing = SpherePacking::new(vec![ball], SolidProperties::ball(0.5))?;
/// let urdf = to_urdf(&packing, "ball", 1_000.0)?;
/// assert!(urdf.contains(r#"<sphere radius="0.5"/>"#));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn to_urdf(packing: &SpherePacking, name: &str, density: f64) -> Result<String, ExportError> {
    if !(density > 0.0 && density.is_finite()) {
        return Err(ExportError::InvalidDensity { density });
    }
    let failed = |what: String| ExportError::Write { format: "URDF", what };
    let document = document(packing, &valid(name), density).map_err(|error| failed(error.to_string()))?;
    String::from_utf8(document).map_err(|error| failed(error.to_string()))
}

fn document(packing: &SpherePacking, name: &str, density: f64) -> io::Result<Vec<u8>> {
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    xml.create_element("robot").with_attribute(("name", name)).write_inner_content(|xml| {
        xml.create_element("link").with_attribute(("name", name)).write_inner_content(|xml| {
            inertial(xml, packing, density)?;
            packing.spheres().iter().try_for_each(|sphere| collision(xml, sphere))
        })?;
        Ok(())
    })?;
    let mut document = xml.into_inner();
    document.push(b'\n');
    Ok(document)
}

fn inertial(xml: &mut Writer<Vec<u8>>, packing: &SpherePacking, density: f64) -> io::Result<()> {
    let solid = packing.solid();
    let inertia = solid.unit_inertia * density;
    xml.create_element("inertial").write_inner_content(|xml| {
        origin(xml, solid.centroid.to_array())?;
        let mass = (density * solid.volume).to_string();
        xml.create_element("mass").with_attribute(("value", mass.as_str())).write_empty()?;
        let moments = [
            ("ixx", inertia.x_axis.x),
            ("ixy", inertia.x_axis.y),
            ("ixz", inertia.x_axis.z),
            ("iyy", inertia.y_axis.y),
            ("iyz", inertia.y_axis.z),
            ("izz", inertia.z_axis.z),
        ]
        .map(|(name, value)| (name, value.to_string()));
        let attributes = moments.iter().map(|(name, value)| (*name, value.as_str()));
        xml.create_element("inertia").with_attributes(attributes).write_empty()?;
        Ok(())
    })?;
    Ok(())
}

fn collision(xml: &mut Writer<Vec<u8>>, sphere: &InnerSphere) -> io::Result<()> {
    xml.create_element("collision").write_inner_content(|xml| {
        origin(xml, sphere.center.to_array())?;
        xml.create_element("geometry").write_inner_content(|xml| {
            let radius = sphere.radius.to_string();
            xml.create_element("sphere").with_attribute(("radius", radius.as_str())).write_empty()?;
            Ok(())
        })?;
        Ok(())
    })?;
    Ok(())
}

fn origin<T: std::fmt::Display>(xml: &mut Writer<Vec<u8>>, [x, y, z]: [T; 3]) -> io::Result<()> {
    let place = format!("{x} {y} {z}");
    let attributes = [("xyz", place.as_str()), ("rpy", "0 0 0")];
    xml.create_element("origin").with_attributes(attributes).write_empty()?;
    Ok(())
}

/// `name` without the characters that XML 1.0 cannot hold, not even escaped.
fn valid(name: &str) -> String {
    let is_allowed = |c: char| !c.is_control() && !matches!(c, '\u{FFFE}' | '\u{FFFF}');
    let name: String = name.chars().map(|c| if is_allowed(c) { c } else { '_' }).collect();
    if name.is_empty() { "packing".to_owned() } else { name }
}
