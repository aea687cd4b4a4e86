//! What is recorded, how often and how densely.

use std::collections::BTreeMap;

/// Direction that viewers should show as up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UpAxis {
    /// +y, as in Rapier's examples.
    #[default]
    Y,
    /// +z, as viewers expect.
    Z,
}

/// Compression of the file's chunks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ChunkCompression {
    /// Plain bytes.
    None,
    /// Fast.
    Lz4,
    /// Small.
    #[default]
    Zstd,
}

/// What a [`Recorder`](super::Recorder) writes. Start from a preset, then adjust.
///
/// ```
/// use rapier_ist::record::{ChunkCompression, RecordOptions};
///
/// let options = RecordOptions::contacts().every(2).compression(ChunkCompression::Lz4).metadata("seed", 42);
/// ```
#[derive(Clone, Debug)]
pub struct RecordOptions {
    pub(super) contacts: bool,
    pub(super) packings: bool,
    pub(super) timings: bool,
    pub(super) background: bool,
    pub(super) every: u64,
    pub(super) up: UpAxis,
    pub(super) chunk_size: u64,
    pub(super) compression: ChunkCompression,
    pub(super) arrow_length_per_newton: Option<f64>,
    pub(super) metadata: BTreeMap<String, String>,
}

impl RecordOptions {
    /// Meshes and poses: enough to watch the scene. Smallest files.
    #[must_use]
    pub fn poses() -> Self {
        Self {
            contacts: false,
            packings: false,
            timings: false,
            background: false,
            every: 1,
            up: UpAxis::default(),
            // The format's own default.
            chunk_size: 1 << 20,
            compression: ChunkCompression::default(),
            arrow_length_per_newton: None,
            metadata: BTreeMap::new(),
        }
    }

    /// [`Self::poses`], and the contacts of every step with force arrows, and energies.
    #[must_use]
    pub fn contacts() -> Self {
        Self { contacts: true, ..Self::poses() }
    }

    /// [`Self::contacts`], and every body's packing, to be seen and as an `.ist` attachment.
    #[must_use]
    pub fn everything() -> Self {
        Self { packings: true, ..Self::contacts() }
    }

    /// Record only every `n`-th step; 0 counts as 1.
    #[must_use]
    pub fn every(mut self, n: u32) -> Self {
        self.every = u64::from(n.max(1));
        self
    }

    /// Direction that viewers show as up.
    #[must_use]
    pub fn up(mut self, axis: UpAxis) -> Self {
        self.up = axis;
        self
    }

    /// Bytes after which a chunk ends, before compression. What a killed run loses is the chunk that it was filling:
    /// smaller chunks lose less, larger ones compress better. 0 makes a chunk of every message.
    #[must_use]
    pub fn chunk_size(mut self, bytes: u64) -> Self {
        self.chunk_size = bytes;
        self
    }

    /// Compression of the chunks.
    #[must_use]
    pub fn compression(mut self, compression: ChunkCompression) -> Self {
        self.compression = compression;
        self
    }

    /// Length of force arrows (m/N). Without it, the mean weight of the dynamic bodies draws an arrow as long as
    /// the mean radius of the described bodies.
    #[must_use]
    pub fn arrow_length_per_newton(mut self, length: f64) -> Self {
        self.arrow_length_per_newton = (length.is_finite() && length > 0.0).then_some(length);
        self
    }

    /// Also write wall times into `/metrics`. Off by default: with them, equal runs no longer give equal files.
    #[must_use]
    pub fn timings(mut self, on: bool) -> Self {
        self.timings = on;
        self
    }

    /// Compress and write on a thread of its own, for [`Recorder::create`](super::Recorder::create) and
    /// [`Recorder::new_send`](super::Recorder::new_send). The file's bytes are the same. Off by default.
    ///
    /// A step then only encodes its messages, and waits where 64 of them are still to be written. An error reaches
    /// the caller some steps after it happened, at the latest in [`Recorder::finish`](super::Recorder::finish).
    #[must_use]
    pub fn background(mut self, on: bool) -> Self {
        self.background = on;
        self
    }

    /// Adds an entry to the file's metadata record, for example the seed or a parameter of the scene.
    #[must_use]
    pub fn metadata(mut self, key: impl Into<String>, value: impl ToString) -> Self {
        self.metadata.insert(key.into(), value.to_string());
        self
    }
}

impl Default for RecordOptions {
    /// As [`RecordOptions::contacts`].
    fn default() -> Self {
        Self::contacts()
    }
}
