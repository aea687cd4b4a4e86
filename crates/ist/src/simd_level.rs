//! The instruction set that queries run on.

use fearless_simd::Level;

/// The best that the processor has. Without feature `std` nobody asks it, and this is what the crate was compiled for.
/// Results are the same on every one.
pub(crate) fn simd_level() -> Level {
    Level::try_detect().unwrap_or_else(Level::baseline)
}
