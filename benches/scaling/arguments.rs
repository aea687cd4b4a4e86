//! What the command line asks for.

use std::error::Error;
use std::path::{Path, PathBuf};

/// The parts of the benchmark to run.
pub(crate) struct Arguments {
    /// Whether this is a benchmark at all: `cargo test --benches` runs it too, without the flag.
    pub(crate) bench: bool,
    pub(crate) criterion: bool,
    pub(crate) tables: bool,
    pub(crate) large: bool,
    /// Where to draw the tables.
    pub(crate) svg: Option<PathBuf>,
}

impl Arguments {
    /// Arguments that are not known here, such as a filter, are Criterion's, and then there are no tables.
    pub(crate) fn parse() -> Result<Self, Box<dyn Error>> {
        let mut out = Self { bench: false, criterion: true, tables: true, large: false, svg: None };
        let mut arguments = std::env::args().skip(1);
        while let Some(argument) = arguments.next() {
            match argument.as_str() {
                "--bench" => out.bench = true,
                "--large" => (out.large, out.criterion) = (true, false),
                "--svg" => {
                    let path = arguments.next().ok_or("--svg needs a path: --svg docs/scaling.svg")?;
                    // Cargo runs benchmarks in the folder of their package, callers stand in that of the workspace.
                    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
                    (out.svg, out.criterion) = (Some(workspace.join(path)), false);
                }
                _ => out.tables = false,
            }
        }
        Ok(out)
    }
}
