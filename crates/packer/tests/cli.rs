//! The program `packer`, from outside.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail by panicking")]
#![cfg(feature = "cli")]

mod common;
#[path = "common/program.rs"]
mod program;

use ist::SpherePacking;
use program::{folder, names, packer};
use std::path::Path;
use std::process::{Command, Output};

fn json(output: &Output) -> serde_json::Value {
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn pack_writes_a_packing_and_reports_it() {
    let folder = folder();
    let at = folder.path();
    let output =
        packer(at, ["pack", "cube.obj", "-o", "cube.ist", "--spheres", "60", "--threads", "1", "--json"]);
    assert!(output.status.success(), "{output:?}");
    assert!(output.stderr.is_empty(), "no progress bar without a terminal");
    let report = json(&output);
    assert_eq!(report["spheres"], 60);
    assert_eq!(report["stop"], "sphere count");
    let packing = SpherePacking::load(at.join("cube.ist")).unwrap();
    assert_eq!(packing.spheres().len(), 60);
    assert!(packing.provenance().source.starts_with("cube.obj "));
    assert_eq!(names(at), ["cube.ist", "cube.obj"]);

    let first = std::fs::read(at.join("cube.ist")).unwrap();
    // More than a machine starts, too: a million threads ended in an error, three thousand in none for minutes.
    for threads in [&[][..], &["--threads", "1000000"]] {
        let arguments = [&["pack", "cube.obj", "-o", "cube.ist", "--spheres", "60"], threads].concat();
        assert!(packer(at, arguments).status.success(), "{threads:?}");
        assert!(first == std::fs::read(at.join("cube.ist")).unwrap(), "threads changed the file");
    }
}

#[test]
fn info_shows_a_packing_and_writes_its_table() {
    let folder = folder();
    let at = folder.path();
    assert!(packer(at, ["pack", "cube.obj", "-o", "cube.ist", "-n", "9"]).status.success());
    let output = packer(at, ["info", "cube.ist", "--json", "--csv", "cube.csv"]);
    assert_eq!(json(&output)["spheres"], 9);
    let csv = std::fs::read_to_string(at.join("cube.csv")).unwrap();
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some("x,y,z,radius,cell_volume,nx,ny,nz"));
    let rows: Vec<Vec<f32>> = lines.map(|l| l.split(',').map(|x| x.parse().unwrap()).collect()).collect();
    assert!(rows.len() == 9 && rows.iter().all(|row| row.len() == 8));
    let text = String::from_utf8(packer(at, ["info", "cube.ist"]).stdout).unwrap();
    assert!(text.contains("9 spheres") && text.contains("rapier-ist-packer"), "{text}");
}

#[test]
fn check_tells_good_meshes_from_bad_ones() {
    let folder = folder();
    let at = folder.path();
    let output = packer(at, ["check", "cube.obj", "--json"]);
    assert!(output.status.success());
    assert_eq!(
        (json(&output)["packable"].as_bool(), json(&output)["triangles"].as_u64()),
        (Some(true), Some(12))
    );
    let text = std::fs::read_to_string(at.join("cube.obj")).unwrap();
    let open = text.rsplit_once("f ").unwrap().0;
    std::fs::write(at.join("open.obj"), open).unwrap();
    let output = packer(at, ["check", "open.obj", "--json"]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(json(&output)["packable"], false);
    assert!(json(&output)["error"].as_str().unwrap().contains("3 open edges"));
}

#[test]
fn every_stop_can_be_asked_for_and_is_named() {
    let folder = folder();
    let at = folder.path();
    for (option, value, stop) in [
        ("--spheres", "20", "sphere count"),
        ("--coverage", "0.6", "coverage"),
        ("--min-radius", "0.1", "minimum radius"),
        ("--volume-error", "0.2", "volume error"),
        ("--time-limit", "1.5", "time limit"),
    ] {
        let output = packer(at, ["pack", "cube.obj", "-o", "cube.ist", option, value, "--json"]);
        let report = json(&output);
        assert_eq!(report["stop"], stop);
        assert!(report["quality"]["volume_error"].as_f64().unwrap() < 0.5, "{report}");
        assert_eq!(report["spheres"], SpherePacking::load(at.join("cube.ist")).unwrap().spheres().len());
    }
}

#[test]
fn bad_input_gives_a_message_and_status_2_and_leaves_nothing_behind() {
    let folder = folder();
    let at = folder.path();
    let text = std::fs::read_to_string(at.join("cube.obj")).unwrap();
    std::fs::write(at.join("empty.obj"), "").unwrap();
    std::fs::write(at.join("noise.stl"), [7_u8; 300]).unwrap();
    std::fs::write(at.join("notes.txt"), "hello").unwrap();
    std::fs::write(at.join("open.obj"), text.rsplit_once("f ").unwrap().0).unwrap();
    std::fs::write(at.join("nan.obj"), text.replacen("v 0 0 0", "v 0 NaN 0", 1)).unwrap();
    let before = names(at);
    for (arguments, message) in [
        (vec!["pack", "missing.obj", "-o", "out.ist"], "cannot read missing.obj"),
        (vec!["pack", "empty.obj", "-o", "out.ist"], "is empty"),
        (vec!["pack", "noise.stl", "-o", "out.ist"], "not readable as STL"),
        (vec!["pack", "notes.txt", "-o", "out.ist"], "no mesh file known here"),
        (vec!["pack", "open.obj", "-o", "out.ist"], "open edges"),
        (vec!["pack", "nan.obj", "-o", "out.ist"], "NaN"),
        (vec!["pack", "cube.obj", "-o", "out.ist", "--spheres", "0"], "zero spheres"),
        (vec!["pack", "cube.obj", "-o", "out.ist", "--coverage", "1.5"], "coverage 1.5"),
        (vec!["pack", "cube.obj", "-o", "out.ist", "--coverage", "-1"], "coverage -1"),
        (vec!["pack", "cube.obj", "-o", "out.ist", "--coverage", "NaN"], "coverage NaN"),
        (vec!["pack", "cube.obj", "-o", "out.ist", "--volume-error", "2"], "volume error 2"),
        (vec!["pack", "cube.obj", "-o", "out.ist", "--time-limit", "-1"], "time-limit"),
        (vec!["pack", "cube.obj", "-o", "out.ist", "--time-limit", "0"], "time"),
        (vec!["pack", "cube.obj", "-o", "out.ist", "--threads", "0"], "zero threads"),
        (vec!["pack", "cube.obj", "-o", "nowhere/out.ist"], "output folder nowhere does not exist"),
        (vec!["pack", "cube.obj", "-o", "."], "is a folder"),
        (vec!["pack", "cube.obj"], "--output"),
        (vec!["info", "cube.obj"], "not an .ist file"),
        (vec!["info", "missing.ist"], "cannot read missing.ist"),
    ] {
        let output =
            Command::new(env!("CARGO_BIN_EXE_packer")).current_dir(at).args(&arguments).output().unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {stderr}");
        assert!(stderr.contains(message), "{arguments:?}: {stderr}");
        assert!(!stderr.contains("panicked") && output.stdout.is_empty(), "{arguments:?}: {stderr}");
    }
    assert_eq!(names(at), before);
}

#[test]
fn help_has_examples() {
    let help = |arguments: &[&str]| {
        let output =
            Command::new(env!("CARGO_BIN_EXE_packer")).args(arguments).arg("--help").output().unwrap();
        assert!(output.status.success());
        String::from_utf8(output.stdout).unwrap()
    };
    let program = help(&[]);
    assert!(program.contains("packer pack bunny.obj -o bunny.ist"), "{program}");
    for command in ["pack", "batch", "check", "info", "completions"] {
        assert!(program.contains(&format!("\n  {command} ")), "{program}");
        let text = help(&[command]);
        let examples = text.split_once("Examples:\n").unwrap_or_else(|| panic!("{text}")).1;
        assert!(examples.contains(&format!("packer {command} ")), "{text}");
    }
    for preset in ["fast", "balanced", "fine"] {
        assert!(help(&["pack"]).contains(preset) && help(&["batch"]).contains(preset));
    }
}

/// The arguments of the examples in the help, as the program reads them.
#[test]
fn examples_in_the_help_are_understood() {
    let folder = folder();
    let at = folder.path();
    std::fs::create_dir(at.join("meshes")).unwrap();
    for name in ["bunny.obj", "meshes/bunny.obj"] {
        std::fs::copy(at.join("cube.obj"), at.join(name)).unwrap();
    }
    assert!(packer(at, ["pack", "bunny.obj", "-o", "bunny.ist", "-n", "9"]).status.success());
    for command in ["pack", "batch", "check", "info", "completions"] {
        let help = String::from_utf8(packer(at, [command, "--help"]).stdout).unwrap();
        let examples = help.split_once("Examples:").unwrap().1;
        for line in examples.lines().filter_map(|line| line.strip_prefix("  packer ")) {
            let arguments = line.split('>').next().unwrap().replace("\"$SLURM_ARRAY_TASK_ID/8\"", "2/8");
            // The meshes of some examples are not here: what counts is that no argument is refused.
            let output = Command::new(env!("CARGO_BIN_EXE_packer"))
                .current_dir(at)
                .args(arguments.split_whitespace())
                .output()
                .unwrap();
            let stderr = String::from_utf8(output.stderr).unwrap();
            let is_fine = output.status.success() || stderr.contains("cannot read");
            assert!(is_fine, "packer {arguments}: {stderr}");
        }
    }
}

#[test]
fn presets_are_starting_points() {
    let folder = folder();
    let at = folder.path();
    let options = |arguments: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_packer"))
            .current_dir(at)
            .args(["pack", "cube.obj", "-o", "cube.ist"])
            .args(arguments)
            .output()
            .unwrap();
        assert!(output.status.success(), "{output:?}");
        SpherePacking::load(at.join("cube.ist")).unwrap().provenance().options.clone()
    };
    let balanced = options(&[]);
    assert_eq!(balanced, packer::PackOptions::balanced().to_string());
    assert_eq!(balanced, options(&["--preset", "balanced"]));
    assert_eq!(options(&["--preset", "fast"]), packer::PackOptions::fast().to_string());
    assert_eq!(
        options(&["--preset", "fine", "-n", "7"]),
        packer::PackOptions::fine().spheres(7).to_string(),
        "a number given by hand counts"
    );
    let covered = packer::PackOptions::fast().spheres(1_000_000).coverage(0.6);
    assert_eq!(options(&["-p", "fast", "--coverage", "0.6"]), covered.to_string());
}

#[test]
fn exports_of_pack_and_info_are_the_same() {
    let folder = folder();
    let at = folder.path();
    let output = packer(
        at,
        [
            "pack",
            "cube.obj",
            "-o",
            "cube.ist",
            "-n",
            "30",
            "--csv",
            "1.csv",
            "--spheres-json",
            "1.json",
            "--urdf",
            "1.urdf",
            "--density",
            "500",
            "--preview",
            "1.png",
        ],
    );
    assert!(output.status.success(), "{output:?}");
    let output = packer(
        at,
        [
            "info",
            "cube.ist",
            "--csv",
            "2.csv",
            "--spheres-json",
            "2.json",
            "--urdf",
            "2.urdf",
            "--density",
            "500",
            "--preview",
            "2.png",
        ],
    );
    assert!(output.status.success(), "{output:?}");
    let read = |name: &str| std::fs::read(at.join(name)).unwrap();
    for kind in ["csv", "json", "urdf"] {
        assert!(read(&format!("1.{kind}")) == read(&format!("2.{kind}")), "{kind}");
    }
    let json: serde_json::Value = serde_json::from_slice(&read("1.json")).unwrap();
    assert_eq!(json["spheres"].as_array().unwrap().len(), 30);
    let urdf = String::from_utf8(read("1.urdf")).unwrap();
    let document = roxmltree::Document::parse(&urdf).unwrap();
    assert_eq!(document.root_element().attribute("name"), Some("cube"), "named after the file");
    let mass = document.descendants().find(|node| node.has_tag_name("mass")).unwrap();
    let mass: f64 = mass.attribute("value").unwrap().parse().unwrap();
    assert!((mass - 500.0).abs() < 1e-9, "a cube of 1 m³");
    assert_eq!(document.descendants().filter(|node| node.has_tag_name("sphere")).count(), 30);
    for name in ["1.png", "2.png"] {
        let reader = png::Decoder::new(std::io::Cursor::new(read(name))).read_info().unwrap();
        assert_eq!((reader.info().width, reader.info().height), (1000, 800));
    }
    assert!(read("1.png") != read("2.png"), "pack shows the mesh too");
    assert_eq!(
        names(at),
        ["1.csv", "1.json", "1.png", "1.urdf", "2.csv", "2.json", "2.png", "2.urdf", "cube.ist", "cube.obj"]
    );
}

#[test]
fn completions_name_every_command_and_option() {
    for (shell, mark) in [
        ("bash", "complete -F _packer"),
        ("zsh", "#compdef packer"),
        ("fish", "complete -c packer"),
        ("powershell", "Register-ArgumentCompleter"),
        ("elvish", "edit:completion:arg-completer[packer]"),
    ] {
        let output = packer(Path::new("."), ["completions", shell]);
        assert!(output.status.success(), "{output:?}");
        let script = String::from_utf8(output.stdout).unwrap();
        for word in [mark, "batch", "completions", "shard", "preview", "spheres-json", "urdf"] {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
}
