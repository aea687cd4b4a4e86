//! What the examples leave behind: an exit status, and files that are there as a whole or not at all.

use crate::run::Verdict;
use anyhow::{Context, Result, ensure};
use std::fmt::Display;
use std::io::{ErrorKind, Write};
use std::path::Path;
use std::process::ExitCode;

/// Exit status of an example: 0, 1 where a check failed, or 2 after telling what was wrong with the input.
#[must_use]
pub fn exit_code(result: Result<Verdict>) -> ExitCode {
    match result {
        Ok(Verdict::Passed) => ExitCode::SUCCESS,
        Ok(Verdict::Failed) => {
            eprintln!("a check failed");
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(2)
        }
    }
}

/// Prints `text` and ends the line. A reader that closed the pipe has seen enough: the example goes on without it.
///
/// # Errors
/// Where the output cannot be written for another reason, such as a full disk.
pub fn print_line(text: impl Display) -> Result<()> {
    match writeln!(std::io::stdout(), "{text}") {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error).context("cannot print"),
        _ => Ok(()),
    }
}

/// Refuses a path that cannot be written, before any work is done for it.
///
/// # Errors
/// Names the folder that is missing.
pub fn check_folder_of(path: &Path) -> Result<()> {
    let folder = folder_of(path);
    ensure!(
        folder.is_dir(),
        "cannot write {}: the folder {} does not exist; create it first",
        path.display(),
        folder.display()
    );
    ensure!(!path.is_dir(), "cannot write {}: it is a folder; name a file in it", path.display());
    Ok(())
}

/// Writes `bytes` to a temporary file beside `path` and renames it.
///
/// # Errors
/// Where the folder cannot be written or the disk is full; `path` is then as it was.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    let write = || -> Result<()> {
        let mut file = temporary_file(folder_of(path))?;
        file.write_all(bytes)?;
        file.persist(path)?;
        Ok(())
    };
    write().with_context(|| format!("cannot write {}", path.display()))
}

/// With the permissions of any new file, not those of a secret one.
fn temporary_file(folder: &Path) -> std::io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(unix)]
    fn files_have_the_permissions_of_any_other() -> Result<()> {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir()?;
        let mode =
            |name: &str| -> Result<u32> { Ok(folder.path().join(name).metadata()?.permissions().mode()) };
        write_whole(&folder.path().join("ours"), b"text")?;
        std::fs::write(folder.path().join("any"), b"text")?;
        assert_eq!(mode("ours")?, mode("any")?);
        Ok(())
    }
}
