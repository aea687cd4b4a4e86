//! What recording costs a step of the pile: `cargo bench -p rapier-ist-benches --bench recording`.
//!
//! Piles that are the same in every number step side by side, one of them not recorded, so that what else the machine does
//! hits all of them alike. The ratios printed first are the medians over all steps of the recorded step's time to
//! the plain step's, and the sums of the recorders' times to the sum of the plain steps' times.

use criterion::{Criterion, criterion_group};
use rapier_ist::record::{RecordOptions, Recorder};
use rapier_ist_examples::figures::percentile;
use rapier_ist_examples::recording::describe;
use rapier_ist_examples::scenes::{Pile, PileOptions};
use std::error::Error;
use std::fs::File;
use std::io::BufWriter;
use std::time::{Duration, Instant};

/// Steps that are measured: bodies fall and pile up. Later they sleep, and a step takes less than a recorded pose.
const STEPS: usize = 120;
/// A choice of options.
type Preset = fn() -> RecordOptions;
/// Ways to record.
const WAYS: [(&str, Preset); 4] = [
    ("poses", RecordOptions::poses),
    ("poses, background", || RecordOptions::poses().background(true)),
    ("everything", RecordOptions::everything),
    ("everything, background", || RecordOptions::everything().background(true)),
];

/// A pile that is recorded, and the times of its steps (s).
struct Run {
    name: &'static str,
    pile: Pile,
    recorder: Option<Recorder<BufWriter<File>>>,
    steps: Vec<f64>,
    records: Vec<f64>,
}

impl Run {
    fn new(name: &'static str, options: Option<RecordOptions>) -> Result<Self, Box<dyn Error>> {
        let pile = Pile::new(&PileOptions::default(), |_| ())?;
        let recorder = match options {
            Some(options) => {
                let path = std::env::temp_dir().join(format!("rapier-ist bench {name}.mcap"));
                let mut recorder = Recorder::create(path, options)?;
                describe(&mut recorder, &pile)?;
                recorder.record_start(&pile.world)?;
                Some(recorder)
            }
            None => None,
        };
        Ok(Self { name, pile, recorder, steps: Vec::new(), records: Vec::new() })
    }

    fn step(&mut self) -> Result<(), Box<dyn Error>> {
        let start = Instant::now();
        self.pile.step();
        let stepped = start.elapsed();
        if let Some(recorder) = &mut self.recorder {
            recorder.record(&self.pile.world, self.pile.plugin.report())?;
        }
        let all = start.elapsed();
        self.steps.push(all.as_secs_f64());
        self.records.push((all - stepped).as_secs_f64());
        Ok(())
    }
}

/// All runs side by side.
fn measure() -> Result<Vec<Run>, Box<dyn Error>> {
    let mut runs = vec![Run::new("none", None)?];
    for (name, options) in WAYS {
        runs.push(Run::new(name, Some(options()))?);
    }
    for step in 0..STEPS {
        // Who begins is nobody's advantage.
        let count = runs.len();
        for turn in 0..count {
            runs[(step + turn) % count].step()?;
        }
    }
    Ok(runs)
}

fn print(runs: &[Run]) {
    let plain = &runs[0].steps;
    println!("\nA step of the pile, 40 bodies of 1000 spheres, {STEPS} steps\n");
    println!("| recorded | median step | ratio to none, median | recorder's time / plain step's |");
    println!("|---|---|---|---|");
    for run in runs {
        let ratios: Vec<f64> = run.steps.iter().zip(plain).map(|(step, plain)| step / plain).collect();
        let share = run.records.iter().sum::<f64>() / plain.iter().sum::<f64>();
        println!(
            "| {} | {:.2} ms | {:.3} | {:.2} % |",
            run.name,
            1e3 * percentile(&run.steps, 0.5),
            percentile(&ratios, 0.5),
            100.0 * share
        );
    }
}

/// Criterion's report: one call of `record` for a pile at rest.
fn record(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("record one step of the pile");
    group.sample_size(20).warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(2));
    for (name, options) in WAYS {
        let Ok(mut run) = Run::new(name, Some(options())) else { continue };
        for _ in 0..120 {
            run.pile.step();
        }
        group.bench_function(name, |bencher| {
            let Run { recorder: Some(recorder), pile, .. } = &mut run else { return };
            bencher.iter(|| recorder.record(&pile.world, pile.plugin.report()).is_ok());
        });
    }
    group.finish();
}

criterion_group!(benches, record);

fn main() -> Result<(), Box<dyn Error>> {
    // `cargo test --benches` runs this too, without the flag.
    if !std::env::args().any(|argument| argument == "--bench") {
        return Ok(());
    }
    print(&measure()?);
    benches();
    Criterion::default().configure_from_args().final_summary();
    Ok(())
}
