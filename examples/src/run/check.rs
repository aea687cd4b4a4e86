//! What an example asserts of its own physics.

use crate::output::print_line;
use anyhow::Result;
use serde::Serialize;

/// A figure of a run beside what it should be.
#[derive(Clone, Debug, Serialize)]
pub struct Check {
    /// What was measured.
    pub name: String,
    /// The figure.
    pub measured: f64,
    /// Its unit; empty for numbers.
    pub unit: &'static str,
    /// What it should be.
    pub wanted: Wanted,
    /// Whether it is.
    pub passed: bool,
}

/// What a figure should be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Wanted {
    /// No more than this.
    AtMost(f64),
    /// No less than this.
    AtLeast(f64),
    /// This value, give or take a share of it.
    Near {
        /// The value.
        value: f64,
        /// Largest deviation as a share of the value.
        tolerance: f64,
    },
    /// Anything: the figure is reported, and no promise rests on it.
    Reported,
}

/// How the checks of an example went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Every one passed.
    Passed,
    /// One failed, or more.
    Failed,
}

impl Check {
    /// The figure `measured` beside what is wanted of it. A figure that is no number passes nothing.
    #[must_use]
    pub fn new(name: impl Into<String>, measured: f64, unit: &'static str, wanted: Wanted) -> Self {
        let passed = match wanted {
            Wanted::AtMost(most) => measured <= most,
            Wanted::AtLeast(least) => measured >= least,
            Wanted::Near { value, tolerance } => (measured - value).abs() <= tolerance * value.abs(),
            Wanted::Reported => measured.is_finite(),
        };
        Self { name: name.into(), measured, unit, wanted, passed }
    }

    /// The figure without any promise.
    #[must_use]
    pub fn reported(self) -> Self {
        Self::new(self.name, self.measured, self.unit, Wanted::Reported)
    }
}

/// Whether all of `checks` passed.
#[must_use]
pub fn verdict(checks: &[Check]) -> Verdict {
    if checks.iter().all(|check| check.passed) { Verdict::Passed } else { Verdict::Failed }
}

/// Prints one line per check.
///
/// # Errors
/// As [`print_line`].
pub fn report(checks: &[Check]) -> Result<()> {
    checks.iter().try_for_each(|check| print_line(format_args!("  {}", line(check))))
}

fn line(check: &Check) -> String {
    let unit = if check.unit.is_empty() { String::new() } else { format!(" {}", check.unit) };
    let wanted = match check.wanted {
        Wanted::AtMost(most) => format!("at most {}{unit}", figure(most)),
        Wanted::AtLeast(least) => format!("at least {}{unit}", figure(least)),
        Wanted::Near { value, tolerance } => {
            format!("{}{unit} ± {} %", figure(value), figure(100.0 * tolerance))
        }
        Wanted::Reported => "reported only".to_owned(),
    };
    let passed = match check.wanted {
        Wanted::Reported => "      ",
        _ if check.passed => "ok    ",
        _ => "FAILED",
    };
    format!("{passed} {}: {}{unit} ({wanted})", check.name, figure(check.measured))
}

/// A number in as few digits as tell it: four significant ones, none for whole numbers.
fn figure(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let digits = (3 - value.abs().log10().floor() as i32).clamp(0, 9) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn passes(measured: f64, wanted: Wanted) -> bool {
        Check::new("figure", measured, "m", wanted).passed
    }

    #[test]
    fn bounds_belong_to_what_is_wanted() {
        assert!(passes(1.0, Wanted::AtMost(1.0)) && !passes(1.001, Wanted::AtMost(1.0)));
        assert!(passes(1.0, Wanted::AtLeast(1.0)) && !passes(0.999, Wanted::AtLeast(1.0)));
        let near = Wanted::Near { value: -2.0, tolerance: 0.25 };
        assert!(passes(-2.5, near) && passes(-1.5, near) && !passes(-2.51, near) && !passes(2.0, near));
    }

    #[test]
    fn what_is_no_number_passes_nothing() {
        let near = Wanted::Near { value: 1.0, tolerance: 10.0 };
        for wanted in [Wanted::AtMost(1.0), Wanted::AtLeast(1.0), near, Wanted::Reported] {
            assert!(!passes(f64::NAN, wanted), "{wanted:?}");
        }
    }

    #[test]
    fn one_failure_decides() {
        let [good, bad] = [1.0, 3.0].map(|x| Check::new("figure", x, "", Wanted::AtMost(2.0)));
        assert_eq!(verdict(&[]), Verdict::Passed);
        assert_eq!(verdict(&[good.clone(), good.clone()]), Verdict::Passed);
        assert_eq!(verdict(&[good, bad.clone()]), Verdict::Failed);
        assert_eq!(verdict(&[bad.reported()]), Verdict::Passed);
    }

    #[test]
    fn lines_say_figure_and_bound() {
        let check = Check::new("drift", 0.01234567, "%", Wanted::AtMost(1.0));
        assert_eq!(line(&check), "ok     drift: 0.01235 % (at most 1 %)");
        let check = Check::new("ratio", 1.7, "", Wanted::Near { value: 1.5, tolerance: 0.01 });
        assert_eq!(line(&check), "FAILED ratio: 1.7 (1.5 ± 1 %)");
        assert_eq!(figure(12345.678), "12346");
    }
}
