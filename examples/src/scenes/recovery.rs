//! Bunnies wholly inside bunnies: how each kind of shape gets them out.

use super::inside::{Pair, PairPlace, weightless_world};
use super::{Model, ShapeKind};
use crate::figures::Summary;
use crate::palette;
use crate::render::{CutPlane, Section};
use crate::run::{Body, Check, Simulation, View, Wanted};
use anyhow::{Result, ensure};
use glam::Vec3;
use glamx::Pose3;
use rapier_ist::IstPlugin;
use rapier3d::pipeline::PhysicsWorld;
use serde::Serialize;

/// Density of all bodies (kg/m³).
const DENSITY: f32 = 1000.0;
/// Distance of the large bodies from each other (m): they are 1 m long.
const SPACING: f32 = 1.25;
/// Steps from one look at the exact meshes to the next.
const LOOK_EVERY: usize = 6;
/// Most steps that may pass until the small body is outside: 3 s.
const OUT_AFTER: usize = 180;
/// Fastest that it may become (m/s, rad/s).
const FASTEST: [f64; 2] = [5.0, 20.0];

/// Pairs side by side, one column per kind of shape and one row per pose; they do not touch each other.
pub struct Recovery {
    world: PhysicsWorld,
    plugin: IstPlugin,
    columns: Vec<Column>,
    steps: usize,
}

/// Pairs of one kind of shape.
struct Column {
    kind: ShapeKind,
    model: Model,
    escapes: Vec<Escape>,
}

/// A pair and what became of it.
struct Escape {
    pair: Pair,
    /// Time since which the small body is outside (s).
    outside: Option<f64>,
    /// Fastest linear (m/s) and angular (rad/s) speed of the small body.
    speeds: [f64; 2],
}

/// What became of the pairs of one kind of shape.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Outcome {
    /// The shape.
    pub kind: ShapeKind,
    /// Pairs.
    pub pairs: usize,
    /// Small bodies outside.
    pub outside: usize,
    /// When the last of them was (s).
    pub last: f64,
    /// Fastest linear (m/s) and angular (rad/s) speed of any small body.
    pub speeds: [f64; 2],
}

impl Recovery {
    /// A pair for each of `kinds` and `poses`, the small body `scale` times as large; at most 32 pairs. `load` makes the
    /// model.
    ///
    /// # Errors
    /// Where `load` has one, a shape cannot be scaled, or there are more pairs than groups of colliders.
    pub fn new(
        kinds: &[ShapeKind],
        poses: &[Pose3],
        scale: f32,
        mut load: impl FnMut(ShapeKind) -> Result<Model>,
    ) -> Result<Self> {
        ensure!(
            kinds.len() * poses.len() <= 32,
            "{} shapes at {} poses are more than the 32 pairs that can be kept apart; ask for fewer (--poses)",
            kinds.len(),
            poses.len()
        );
        let mut world = weightless_world();
        let plugin = IstPlugin::install(&mut world);
        let mut columns = Vec::new();
        for (column, &kind) in kinds.iter().enumerate() {
            let model = load(kind)?;
            let mut escapes = Vec::new();
            for (row, &pose) in poses.iter().enumerate() {
                let translation = Vec3::new(column as f32, -(row as f32), 0.0) * SPACING;
                let group = (column * poses.len() + row) as u32;
                let place = PairPlace { translation, pose, scale, group };
                let pair = Pair::insert(&mut world, [&model, &model], &place, DENSITY)?;
                escapes.push(Escape { pair, outside: None, speeds: [0.0; 2] });
            }
            columns.push(Column { kind, model, escapes });
        }
        Ok(Self { world, plugin, columns, steps: 0 })
    }

    /// What became of the pairs, by kind of shape.
    pub fn outcomes(&self) -> impl Iterator<Item = Outcome> {
        self.columns.iter().map(|Column { kind, escapes, .. }| Outcome {
            kind: *kind,
            pairs: escapes.len(),
            outside: escapes.iter().filter(|escape| escape.outside.is_some()).count(),
            last: escapes.iter().filter_map(|escape| escape.outside).fold(0.0, f64::max),
            speeds: [0, 1].map(|k| escapes.iter().map(|escape| escape.speeds[k]).fold(0.0, f64::max)),
        })
    }
}

impl Escape {
    fn look(&mut self, world: &PhysicsWorld, model: &Model, time: f64) {
        let inside = self.pair.share_inside(world, [model, model]) > 0.0;
        self.outside = if inside { None } else { self.outside.or(Some(time)) };
    }
}

impl Simulation for Recovery {
    fn title(&self) -> String {
        let kinds: Vec<String> = self.columns.iter().map(|column| format!("{:?}", column.kind)).collect();
        format!("bunny inside a bunny, {}", kinds.join(", "))
    }

    fn world(&self) -> &PhysicsWorld {
        &self.world
    }

    fn plugin(&self) -> &IstPlugin {
        &self.plugin
    }

    fn step(&mut self) {
        self.plugin.step(&mut self.world);
        self.steps += 1;
        let time = self.steps as f64 * f64::from(self.world.integration_parameters.dt);
        for Column { model, escapes, .. } in &mut self.columns {
            for escape in escapes {
                let body = &self.world.bodies[escape.pair.small];
                let speeds = [body.linvel(), body.angvel()].map(|velocity| f64::from(velocity.length()));
                escape.speeds = [0, 1].map(|k| escape.speeds[k].max(speeds[k]));
                if self.steps.is_multiple_of(LOOK_EVERY) {
                    escape.look(&self.world, model, time);
                }
            }
        }
    }

    fn bodies(&self) -> Vec<Body<'_>> {
        let mut bodies = Vec::new();
        for (index, Column { kind, model, escapes }) in self.columns.iter().enumerate() {
            for (row, Escape { pair, .. }) in escapes.iter().enumerate() {
                let body = |handle, name| {
                    let body = Body::new(handle, format!("{kind:?}_{name}_{row}"), &model.solid);
                    if *kind == ShapeKind::Ist { body.packing(&model.packing) } else { body }
                };
                bodies.push(body(pair.large, "large").opacity(0.3).section(Section::Capped));
                bodies.push(
                    body(pair.small, "small").unframed().scale(pair.scale).color(palette::color(index)),
                );
            }
        }
        bodies
    }

    /// Only of inner sphere trees: Rapier's own shapes are there to compare with.
    fn checks(&self, _: &Summary) -> Vec<Check> {
        let mut checks = Vec::new();
        for outcome in self.outcomes().filter(|outcome| outcome.kind == ShapeKind::Ist) {
            let [linear, angular] = outcome.speeds;
            checks.push(Check::new("fastest", linear, "m/s", Wanted::AtMost(FASTEST[0])));
            checks.push(Check::new("fastest turn", angular, "rad/s", Wanted::AtMost(FASTEST[1])));
            if self.steps >= OUT_AFTER {
                let inside = (outcome.pairs - outcome.outside) as f64;
                checks.push(Check::new("still inside after 3 s", inside, "", Wanted::AtMost(0.0)));
            }
        }
        checks
    }

    fn figures(&self) -> serde_json::Value {
        serde_json::to_value(self.outcomes().collect::<Vec<_>>()).unwrap_or_default()
    }

    fn remarks(&self) -> String {
        let mut table = String::from("  shape       outside   the last after   fastest   fastest turn\n");
        for Outcome { kind, pairs, outside, last, speeds: [linear, angular] } in self.outcomes() {
            let kind = format!("{kind:?}");
            let last = if outside == 0 { "–".to_owned() } else { format!("{last:.1} s") };
            table += &format!(
                "  {kind:<10} {outside:>3} of {pairs} {last:>16} {linear:>6.2} m/s {angular:>8.2} rad/s\n"
            );
        }
        table
    }

    fn view(&self) -> View {
        let cut = CutPlane { point: Vec3::ZERO, normal: Vec3::Z };
        View { from: Vec3::new(0.0, 0.1, 1.0), ground: None, cut: Some(cut) }
    }

    fn metadata(&self) -> Vec<(&'static str, String)> {
        vec![("example", "inside".to_owned())]
    }
}
