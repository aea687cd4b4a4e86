//! Recordings of whole scenes.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod faults;
mod killed;
mod pile;
