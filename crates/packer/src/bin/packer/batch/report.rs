//! What a batch says: lines for people, or one JSON object.

use super::Arguments;
use super::item::{Item, Outcome};
use crate::output;
use packer::PackOptions;
use serde_json::{Value, json};
use std::fmt::Write;

/// All meshes of a run and what became of them.
pub(super) struct Report<'a> {
    pub(super) items: &'a [Item],
    pub(super) outcomes: &'a [Outcome],
    /// Meshes of all shards.
    pub(super) listed: usize,
    pub(super) seconds: f64,
}

/// Says what became of a mesh as soon as it is known.
pub(super) fn tell(item: &Item, outcome: &Outcome) {
    let path = item.path().display();
    let line = match outcome {
        Outcome::Packed { spheres, coverage, seconds, .. } => {
            format!("packed  {path}: {spheres} spheres fill {:.2} % ({seconds:.2} s)", 100.0 * coverage)
        }
        Outcome::Failed { .. } => format!("failed  {path}"),
        Outcome::Unchanged { .. } => return,
    };
    // A reader that closed the pipe is no reason to stop packing.
    let _ = output::print(line);
}

impl Report<'_> {
    pub(super) fn failed(&self) -> usize {
        self.count(|outcome| matches!(outcome, Outcome::Failed { .. }))
    }

    fn count(&self, which: impl Fn(&Outcome) -> bool) -> usize {
        self.outcomes.iter().filter(|outcome| which(outcome)).count()
    }

    fn packed(&self) -> usize {
        self.count(|outcome| matches!(outcome, Outcome::Packed { .. }))
    }

    fn unchanged(&self) -> usize {
        self.count(|outcome| matches!(outcome, Outcome::Unchanged { .. }))
    }

    /// Counts, and the meshes that failed with their errors.
    pub(super) fn summary(&self, arguments: &Arguments) -> String {
        let mut text = format!(
            "{}: {} packed, {} unchanged, {} failed in {:.2} s",
            arguments.output.display(),
            self.packed(),
            self.unchanged(),
            self.failed(),
            self.seconds
        );
        // Writing to a string does not fail.
        if self.items.len() < self.listed {
            let _ = write!(
                text,
                "; shard {} has {} of {} meshes",
                arguments.shard,
                self.items.len(),
                self.listed
            );
        }
        for (item, outcome) in self.items.iter().zip(self.outcomes) {
            if let Outcome::Failed { error } = outcome {
                let _ = write!(text, "\nfailed: {}: {error}", item.path().display());
            }
        }
        text
    }

    pub(super) fn to_json(&self, arguments: &Arguments, options: &PackOptions) -> Value {
        let files: Vec<Value> =
            self.items.iter().zip(self.outcomes).map(|(i, o)| file_to_json(i, o)).collect();
        json!({
            "input": arguments.input.display().to_string(),
            "output": arguments.output.display().to_string(),
            "options": options.to_string(),
            "shard": arguments.shard.to_string(),
            "meshes_in_all_shards": self.listed,
            "packed": self.packed(),
            "unchanged": self.unchanged(),
            "failed": self.failed(),
            "seconds": self.seconds,
            "meshes": files,
        })
    }
}

fn file_to_json(item: &Item, outcome: &Outcome) -> Value {
    let mut file = match outcome {
        Outcome::Packed { spheres, coverage, stop, seconds } => json!({
            "status": "packed",
            "spheres": spheres,
            "coverage": coverage,
            "stop": stop,
            "seconds": seconds,
        }),
        Outcome::Unchanged { spheres, coverage } => {
            json!({ "status": "unchanged", "spheres": spheres, "coverage": coverage })
        }
        Outcome::Failed { error } => json!({ "status": "failed", "error": error }),
    };
    file["input"] = item.path().display().to_string().into();
    file["output"] = item.output().display().to_string().into();
    file
}
