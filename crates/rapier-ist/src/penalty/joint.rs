//! Joints, and contacts that Rapier solves, inside the penalty solve: rows of forces that fall with the speed along them.

use super::body::SolverBody;
use super::twist::{Screw, Symmetric6};
use rapier3d::glamx::{DMat3, DVec3};

/// What a row is in Rapier's joint, and along which of its axes.
#[derive(Clone, Copy, Debug)]
pub(crate) enum RowKind {
    Lock(usize),
    Limit(usize),
    Motor(usize),
}

/// One direction in which a joint acts: the force along `axis` is `force − damping · speed`, within `bounds`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointRow {
    /// Wrench on the second body, about its anchor, per unit of force.
    axis: Screw,
    force: f64,
    damping: f64,
    bounds: [f64; 2],
    /// Relative twist along `axis`, as last solved.
    speed: f64,
    /// Of a row of friction: the row of the normal force, and the coefficient.
    friction: Option<(usize, f64)>,
    /// None where Rapier's joint has no such row.
    kind: Option<RowKind>,
    /// Whether Rapier's step does the same again where bodies already have their final velocities.
    is_repeated: bool,
}

impl JointRow {
    /// A row that works towards the speed `wanted` along `axis`, with so much force per missing speed.
    pub(crate) fn new(axis: Screw, wanted: f64, damping: f64, bounds: [f64; 2]) -> Self {
        Self {
            axis,
            force: damping * wanted,
            damping,
            bounds,
            speed: 0.0,
            friction: None,
            kind: None,
            is_repeated: false,
        }
    }

    /// As friction of the row `normal` of the same joint.
    pub(crate) fn rubs(mut self, normal: usize, coefficient: f64) -> Self {
        self.friction = Some((normal, coefficient));
        self
    }

    /// As this row of Rapier's joint.
    pub(crate) fn of(mut self, kind: RowKind) -> Self {
        self.kind = Some(kind);
        self
    }

    /// As [`JointRow::is_repeated`] says.
    pub(crate) fn repeated(mut self, is_repeated: bool) -> Self {
        self.is_repeated = is_repeated;
        self
    }

    pub(crate) fn is_finite(&self) -> bool {
        self.axis.is_finite() && self.force.is_finite() && self.damping.is_finite()
    }

    fn is_motor(&self) -> bool {
        self.friction.is_none() && self.is_limited()
    }

    fn is_limited(&self) -> bool {
        self.bounds.iter().all(|bound| bound.is_finite())
    }

    /// The force at a speed.
    fn at(&self, speed: f64) -> f64 {
        let [least, most] = self.bounds;
        (self.force - self.damping * speed).max(least).min(most)
    }

    /// Force at no speed and damping, linearised at the speed of the last pass.
    ///
    /// A motor is, and friction, a secant through the speed at which it does nothing: between tangents where it does all that it
    /// can, one way and then the other, passes would go back and forth for ever.
    fn linearized(&self) -> [f64; 2] {
        let law = self.at(self.speed);
        let missing = self.force / self.damping - self.speed;
        if self.is_limited() {
            let damping = if missing == 0.0 { self.damping } else { self.damping.min(law / missing) };
            return [damping * (missing + self.speed), damping];
        }
        let is_bounded = law != self.force - self.damping * self.speed;
        if is_bounded { [law, 0.0] } else { [self.force, self.damping] }
    }
}

/// The rows of one joint, linearised in the final velocity like a contact.
#[derive(Clone, Debug)]
pub(crate) struct JointForces {
    /// Where it acts on the bodies, world frame: as in Rapier on each at its own anchor, which differ by the joint's error.
    pub(crate) anchors: [DVec3; 2],
    rows: Vec<JointRow>,
    /// Whether it is a contact that Rapier solves.
    is_support: bool,
    /// As last linearised: force at no speed and damping of each row.
    laws: Vec<[f64; 2]>,
    /// Wrench on the second body at zero relative velocity.
    offset: Screw,
    /// What a relative twist takes away from it.
    damping: Symmetric6,
}

impl JointForces {
    pub(crate) fn new(anchors: [DVec3; 2], rows: Vec<JointRow>) -> Self {
        let laws = vec![[0.0; 2]; rows.len()];
        Self { anchors, rows, is_support: false, laws, offset: Screw::ZERO, damping: Symmetric6::ZERO }
    }

    /// As a contact that Rapier solves.
    pub(crate) fn of_support(mut self) -> Self {
        self.is_support = true;
        self
    }

    /// Lets friction be as large as the normal forces of the last pass allow.
    fn bound_friction(&mut self) {
        for i in 0..self.rows.len() {
            if let Some((normal, coefficient)) = self.rows[i].friction {
                let most = coefficient * self.rows[normal].at(self.rows[normal].speed);
                self.rows[i].bounds = [-most, most];
            }
        }
    }

    /// Linearises all rows at the speeds of the last pass.
    pub(crate) fn linearize(&mut self) {
        (self.offset, self.damping) = (Screw::ZERO, Symmetric6::ZERO);
        for (row, law) in self.rows.iter().zip(&mut self.laws) {
            *law = row.linearized();
            let [force, damping] = *law;
            self.offset += row.axis * force;
            let Screw { linear, angular } = row.axis;
            self.damping += Symmetric6 {
                linear: outer(linear, linear),
                mixed: outer(linear, angular),
                angular: outer(angular, angular),
            } * damping;
        }
    }

    /// Takes over a relative twist for the next linearisation. Returns how far the forces of the law are from those of the
    /// linearised system, relative to their sum.
    pub(crate) fn update(&mut self, twist: Screw) -> f64 {
        self.rows.iter_mut().for_each(|row| row.speed = twist.dot(row.axis));
        self.bound_friction();
        let (mut change, mut total) = (0.0, 0.0);
        for (row, [force, damping]) in self.rows.iter().zip(&self.laws) {
            let (solved, law) = (force - damping * row.speed, row.at(row.speed));
            change += (solved - law).abs();
            total += solved.abs().max(law.abs());
        }
        if total > 0.0 { change / total } else { 0.0 }
    }

    /// What its motors do where the bodies do not move relative to each other (N), all sizes added: of torques, at the bodies'
    /// radius of gyration.
    pub(crate) fn drive(&self, states: [&SolverBody; 2]) -> f64 {
        let lever = |axis: Screw| {
            let turning = compliance(states, self.anchors, Screw { linear: DVec3::ZERO, ..axis });
            let moving: f64 = states.iter().map(|body| body.root_linear.length_squared() / 3.0).sum();
            if moving > 0.0 { axis.linear.length() + (turning / moving).sqrt() } else { 0.0 }
        };
        self.rows.iter().filter(|row| row.is_motor()).map(|row| row.at(0.0).abs() * lever(row.axis)).sum()
    }

    /// Whether it has motors.
    pub(crate) fn is_driven(&self) -> bool {
        self.rows.iter().any(JointRow::is_motor)
    }

    /// By how much its motors may change the relative velocity at the joint in a step of `dt` seconds (m/s, rad/s): until they work no
    /// more, and by no more than their force does to bodies that nothing else holds.
    pub(crate) fn drives(&self, states: [&SolverBody; 2], dt: f64) -> [f64; 2] {
        let [a, b] = [0, 1].map(|i| states[i].twist_at(self.anchors[i]));
        let mut drives = [0.0; 2];
        for row in self.rows.iter().filter(|row| row.is_motor()) {
            let speed = (b - a).dot(row.axis);
            let missing = (row.force / row.damping - speed).abs();
            let change = missing.min(row.at(speed).abs() * dt * compliance(states, self.anchors, row.axis));
            drives[0] += change * row.axis.linear.length();
            drives[1] += change * row.axis.angular.length();
        }
        drives
    }

    /// Wrench on the second body about its anchor at the given relative twist.
    pub(crate) fn wrench(&self, twist: Screw) -> Screw {
        self.offset - self.damping * twist
    }

    /// Forces of the rows on the second body along their axes (N, N·m), at the velocities as last solved, but for what Rapier applies
    /// once more.
    pub(crate) fn applied(&self) -> impl Iterator<Item = (RowKind, f64)> {
        let applied = self.rows.iter().filter(|row| !row.is_repeated);
        applied.filter_map(|row| Some((row.kind?, row.at(row.speed))))
    }

    /// What Rapier does once more, at the velocities as last solved: as a joint, and as a contact.
    pub(super) fn repeated_wrenches(&self) -> [Screw; 2] {
        let repeated = self.rows.iter().filter(|row| row.is_repeated || self.is_support);
        let wrench = repeated.fold(Screw::ZERO, |sum, row| sum + row.axis * row.at(row.speed));
        if self.is_support { [Screw::ZERO, wrench] } else { [wrench, Screw::ZERO] }
    }

    pub(super) fn damping(&self) -> &Symmetric6 {
        &self.damping
    }
}

/// What joints and Rapier's contacts do to a body, about its centre of mass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointWrench {
    pub(crate) solved: Screw,
    /// The part of it that Rapier's step does again to a body that already has its final velocity.
    pub(crate) again: Screw,
    /// What Rapier's contacts do.
    pub(crate) support: Screw,
}

impl JointWrench {
    pub(crate) const ZERO: Self = Self { solved: Screw::ZERO, again: Screw::ZERO, support: Screw::ZERO };
}

/// `wᵀ (M_a⁻¹ + M_b⁻¹) w`: the relative velocity along a unit of impulse `axis` at the anchors.
pub(crate) fn compliance([a, b]: [&SolverBody; 2], anchors: [DVec3; 2], axis: Screw) -> f64 {
    a.compliance(anchors[0], axis) + b.compliance(anchors[1], axis)
}

/// `a bᵀ`.
fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn row(wanted: f64, damping: f64, bounds: [f64; 2], speed: f64) -> JointRow {
        let axis = Screw { linear: DVec3::X, ..Screw::ZERO };
        JointRow { speed, ..JointRow::new(axis, wanted, damping, bounds) }
    }

    proptest! {
        /// And never pushes away from the speed that is wanted.
        #[test]
        fn rows_are_exact_where_they_are_linearised(
            wanted in -10.0_f64..10.0, speed in -10.0_f64..10.0, damping in 0.1_f64..1e6, most in 0.1_f64..1e3,
            kind in 0_usize..4,
        ) {
            let bounds = [FREE, [-most, most], [f64::NEG_INFINITY, 0.0], [0.0, f64::INFINITY]][kind];
            let row = row(wanted, damping, bounds, speed);
            let [force, slope] = row.linearized();
            let law = row.at(speed);
            prop_assert!((force - slope * speed - law).abs() <= 1e-9 * (1.0 + law.abs() + damping * 20.0));
            prop_assert!((0.0..=damping).contains(&slope));
            prop_assert!(law * (wanted - speed) >= 0.0);
        }
    }

    proptest! {
        /// A body of 1 kg that a motor drives, in one step.
        #[test]
        fn motors_drive_no_farther_than_they_say(
            wanted in -10.0_f64..10.0, speed in -10.0_f64..10.0, damping in 0.1_f64..1e6, most in 0.1_f64..1e3, dt in 1e-3_f64..0.1,
        ) {
            let body = SolverBody {
                velocity: Screw { linear: DVec3::X * speed, ..Screw::ZERO },
                root_linear: DVec3::ONE,
                ..SolverBody::FIXED
            };
            let joint = JointForces::new([DVec3::ZERO; 2], vec![row(wanted, damping, [-most, most], 0.0)]);
            let [translation, rotation] = joint.drives([&SolverBody::FIXED, &body], dt);
            // The law is monotonic: the speed at the end of the step by bisection.
            let [mut low, mut high] = [speed.min(wanted), speed.max(wanted)];
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if middle < speed + dt * joint.rows[0].at(middle) { low = middle } else { high = middle }
            }
            prop_assert!((low - speed).abs() <= translation * (1.0 + 1e-9) + 1e-9, "{low} {speed} {translation}");
            prop_assert_eq!(rotation, 0.0);
        }
    }

    const FREE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

    /// A mass that a motor of limited force drives, step by step: passes end, at the force that it has and not beyond its speed.
    #[test]
    fn passes_over_a_motor_end() {
        for (most, expected) in [(1.0, 0.1), (5.0, 0.5), (100.0, 2.0)] {
            let mut joint = JointForces::new([DVec3::ZERO; 2], vec![row(2.0, 1e4, [-most, most], 0.0)]);
            let (mass, dt, mut speed) = (1.0, 0.1, 0.0);
            let ended = (0..8).any(|_| {
                joint.linearize();
                let force = joint.wrench(Screw::ZERO).linear.x;
                let slope = joint.damping().linear.x_axis.x;
                speed = dt * force / (mass + dt * slope);
                joint.update(Screw { linear: DVec3::X * speed, ..Screw::ZERO }) < 1e-3
            });
            println!("{most} N: {speed} m/s");
            assert!(ended && (speed - expected).abs() < 2e-2 * expected, "{most}: {speed}");
        }
    }
}
