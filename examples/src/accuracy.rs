//! Overlap volumes against exact ones, band by band.

use crate::figures::percentile;
use crate::pair::PairSolid;
use crate::plot::Group;
use crate::poses::PoseFile;
use anyhow::{Context, Result};
use ist::{InnerSphere, InnerSphereTree, OverlapWorkspace, SpherePacking};

/// Upper ends of the bands as shares of the smaller solid: touches are in none, as what is wholly inside.
const BANDS: [f64; 5] = [0.002, 0.05, 0.25, 0.9999, f64::INFINITY];

/// The band of an exact volume, shallow, mid or deep, as 0 to 2.
#[must_use]
pub fn band(volume: f64, smaller: f64) -> Option<usize> {
    let share = volume / smaller;
    BANDS.windows(2).take(3).position(|ends| share >= ends[0] && share <= ends[1])
}

/// Median relative error of the measured volumes in each band; none where no pose is in it. Pairs are measured and exact
/// volumes.
#[must_use]
pub fn median_errors(pairs: &[(f64, f64)], smaller: f64) -> [Option<f64>; 3] {
    std::array::from_fn(|wanted| {
        let of_band = pairs.iter().filter(|(_, exact)| band(*exact, smaller) == Some(wanted));
        let errors: Vec<f64> = of_band.map(|(measured, exact)| (measured / exact - 1.0).abs()).collect();
        (!errors.is_empty()).then(|| percentile(&errors, 0.5))
    })
}

/// Trees of two solids, of their power cells or of plain inner balls.
///
/// # Errors
/// Where a solid's scale is no size.
pub fn trees([a, b]: &[PairSolid; 2], is_plain: bool) -> Result<[InnerSphereTree; 2]> {
    let tree = |solid: &PairSolid| {
        if !is_plain {
            return solid.tree();
        }
        PairSolid { packing: plain(&solid.packing)?, ..solid.clone() }.tree()
    };
    Ok([tree(a)?, tree(b)?])
}

/// Median errors with power cells beside those of plain inner balls, for a plot.
///
/// # Errors
/// Where no exact volume is known.
pub fn compare(name: &str, file: &PoseFile, solids: &[PairSolid; 2]) -> Result<Group> {
    let smaller = file.smaller_volume.with_context(|| {
        format!("no errors to plot: {name} does not have the exact volumes for this size of B (--scale-b)")
    })?;
    let errors = |is_plain| -> Result<_> {
        let ([a, b], mut workspace) = (trees(solids, is_plain)?, OverlapWorkspace::default());
        let measured = file.poses.iter().filter_map(|known| {
            Some((f64::from(a.overlap(&b, &known.pose, &mut workspace).volume), known.volume?))
        });
        Ok(median_errors(&measured.collect::<Vec<_>>(), smaller))
    };
    let (cells, plain) = (errors(false)?, errors(true)?);
    Ok(Group { name: name.to_owned(), errors: std::array::from_fn(|band| [cells[band], plain[band]]) })
}

/// The packing with every power cell cut down to its inner ball: the plain method.
///
/// # Errors
/// Never for a valid packing.
fn plain(packing: &SpherePacking) -> Result<SpherePacking> {
    let ball = |s: &InnerSphere| InnerSphere::solid_ball(s.center, s.radius, s.normal);
    Ok(SpherePacking::new(packing.spheres().iter().map(ball).collect(), *packing.solid())?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_leave_out_touches_and_what_is_inside() {
        let bands = [0.001, 0.002, 0.05, 0.051, 0.26, 0.99995].map(|volume| band(2.0 * volume, 2.0));
        assert_eq!(bands, [None, Some(0), Some(0), Some(1), Some(2), None]);
    }

    #[test]
    fn medians_are_of_their_band() {
        let pairs = [(0.011, 0.01), (0.0104, 0.01), (0.02, 0.01), (0.6, 0.5)];
        let [shallow, mid, deep] = median_errors(&pairs, 1.0);
        assert!((shallow.unwrap() - 0.1).abs() < 1e-9 && mid.is_none());
        assert!((deep.unwrap() - 0.2).abs() < 1e-9);
    }
}
