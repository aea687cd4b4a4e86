//! Benchmarks of the workspace: `cargo bench -p rapier-ist-benches`.
