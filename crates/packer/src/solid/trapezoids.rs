//! A triangle cut along segments, as trapezoids.
//!
//! The trapezoidal decomposition of an arrangement of segments (M. de Berg et al., *Computational geometry*,
//! chapter 6), in the simple form: vertical lines through all ends and crossings make slabs, in which no two
//! segments cross.

use glam::DVec2;

/// Segments in one triangle above which it is not cut. Crossings are looked for in all pairs; the curve in which
/// a mesh of 100,000 triangles cuts a plane has about a thousand segments.
const MOST_CUTS: usize = 4_000;
/// Trapezoids above which the triangle is not cut, for each segment and for 64 more. A curve that does not cross itself makes
/// about 6; segments that cross all others make more than their number.
const MOST_PER_CUT: usize = 64;
/// Slabs and trapezoids of less than this width or height are left out.
const THINNEST: f64 = 1e-12;

/// Corners, counter-clockwise from the lower left.
pub(super) type Trapezoid = [DVec2; 4];

/// Cuts the triangle `u ≥ 0, v ≥ 0, u + v ≤ 1` along `cuts`. None if there are too many; O(n²) for n segments that
/// rarely cross.
pub(super) fn trapezoids(cuts: &[[DVec2; 2]]) -> Option<Vec<Trapezoid>> {
    if cuts.len() > MOST_CUTS {
        return None;
    }
    let most = MOST_PER_CUT * (cuts.len() + MOST_PER_CUT);
    let sides = [[DVec2::ZERO, DVec2::X], [DVec2::Y, DVec2::X]];
    let segments: Vec<[DVec2; 2]> =
        sides.iter().chain(cuts).map(|[a, b]| if a.x <= b.x { [*a, *b] } else { [*b, *a] }).collect();
    let mut lines: Vec<f64> = segments.iter().flatten().map(|end| end.x.clamp(0.0, 1.0)).collect();
    for (index, segment) in segments.iter().enumerate() {
        lines.extend(segments[..index].iter().filter_map(|other| crossing(segment, other)));
        if lines.len() > most {
            return None;
        }
    }
    lines.sort_by(f64::total_cmp);
    lines.dedup_by(|b, a| *b - *a < THINNEST);
    let mut out = Vec::new();
    let mut heights = Vec::new();
    for slab in lines.windows(2) {
        let [left, right] = [slab[0], slab[1]];
        let middle = 0.5 * (left + right);
        heights.clear();
        heights.extend(
            segments
                .iter()
                .filter(|[a, b]| a.x < middle && middle < b.x)
                .map(|segment| [middle, left, right].map(|x| height(segment, x))),
        );
        heights.sort_by(|a, b| a[0].total_cmp(&b[0]));
        for pair in heights.windows(2) {
            let ([low, low_left, low_right], [high, high_left, high_right]) = (pair[0], pair[1]);
            if high - low > THINNEST {
                out.push([
                    DVec2::new(left, low_left),
                    DVec2::new(right, low_right),
                    DVec2::new(right, high_right),
                    DVec2::new(left, high_left),
                ]);
            }
        }
        if out.len() > most {
            return None;
        }
    }
    Some(out)
}

/// Height of a segment above `x`, within the triangle.
fn height([a, b]: &[DVec2; 2], x: f64) -> f64 {
    let share = ((x - a.x) / (b.x - a.x)).clamp(0.0, 1.0);
    (a.y + (b.y - a.y) * share).clamp(0.0, 1.0 - x)
}

/// Abscissa of the point in which two segments cross.
fn crossing([a, b]: &[DVec2; 2], [c, d]: &[DVec2; 2]) -> Option<f64> {
    let (ab, cd, ac) = (*b - *a, *d - *c, *c - *a);
    let determinant = ab.perp_dot(cd);
    let (s, t) = (ac.perp_dot(cd) / determinant, ac.perp_dot(ab) / determinant);
    // Also false where the segments are parallel and the quotients not finite.
    let crosses = s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0;
    crosses.then(|| (a.x + ab.x * s).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(trapezoids: &[Trapezoid]) -> f64 {
        let area = |[a, b, c, d]: &Trapezoid| 0.5 * (*c - *a).perp_dot(*d - *b);
        trapezoids.iter().map(area).sum()
    }

    #[test]
    fn trapezoids_tile_the_triangle_and_none_is_crossed() {
        let end = |i: u32, factor: f64| {
            let p = (f64::from(i) * DVec2::new(0.754_877_7, 0.569_840_3) * factor).fract();
            if p.x + p.y > 1.0 { 1.0 - p } else { p }
        };
        for count in [0, 1, 2, 7, 30] {
            let cuts: Vec<_> = (1..=count).map(|i| [end(i, 1.0), end(i, 1.618)]).collect();
            let found = trapezoids(&cuts).unwrap();
            assert!((area(&found) - 0.5).abs() < 1e-9);
            for [a, b, c, d] in &found {
                let middle = 0.25 * (*a + *b + *c + *d);
                for side in [[*a, middle], [*b, middle], [*c, middle], [*d, middle]] {
                    let shortened = side.map(|p| p.lerp(middle, 1e-3));
                    assert!(cuts.iter().all(|cut| crossing(cut, &shortened).is_none()));
                }
            }
        }
    }

    #[test]
    fn upright_and_repeated_cuts_are_no_hindrance() {
        let upright = [DVec2::new(0.5, 0.0), DVec2::new(0.5, 0.5)];
        let level = [DVec2::new(0.0, 0.25), DVec2::new(0.75, 0.25)];
        let found = trapezoids(&[upright, level, upright, level]).unwrap();
        assert_eq!(found.len(), 5);
        assert!((area(&found) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn a_tangle_is_given_up() {
        let cuts: Vec<_> = (1..600)
            .map(|i| f64::from(i) / 601.0)
            .map(|x| [DVec2::new(x, 0.0), DVec2::new(0.0, 1.0 - x)])
            .collect();
        assert!(trapezoids(&cuts).is_none());
        assert!(trapezoids(&vec![[DVec2::ZERO, DVec2::ONE]; MOST_CUTS + 1]).is_none());
    }
}
