//! The spherical cap, the part of a ball behind a plane.
//!
//! With h the height of the cap, clamped to [0, 2r] so that the same formulas give a whole ball and nothing:
//! volume πh²(3r−h)/3, base πh(2r−h), centroid 3(2r−h)²/(4(3r−h)) from the ball's centre (by integrating discs).

use core::f64::consts::PI;

/// The part of a ball behind a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cap {
    /// Height (m), from the base to the pole.
    pub(super) height: f64,
    /// Volume (m³).
    pub(super) volume: f64,
    /// Area of the base (m²); the derivative of the volume by the height.
    pub(super) base: f64,
    /// Distance of the centroid from the ball's centre (m), towards the pole.
    pub(super) centroid: f64,
}

impl Cap {
    /// The cap of a ball of radius `radius` (m), positive, whose centre is `distance` (m) in front of the plane, negative
    /// behind it.
    pub(super) fn new(radius: f64, distance: f64) -> Self {
        let height = (radius - distance).clamp(0.0, 2.0 * radius);
        let (rest, thrice) = (2.0 * radius - height, 3.0 * radius - height);
        Self {
            height,
            volume: PI / 3.0 * height * height * thrice,
            base: PI * height * rest,
            centroid: 0.75 * rest * rest / thrice,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn matches_quadrature(radius in 0.1_f64..3.0, share in -1.2_f64..1.2) {
            let (cap, steps) = (Cap::new(radius, share * radius), 20_000);
            let (mut volume, mut moment) = (0.0, 0.0);
            let dx = cap.height / f64::from(steps);
            for i in 0..steps {
                let x = radius - cap.height + dx * (f64::from(i) + 0.5);
                let disc = PI * (radius * radius - x * x).max(0.0);
                volume += disc * dx;
                moment += disc * dx * x;
            }
            let size = radius.powi(3);
            prop_assert!((cap.volume - volume).abs() < 1e-6 * size);
            prop_assert!((cap.volume * cap.centroid - moment).abs() < 1e-6 * size * radius);
        }

        #[test]
        fn the_base_is_the_derivative(radius in 0.1_f64..3.0, share in -1.1_f64..1.1) {
            let (d, e) = (share * radius, 1e-6);
            let slope = (Cap::new(radius, d - e).volume - Cap::new(radius, d + e).volume) / (2.0 * e);
            prop_assert!((Cap::new(radius, d).base - slope).abs() < 1e-4 * radius);
        }
    }
}
