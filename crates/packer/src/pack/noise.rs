//! Random numbers that depend on nothing but their seed: SplitMix64 (G. Steele, D. Lea, C. Flood, *Fast
//! splittable pseudorandom number generators*, 2014).

use glam::DVec3;

/// A stream of random numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Noise(u64);

impl Noise {
    const STEP: u64 = 0x9E37_79B9_7F4A_7C15;

    /// The stream of `seed`; streams of neighbouring seeds have nothing in common.
    pub(super) fn new(seed: u64) -> Self {
        Self(mix(seed.wrapping_add(Self::STEP)))
    }

    pub(super) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(Self::STEP);
        mix(self.0)
    }

    /// Uniform in [0, 1).
    pub(super) fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform in the unit cube.
    pub(super) fn point(&mut self) -> DVec3 {
        DVec3::new(self.uniform(), self.uniform(), self.uniform())
    }
}

fn mix(z: u64) -> u64 {
    let z = (z ^ z >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ z >> 31
}
