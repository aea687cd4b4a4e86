//! `packer`: packs mesh files, checks them, and shows what is in an `.ist` file.

mod check;
mod info;
mod output;
mod pack;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Exit status for bad input, as clap uses for bad arguments.
const BAD_INPUT: u8 = 2;

/// Fills closed triangle meshes with disjoint inner spheres.
#[derive(Parser)]
#[command(
    version,
    after_help = "\
Examples:
  packer check bunny.obj
  packer pack bunny.obj -o bunny.ist
  packer pack bunny.obj -o bunny.ist --spheres 5000 --json
  packer pack gear.stl -o gear.ist --spheres 100000 --coverage 0.8
  packer info bunny.ist --csv bunny.csv"
)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Pack a mesh (.obj, .stl, .ply, .gltf, .glb) and write an .ist file.
    Pack(pack::Arguments),
    /// Tell whether a mesh can be packed, and what is wrong with it.
    Check(check::Arguments),
    /// Show what is in an .ist file.
    Info(info::Arguments),
}

fn main() -> ExitCode {
    let result = match Arguments::parse().command {
        Command::Pack(arguments) => pack::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Info(arguments) => info::run(&arguments),
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
