//! Spur gears with involute teeth.

use super::grid::closed_grid;
use glam::DVec3;
use packer::TriangleMesh;
use std::f64::consts::PI;

/// Height of a tooth over the pitch circle, and depth of the gap under it, in modules: the proportions of ISO 53.
const ADDENDUM: f64 = 1.0;
const DEDENDUM: f64 = 1.25;
/// By how much the fillet widens the foot of a flank, in modules; it stays clear of the tips of the other gear's teeth
/// (test below).
const FILLET: f64 = 0.12;
/// Facets of a fillet, a flank, a tip and a root.
const FACETS: [u32; 4] = [3, 8, 2, 3];

/// A spur gear about the y axis, centred at the origin; a tooth points along x.
///
/// Gears of equal module and pressure angle mesh at a centre distance of half the sum of their [pitch
/// diameters](Self::pitch_radius). Two gears of at least 14 teeth and at most 26, or of at least 17 and any number, with a
/// pressure angle of 20° touch on their involutes only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpurGear {
    /// Pitch diameter per tooth (m).
    pub module: f64,
    /// Number of teeth, at least 5.
    pub teeth: u32,
    /// Slope of the flanks at the pitch circle (rad), 20° as a rule.
    pub pressure_angle: f64,
    /// Play between the flanks of two equal gears, along the pitch circle (m): each has its teeth thinned by half of it.
    pub backlash: f64,
    /// Length of the teeth along the axis (m).
    pub width: f64,
    /// Radius of the bore (m), less than that of the root circle.
    pub bore: f64,
}

impl SpurGear {
    /// Radius (m) of the circle that rolls on that of the other gear.
    #[must_use]
    pub fn pitch_radius(&self) -> f64 {
        0.5 * self.module * f64::from(self.teeth)
    }

    /// Radius (m) of the tips.
    #[must_use]
    pub fn tip_radius(&self) -> f64 {
        self.pitch_radius() + ADDENDUM * self.module
    }

    /// Radius (m) of the bottom of the gaps.
    #[must_use]
    pub fn root_radius(&self) -> f64 {
        self.pitch_radius() - DEDENDUM * self.module
    }

    /// Radius (m) of the circle that the involutes unwind from.
    #[must_use]
    pub fn base_radius(&self) -> f64 {
        self.pitch_radius() * self.pressure_angle.cos()
    }

    /// The solid.
    #[must_use]
    pub fn mesh(&self) -> TriangleMesh {
        let outline = self.outline();
        let half = 0.5 * self.width;
        closed_grid(outline.len() as u32, 4, |i, j| {
            let (radius, angle) = outline[i as usize];
            let (radius, y) =
                [(self.bore, -half), (radius, -half), (radius, half), (self.bore, half)][j as usize];
            DVec3::new(radius * angle.cos(), y, -radius * angle.sin())
        })
    }

    /// Half the angle (rad) that a tooth takes at `radius`.
    ///
    /// On the involute it is that at the pitch circle plus inv α − inv α(r), with inv α = tan α − α and cos α(r) = r_b / r.
    fn half_angle(&self, radius: f64) -> f64 {
        let involute = |radius: f64| {
            let angle = (self.base_radius() / radius).min(1.0).acos();
            angle.tan() - angle
        };
        let pitch = self.pitch_radius();
        let at_pitch = (0.5 * PI * self.module - 0.5 * self.backlash) / (2.0 * pitch);
        let (form, root) = (self.form_radius(), self.root_radius());
        // A parabola that leaves the involute along the radius.
        let down = ((form - radius) / (form - root).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        at_pitch + involute(pitch) - involute(radius.max(form)) + FILLET * self.module / root * down * down
    }

    /// Radius (m) at which the involute begins.
    fn form_radius(&self) -> f64 {
        self.base_radius().max(self.root_radius())
    }

    /// Radius (m) and angle (rad) of the corners of the cross-section, by rising angle.
    fn outline(&self) -> Vec<(f64, f64)> {
        let [fillet, flank, tip, root] = FACETS;
        let between = |from: f64, to: f64, count: u32| {
            (0..count).map(move |k| from + (to - from) * f64::from(k) / f64::from(count))
        };
        // Equal steps of the roll angle, the root of r² − r_b², are finest where the involute bends most.
        let base = self.base_radius();
        let roll = |radius: f64| (radius * radius - base * base).max(0.0).sqrt();
        let (start, form, end) = (self.root_radius(), self.form_radius(), self.tip_radius());
        let fillet = between(start, form, if form > start { fillet } else { 0 });
        let flank = between(roll(form), roll(end), flank).map(|roll| roll.hypot(base));
        let rising: Vec<f64> = fillet.chain(flank).collect();
        let (foot, head) = (self.half_angle(start), self.half_angle(end));
        let step = 2.0 * PI / f64::from(self.teeth);
        let tooth = |index: u32| {
            let middle = step * f64::from(index);
            let up = rising.iter().map(|&r| (r, -self.half_angle(r)));
            let across = between(-head, head, tip).map(|angle| (end, angle));
            let top = std::iter::once((end, head));
            let down = rising.iter().skip(1).rev().map(|&r| (r, self.half_angle(r)));
            let gap = between(foot, step - foot, root).map(|angle| (start, angle));
            up.chain(across).chain(top).chain(down).chain(gap).map(move |(r, angle)| (r, middle + angle))
        };
        (0..self.teeth).flat_map(tooth).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::check::{Expected, assert_solid};
    use glam::DQuat;
    use packer::Solid;

    fn gear(teeth: u32, backlash: f64) -> SpurGear {
        SpurGear {
            module: 0.05,
            teeth,
            pressure_angle: 20_f64.to_radians(),
            backlash,
            width: 0.1,
            bore: 0.06,
        }
    }

    #[test]
    fn is_a_closed_gear() {
        for teeth in [14, 21, 60] {
            let gear = gear(teeth, 0.002);
            // Half the integral of the squared radius, ring by ring: ∫ 2 ψ(r) r dr for every tooth over the root circle.
            let steps = 100_000;
            let (root, tip) = (gear.root_radius(), gear.tip_radius());
            let dr = (tip - root) / f64::from(steps);
            let ring = |k: u32| {
                let r = root + (f64::from(k) + 0.5) * dr;
                2.0 * gear.half_angle(r) * r * dr
            };
            let teeth_area: f64 = f64::from(teeth) * (0..steps).map(ring).sum::<f64>();
            let area = PI * (root * root - gear.bore * gear.bore) + teeth_area;
            assert_solid(&gear.mesh(), &Expected { volume: area * gear.width, tolerance: 3e-3, euler: 0 });
        }
    }

    #[test]
    fn teeth_are_half_the_pitch_wide_less_the_backlash() {
        for backlash in [0.0, 0.004] {
            let gear = gear(14, backlash);
            let width = 2.0 * gear.half_angle(gear.pitch_radius()) * gear.pitch_radius();
            assert!((width - (0.5 * PI * gear.module - 0.5 * backlash)).abs() < 1e-12);
        }
    }

    /// The normal of an involute touches the base circle: that is what makes the ratio of speeds constant.
    #[test]
    fn normals_of_the_flanks_touch_the_base_circle() {
        let gear = gear(21, 0.0);
        let at = |radius: f64| {
            let angle = gear.half_angle(radius);
            DVec3::new(radius * angle.cos(), 0.0, -radius * angle.sin())
        };
        for share in [0.1, 0.4, 0.9] {
            let radius = gear.base_radius() + share * (gear.tip_radius() - gear.base_radius());
            let tangent = (at(radius + 1e-6) - at(radius - 1e-6)).normalize();
            // The lever of a line along the normal is the part of the arm across it.
            let lever = at(radius).dot(tangent).abs();
            assert!((lever / gear.base_radius() - 1.0).abs() < 1e-6, "{lever}");
        }
    }

    /// Gears turned by angles in the ratio of their teeth neither cut into each other nor part, in any position.
    #[test]
    fn gears_mesh_at_the_ratio_of_their_teeth() {
        let backlash = 0.002;
        let gears = [(14, 0.2), (21, 0.1)].map(|(teeth, width)| SpurGear { width, ..gear(teeth, backlash) });
        let solids = gears.map(|gear| Solid::new(&gear.mesh()).unwrap());
        let distance = DVec3::X * (gears[0].pitch_radius() + gears[1].pitch_radius());
        // Half the backlash on either side is this far along the normal.
        let gap = 0.5 * backlash * gears[0].pressure_angle.cos();
        let pitch = 2.0 * PI / 14.0;
        for step in 0..12 {
            let turn = pitch * f64::from(step) / 12.0;
            // A tooth of the first points at a gap of the second at the start.
            let turns = [turn, PI - PI / 21.0 - turn * 14.0 / 21.0].map(DQuat::from_rotation_y);
            let depth = |p: DVec3| solids[0].depth(turns[0].inverse() * p);
            let placed = solids[1].mesh().vertices.iter().map(|v| distance + turns[1] * *v);
            let nearest = placed.map(depth).fold(f64::NEG_INFINITY, f64::max);
            assert!(
                (-1.3 * gap..-0.5 * gap).contains(&nearest),
                "step {step}: {nearest}, half the play is {gap}"
            );
        }
    }
}
