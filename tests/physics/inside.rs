//! A small bunny inside a big one.

use rapier_ist_examples::scenes::{Inside, Model, ShapeKind, asset_folder};
use rapier_ist_tests::{TruePose, Truth};

const SPHERES: usize = 1000;

/// What happened in three seconds.
#[derive(Clone, Copy, Debug)]
struct Outcome {
    /// When the small body was outside, for good (s).
    outside: Option<f32>,
    /// Fastest linear (m/s) and angular (rad/s) speed of the small body.
    speeds: [f32; 2],
}

/// Lets go of the small body at `pose`; whether it is outside is asked of the exact meshes.
fn run(truth: &Truth, models: &[Model; 2], pose: &TruePose) -> Outcome {
    let mut scene = Inside::new(&models[0], &models[1], truth.scale_b, pose.pose(), 1000.0).unwrap();
    let mut outcome = Outcome { outside: None, speeds: [0.0; 2] };
    for step in 1..=180 {
        scene.plugin.step(&mut scene.world);
        let body = &scene.world.bodies[scene.small];
        outcome.speeds[0] = outcome.speeds[0].max(body.linvel().length());
        outcome.speeds[1] = outcome.speeds[1].max(body.angvel().length());
        if step % 6 == 0 {
            let time = step as f32 / 60.0;
            let inside = scene.share_inside(&models[0], &models[1]) > 0.0;
            outcome.outside = if inside { None } else { outcome.outside.or(Some(time)) };
        }
    }
    outcome
}

fn models(kind: ShapeKind) -> [Model; 2] {
    let load = || Model::load(&asset_folder().join("bunny.obj"), SPHERES, kind).unwrap();
    [load(), load()]
}

/// Poses at which the small body is wholly inside.
fn inside_poses(truth: &Truth) -> Vec<&TruePose> {
    truth.poses.iter().filter(|pose| truth.is_contained(pose.volume)).collect()
}

/// Outcomes at all of `poses` as one line: how many got out, how fast, at most how long.
fn summary(outcomes: &[Outcome]) -> String {
    let outside = outcomes.iter().filter(|o| o.outside.is_some()).count();
    let worst = |of: fn(&Outcome) -> f32| outcomes.iter().map(of).fold(0.0, f32::max);
    format!(
        "{outside} of {} outside, the last after {:.1} s, at most {:.2} m/s and {:.2} rad/s",
        outcomes.len(),
        worst(|o| o.outside.unwrap_or(f32::INFINITY)),
        worst(|o| o.speeds[0]),
        worst(|o| o.speeds[1])
    )
}

#[test]
fn a_bunny_gets_out_of_a_bunny() {
    let truth = Truth::load("bunny_inside").unwrap();
    let models = models(ShapeKind::Ist);
    let poses = inside_poses(&truth);
    let outcomes: Vec<Outcome> = poses.iter().map(|pose| run(&truth, &models, pose)).collect();
    println!("inner spheres: {}", summary(&outcomes));
    for (index, outcome) in outcomes.iter().enumerate() {
        assert!(outcome.outside.is_some(), "pose {index}: {outcome:?}");
        assert!(outcome.speeds[0] <= 5.0 && outcome.speeds[1] <= 20.0, "pose {index}: {outcome:?}");
    }
}

#[test]
fn rapiers_own_shapes_beside_it() {
    let truth = Truth::load("bunny_inside").unwrap();
    for kind in [ShapeKind::Trimesh, ShapeKind::Voxels, ShapeKind::Vhacd] {
        let models = models(kind);
        // A few poses say enough, and a triangle mesh takes its time.
        let poses = inside_poses(&truth).into_iter().step_by(24);
        let outcomes: Vec<Outcome> = poses.map(|pose| run(&truth, &models, pose)).collect();
        println!("{kind:?}: {}", summary(&outcomes));
    }
}
