//! Arguments that the examples share.

use crate::output::check_folder_of;
use crate::render::PictureSize;
use anyhow::{Result, ensure};
use clap::{Args, Parser};
use std::path::PathBuf;

/// How long, how fine and where to: to be flattened into an example's own arguments.
#[derive(Args, Clone, Debug)]
pub struct RunArguments {
    /// Steps of 1/60 s.
    #[arg(long)]
    pub steps: usize,
    /// Spheres per body.
    #[arg(long)]
    pub spheres: usize,
    /// Recording for Foxglove or Rerun.
    #[arg(long, value_name = "FILE")]
    pub mcap: PathBuf,
    /// Picture of the end, or of the time asked for.
    #[arg(long, value_name = "FILE")]
    pub png: PathBuf,
    /// Time of the picture (s).
    #[arg(long, value_name = "SECONDS")]
    pub png_time: Option<f64>,
    /// Width of the picture in pixels; 16:9.
    #[arg(long, value_name = "PIXELS", default_value_t = 1280, value_parser = clap::value_parser!(u32).range(16..=7680))]
    pub png_width: u32,
    /// Record the wall times of steps too, for plots; equal runs then no longer give equal files.
    #[arg(long)]
    pub timings: bool,
    /// Figures and checks as JSON.
    #[arg(long, value_name = "FILE.json")]
    pub summary: Option<PathBuf>,
}

/// An example's own defaults, as they stand in its help.
#[derive(Clone, Copy, Debug)]
pub struct Defaults {
    /// Of `--steps`.
    pub steps: &'static str,
    /// Of `--spheres`.
    pub spheres: &'static str,
    /// Of `--mcap`.
    pub mcap: &'static str,
    /// Of `--png`.
    pub png: &'static str,
}

/// Reads the command line; ends the program where it asks for help or cannot be understood.
#[must_use]
pub fn parse<A: Parser>(defaults: &Defaults) -> A {
    A::from_arg_matches(&command::<A>(defaults).get_matches()).unwrap_or_else(|error| error.exit())
}

fn command<A: Parser>(defaults: &Defaults) -> clap::Command {
    let Defaults { steps, spheres, mcap, png } = *defaults;
    let values = [("steps", steps), ("spheres", spheres), ("mcap", mcap), ("png", png)];
    values.into_iter().fold(A::command(), |command, (name, value)| {
        command.mut_arg(name, |argument| argument.default_value(value).required(false))
    })
}

impl RunArguments {
    /// Refuses what cannot be done, before any work is done for it.
    ///
    /// # Errors
    /// Names the argument or the folder.
    pub fn check(&self) -> Result<()> {
        for path in [Some(&self.mcap), Some(&self.png), self.summary.as_ref()].into_iter().flatten() {
            check_folder_of(path)?;
        }
        ensure!(self.spheres > 0, "zero spheres asked for; ask for at least one (--spheres)");
        let end = self.steps as f64 / 60.0;
        if let Some(time) = self.png_time {
            ensure!((0.0..=end).contains(&time), "--png-time {time} is not within the run of {end:.2} s");
        }
        Ok(())
    }

    /// Size of the picture.
    #[must_use]
    pub fn picture_size(&self) -> PictureSize {
        PictureSize::wide(self.png_width)
    }

    /// The step after which the picture is taken, where it is not the end.
    pub(super) fn picture_step(&self) -> Option<usize> {
        self.png_time.map(|time| (time * 60.0).round() as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::FromArgMatches;

    #[derive(Parser, Debug)]
    struct Example {
        #[command(flatten)]
        run: RunArguments,
    }

    const DEFAULTS: Defaults = Defaults { steps: "90", spheres: "50", mcap: "a.mcap", png: "a.png" };

    fn parsed(line: &[&str]) -> RunArguments {
        let matches = command::<Example>(&DEFAULTS).get_matches_from([&["example"], line].concat());
        Example::from_arg_matches(&matches).unwrap().run
    }

    #[test]
    fn examples_have_defaults_of_their_own() {
        let arguments = parsed(&[]);
        assert_eq!((arguments.steps, arguments.spheres), (90, 50));
        assert_eq!((arguments.mcap, arguments.png), ("a.mcap".into(), "a.png".into()));
        assert_eq!(parsed(&["--steps", "7"]).steps, 7);
    }

    #[test]
    fn what_cannot_be_done_is_refused_before_anything_is_done() {
        assert!(parsed(&[]).check().is_ok());
        let refused: [&[&str]; 4] =
            [&["--spheres=0"], &["--png-time=2"], &["--png-time=-0.5"], &["--mcap=/nowhere/a.mcap"]];
        for line in refused {
            assert!(parsed(line).check().is_err(), "{line:?}");
        }
    }
}
