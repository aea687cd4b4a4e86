//! Open parts of the overlap and sums over them.

use super::super::totals::{Totals, WrenchSum};
use glam::Vec3;

/// A node of B with some nodes of A that it meets, all on one level: that part of the overlap which the spheres below
/// them make.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Row {
    /// Centre and radius of B's node in A's frame.
    pub(super) ball: [f32; 4],
    /// Index of B's node in its level.
    pub(super) node: u32,
    pub(super) level_a: u8,
    pub(super) level_b: u8,
    /// Where in the frontier's lists the nodes of A begin, and how many there are.
    pub(super) start: u32,
    pub(super) len: u32,
    /// The largest radius of a node of A.
    pub(super) largest: f32,
    pub(super) part: Part,
}

/// What is known about a part of the overlap, in A's unscaled frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Part {
    /// The part's volume is at least that …
    pub(super) lower: f32,
    /// … and at most that.
    pub(super) upper: f32,
    pub(super) expected: Expected,
}

/// Expected sums over the pairs of spheres of a part; as [`Totals`].
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Expected {
    pub(super) volume: f32,
    pub(super) moment: Vec3,
    pub(super) gradient: Wrench,
    pub(super) outward: Wrench,
}

/// A force and its torque about A's origin.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wrench {
    pub(super) force: Vec3,
    pub(super) torque: Vec3,
}

impl Expected {
    fn is_finite(&self) -> bool {
        let Self { volume, moment, gradient, outward } = self;
        let vectors = [moment, &gradient.force, &gradient.torque, &outward.force, &outward.torque];
        volume.is_finite() && vectors.iter().all(|v| v.is_finite())
    }

    /// The same with this volume, everything in proportion.
    ///
    /// Of balls that are too small for f32 to hold their volumes the densities are infinite: then nothing but the volume is known.
    pub(super) fn with_volume(self, volume: f32) -> Self {
        if self.volume > 0.0 && self.is_finite() {
            self.scaled(volume / self.volume)
        } else {
            Self { volume, ..Self::default() }
        }
    }

    /// Everything times `factor`.
    fn scaled(self, factor: f32) -> Self {
        let wrench = |w: Wrench| Wrench { force: w.force * factor, torque: w.torque * factor };
        Self {
            volume: self.volume * factor,
            moment: self.moment * factor,
            gradient: wrench(self.gradient),
            outward: wrench(self.outward),
        }
    }
}

/// Sums over all open parts. A part that is opened is subtracted and what it is made of is added, so that they are
/// there at any time.
#[derive(Clone, Debug, Default)]
pub(super) struct OpenSums {
    pub(super) lower: f64,
    pub(super) upper: f64,
    pub(super) expected: Totals,
    /// The largest `upper` so far, and how often it was changed: what adding and subtracting has rounded away is at
    /// most their product times 2⁻⁵³.
    peak: f64,
    changes: u32,
}

impl OpenSums {
    pub(super) fn add(&mut self, part: &Part) {
        self.change(part, 1.0);
    }

    pub(super) fn subtract(&mut self, part: &Part) {
        self.change(part, -1.0);
    }

    fn change(&mut self, part: &Part, sign: f64) {
        self.lower += sign * f64::from(part.lower);
        self.upper += sign * f64::from(part.upper);
        self.peak = self.peak.max(self.upper);
        self.changes += 1;
        let (sums, expected) = (&mut self.expected, &part.expected);
        sums.volume += sign * f64::from(expected.volume);
        sums.moment += sign * expected.moment.as_dvec3();
        for (sum, wrench) in
            [(&mut sums.gradient, &expected.gradient), (&mut sums.outward, &expected.outward)]
        {
            sum.force += sign * wrench.force.as_dvec3();
            sum.torque += sign * wrench.torque.as_dvec3();
        }
    }

    /// Bound of the rounding of `lower` and `upper`.
    pub(super) fn rounding(&self) -> f64 {
        self.peak * f64::from(self.changes) * f64::EPSILON
    }
}

/// Adds `open`, times `factor`, to the sums over resolved pairs.
pub(super) fn add_open(resolved: &mut Totals, open: &Totals, factor: f64) {
    resolved.volume += factor * open.volume;
    resolved.moment += factor * open.moment;
    let add = |sum: &mut WrenchSum, wrench: &WrenchSum| {
        sum.force += factor * wrench.force;
        sum.torque += factor * wrench.torque;
    };
    add(&mut resolved.gradient, &open.gradient);
    add(&mut resolved.outward, &open.outward);
}
