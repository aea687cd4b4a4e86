//! What Rapier's joints do, as rows of the solve.
//!
//! The rows, their errors and their signs are those of Rapier's joint constraints: locked axes, limits and motors, and the
//! distance of coupled linear axes (ropes, springs). Limits of coupled angular axes are left to Rapier alone.

use crate::joints::Joint;
use crate::links::Link;
use crate::penalty::{JointForces, JointRow, RowKind, Screw, SolverBody, compliance};
use rapier3d::dynamics::{GenericJoint, IntegrationParameters, JointAxesMask};
use rapier3d::glamx::{DMat3, DQuat, DVec3};
use rapier3d::math::{Pose, Real};
use std::f64::consts::PI;

/// Least share of the bodies' own compliance that a row gives way by.
///
/// Rows that are rigid in Rapier are dampers here. With 1e-4 a motor presses a finger of 4 g against a block with 0.982 of its force, with
/// 1e-5, 1e-6 and 1e-8 with 0.998, 0.999 and 0.999; a taut rope of 20 links of 20 g, of which some lie on the ground, trembles
/// by 0.6, 0.3 and 0.3 m/s with 1e-4, 1e-6 and 1e-8, and one that Rapier alone stretches to twice its length is thrown about with 1e-8.
pub(crate) const SOFTNESS: f64 = 1e-6;

/// By how much a row gives way to an impulse.
#[derive(Clone, Copy, Default)]
struct Give {
    /// As a share of the bodies' own compliance.
    share: f64,
    /// Besides that (m/s per N·s, rad/s per N·m·s).
    gain: f64,
}

/// A joint at its present position, and what its rows are made of.
struct JointState<'a> {
    states: [&'a SolverBody; 2],
    joint: &'a GenericJoint,
    link: Option<Link<'a>>,
    /// Time step (s).
    dt: f64,
    most_bias: f64,
    /// Where the joint acts on the bodies.
    anchors: [DVec3; 2],
    /// Axes of the first frame.
    basis: DMat3,
    /// From the first anchor to the second.
    offset: DVec3,
    /// Of the second frame in the first.
    rotation: DQuat,
}

/// The rows of `joint` between bodies at the given poses; none where it does nothing, or where its numbers are not finite.
pub(crate) fn joint_forces(
    states: [&SolverBody; 2],
    poses: [&Pose; 2],
    joint: &Joint<'_>,
    parameters: &IntegrationParameters,
) -> Option<JointForces> {
    let Joint { data: joint, link, .. } = *joint;
    let (frame_a, frame_b) = (*poses[0] * joint.local_frame1, *poses[1] * joint.local_frame2);
    let [rotation_a, rotation_b] = [frame_a, frame_b].map(|frame| frame.rotation.as_dquat().normalize());
    let rotation = rotation_a.inverse() * rotation_b;
    let basis = DMat3::from_quat(rotation_a);
    let [anchor_a, anchor_b] = [frame_a, frame_b].map(|frame| frame.translation.as_dvec3());
    let offset = anchor_b - anchor_a;
    // As in Rapier: along free axes the first body is held where the second is.
    let free = axes_in(!joint.locked_axes & JointAxesMask::LIN_AXES);
    let free: DVec3 = free.map(|i| basis.col(i) * offset.dot(basis.col(i))).sum();
    let state = JointState {
        states,
        joint,
        link,
        dt: f64::from(parameters.dt),
        most_bias: f64::from(parameters.max_corrective_velocity()),
        anchors: [anchor_a + free, anchor_b],
        basis,
        offset,
        rotation: if rotation.w < 0.0 { -rotation } else { rotation },
    };
    let rows: Vec<Option<JointRow>> = if link.is_some_and(|link| link.is_kinematic()) {
        state.motion().collect()
    } else {
        let driven = state.motors().chain(state.dampers());
        driven.chain(state.locks()).chain(state.limits()).chain(state.coupled()).collect()
    };
    let rows: Vec<JointRow> = rows.into_iter().flatten().filter(JointRow::is_finite).collect();
    let is_finite = state.anchors.iter().all(|anchor| anchor.is_finite());
    (is_finite && !rows.is_empty()).then(|| JointForces::new(state.anchors, rows))
}

impl JointState<'_> {
    /// Rows that keep the present motion.
    fn motion(&self) -> impl Iterator<Item = Option<JointRow>> {
        let [a, b] = [0, 1].map(|i| self.states[i].twist_at(self.anchors[i]));
        (0..6).map(move |i| {
            let axis = self.axis(i);
            self.row(axis, (b - a).dot(axis), Give::default(), FREE)
        })
    }

    fn motors(&self) -> impl Iterator<Item = Option<JointRow>> {
        let axes = self.joint.motor_axes & !self.joint.locked_axes & !self.joint.coupled_axes;
        axes_in(axes).map(move |i| {
            let motor = &self.joint.motors[i];
            let place = self.coordinate(i);
            let error = place - f64::from(motor.target_pos);
            match self.link {
                None if i >= 3 => self.motor(i, self.axis(i), wrapped(error), None),
                _ => self.motor(i, self.axis(i), error, self.room(i, place)),
            }
        })
    }

    /// The damping of multibodies' joints.
    fn dampers(&self) -> impl Iterator<Item = Option<JointRow>> {
        axes_in(!self.joint.locked_axes).map(|i| {
            let damping = self.link?.damping(i);
            (damping > 0.0).then(|| JointRow::new(self.axis(i), 0.0, damping, FREE).repeated(true))
        })
    }

    fn locks(&self) -> impl Iterator<Item = Option<JointRow>> {
        axes_in(self.joint.locked_axes).map(|i| {
            let (axis, error) = self.locked(i);
            Some(self.rigid(axis, error, FREE)?.of(RowKind::Lock(i)))
        })
    }

    /// A locked axis and how far the joint is off along it (m, rad). The relative twist along the axis is the rate of the error.
    fn locked(&self, i: usize) -> (Screw, f64) {
        if i < 3 {
            return (self.axis(i), self.place(i));
        }
        // The imaginary part of a rotation changes with its angular velocity ω by (w ω + ω × v) / 2.
        let (w, v) = (self.rotation.w, self.rotation.xyz());
        let unit = DVec3::AXES[i - 3];
        let angular = self.basis * (unit * w + v.cross(unit));
        (Screw { linear: DVec3::ZERO, angular }, 2.0 * self.imaginary(i))
    }

    fn limits(&self) -> impl Iterator<Item = Option<JointRow>> {
        let axes = self.joint.limit_axes & !self.joint.locked_axes & !self.joint.coupled_axes;
        axes_in(axes).map(|i| {
            let [least, most] = self.limits_of(i);
            if i < 3 || self.link.is_some() {
                return self.limit(i, self.coordinate(i), [least, most]);
            }
            let (half_range, center) = ((most - least) * 0.5, (most + least) * 0.5);
            if half_range >= PI || half_range.is_nan() {
                return None;
            }
            let half = self.imaginary(i).atan2(self.rotation.w) - center * 0.5;
            self.limit(i, wrapped(2.0 * half), [-half_range, half_range])
        })
    }

    /// The rows along the distance of coupled linear axes.
    fn coupled(&self) -> impl Iterator<Item = Option<JointRow>> {
        let GenericJoint { coupled_axes, motor_axes, limit_axes, locked_axes, .. } = *self.joint;
        let first = axes_in(coupled_axes & JointAxesMask::LIN_AXES).next();
        let distance: DVec3 =
            axes_in(coupled_axes & JointAxesMask::LIN_AXES).map(|i| self.basis.col(i) * self.place(i)).sum();
        let along = distance.try_normalize().map(|linear| Screw { linear, angular: DVec3::ZERO });
        let has = move |axes: JointAxesMask, i: usize| (axes & !locked_axes).bits() & (1 << i) != 0;
        let length = distance.length();
        first.zip(along).into_iter().flat_map(move |(i, along)| {
            let error = length - f64::from(self.joint.motors[i].target_pos);
            let drive =
                has(motor_axes, i).then(|| self.motor(i, along, error, self.room(i, length))).flatten();
            let limit = has(limit_axes, i).then(|| self.rope(along, self.limits_of(i)[1] - length));
            [drive, limit.flatten().map(|row| row.of(RowKind::Limit(i)))]
        })
    }

    /// The row of a distance that may grow by `room`; it cannot be too short. Rapier looks ahead for ropes, and only for these.
    fn rope(&self, along: Screw, room: f64) -> Option<JointRow> {
        const PULL: [f64; 2] = [f64::NEG_INFINITY, 0.0];
        if room <= 0.0 {
            return self.rigid(along, -room, PULL);
        }
        let share = f64::from(self.joint.softness.cfm_coeff(self.dt as Real));
        self.row(along, room / self.dt, Give { share, ..Give::default() }, PULL)
    }

    /// A row that takes `error` back, at the softness of the joint.
    ///
    /// Rapier's velocities at the end of a step are without what takes back the errors of rigid rows, and so are these: with it,
    /// a car whose wheels are driven through joints drifts by 6 cm in 5 s on a slope, without by less than 1 cm. In soft rows it
    /// is the force of the spring.
    fn rigid(&self, axis: Screw, error: f64, bounds: [f64; 2]) -> Option<JointRow> {
        let softness = &self.joint.softness;
        let dt = self.dt as Real;
        let share = f64::from(softness.cfm_coeff(dt));
        let bias = (error * f64::from(softness.erp_inv_dt(dt))).max(-self.most_bias).min(self.most_bias);
        let give = Give { share, ..Give::default() };
        self.row(axis, -bias * (share / SOFTNESS).min(1.0), give, bounds)
    }

    /// The row of motor `i` along `axis`, `error` beyond its target.
    fn motor(&self, i: usize, axis: Screw, error: f64, room: Option<[f64; 2]>) -> Option<JointRow> {
        let motor = &self.joint.motors[i];
        let dt = self.dt as Real;
        let (rate, share, gain) = motor.model.combine_coefficients(dt, motor.stiffness, motor.damping);
        let speed = f64::from(motor.target_vel);
        let speed = room.map_or(speed, |[least, most]| speed.max(least).min(most));
        let wanted = speed - error * f64::from(rate);
        let mut give = Give { share: f64::from(share), gain: f64::from(gain) };
        // In a multibody that depends on all of its links.
        if let Some(compliance) = self.link.and_then(|link| link.compliance(i)) {
            give = Give { share: 0.0, gain: give.gain + give.share * compliance };
        }
        let most = f64::from(motor.max_force);
        // Those of impulse joints are switched off during Rapier's step.
        let row = self.row(axis, wanted, give, [-most, most])?;
        Some(row.of(RowKind::Motor(i)).repeated(self.link.is_some()))
    }

    /// The row of a limit, where it is reached.
    fn limit(&self, i: usize, place: f64, [least, most]: [f64; 2]) -> Option<JointRow> {
        let bounds = [
            if place >= most { f64::NEG_INFINITY } else { 0.0 },
            if place <= least { f64::INFINITY } else { 0.0 },
        ];
        if bounds == [0.0; 2] {
            return None;
        }
        let row = self.rigid(self.axis(i), (place - most).max(0.0) - (least - place).max(0.0), bounds)?;
        Some(row.of(RowKind::Limit(i)))
    }

    /// A row that works towards the speed `wanted`; none where no body can move.
    fn row(&self, axis: Screw, wanted: f64, give: Give, bounds: [f64; 2]) -> Option<JointRow> {
        let compliance = compliance(self.states, self.anchors, axis);
        let give_way = (compliance * give.share + give.gain).max(compliance * SOFTNESS);
        let damping = 1.0 / (self.dt * give_way);
        // What is rigid has nothing to do where bodies have their final velocities. Springs do again what they do.
        let is_repeated = give.share > SOFTNESS;
        (compliance > 0.0).then(|| JointRow::new(axis, wanted, damping, bounds).repeated(is_repeated))
    }

    fn axis(&self, i: usize) -> Screw {
        let axis = self.basis.col(i % 3);
        let (linear, angular) = if i < 3 { (axis, DVec3::ZERO) } else { (DVec3::ZERO, axis) };
        Screw { linear, angular }
    }

    /// Of the joint along an axis that is not locked (m, rad).
    fn coordinate(&self, i: usize) -> f64 {
        match self.link {
            Some(link) => link.coordinate(i),
            None if i < 3 => self.place(i),
            None => 2.0 * self.imaginary(i).clamp(-1.0, 1.0).asin(),
        }
    }

    /// Of the second anchor along a linear axis.
    fn place(&self, i: usize) -> f64 {
        self.offset.dot(self.basis.col(i))
    }

    /// Of the rotation about an angular axis.
    fn imaginary(&self, i: usize) -> f64 {
        self.rotation.xyz()[i - 3]
    }

    fn limits_of(&self, i: usize) -> [f64; 2] {
        let limits = &self.joint.limits[i];
        [f64::from(limits.min), f64::from(limits.max)]
    }

    /// Speeds at which a motor at `place` reaches its limits in the step.
    fn room(&self, i: usize, place: f64) -> Option<[f64; 2]> {
        let limited = self.joint.limit_axes.bits() & (1 << i) != 0;
        limited.then(|| self.limits_of(i).map(|limit| (limit - place) / self.dt))
    }
}

/// No bounds.
const FREE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// Linear axes first, then angular ones.
fn axes_in(axes: JointAxesMask) -> impl Iterator<Item = usize> {
    (0..6).filter(move |i| axes.bits() & (1 << i) != 0)
}

/// The same angle in (−π, π].
fn wrapped(angle: f64) -> f64 {
    angle - (angle / (2.0 * PI)).round() * 2.0 * PI
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rapier3d::dynamics::RopeJointBuilder;
    use rapier3d::glamx::DPose3;

    fn vector(most: f64) -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-most..most).prop_map(DVec3::from)
    }

    /// A joint whose second frame stands at `pose` in the first, turned with the first by `turn`.
    fn state<'a>(joint: &'a GenericJoint, turn: DQuat, pose: DPose3) -> JointState<'a> {
        JointState {
            states: [&SolverBody::FIXED, &SolverBody::FIXED],
            joint,
            link: None,
            dt: 0.01,
            most_bias: f64::INFINITY,
            anchors: [DVec3::ZERO, turn * pose.translation],
            basis: DMat3::from_quat(turn),
            offset: turn * pose.translation,
            rotation: if pose.rotation.w < 0.0 { -pose.rotation } else { pose.rotation },
        }
    }

    proptest! {
        #[test]
        fn errors_change_by_the_twist_along_their_axes(
            turn in vector(3.0), place in vector(1.0), rotation in vector(1.5), linear in vector(1.0), angular in vector(1.0),
        ) {
            let joint = GenericJoint::default();
            let turn = DQuat::from_scaled_axis(turn);
            let pose = DPose3::from_parts(place, DQuat::from_scaled_axis(rotation));
            let before = state(&joint, turn, pose);
            // The first frame stands still; the twist is that of the second at its own anchor, in the world.
            const STEP: f64 = 1e-6;
            let inverse = turn.inverse();
            let turned = DQuat::from_scaled_axis(inverse * angular * STEP) * pose.rotation;
            let moved = DPose3::from_parts(place + inverse * linear * STEP, turned);
            let after = state(&joint, turn, moved);
            for i in 0..6 {
                let (axis, error) = before.locked(i);
                let rate = (after.locked(i).1 - error) / STEP;
                let expected = axis.dot(Screw { linear, angular });
                prop_assert!((rate - expected).abs() < 1e-5, "{i}: {rate} {expected}");
            }
        }
    }

    /// A body of 1 kg on a rope of 2 m, 1 cm or nothing of it slack, in a step of 0.01 s.
    #[test]
    fn slack_ropes_do_not_pull() {
        let joint = RopeJointBuilder::new(2.0).build();
        let body = SolverBody { root_linear: DVec3::ONE, ..SolverBody::FIXED };
        for (length, free) in [(1.99, 1.0), (2.0, 0.0)] {
            let pose = DPose3::from_translation(DVec3::X * length);
            let state = state(&joint.data, DQuat::IDENTITY, pose);
            let state = JointState { states: [&SolverBody::FIXED, &body], ..state };
            let rows: Vec<JointRow> = state.coupled().flatten().collect();
            let forces = |speed: f64| {
                let mut joint = JointForces::new(state.anchors, rows.clone());
                joint.update(Screw { linear: DVec3::X * speed, ..Screw::ZERO });
                joint.linearize();
                joint.wrench(Screw { linear: DVec3::X * speed, ..Screw::ZERO }).linear.x
            };
            for speed in [-3.0, 0.0, free - 0.01] {
                assert_eq!(forces(speed), 0.0, "{length} m at {speed} m/s");
            }
            assert!(forces(free + 0.01) < -100.0);
        }
    }

    #[test]
    fn angles_are_wrapped() {
        for (angle, expected) in
            [(0.5, 0.5), (-0.5, -0.5), (4.0, 4.0 - 2.0 * PI), (-4.0, 2.0 * PI - 4.0), (13.0, 13.0 - 4.0 * PI)]
        {
            assert!((wrapped(angle) - expected).abs() < 1e-12);
        }
    }
}
