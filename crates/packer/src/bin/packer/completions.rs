//! `packer completions`.

use crate::output;
use clap::CommandFactory;
use clap_complete::Shell;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Shell to print the script for.
    #[arg(value_enum)]
    shell: Shell,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    // By way of memory: the generator panics where it cannot write, as when a pipe is closed.
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut crate::Arguments::command(), "packer", &mut script);
    output::print(String::from_utf8_lossy(&script).trim_end())
}
