//! Files that are there whole or not at all, and lines on standard output.

use anyhow::{Context, bail};
use std::io::Write;
use std::path::Path;

/// The folder of `path`.
fn folder(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Refuses a path that cannot be written, before any work is done for it.
pub(crate) fn check_writable(path: &Path) -> anyhow::Result<()> {
    if path.is_dir() || path.file_name().is_none() {
        bail!("{} is a folder; name a file in it", path.display());
    }
    let folder = folder(path);
    if !folder.is_dir() {
        bail!("the output folder {} does not exist; create it first", folder.display());
    }
    // Whether a file can be made there is known only by making one; it is gone at the end of the statement.
    tempfile::NamedTempFile::new_in(folder)
        .with_context(|| format!("cannot write to the output folder {}", folder.display()))?;
    Ok(())
}

/// Writes `bytes` to a temporary file beside `path` and renames it: readers see the old file or the new one.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    let write = || -> std::io::Result<()> {
        let mut builder = tempfile::Builder::new();
        // Temporary files are private; a result is as readable as any other file.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o644));
        let mut file = builder.prefix(".packer-").tempfile_in(folder(path))?;
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        file.persist(path)?;
        Ok(())
    };
    write().with_context(|| format!("cannot write {}", path.display()))
}

/// Prints one line.
pub(crate) fn print(line: impl std::fmt::Display) -> anyhow::Result<()> {
    Ok(writeln!(std::io::stdout(), "{line}")?)
}

/// An error with its causes; those that the text tells already are left out.
pub(crate) fn message(error: &anyhow::Error) -> String {
    error.chain().fold(String::new(), |text, cause| match cause.to_string() {
        cause if text.contains(&cause) => text,
        cause if text.is_empty() => cause,
        cause => format!("{text}: {cause}"),
    })
}
