//! Two balls and the line through their centres.

use glam::DVec3;

/// Two balls, their gap and where they are nearest.
#[derive(Clone, Copy, Debug)]
pub(super) struct BallPair {
    pub(super) centers: [DVec3; 2],
    pub(super) radii: [f64; 2],
    /// Unit vector from the first centre to the second.
    pub(super) normal: DVec3,
    /// Distance of the balls (m), negative where they meet.
    pub(super) gap: f64,
}

impl BallPair {
    /// `fallback` is the normal of concentric balls.
    pub(super) fn new(a: (DVec3, f64), b: (DVec3, f64), fallback: DVec3) -> Self {
        let delta = b.0 - a.0;
        Self {
            centers: [a.0, b.0],
            radii: [a.1, b.1],
            normal: delta.try_normalize().unwrap_or(fallback),
            gap: delta.length() - a.1 - b.1,
        }
    }

    /// The nearest points of the balls; where they meet, twice the middle of what they share of the line.
    pub(super) fn witnesses(&self) -> [DVec3; 2] {
        let [a, b] = self.radii;
        if self.gap > 0.0 {
            return [self.centers[0] + a * self.normal, self.centers[1] - b * self.normal];
        }
        // On the line, from the first centre: [−a, a] and [d − b, d + b].
        let d = self.gap + a + b;
        let middle = 0.5 * ((-a).max(d - b) + a.min(d + b));
        [self.centers[0] + middle * self.normal; 2]
    }
}
