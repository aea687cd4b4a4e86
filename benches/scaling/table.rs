//! The measurements as Markdown.

use crate::Measurement;
use crate::solids::Row;
use crate::turn::Turn;

/// A table, and what it comes to.
pub(crate) fn print(row: &Row, turn: Turn, measurements: &[Measurement]) {
    println!("\n{}, {turn}\n", row.name);
    println!(
        "| spheres | grid, 1 thread | grid, 2 threads | ratio | two trees at once, ratio | per sphere | tree | pairs per sphere | levels | bytes per sphere, tree + grid |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for (case, m) in row.cases.iter().zip(measurements) {
        let bytes = |bytes: usize| bytes as f64 / m.spheres as f64;
        println!(
            "| {} | {} | {} | {:.2} | {:.2} | {:.0} ns | {} | {:.2} | {} | {:.0} + {:.0} |",
            grouped(m.spheres),
            time(m.grid_one_thread),
            time(m.grid_two_threads),
            m.grid_one_thread / m.grid_two_threads,
            m.gain_at_once(),
            1e9 * m.per_sphere(m.grid_one_thread),
            time(m.tree),
            m.per_sphere(m.pairs),
            case.levels(),
            bytes(case.tree_bytes),
            bytes(case.grid_bytes),
        );
    }
    println!(
        "\nExponents: {:.3} on one thread, {:.3} on two, {:.3} of the tree.",
        exponent(measurements, |m| m.grid_one_thread),
        exponent(measurements, |m| m.grid_two_threads),
        exponent(measurements, |m| m.tree),
    );
}

impl Measurement {
    /// Spheres are those of both solids.
    fn per_sphere(&self, amount: f64) -> f64 {
        amount / (2 * self.spheres) as f64
    }
}

/// The e of t = c·nᵉ by least squares over log t = log c + e·log n.
pub(crate) fn exponent(measurements: &[Measurement], time: impl Fn(&Measurement) -> f64) -> f64 {
    let points = measurements.iter().map(|m| ((m.spheres as f64).ln(), time(m).ln()));
    let count = measurements.len() as f64;
    let (x, y) = points.clone().fold((0.0, 0.0), |(x, y), p| (x + p.0 / count, y + p.1 / count));
    let (xy, xx) =
        points.fold((0.0, 0.0), |(xy, xx), p| (xy + (p.0 - x) * (p.1 - y), xx + (p.0 - x) * (p.0 - x)));
    xy / xx
}

/// Three digits and a unit.
fn time(seconds: f64) -> String {
    let (value, unit) = if seconds < 1e-3 { (1e6 * seconds, "µs") } else { (1e3 * seconds, "ms") };
    let digits = if value < 10.0 { 2 } else { usize::from(value < 100.0) };
    format!("{value:.digits$} {unit}")
}

/// With commas between thousands.
pub(crate) fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}
