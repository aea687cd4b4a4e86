//! A recording as one HTML page that plays it in any browser with WebGL 2, without a network.
//!
//! The page holds the player (`*.js`, `page.html`, `style.css`), a description as JSON and the numbers as base64:
//! positions and rotations in 14 bytes for each body and step, shapes and spheres in 16-bit steps of their size, each
//! once however many bodies have them.

mod data;
mod shapes;
#[cfg(test)]
mod tests;

use anyhow::Result;
use data::Recording;
use rapier_ist::replay::Replay;

const PAGE: &str = include_str!("page.html");
const STYLE: &str = include_str!("style.css");
const SCRIPTS: [&str; 5] = [
    include_str!("recording.js"),
    include_str!("geometry.js"),
    include_str!("shaders.js"),
    include_str!("renderer.js"),
    include_str!("controls.js"),
];

/// The page that plays `replay` under the heading `title`.
///
/// # Errors
/// Where the recording has no steps, or more numbers than a page can hold.
pub fn page(replay: &Replay, title: &str) -> Result<String> {
    let recording = Recording::new(replay, title)?;
    // In a script element only `<` could end it or begin a comment.
    let description = serde_json::to_string(&recording.description)?.replace('<', "\\u003c");
    let parts = [
        ("/*STYLE*/", STYLE.to_owned()),
        ("/*DESCRIPTION*/", description),
        ("/*NUMBERS*/", base64(&recording.numbers)),
        ("/*SCRIPTS*/", SCRIPTS.join("\n")),
    ];
    let mut page = String::new();
    let mut rest = PAGE;
    for (mark, part) in parts {
        let (before, after) = rest.split_once(mark).unwrap_or((rest, ""));
        page.push_str(before);
        page.push_str(&part);
        rest = after;
    }
    page.push_str(rest);
    Ok(page)
}

/// The bytes in base64 (RFC 4648, section 4).
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let byte = |index: usize| u32::from(three.get(index).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for digit in 0..4 {
            let value = (bits >> (18 - 6 * digit)) & 63;
            text.push(if digit <= three.len() { char::from(DIGITS[value as usize]) } else { '=' });
        }
    }
    text
}
