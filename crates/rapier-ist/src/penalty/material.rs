//! What two colliders' materials say about their contact.

use super::impact::Impact;
use rapier3d::glamx::DVec3;

/// Material of a pair of colliders, after Rapier's combine rules.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Material {
    /// Force per overlap volume (N/m³).
    pub(crate) stiffness: f64,
    /// Least Hunt–Crossley dissipation (s/m).
    pub(crate) dissipation: f64,
    pub(crate) friction: f64,
    /// 0 to 1.
    pub(crate) restitution: f64,
    /// Velocity of the second collider relative to the first that friction works towards (m/s), as on a conveyor belt.
    pub(crate) tangent_velocity: DVec3,
    /// Slip speed under which friction is viscous (m/s).
    pub(crate) creep_speed: f64,
    /// Fastest that overlap alone may push bodies apart (m/s), positive.
    pub(crate) recovery_speed: f64,
    /// Approach speed from which on a contact rebounds (m/s).
    pub(crate) rebound_speed: f64,
}

/// Contacts with a lower restitution dissipate as with this one, whose rebound has 0.1 % of the energy.
const LEAST_RESTITUTION: f64 = 0.03;

/// However much an impact dissipates, overlap that is left after it separates up to this share of the recovery speed.
///
/// A stack of six rings at 1e4 N/m³ (20 kg/m³, 18 % deep, dropped 1 cm) sleeps after 1.1 s with 1, after 0.9 s with 0.3, and
/// slides apart with 0.1.
const LEAST_RECOVERY: f64 = 0.3;

impl Material {
    /// Hunt–Crossley dissipation (s/m) of a contact that began with `impact`.
    pub(crate) fn dissipation(&self, impact: Impact) -> f64 {
        if impact.speed <= 0.0 {
            return self.dissipation.max(1.0 / self.recovery_speed);
        }
        let restitution = self.restitution.max(LEAST_RESTITUTION);
        let mut dissipation = impact_dissipation(restitution) / impact.speed;
        if impact.rebounded {
            // What is left of the overlap must not push it faster than it rebounds.
            dissipation = dissipation.max(1.0 / (restitution * impact.speed));
        }
        if !impact.is_under_way() {
            dissipation = dissipation.min(1.0 / (LEAST_RECOVERY * self.recovery_speed));
        }
        dissipation.max(self.dissipation)
    }
}

/// Dissipation, in units of the inverse of the impact speed, with which a contact `f = φ(x) (1 + δ ẋ)` has the given
/// restitution e, whatever φ: the energy that φ takes up on the way in is what it gives back on the way out if
/// `ln((1 + d) / (1 − e d)) = d (1 + e)`. Zero for e = 1.
fn impact_dissipation(restitution: f64) -> f64 {
    let e = restitution;
    if e >= 1.0 {
        return 0.0;
    }
    // The left side is the smaller one up to the root and grows beyond all bounds at 1/e. The difference is convex beyond its
    // minimum at (1 − e)/e, and Newton's method falls towards the root from the right; where rounding leads it astray, bisection.
    let (mut lower, mut upper) = (0.0, 1.0 / e);
    // d = (1 − (1 + d) exp(−d (1 + e))) / e rises with d, and at 1/e it is right of the root.
    let mut d = (1.0 - (1.0 + upper) * libm::exp(-upper * (1.0 + e))) / e;
    // To all digits but a few: up to e = 0.8 that takes at most 9 steps, 23 at 0.999 and never more than 48 where rounding ends it.
    // By 48 bisections, with two logarithms each, the solve of a pile of 100 gears took 2 to 4 % longer.
    for _ in 0..48 {
        let excess = libm::log1p(d) - libm::log1p(-e * d) - d * (1.0 + e);
        if excess < 0.0 {
            lower = d;
        } else {
            upper = d;
        }
        let slope = (1.0 + e) * (1.0 / ((1.0 + d) * (1.0 - e * d)) - 1.0);
        let newton = d - excess / slope;
        let next = if newton >= lower && newton <= upper { newton } else { 0.5 * (lower + upper) };
        let change = (next - d).abs();
        d = next;
        if change <= 1e-12 * d {
            break;
        }
    }
    d
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The same by bisection alone: the left side of the equation is the smaller one up to the root.
    fn bisected(e: f64) -> f64 {
        let (mut lower, mut upper) = (0.0, 1.0 / e);
        for _ in 0..48 {
            let d = 0.5 * (lower + upper);
            if libm::log1p(d) - libm::log1p(-e * d) < d * (1.0 + e) { lower = d } else { upper = d }
        }
        lower
    }

    proptest! {
        /// Near e = 1 both sides cancel, and neither way finds more digits.
        #[test]
        fn dissipations_are_those_of_bisection(closeness in 0.0_f64..4.0, share in 0.0_f64..1.0) {
            for restitution in [1.0 - 10.0_f64.powf(-closeness), share].map(|e| e.max(LEAST_RESTITUTION)) {
                let (exact, found) = (bisected(restitution), impact_dissipation(restitution));
                let room = 1e-12 + 1e-15 / (1.0 - restitution).powi(2);
                prop_assert!((found / exact - 1.0).abs() <= room, "{restitution}: {found} instead of {exact}");
            }
        }
    }

    #[test]
    fn impacts_have_the_restitution_that_they_were_made_for() {
        for (restitution, power) in [(0.1, 1), (0.3, 2), (0.5, 1), (0.8, 2), (0.95, 3)] {
            let dissipation = impact_dissipation(restitution) / 3.0;
            // A unit mass against f = 1e6 xⁿ (1 + δ ẋ), by semi-implicit steps of a microsecond.
            let (mut x, mut v) = (0.0_f64, 3.0);
            loop {
                v -= 1e-6 * (1e6 * x.powi(power) * (1.0 + dissipation * v)).max(0.0);
                x += 1e-6 * v;
                if x <= 0.0 {
                    break;
                }
            }
            assert!((-v / 3.0 - restitution).abs() < 2e-3, "{restitution} {power}: {v}");
        }
    }
}
