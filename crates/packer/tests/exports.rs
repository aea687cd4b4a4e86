//! Exported packings, read back by parsers that did not write them.
#![cfg(feature = "export")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail by panicking")]

use glam::{DMat3, DVec3, Vec3};
use ist::{InnerSphere, SolidProperties, SpherePacking};
use packer::export::{ExportError, to_csv, to_json, to_urdf};
use roxmltree::{Document, Node};

/// Three balls in a solid without any symmetry, with numbers that have no short decimal form.
fn packing() -> SpherePacking {
    let sphere = |x: f32, radius: f32| InnerSphere {
        center: Vec3::new(x, x / 3.0, -x / 7.0),
        radius,
        cell_volume: 5.0 * radius.powi(3),
        cell_centroid: Vec3::new(x, x / 2.9, -x / 7.1),
        normal: Vec3::new(0.6, 0.0, -0.8),
    };
    let spheres = vec![sphere(0.1, 1.0 / 3.0), sphere(2.0, 0.7), sphere(-3.0e-7, 1.0e-9)];
    let solid = SolidProperties {
        volume: 2.0 / 3.0,
        centroid: DVec3::new(0.1, -0.2, 1.0 / 3.0),
        unit_inertia: DMat3::from_cols_array(&[3.0, 0.1, 0.2, 0.1, 4.0, 0.3, 0.2, 0.3, 5.0]),
    };
    SpherePacking::new(spheres, solid).unwrap()
}

fn child<'a>(node: Node<'a, 'a>, name: &str) -> Node<'a, 'a> {
    let mut found = node.children().filter(|child| child.has_tag_name(name));
    let first = found.next().unwrap_or_else(|| panic!("no <{name}>"));
    assert!(found.next().is_none(), "two of <{name}>");
    first
}

fn number(node: Node, attribute: &str) -> f64 {
    node.attribute(attribute).unwrap().parse().unwrap()
}

fn origin(node: Node) -> [f64; 3] {
    let text = child(node, "origin").attribute("xyz").unwrap();
    let numbers: Vec<f64> = text.split(' ').map(|part| part.parse().unwrap()).collect();
    numbers.try_into().unwrap()
}

#[test]
fn urdf_has_every_ball_and_the_solids_inertia() {
    let packing = packing();
    let text = to_urdf(&packing, "part", 7_850.0).unwrap();
    let document = Document::parse(&text).unwrap();
    let robot = document.root_element();
    assert_eq!((robot.tag_name().name(), robot.attribute("name")), ("robot", Some("part")));
    let link = child(robot, "link");
    assert_eq!(link.attribute("name"), Some("part"));

    let inertial = child(link, "inertial");
    assert_eq!(origin(inertial), packing.solid().centroid.to_array());
    assert_eq!(number(child(inertial, "mass"), "value"), 7_850.0 * packing.solid().volume);
    let tensor = child(inertial, "inertia");
    for (attribute, unit) in
        [("ixx", 3.0), ("ixy", 0.1), ("ixz", 0.2), ("iyy", 4.0), ("iyz", 0.3), ("izz", 5.0)]
    {
        assert_eq!(number(tensor, attribute), unit * 7_850.0, "{attribute}");
    }

    let balls: Vec<Node> = link.children().filter(|node| node.has_tag_name("collision")).collect();
    assert_eq!(balls.len(), 3);
    for (ball, sphere) in balls.into_iter().zip(packing.spheres()) {
        let radius = number(child(child(ball, "geometry"), "sphere"), "radius");
        assert_eq!(radius as f32, sphere.radius);
        assert_eq!(origin(ball).map(|c| c as f32), sphere.center.to_array());
    }
}

#[test]
fn urdf_names_are_escaped() {
    for (name, read) in [
        ("a<b>&\"c'", "a<b>&\"c'"),
        ("Zahnrad süß 齒輪", "Zahnrad süß 齒輪"),
        ("bell\u{7}\u{0}\n\t\u{FFFF}end", "bell_____end"),
        ("", "packing"),
        ("]]> <!-- -->", "]]> <!-- -->"),
    ] {
        let text = to_urdf(&packing(), name, 1.0).unwrap();
        let document = Document::parse(&text).unwrap_or_else(|error| panic!("{name:?}: {error}\n{text}"));
        assert_eq!(document.root_element().attribute("name"), Some(read));
    }
}

#[test]
fn urdf_refuses_densities_of_no_body() {
    for density in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = to_urdf(&packing(), "part", density).unwrap_err();
        assert!(matches!(error, ExportError::InvalidDensity { .. }), "{density}");
    }
}

#[test]
fn json_gives_every_bit_back() {
    let packing = packing();
    let json: serde_json::Value = serde_json::from_str(&to_json(&packing).unwrap()).unwrap();
    let float = |value: &serde_json::Value| value.as_f64().unwrap();
    let spheres = json["spheres"].as_array().unwrap();
    assert_eq!(spheres.len(), 3);
    for (read, sphere) in spheres.iter().zip(packing.spheres()) {
        for axis in 0..3 {
            assert_eq!(float(&read["center"][axis]) as f32, sphere.center[axis]);
            assert_eq!(float(&read["normal"][axis]) as f32, sphere.normal[axis]);
        }
        assert_eq!(float(&read["radius"]) as f32, sphere.radius);
        assert_eq!(float(&read["cell_volume"]) as f32, sphere.cell_volume);
    }
    assert_eq!(float(&json["solid"]["volume"]), packing.solid().volume);
    assert_eq!(float(&json["solid"]["centroid"][2]), packing.solid().centroid.z);
    assert_eq!(float(&json["solid"]["unit_inertia"][1][2]), 0.3);
}

#[test]
fn csv_gives_every_bit_back() {
    let packing = packing();
    let csv = to_csv(&packing);
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some("x,y,z,radius,cell_volume,nx,ny,nz"));
    for sphere in packing.spheres() {
        let row: Vec<f32> = lines.next().unwrap().split(',').map(|x| x.parse().unwrap()).collect();
        let (c, n) = (sphere.center, sphere.normal);
        assert_eq!(row, [c.x, c.y, c.z, sphere.radius, sphere.cell_volume, n.x, n.y, n.z]);
    }
    assert_eq!(lines.next(), None);
}
