//! Clear water in a box: light that crosses it loses its red first.

use super::scene::WaterBlock;
use glam::Vec3;

/// Share of the light that a metre of water takes away is 1 − exp(−x): red, green, blue. Far more than clear water takes, so
/// that it shows over half a metre.
const ABSORPTION: Vec3 = Vec3::new(2.6, 1.1, 0.7);
/// What a great depth looks like, linear.
const DEEP: Vec3 = Vec3::new(0.07, 0.25, 0.36);
/// Reflected share of the light that meets water at a right angle.
const REFLECTANCE: f32 = 0.02;

/// A line of sight through water.
pub(super) struct Crossing {
    /// Metres of water before the thing that is seen.
    length: f32,
    /// Share of the sky's light that the water reflects where the line enters.
    reflected: f32,
}

impl WaterBlock {
    /// How a ray crosses the water before it meets a thing at `end` times its direction; `None` where it does not.
    pub(super) fn crossing(&self, (origin, direction): (Vec3, Vec3), end: f32) -> Option<Crossing> {
        let to = |corner: Vec3| (corner - origin) / direction;
        let (a, b) = (to(self.lower), to(self.upper));
        let (near, far) = (a.min(b), a.max(b));
        let (enter, leave) = (near.max_element().max(0.0), far.min_element().min(end));
        // A ray along a face makes what is not a number, and crosses nothing.
        (enter < leave).then(|| {
            let length = direction.length();
            let cosine = if near.max_element() == near.y { (direction.y / length).abs() } else { 1.0 };
            // C. Schlick, An inexpensive BRDF model for physically-based rendering (1994).
            let reflected = REFLECTANCE + (1.0 - REFLECTANCE) * (1.0 - cosine).powi(5);
            Crossing { length: (leave - enter) * length, reflected }
        })
    }
}

impl Crossing {
    /// What is left of `light` from beyond the water, with what the water adds under a sky of light `sky`.
    pub(super) fn tint(&self, light: Vec3, sky: Vec3) -> Vec3 {
        let passed = (ABSORPTION * -self.length).exp();
        DEEP.lerp(sky, self.reflected) * (Vec3::ONE - passed)
            + light * passed * (1.0 - self.reflected)
            + sky * passed * self.reflected
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WATER: WaterBlock =
        WaterBlock { lower: Vec3::new(-1.0, -2.0, -1.0), upper: Vec3::new(1.0, 0.0, 1.0) };

    #[test]
    fn only_what_lies_in_or_behind_the_water_is_tinted() {
        let down = (Vec3::new(0.3, 5.0, 0.1), Vec3::NEG_Y * 0.5);
        assert!(WATER.crossing(down, 9.9).is_none(), "a thing above it");
        assert!((WATER.crossing(down, 11.0).unwrap().length - 0.5).abs() < 1e-6);
        assert!((WATER.crossing(down, f32::INFINITY).unwrap().length - 2.0).abs() < 1e-6);
        assert!(
            WATER.crossing((Vec3::new(3.0, 5.0, 0.0), Vec3::NEG_Y), f32::INFINITY).is_none(),
            "beside it"
        );
        assert!(WATER.crossing((Vec3::Y, Vec3::Y), f32::INFINITY).is_none(), "away from it");
    }

    #[test]
    fn deep_water_hides_what_is_behind() {
        let [deep, shallow] = [100.0, 1e-6].map(|length| Crossing { length, reflected: 0.0 });
        assert!(deep.tint(Vec3::ONE, Vec3::ONE).distance(DEEP) < 1e-6);
        assert!(shallow.tint(Vec3::ONE, Vec3::ONE).distance(Vec3::ONE) < 1e-4);
    }
}
