//! Times before which two balls cannot meet, in closed form.

use glam::DVec3;

/// The first time s ≥ 0 at which `gap + rate s − ½ acceleration s²` is 0, for a positive gap.
pub(super) fn time_to_close(gap: f64, rate: f64, acceleration: f64) -> f64 {
    let root = libm::sqrt(rate * rate + 2.0 * acceleration * gap);
    if rate < 0.0 {
        // Nothing cancels, and the acceleration may be 0.
        2.0 * gap / (root - rate)
    } else if acceleration > 0.0 {
        (rate + root) / acceleration
    } else {
        f64::INFINITY
    }
}

/// The first time s ≥ 0 at which `|offset + velocity s| ≤ reach`; infinite if there is none.
pub(super) fn time_to_reach(offset: DVec3, velocity: DVec3, reach: f64) -> f64 {
    if offset.length_squared() <= reach * reach {
        return 0.0;
    }
    let speed = velocity.length();
    if speed == 0.0 {
        return f64::INFINITY;
    }
    let direction = velocity / speed;
    let way = -offset.dot(direction);
    let aside = (offset + way * direction).length_squared();
    let half = reach * reach - aside;
    if way <= 0.0 || half < 0.0 {
        return f64::INFINITY;
    }
    ((way - libm::sqrt(half)) / speed).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closing_times_are_roots() {
        for (gap, rate, acceleration) in
            [(1.0, -2.0, 0.0), (1.0, -2.0, 3.0), (0.5, 1.0, 4.0), (1e-9, 0.0, 7.0), (2.0, -1e-9, 1e3)]
        {
            let s = time_to_close(gap, rate, acceleration);
            assert!(
                (gap + rate * s - 0.5 * acceleration * s * s).abs() < 1e-12 * (1.0 + gap),
                "{gap} {rate}"
            );
        }
        assert_eq!(time_to_close(1.0, 0.0, 0.0), f64::INFINITY);
        assert_eq!(time_to_close(1.0, 2.0, 0.0), f64::INFINITY);
    }

    #[test]
    fn reaching_times_are_those_of_a_ball() {
        assert_eq!(time_to_reach(DVec3::X * 5.0, DVec3::X * -2.0, 1.0), 2.0);
        assert_eq!(time_to_reach(DVec3::X * 5.0, DVec3::X * 2.0, 1.0), f64::INFINITY);
        assert_eq!(time_to_reach(DVec3::X * 5.0, DVec3::ZERO, 1.0), f64::INFINITY);
        assert_eq!(time_to_reach(DVec3::new(5.0, 1.01, 0.0), DVec3::NEG_X, 1.0), f64::INFINITY);
        assert_eq!(time_to_reach(DVec3::X * 0.5, DVec3::X, 1.0), 0.0);
    }
}
