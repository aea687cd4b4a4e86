//! The commands of docs/packing.md, run.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail by panicking")]
#![cfg(all(feature = "cli", unix))]

mod common;

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

fn guide() -> String {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../docs/packing.md");
    std::fs::read_to_string(path).unwrap()
}

/// The contents of the guide's code blocks in one language.
fn blocks(language: &str) -> Vec<String> {
    let text = guide();
    let mut blocks = Vec::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if let Some(name) = line.strip_prefix("```").filter(|name| !name.is_empty()) {
            let content: Vec<&str> = lines.by_ref().take_while(|line| *line != "```").collect();
            if name == language {
                blocks.push(content.join("\n"));
            }
        }
    }
    assert!(!blocks.is_empty(), "no {language} in the guide");
    blocks
}

/// The folder that the guide takes for granted: the meshes, and two of them below `meshes`.
fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    std::fs::create_dir_all(at.join("meshes/parts")).unwrap();
    for (mesh, copy) in [
        ("bunny.obj", "bunny.obj"),
        ("femur.obj", "femur.obj"),
        ("bunny.obj", "meshes/bunny.obj"),
        ("femur.obj", "meshes/parts/femur.obj"),
    ] {
        std::fs::copy(common::asset(mesh), at.join(copy)).unwrap();
    }
    folder
}

/// Runs a script in `folder`, with the program in the search path.
fn bash(folder: &Path, script: &str, variables: &[(&str, &str)]) -> Output {
    let program = Path::new(env!("CARGO_BIN_EXE_packer")).parent().unwrap();
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap());
    let mut command = Command::new("bash");
    command.args(["-euc", script]).current_dir(folder).env("PATH", path).env("HOME", folder);
    command.envs(variables.iter().copied()).output().unwrap()
}

fn packings(folder: &Path) -> [Vec<u8>; 2] {
    ["bunny.obj.ist", "parts/femur.obj.ist"].map(|name| std::fs::read(folder.join(name)).unwrap())
}

#[test]
fn every_command_works() {
    let folder = folder();
    let at = folder.path();
    let mut outputs = String::new();
    for block in blocks("sh").iter().filter(|block| !block.starts_with("cargo ")) {
        let output = bash(at, block, &[]);
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success(), "{block}\n{text}{}", String::from_utf8_lossy(&output.stderr));
        writeln!(outputs, "{text}").unwrap();
    }
    for said in ["(stop: sphere count)", "2 packed, 0 unchanged, 0 failed", "0 packed, 2 unchanged, 0 failed"]
    {
        assert!(outputs.contains(said), "{said}: {outputs}");
    }
    for file in ["bunny.ist", "bunny.png", "bunny.csv", "bunny.json", "femur.urdf"] {
        assert!(at.join(file).is_file(), "{file}");
    }
}

#[test]
fn job_files_give_what_one_run_gives() {
    let folder = folder();
    let at = folder.path();
    assert!(bash(at, "packer batch meshes -o packings", &[]).status.success());
    let whole = packings(&at.join("packings"));

    let slurm = &blocks("bash")[0];
    assert!(slurm.contains("#SBATCH --array=1-8"));
    std::fs::remove_dir_all(at.join("packings")).unwrap();
    for index in 1..=8 {
        let output = bash(at, slurm, &[("SLURM_ARRAY_TASK_ID", &index.to_string())]);
        assert!(output.status.success(), "{output:?}");
    }
    assert!(packings(&at.join("packings")) == whole);

    let kubernetes = &blocks("yaml")[0];
    assert!(kubernetes.contains("completions: 8"));
    let command = kubernetes.lines().find_map(|line| line.trim().strip_prefix("- exec ")).unwrap();
    let command = command.replace("/data", at.to_str().unwrap());
    std::fs::remove_dir_all(at.join("packings")).unwrap();
    for index in 0..8 {
        let output = bash(at, &command, &[("JOB_COMPLETION_INDEX", &index.to_string())]);
        assert!(output.status.success(), "{output:?}");
    }
    assert!(packings(&at.join("packings")) == whole);
}
