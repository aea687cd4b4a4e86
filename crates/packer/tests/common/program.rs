//! The program `packer` and folders to run it in.
#![allow(dead_code, reason = "each test file uses its part")]

use crate::common;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

pub(crate) fn packer<'a>(folder: &Path, arguments: impl AsRef<[&'a str]>) -> Output {
    Command::new(env!("CARGO_BIN_EXE_packer")).current_dir(folder).args(arguments.as_ref()).output().unwrap()
}

/// A folder with a mesh `cube.obj` in it.
pub(crate) fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    let mut text = String::new();
    let cube = common::cuboid(glam::DVec3::ZERO, glam::DVec3::ONE);
    cube.vertices.iter().for_each(|v| text += &format!("v {} {} {}\n", v.x, v.y, v.z));
    cube.triangles.iter().for_each(|t| text += &format!("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1));
    std::fs::write(folder.path().join("cube.obj"), text).unwrap();
    folder
}

pub(crate) fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}
