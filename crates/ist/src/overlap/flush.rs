//! Contact that begins flush with the surface.
//!
//! Volume balls reach out of the solid, each by another length: where two of them meet first, a solid stands on the tips of a
//! few, and flat faces are bumpy. Inner balls touch the surface. So a contact sample keeps the volume of its volume balls, but
//! counts its depth from where the inner balls meet. With the depth h of the volume balls and i of the inner balls, along the
//! normal of the sample and with an allowance, volume balls protrude by `p = max(0, h − i)`. Contact is `δ = h − p` deep, and there is
//! none where that is not positive. The sample is the lens (or cap) of height `f = δ + p s(δ/ℓ)`, s a smooth step: nothing
//! at δ = 0 and the whole one, `f = h`, from `δ = ℓ` on.
//!
//! The normal of the sample has to be that of the contact. The stored normals will not do, as a ball at an edge touches two faces
//! and names one, nor the line between two centres: rings sank into each other, and nuts leaned.

/// Inner balls that touch the surface of a face leave gaps between them, so that solids would sink into each other by as much. They
/// count as this share of the mean radius of the volume balls larger, on either side.
///
/// Rings that stand on each other sink in by up to 1.13 % of their thickness with 0.05 and by less than 1 % with 0.075.
const ALLOWANCE: f32 = 0.075;

/// Depth of the contact at which the lens is whole, as a share of the smaller radius.
///
/// Stacks of three crates and two rings on a slope of 13°: the lower ring rocks at 36 mrad/s (root of the mean square) with 0.25, at 0.8
/// with 0.3 and at 2.9 with 0.35.
const WHOLE: f64 = 0.3;

/// How far (m) `mean_radius` (m) lets a contact begin in front of the surface.
pub(crate) fn allowance(mean_radius: f32) -> f32 {
    ALLOWANCE * mean_radius
}

/// Two balls, or a ball and a surface, in contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Flush {
    /// Height f (m) of the lens or cap.
    pub(super) height: f64,
    /// What its cross-section is to be multiplied by: df/dδ, or f/δ where that is more, so that a square law that is fitted to volume and
    /// cross-section ends no deeper than where the contact does.
    ///
    /// With f/δ alone the stacks of [`WHOLE`] rock, at 21 mrad/s on a slope of 10°; with df/dδ alone presses are off by a tenth.
    pub(super) slope: f64,
    /// The smooth step, 0 to 1.
    pub(super) whole: f64,
}

impl Flush {
    /// Of volume balls that meet to the height `volume` (m) and inner balls that do to `inner` (m), the smaller volume ball being of
    /// `radius` (m). `None` where there is no contact yet.
    pub(super) fn new(volume: f64, inner: f64, radius: f64) -> Option<Self> {
        if inner.is_nan() || inner <= 0.0 || volume <= 0.0 {
            return None;
        }
        let depth = volume.min(inner);
        let protrusion = volume - depth;
        let reach = WHOLE * radius;
        let x = (depth / reach).min(1.0);
        let whole = x * x * (3.0 - 2.0 * x);
        let height = depth + protrusion * whole;
        let tangent = 1.0 + protrusion * 6.0 * x * (1.0 - x) / reach;
        Some(Self { height, slope: tangent.max(height / depth), whole })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn rises_from_nothing_to_the_whole(
            protrusion in 0.0_f64..2.0,
            depth in 1e-6_f64..3.0,
            radius in 0.1_f64..10.0,
        ) {
            let at = |depth: f64| Flush::new(depth + protrusion, depth, radius).unwrap();
            let (flush, step) = (at(depth), 1e-7);
            prop_assert!(flush.height >= depth && flush.height <= (depth + protrusion) * (1.0 + 1e-12));
            prop_assert!(flush.slope >= 1.0 && (0.0..=1.0).contains(&flush.whole));
            if depth > WHOLE * radius {
                prop_assert!((flush.height - depth - protrusion).abs() < 1e-12 * flush.height);
            }
            // Never flatter than it is, and so steep that a line to nothing does not end deeper than the contact.
            let derivative = (at(depth + step).height - flush.height) / step;
            prop_assert!(flush.slope > derivative * (1.0 - 1e-4) - 1e-5, "{flush:?} {derivative}");
            prop_assert!(flush.slope * depth >= flush.height * (1.0 - 1e-12));
            let is_steep = (flush.slope - derivative).abs() < 1e-3 * derivative + 1e-3 * protrusion / radius;
            prop_assert!(is_steep || (flush.slope * depth - flush.height).abs() < 1e-9 * flush.height);
        }

        #[test]
        fn what_does_not_protrude_is_as_it_was(volume in 1e-6_f64..1.0, beyond in 0.0_f64..1.0, radius in 0.1_f64..1.0) {
            let flush = Flush::new(volume, volume + beyond, radius).unwrap();
            prop_assert_eq!((flush.height, flush.slope), (volume, 1.0));
        }
    }

    #[test]
    fn nothing_before_the_inner_balls_meet() {
        for inner in [0.0, -0.1, f64::NAN] {
            assert_eq!(Flush::new(0.1, inner, 1.0), None);
        }
        assert_eq!(Flush::new(-0.1, 0.1, 1.0), None);
    }
}
