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
