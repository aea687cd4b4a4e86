//! PLY, ASCII and binary.

use super::Parsed;
pub(super) fn parse(_bytes: &[u8]) -> Parsed {
    Err("not yet".into())
}
