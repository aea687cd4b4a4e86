//! The mesh files below a folder.

use anyhow::{Context, bail};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use walkdir::{DirEntry, WalkDir};

/// Extensions of the formats that `TriangleMesh::load` reads.
const EXTENSIONS: [&str; 5] = ["obj", "stl", "ply", "gltf", "glb"];

/// A mesh, or something that should be one.
pub(super) struct Entry {
    /// Where it is, relative to the input folder.
    pub(super) path: PathBuf,
    /// Why it cannot be read, if that is known already.
    pub(super) error: Option<String>,
}

/// All meshes below a folder, in the order of their paths.
pub(super) struct Listing {
    pub(super) entries: Vec<Entry>,
}

impl Listing {
    /// Lists `folder` and its subfolders. Links are followed unless they lead back to what is listed anyway; hidden
    /// files and folders are left out, for they hold what programs keep for themselves (`.git`, the `._part.obj` of
    /// network drives).
    pub(super) fn of(folder: &Path) -> anyhow::Result<Self> {
        let metadata = std::fs::metadata(folder)
            .with_context(|| format!("cannot read the input folder {}", folder.display()))?;
        if !metadata.is_dir() {
            bail!("{} is a file; name its folder, or use packer pack for a single mesh", folder.display());
        }
        let root = folder
            .canonicalize()
            .with_context(|| format!("cannot read the input folder {}", folder.display()))?;
        let is_wanted = |entry: &DirEntry| {
            entry.depth() == 0 || !(is_hidden(entry.file_name()) || leads_back(entry, &root))
        };
        let mut entries = Vec::new();
        for found in WalkDir::new(folder).follow_links(true).into_iter().filter_entry(is_wanted) {
            entries.extend(match &found {
                Ok(entry) => examine(entry, folder),
                Err(error) if error.depth() == 0 => {
                    bail!("cannot read the input folder {}: {error}", folder.display())
                }
                Err(error) => examine_error(error, folder),
            });
        }
        if entries.is_empty() {
            bail!(
                "there are no meshes below {}; files that end in .{} are packed",
                folder.display(),
                EXTENSIONS.join(", .")
            );
        }
        entries.sort_by(|a, b| a.path.cmp(&b.path));
        Ok(Self { entries })
    }
}

fn examine(entry: &DirEntry, folder: &Path) -> Option<Entry> {
    let kind = entry.file_type();
    if kind.is_dir() || !is_mesh(entry.path()) {
        return None;
    }
    // To open a pipe would wait for ever.
    let error = (!kind.is_file())
        .then(|| format!("{} is neither a file nor a folder; remove it", entry.path().display()));
    Some(Entry { path: relative(entry.path(), folder), error })
}

/// What cannot be looked at: a folder without permission, or a link that leads nowhere.
fn examine_error(error: &walkdir::Error, folder: &Path) -> Option<Entry> {
    let path = error.path()?;
    // A link back to a folder that is being listed shows nothing new.
    let is_loop = error.loop_ancestor().is_some();
    let is_dead_link = std::fs::symlink_metadata(path).is_ok_and(|m| m.is_symlink()) && !is_mesh(path);
    if is_loop || is_dead_link || path.file_name().is_some_and(is_hidden) {
        return None;
    }
    let reason = error.io_error().map_or_else(|| error.to_string(), ToString::to_string);
    let message = format!("cannot read {}: {reason}", path.display());
    Some(Entry { path: relative(path, folder), error: Some(message) })
}

fn is_mesh(path: &Path) -> bool {
    let extension = path.extension().and_then(OsStr::to_str).unwrap_or_default();
    EXTENSIONS.iter().any(|known| extension.eq_ignore_ascii_case(known))
}

fn is_hidden(name: &OsStr) -> bool {
    name.as_encoded_bytes().starts_with(b".")
}

/// Whether an entry is a link to a folder that is listed at its own place, or to one that holds the whole listing.
fn leads_back(entry: &DirEntry, root: &Path) -> bool {
    if !(entry.path_is_symlink() && entry.file_type().is_dir()) {
        return false;
    }
    entry.path().canonicalize().is_ok_and(|target| match target.strip_prefix(root) {
        Ok(inside) => !inside.components().any(|part| is_hidden(part.as_os_str())),
        Err(_) => root.starts_with(&target),
    })
}

fn relative(path: &Path, folder: &Path) -> PathBuf {
    path.strip_prefix(folder).unwrap_or(path).to_owned()
}
