//! The code of the documents, compiled and run with the doctests. It is here because what a published crate includes has
//! to lie in the crate's own folder.

#[doc = include_str!("../../README.md")]
struct Readme;

#[doc = include_str!("../../crates/ist/README.md")]
struct ReadmeOfCore;

#[doc = include_str!("../../crates/packer/README.md")]
struct ReadmeOfPacker;

#[doc = include_str!("../../crates/rapier-ist/README.md")]
struct ReadmeOfPlugin;

#[doc = include_str!("../../docs/guide/quick-start.md")]
struct QuickStart;

#[doc = include_str!("../../docs/guide/sphere-counts.md")]
struct SphereCounts;

#[doc = include_str!("../../docs/guide/materials.md")]
struct Materials;

#[doc = include_str!("../../docs/guide/migrating.md")]
struct Migrating;

#[doc = include_str!("../../docs/guide/recordings.md")]
struct Recordings;

#[doc = include_str!("../../docs/guide/baking.md")]
struct Baking;
