//! `packer batch`.
//!
//! What is done and what is left to do is told by the outputs alone: one that was made by this version, with these
//! options, from this very mesh is left as it is. There is no journal that a kill could leave in disorder, and no
//! state that shards would have to share.

mod item;
mod leftovers;
mod listing;
mod report;
mod shard;

use crate::options::{PackingArguments, ThreadArguments};
use crate::output;
use anyhow::{Context, bail};
use indicatif::{ProgressBar, ProgressStyle};
use item::{Item, Outcome};
use report::Report;
use shard::Shard;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Folder with meshes, in subfolders too.
    input: PathBuf,
    /// Folder to write to; it is made if it does not exist.
    #[arg(short, long, value_name = "OUT_DIR")]
    output: PathBuf,
    /// Pack only part I of N, from 1/N to N/N: one machine of a cluster each.
    #[arg(long, value_name = "I/N", default_value_t)]
    shard: Shard,
    #[command(flatten)]
    threads: ThreadArguments,
    /// Print one report as JSON at the end, and nothing before.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    packing: PackingArguments,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let started = Instant::now();
    // Asked before any mesh is read, so that a wrong option is told once and not for every mesh.
    let options = arguments.packing.options(Path::new(""))?;
    let threads = arguments.threads.count()?;
    let listing = listing::Listing::of(&arguments.input)?;
    prepare(arguments)?;
    let listed = listing.entries.len();
    let items: Vec<Item> = listing
        .entries
        .into_iter()
        .filter(|entry| arguments.shard.owns(shard::path_hash(&entry.path)))
        .map(|entry| Item::new(entry, arguments))
        .collect();
    let outcomes = pack_all(&items, threads, arguments)?;
    let report =
        Report { items: &items, outcomes: &outcomes, listed, seconds: started.elapsed().as_secs_f64() };
    let printed = if arguments.json {
        output::print(report.to_json(arguments, &options))
    } else {
        output::print(report.summary(arguments))
    };
    match report.failed() {
        0 => printed,
        failed => bail!("{failed} of {} meshes failed; the report names them", items.len()),
    }
}

/// Makes the output folder and clears it of what a killed run of this shard had not finished.
fn prepare(arguments: &Arguments) -> anyhow::Result<()> {
    let folder = &arguments.output;
    if folder.exists() && !folder.is_dir() {
        bail!("the output {} is a file; name a folder", folder.display());
    }
    std::fs::create_dir_all(folder).with_context(|| {
        format!("cannot make the output folder {}; choose one that is writable", folder.display())
    })?;
    leftovers::remove(folder, arguments.shard)?;
    output::check_folder(folder, &shard::tag(arguments.shard.own_hash()))
}

/// What became of each item, in their order.
///
/// Meshes are packed side by side, each by as many threads as there are to spare: one thread packs a mesh with the
/// least work, and only the last few meshes of a batch leave threads idle.
fn pack_all(items: &[Item], threads: usize, arguments: &Arguments) -> anyhow::Result<Vec<Outcome>> {
    let workers = threads.min(items.len());
    let pools = (0..workers)
        .map(|worker| {
            let share = threads / workers + usize::from(worker < threads % workers);
            rayon::ThreadPoolBuilder::new().num_threads(share).build()
        })
        .collect::<Result<Vec<_>, _>>()?;
    let bar = bar(items.len(), arguments);
    let next = AtomicUsize::new(0);
    let outcomes: Mutex<Vec<Option<Outcome>>> = Mutex::new(items.iter().map(|_| None).collect());
    std::thread::scope(|scope| {
        for pool in &pools {
            scope.spawn(|| {
                while let Some((index, item)) = {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    items.get(index).map(|item| (index, item))
                } {
                    let outcome = pool.install(|| item.process(&arguments.packing));
                    if !arguments.json {
                        bar.suspend(|| report::tell(item, &outcome));
                    }
                    bar.inc(1);
                    outcomes.lock().unwrap_or_else(PoisonError::into_inner)[index] = Some(outcome);
                }
            });
        }
    });
    bar.finish_and_clear();
    let outcomes = outcomes.into_inner().unwrap_or_else(PoisonError::into_inner);
    Ok(outcomes.into_iter().flatten().collect())
}

fn bar(items: usize, arguments: &Arguments) -> ProgressBar {
    if arguments.json || !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("{bar:40} {pos} of {len} meshes, {elapsed}, {eta} left")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    let bar = ProgressBar::new(items as u64).with_style(style);
    bar.enable_steady_tick(std::time::Duration::from_millis(200));
    bar
}
