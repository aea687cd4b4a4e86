//! `packer`: packs mesh files, checks them, and shows what is in an `.ist` file.

mod batch;
mod check;
mod completions;
mod examples;
mod exports;
mod info;
mod options;
mod output;
mod pack;
mod preview;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Exit status for bad input, as clap uses for bad arguments.
const BAD_INPUT: u8 = 2;

/// Fills closed triangle meshes with disjoint inner spheres.
#[derive(Parser)]
#[command(version, after_help = examples::ALL)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Pack a mesh (.obj, .stl, .ply, .gltf, .glb) and write an .ist file.
    #[command(after_help = examples::PACK)]
    Pack(pack::Arguments),
    /// Pack every mesh below a folder; what is packed already is skipped.
    #[command(after_help = examples::BATCH)]
    Batch(batch::Arguments),
    /// Tell whether a mesh can be packed, and what is wrong with it.
    #[command(after_help = examples::CHECK)]
    Check(check::Arguments),
    /// Show what is in an .ist file, draw it, and write it in other formats.
    #[command(after_help = examples::INFO)]
    Info(info::Arguments),
    /// Print a script that completes this program's arguments in a shell.
    #[command(after_help = examples::COMPLETIONS)]
    Completions(completions::Arguments),
}

fn main() -> ExitCode {
    let result = match Arguments::parse().command {
        Command::Pack(arguments) => pack::run(&arguments),
        Command::Batch(arguments) => batch::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Info(arguments) => info::run(&arguments),
        Command::Completions(arguments) => completions::run(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // A reader that closed the pipe has seen enough.
            if error
                .downcast_ref::<std::io::Error>()
                .is_some_and(|e| e.kind() == std::io::ErrorKind::BrokenPipe)
            {
                return ExitCode::SUCCESS;
            }
            eprintln!("error: {}", output::message(&error));
            ExitCode::from(BAD_INPUT)
        }
    }
}
