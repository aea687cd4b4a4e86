//! A round screw thread, and the bolt and the nut that have it.

use super::grid::closed_grid;
use super::nut::hexagon_radius;
use super::revolution::sweep;
use glam::DVec3;
use packer::TriangleMesh;
use std::f64::consts::{PI, TAU};

/// A single right-hand thread about the y axis with a sine for its profile: turned by a positive angle about y it goes up
/// by the pitch per turn.
///
/// Its surface is at the radius `R + h/2 cos(2π y/p − θ)`, with the depth h at all places but the ends, where it
/// fades away over half a pitch so that bolt and nut find each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScrewThread {
    /// Mean radius R (m).
    pub radius: f64,
    /// Height h from root to crest (m), less than the diameter.
    pub depth: f64,
    /// Way per turn p (m).
    pub pitch: f64,
    /// Facets per turn and rows per pitch (≥ 6).
    pub facets: [u32; 2],
}

/// Which side of the surface the material is on.
#[derive(Clone, Copy)]
enum Side {
    Bolt,
    Nut,
}

impl ScrewThread {
    /// The same thread with its surface shifted by `shift` (m) away from the axis: a nut's, to have play.
    #[must_use]
    pub fn widened(self, shift: f64) -> Self {
        Self { radius: self.radius + shift, ..self }
    }

    /// Slope of the thread along the mean radius: tan λ = p / 2πR.
    #[must_use]
    pub fn lead(&self) -> f64 {
        self.pitch / (TAU * self.radius)
    }

    /// Slope of the flank in a section through the axis, halfway up: dr/dy = πh/p is its cotangent.
    #[must_use]
    pub fn flank(&self) -> f64 {
        self.pitch / (PI * self.depth)
    }

    /// A bolt that stands on its hexagonal head: the head's underside is in the plane y = 0, then come `head` (m) of head,
    /// `across_flats` wide, and `length` (m) of thread.
    #[must_use]
    pub fn bolt(&self, across_flats: f64, head: f64, length: f64) -> TriangleMesh {
        let columns = self.columns();
        let heights = self.heights(length);
        let chamfer = 0.1 * head;
        let outline = [(chamfer, 0.0), (0.0, chamfer), (0.0, head - chamfer), (chamfer, head)];
        sweep([columns, (outline.len() + heights.len()) as u32], [0.0, head + length], |i, j| {
            let angle = TAU * f64::from(i) / f64::from(columns);
            let (radius, y) = match outline.get(j as usize) {
                Some(&(inset, y)) => (hexagon_radius(0.5 * across_flats - inset, angle), y),
                None => {
                    let y = heights[j as usize - outline.len()];
                    (self.surface(Side::Bolt, [angle, y], length), head + y)
                }
            };
            DVec3::new(radius * angle.cos(), y, -radius * angle.sin())
        })
    }

    /// A hexagonal nut `across_flats` wide and `height` high (m), centred at the origin, with this thread inside.
    #[must_use]
    pub fn nut(&self, across_flats: f64, height: f64) -> TriangleMesh {
        let columns = self.columns();
        let heights = self.heights(height);
        let chamfer = 0.1 * self.pitch;
        let outline = [(chamfer, 0.0), (0.0, chamfer), (0.0, height - chamfer), (chamfer, height)];
        closed_grid(columns, (outline.len() + heights.len()) as u32, |i, j| {
            let angle = TAU * f64::from(i) / f64::from(columns);
            let (radius, y) = match outline.get(j as usize) {
                Some(&(inset, y)) => (hexagon_radius(0.5 * across_flats - inset, angle), y),
                None => {
                    // Down again on the inside.
                    let y = heights[heights.len() - 1 - (j as usize - outline.len())];
                    (self.surface(Side::Nut, [angle, y], height), y)
                }
            };
            DVec3::new(radius * angle.cos(), y - 0.5 * height, -radius * angle.sin())
        })
    }

    /// Radius (m) of the surface at an angle (rad) and height (m) above the lower end of a thread of `length` (m).
    fn surface(&self, side: Side, [angle, y]: [f64; 2], length: f64) -> f64 {
        let fade = (y.min(length - y) / (0.5 * self.pitch)).clamp(0.0, 1.0);
        let wave = 0.5 * self.depth * (TAU * y / self.pitch - angle).cos();
        let end = match side {
            Side::Bolt => -0.5 * self.depth,
            Side::Nut => 0.5 * self.depth,
        };
        self.radius + end + fade * (wave - end)
    }

    /// Facets around the axis, with corners at those of a hexagon.
    fn columns(&self) -> u32 {
        self.facets[0].clamp(6, 1 << 20).next_multiple_of(6)
    }

    /// Heights of the rows of a thread of `length` (m), from 0 to all of it.
    fn heights(&self, length: f64) -> Vec<f64> {
        let rows = (length / self.pitch * f64::from(self.facets[1].clamp(6, 1 << 20))).ceil().max(2.0);
        (0..=rows as u32).map(|row| length * f64::from(row) / rows).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::check::{Expected, assert_solid};
    use glam::DQuat;
    use packer::Solid;

    const THREAD: ScrewThread = ScrewThread { radius: 0.1, depth: 0.05, pitch: 0.1, facets: [48, 24] };

    /// Volume inside the surface: the mean of r² over a turn is (R + c)² + (f h)²/8 where the depth has faded to the part f
    /// and the mean radius is shifted by c = (1 − f) e, e = ∓h/2 for the bolt and the nut; f rises linearly over p/2 at either end.
    fn volume(thread: &ScrewThread, length: f64, end: f64) -> f64 {
        let ScrewThread { radius, depth, pitch, .. } = *thread;
        let full = radius * radius + depth * depth / 8.0;
        let (a, b) = (radius + end, -end);
        // ∫ (a + b f)² + f² h²/8 over f from 0 to 1.
        let faded = a * a + a * b + b * b / 3.0 + depth * depth / 24.0;
        PI * (full * (length - pitch) + faded * pitch)
    }

    fn hexagon(apothem: f64) -> f64 {
        2.0 * 3.0_f64.sqrt() * apothem * apothem
    }

    /// A hexagonal prism with rims cut at 45°.
    fn prism(across_flats: f64, height: f64, chamfer: f64) -> f64 {
        let [whole, less] = [0.0, chamfer].map(|inset| hexagon(0.5 * across_flats - inset));
        whole * (height - 2.0 * chamfer) + 2.0 * chamfer / 3.0 * (whole + less + (whole * less).sqrt())
    }

    #[test]
    fn a_bolt_is_closed_and_has_its_volume() {
        let expected = prism(0.36, 0.1, 0.01) + volume(&THREAD, 0.7, -0.025);
        let expected = Expected { volume: expected, tolerance: 5e-3, euler: 2 };
        assert_solid(&THREAD.bolt(0.36, 0.1, 0.7), &expected);
    }

    #[test]
    fn a_nut_is_closed_and_has_its_volume() {
        let expected = prism(0.36, 0.25, 0.01) - volume(&THREAD, 0.25, 0.025);
        let expected = Expected { volume: expected, tolerance: 5e-3, euler: 0 };
        assert_solid(&THREAD.nut(0.36, 0.25), &expected);
    }

    /// A nut that turns by an angle and goes along the thread by its share of the pitch keeps its play everywhere.
    #[test]
    fn a_nut_on_its_thread_does_not_cut_into_the_bolt() {
        let play = 0.004;
        let (head, height) = (0.1, 0.25);
        let bolt = Solid::new(&THREAD.bolt(0.36, head, 0.7)).unwrap();
        let nut = THREAD.widened(play).nut(0.36, height);
        for turn in [0.0, 0.3, 1.7, 2.9] {
            // The nut's thread begins at its own underside.
            let lift = head + 0.1 + 0.5 * height + THREAD.pitch * turn;
            let rotation = DQuat::from_rotation_y(TAU * (turn + 0.1 / THREAD.pitch));
            let place = |v: &DVec3| rotation * *v + DVec3::Y * lift;
            let nearest = nut.vertices.iter().map(|v| bolt.depth(place(v))).fold(f64::NEG_INFINITY, f64::max);
            // Along the normal the play is less than along the radius, least on the flanks.
            let least = play / (1.0 + THREAD.flank().powi(-2)).sqrt();
            assert!((-1.2 * least..-0.6 * least).contains(&nearest), "{turn} turns: {nearest} {least}");
        }
    }

    #[test]
    fn a_nut_off_its_thread_cuts_into_the_bolt() {
        // At 0.35 m a quarter of a turn is right, at 0.375 m half a turn.
        let bolt = Solid::new(&THREAD.bolt(0.36, 0.1, 0.7)).unwrap();
        let nut = THREAD.widened(0.004).nut(0.36, 0.25);
        for (lift, turn) in [(0.375, 0.25), (0.35, 0.0), (0.35, 0.75)] {
            let rotation = DQuat::from_rotation_y(TAU * turn);
            let nearest = nut.vertices.iter().map(|v| bolt.depth(rotation * *v + DVec3::Y * lift));
            let nearest = nearest.fold(f64::NEG_INFINITY, f64::max);
            assert!(nearest > 0.005, "lifted by {lift}, turned by {turn}: {nearest}");
        }
    }
}
