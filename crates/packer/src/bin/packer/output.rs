//! Files that are there whole or not at all, and lines on standard output.

use anyhow::{Context, bail};
use std::fs::File;
use std::io::{Error, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

/// Start of the names of files that are being written.
pub(crate) const UNFINISHED: &str = ".packer-";
/// Times that a file is written anew if its temporary file is taken away before it is renamed.
const ATTEMPTS: usize = 5;

/// The folder of `path`.
fn folder(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// What is written, and how files of the kind begin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kind {
    name: &'static str,
    beginning: &'static [u8],
}

pub(crate) const PACKING: Kind = Kind { name: "packing", beginning: b"\x89IST" };
pub(crate) const TABLE: Kind = Kind { name: "table of spheres", beginning: b"x,y,z,radius," };
pub(crate) const JSON: Kind = Kind { name: "list of spheres", beginning: b"{\"provenance\":" };
pub(crate) const URDF: Kind =
    Kind { name: "URDF file", beginning: b"<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<robot " };
pub(crate) const PICTURE: Kind = Kind { name: "PNG picture", beginning: b"\x89PNG" };

/// Refuses a path that cannot be written, or where something else would be lost, before any work is done for it.
pub(crate) fn check_writable(path: &Path, kind: Kind) -> anyhow::Result<()> {
    if path.is_dir() || path.file_name().is_none() {
        bail!("{} is a folder; name a file in it", path.display());
    }
    check_replaceable(path, kind)?;
    let folder = folder(path);
    if !folder.is_dir() {
        bail!("the output folder {} does not exist; create it first", folder.display());
    }
    check_folder(folder, "")
}

/// Refuses to replace what is there, unless it is empty or begins as what is to be written.
fn check_replaceable(path: &Path, kind: Kind) -> anyhow::Result<()> {
    let Ok(metadata) = path.metadata() else { return Ok(()) };
    let name = path.display();
    // Files are replaced as a whole, and a device or a pipe with them.
    if !metadata.is_file() {
        bail!("{name} is no regular file; name one, and lead it from there");
    }
    let mut beginning = Vec::new();
    File::open(path)
        .and_then(|file| file.take(kind.beginning.len() as u64).read_to_end(&mut beginning))
        .with_context(|| format!("cannot read {name}, which would be replaced; choose another name"))?;
    if !beginning.is_empty() && beginning != kind.beginning {
        bail!("{name} is there and is no {}; choose another name, or remove it first", kind.name);
    }
    Ok(())
}

/// Refuses a folder in which no file can be made; `tag` is for the name of the one that is tried.
pub(crate) fn check_folder(folder: &Path, tag: &str) -> anyhow::Result<()> {
    // Whether a file can be made there is known only by making one; it is gone at the end of the statement.
    tempfile::Builder::new().prefix(&format!("{UNFINISHED}{tag}")).tempfile_in(folder).with_context(
        || format!("cannot write to the output folder {}; choose one that is writable", folder.display()),
    )?;
    Ok(())
}

/// Refuses outputs that would replace the input or one another.
pub(crate) fn check_distinct<'a>(
    input: &Path,
    outputs: impl Iterator<Item = &'a Path>,
) -> anyhow::Result<()> {
    // A file to be written need not exist, but its folder does.
    let place = |path: &Path| -> PathBuf {
        let folder = folder(path).canonicalize().unwrap_or_else(|_| folder(path).to_owned());
        path.file_name().map_or_else(|| folder.clone(), |name| folder.join(name))
    };
    // The input by its name and, where that is a link, the file that it stands for.
    let inputs = [place(input), input.canonicalize().unwrap_or_else(|_| input.to_owned())];
    let mut taken = Vec::new();
    for output in outputs {
        let place = place(output);
        if inputs.contains(&place) {
            bail!("{} is the input; choose another name for the output", output.display());
        }
        if taken.contains(&place) {
            bail!("{} is named for two outputs; give each a name of its own", output.display());
        }
        taken.push(place);
    }
    Ok(())
}

/// Writes `bytes` to a temporary file beside `path` and renames it: readers see the old file or the new one. Links stay, and
/// the file that they stand for is replaced.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    write_tagged(path, bytes, "")
}

/// As [`write`], with `tag` in the name of the temporary file.
pub(crate) fn write_tagged(path: &Path, bytes: &[u8], tag: &str) -> anyhow::Result<()> {
    let prefix = format!("{UNFINISHED}{tag}");
    let target = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let write = || -> std::io::Result<()> {
        let mut builder = tempfile::Builder::new();
        // Temporary files are private; a result is as readable as any other file.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o644));
        let mut file = builder.prefix(&prefix).tempfile_in(folder(&target))?;
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        file.persist(&target)?;
        Ok(())
    };
    // Another run may take the temporary file for one that a killed run had left; but a folder that is gone is gone.
    let is_worth_another_try = |error: &Error| error.kind() == ErrorKind::NotFound && folder(path).is_dir();
    retried(write, is_worth_another_try).with_context(|| {
        format!("cannot write {}; check that its folder is writable and has space left", path.display())
    })
}

/// Tries `action` until it succeeds, fails for a reason that another try does not mend, or has had its attempts.
fn retried(
    mut action: impl FnMut() -> std::io::Result<()>,
    is_worth_another_try: impl Fn(&Error) -> bool,
) -> std::io::Result<()> {
    let mut result = action();
    for _ in 1..ATTEMPTS {
        match &result {
            Err(error) if is_worth_another_try(error) => result = action(),
            _ => break,
        }
    }
    result
}

/// Prints one line.
pub(crate) fn print(line: impl std::fmt::Display) -> anyhow::Result<()> {
    writeln!(std::io::stdout(), "{line}")
        .context("cannot write to standard output; lead it to a file or device that has space left")
}

/// An error with its causes; those that the text tells already are left out.
pub(crate) fn message(error: &anyhow::Error) -> String {
    error.chain().fold(String::new(), |text, cause| match cause.to_string() {
        cause if text.contains(&cause) => text,
        cause if text.is_empty() => cause,
        cause => format!("{text}: {cause}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_taken_away_is_written_again() {
        let outcome = |failures: usize, kind: ErrorKind| {
            let mut tries = 0;
            let action = || {
                tries += 1;
                if tries <= failures { Err(Error::from(kind)) } else { Ok(()) }
            };
            let result = retried(action, |error| error.kind() == ErrorKind::NotFound);
            (result.is_ok(), tries)
        };
        assert_eq!(outcome(0, ErrorKind::NotFound), (true, 1));
        assert_eq!(outcome(2, ErrorKind::NotFound), (true, 3));
        assert_eq!(outcome(99, ErrorKind::NotFound), (false, ATTEMPTS));
        assert_eq!(outcome(2, ErrorKind::StorageFull), (false, 1));
    }

    #[test]
    fn a_failed_write_names_the_file_and_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let taken = folder.path().join("taken");
        std::fs::create_dir(&taken).unwrap();
        let error = write(&taken, b"bytes").unwrap_err();
        assert!(error.to_string().contains("taken"), "{error}");
        assert!(write(&folder.path().join("no/file"), b"bytes").is_err());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
