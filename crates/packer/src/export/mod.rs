//! Packings in the formats of other programs.
//!
//! | function | format | for |
//! |---|---|---|
//! | [`to_csv`] | a table with a line per sphere | spreadsheets, numpy, pandas |
//! | [`to_json`] | spheres and mass properties | scripts; planners that take a list of `center` and `radius` |
//! | [`to_urdf`] | a link with a `<sphere>` per ball and its `<inertial>` | robotics simulators and planners |
//!
//! Numbers are written with the fewest digits that give the same floating-point number back.

mod csv;
mod json;
mod urdf;

pub use csv::to_csv;
pub use json::to_json;
pub use urdf::to_urdf;

/// Why a packing was not exported.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The density is not that of a body.
    #[error("density {density} kg/m³ asked for; it is above zero and finite (water: 1000)")]
    InvalidDensity {
        /// What was asked (kg/m³).
        density: f64,
    },
    /// The writer of the format failed.
    #[error("cannot write {format}: {what}")]
    Write {
        /// Name of the format.
        format: &'static str,
        /// What the writer said.
        what: String,
    },
}
