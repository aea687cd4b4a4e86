//! Closed forms for the lens, the intersection of two balls.
//!
//! For balls of radii a, b whose centres are d apart (|a−b| < d < a+b) the intersection is two spherical caps
//! that share a circle. With the penetration h = a+b−d the cap heights are
//! `h_a = h(b−a+d)/(2d)` and `h_b = h(a−b+d)/(2d)`; a cap of height h on a ball of radius r has volume
//! `πh²(3r−h)/3` and first moment `πh²(2r−h)²/4` about the ball's centre (both by integrating discs). Heights
//! clamped to `[0, 2r]` make the same formulas give a contained ball and disjoint balls. Nothing cancels where
//! the lens is thin: h appears as a factor.

use crate::sphere::SQUARABLE;
use core::f64::consts::PI;

/// The intersection of two balls, on the line from the first centre to the second.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Lens {
    /// Volume (m³).
    pub volume: f64,
    /// Area of the disc that the intersection circle bounds (m²); `−dV/dd`. Zero where one ball contains the other, unless the two are
    /// the same: then that of their great circle, which it comes near to before.
    pub area: f64,
    /// Signed distance of the centroid from the first centre (m).
    pub centroid: f64,
    /// Second derivative of the volume by the distance d of the centres (m): with the disc's area π(a² − x²) and
    /// dx/dd = (d − x)/d it is 2πx(d − x)/d. Zero where one ball contains the other.
    pub curvature: f64,
}

impl Lens {
    /// The lens of balls of radii `a` and `b` (m) at distance `d` (m) of their centres.
    ///
    /// All-zero where the balls do not meet, where one has no radius above zero, and where a number is not finite or so small that
    /// f64 has no volumes for it. Where one contains the other, the smaller ball. Exact to rounding for radii up to 1e70 m.
    #[must_use]
    pub fn new(a: f64, b: f64, d: f64) -> Self {
        let h = a + b - d;
        let nothing = Self { volume: 0.0, area: 0.0, centroid: 0.0, curvature: 0.0 };
        // False for what is not a number, too.
        if !(h > 0.0 && a > 0.0 && b > 0.0 && h < f64::INFINITY) {
            return nothing;
        }
        // Concentric balls: any positive distance gives the same clamped heights.
        let d = d.max(SQUARABLE);
        let h_a = (h * (b - a + d) / (2.0 * d)).clamp(0.0, 2.0 * a);
        let h_b = (h * (a - b + d) / (2.0 * d)).clamp(0.0, 2.0 * b);
        let cap_b = PI / 3.0 * h_b * h_b * (3.0 * b - h_b);
        let volume = PI / 3.0 * h_a * h_a * (3.0 * a - h_a) + cap_b;
        if volume == 0.0 {
            return nothing;
        }
        let (chord_a, chord_b) = (h_a * (2.0 * a - h_a), h_b * (2.0 * b - h_b));
        let (moment_a, moment_b) = (PI / 4.0 * (chord_a * chord_a), PI / 4.0 * (chord_b * chord_b));
        let area = PI * h_a * (2.0 * a - h_a);
        let curvature = if area > 0.0 { 2.0 * PI * (a - h_a) * (b - h_b) / d } else { 0.0 };
        Self { volume, area, centroid: (moment_a + d * cap_b - moment_b) / volume, curvature }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Volume and first moment by summing discs.
    fn by_quadrature(a: f64, b: f64, d: f64) -> (f64, f64) {
        let (mut volume, mut moment) = (0.0, 0.0);
        let steps = 200_000;
        for i in 0..steps {
            let x = -a + 2.0 * a * (f64::from(i) + 0.5) / f64::from(steps);
            let disc = (a * a - x * x).min(b * b - (x - d) * (x - d)).max(0.0);
            volume += PI * disc;
            moment += PI * disc * x;
        }
        let dx = 2.0 * a / f64::from(steps);
        (volume * dx, moment * dx)
    }

    #[test]
    fn matches_quadrature() {
        for (a, b, d) in [
            (1.0, 1.0, 1.5),
            (1.0, 0.3, 1.1),
            (0.4, 1.0, 0.7),
            (1.0, 0.2, 0.5),
            (0.2, 1.0, 0.5),
            (1.0, 1.0, 0.01),
        ] {
            let (lens, (volume, moment)) = (Lens::new(a, b, d), by_quadrature(a, b, d));
            assert!((lens.volume - volume).abs() < 1e-6, "{a} {b} {d}");
            assert!((lens.volume * lens.centroid - moment).abs() < 1e-6, "{a} {b} {d}");
        }
    }

    #[test]
    fn matches_the_textbook_volume() {
        let (a, b, d) = (0.8_f64, 0.5_f64, 1.0_f64);
        let textbook =
            PI * (a + b - d).powi(2) * (d * d + 2.0 * d * (a + b) - 3.0 * (a - b).powi(2)) / (12.0 * d);
        assert!((Lens::new(a, b, d).volume - textbook).abs() < 1e-15);
    }

    #[test]
    fn issue_no_radius_has_no_lens() {
        let nothing = Lens::new(1.0, 1.0, 3.0);
        assert_eq!((nothing.volume, nothing.area, nothing.centroid, nothing.curvature), (0.0, 0.0, 0.0, 0.0));
        for (a, b, d) in [
            (1.0, 0.0, 0.5),
            (1.0, -1.0, 0.5),
            (-1.0, 2.0, 0.5),
            (1.0, 1.0, f64::NAN),
            (f64::NAN, 1.0, 0.5),
            (1.0, f64::INFINITY, 0.5),
            (1e-200, 1e-200, 1e-200),
        ] {
            assert_eq!(Lens::new(a, b, d), nothing, "{a} {b} {d}");
            assert_eq!(Lens::new(b, a, d), nothing, "{b} {a} {d}");
        }
    }

    proptest! {
        #[test]
        fn lenses_of_all_sizes_are_finite(a in -80.0_f64..70.0, b in -80.0_f64..70.0, share in 0.0_f64..2.0) {
            let (a, b) = (10.0_f64.powf(a), 10.0_f64.powf(b));
            let lens = Lens::new(a, b, share * a.max(b));
            prop_assert!(lens.volume >= 0.0 && lens.area >= 0.0);
            prop_assert!([lens.volume, lens.area, lens.centroid, lens.curvature].iter().all(|x| x.is_finite()));
            let smaller = 4.0 / 3.0 * PI * a.min(b).powi(3);
            prop_assert!(lens.volume <= smaller * (1.0 + 1e-12));
        }

        #[test]
        fn area_is_minus_the_derivative_of_volume(a in 0.1_f64..2.0, b in 0.1_f64..2.0, t in 0.01_f64..0.99) {
            let d = (a - b).abs() + t * (a + b - (a - b).abs());
            let e = 1e-5;
            let slope = (Lens::new(a, b, d + e).volume - Lens::new(a, b, d - e).volume) / (2.0 * e);
            prop_assert!((Lens::new(a, b, d).area + slope).abs() < 1e-6);
        }

        #[test]
        fn curvature_is_minus_the_derivative_of_the_area(
            a in 0.1_f64..2.0, b in 0.1_f64..2.0, t in 0.05_f64..0.95,
        ) {
            let d = (a - b).abs() + t * (a + b - (a - b).abs());
            let e = 1e-6 * d;
            let slope = (Lens::new(a, b, d + e).area - Lens::new(a, b, d - e).area) / (2.0 * e);
            let lens = Lens::new(a, b, d);
            prop_assert!((lens.curvature + slope).abs() < 1e-6 * lens.curvature.abs().max(1.0));
        }

        #[test]
        fn is_symmetric_in_the_two_balls(a in 0.1_f64..2.0, b in 0.1_f64..2.0, d in 0.0_f64..4.0) {
            let (ab, ba) = (Lens::new(a, b, d), Lens::new(b, a, d));
            prop_assert!((ab.volume - ba.volume).abs() <= 1e-12 * ab.volume.max(1.0));
            if ab.volume > 1e-9 {
                prop_assert!((ab.centroid - (d - ba.centroid)).abs() < 1e-6);
            }
        }
    }
}
