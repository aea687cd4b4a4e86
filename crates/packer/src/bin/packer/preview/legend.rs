//! The scale of colours: which radius has which colour.

use super::scene::Scene;
use super::shade::{color_at, encoded};
use super::{HEIGHT, WIDTH};

const BAR: usize = 240;
const BAR_HEIGHT: usize = 14;
/// Rows from the lower edge to the bar's upper edge.
const RISE: usize = 40;
/// Pixels per dot of a glyph, and dots of a glyph with the gap after it.
const DOT: usize = 2;
const ADVANCE: usize = 6;
const GAP: usize = 12;
const INK: [u8; 3] = [70, 74, 84];

/// Draws a bar of colours with the smallest and the largest radius at its ends.
pub(super) fn draw(scene: &Scene, pixels: &mut [[u8; 3]]) {
    let (min, max) = (f64::from(scene.radii.0) * scene.unit, f64::from(scene.radii.1) * scene.unit);
    let (before, after) = (format!("radius {}", number(min)), number(max));
    let whole = width(&before) + GAP + BAR + GAP + width(&after);
    let left = (WIDTH - whole) / 2;
    let top = HEIGHT - RISE;
    let bar = left + width(&before) + GAP;
    for row in top..top + BAR_HEIGHT {
        for column in 0..BAR {
            let share = (column as f32 + 0.5) / BAR as f32;
            pixels[row * WIDTH + bar + column] = encoded(color_at(share));
        }
    }
    write(&before, left, top, pixels);
    write(&after, bar + BAR + GAP, top, pixels);
}

fn width(text: &str) -> usize {
    text.len() * ADVANCE * DOT
}

fn write(text: &str, left: usize, top: usize, pixels: &mut [[u8; 3]]) {
    for (index, letter) in text.chars().enumerate() {
        for (row, bits) in glyph(letter).into_iter().enumerate() {
            for column in (0..5).filter(|column| bits >> (4 - column) & 1 == 1) {
                let (x, y) = (left + (index * ADVANCE + column) * DOT, top + row * DOT);
                for at in 0..DOT * DOT {
                    pixels[(y + at / DOT) * WIDTH + x + at % DOT] = INK;
                }
            }
        }
    }
}

/// Three significant digits, as a power of ten where a plain number would be long.
fn number(value: f64) -> String {
    let scientific = format!("{value:.2e}");
    // Of the rounded number: 0.0099999 is 0.0100.
    let exponent: i32 = scientific.split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or_default();
    if !(-3..4).contains(&exponent) {
        return scientific;
    }
    format!("{value:.*}", (2 - exponent).max(0) as usize)
}

/// A letter as seven rows of five dots; only those that the legend needs.
fn glyph(letter: char) -> [u8; 7] {
    match letter {
        '0' => [0b01110, 0b10001, 0b10011, 0b10101, 0b11001, 0b10001, 0b01110],
        '1' => [0b00100, 0b01100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110],
        '2' => [0b01110, 0b10001, 0b00001, 0b00110, 0b01000, 0b10000, 0b11111],
        '3' => [0b01110, 0b10001, 0b00001, 0b00110, 0b00001, 0b10001, 0b01110],
        '4' => [0b00010, 0b00110, 0b01010, 0b10010, 0b11111, 0b00010, 0b00010],
        '5' => [0b11111, 0b10000, 0b11110, 0b00001, 0b00001, 0b10001, 0b01110],
        '6' => [0b00110, 0b01000, 0b10000, 0b11110, 0b10001, 0b10001, 0b01110],
        '7' => [0b11111, 0b00001, 0b00010, 0b00010, 0b00100, 0b00100, 0b00100],
        '8' => [0b01110, 0b10001, 0b10001, 0b01110, 0b10001, 0b10001, 0b01110],
        '9' => [0b01110, 0b10001, 0b10001, 0b01111, 0b00001, 0b00010, 0b01100],
        '.' => [0, 0, 0, 0, 0, 0b00110, 0b00110],
        '-' => [0, 0, 0, 0b01110, 0, 0, 0],
        'a' => [0, 0, 0b01110, 0b00001, 0b01111, 0b10001, 0b01111],
        'd' => [0b00001, 0b00001, 0b01101, 0b10011, 0b10001, 0b10001, 0b01111],
        'e' => [0, 0, 0b01110, 0b10001, 0b11111, 0b10000, 0b01110],
        'i' => [0b00100, 0, 0b01100, 0b00100, 0b00100, 0b00100, 0b01110],
        'r' => [0, 0, 0b10110, 0b11001, 0b10000, 0b10000, 0b10000],
        's' => [0, 0, 0b01111, 0b10000, 0b01110, 0b00001, 0b11110],
        'u' => [0, 0, 0b10001, 0b10001, 0b10001, 0b10011, 0b01101],
        _ => [0; 7],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits_and_glyphs() {
        for (value, text) in [
            (0.012_12, "0.0121"),
            (0.268_3, "0.268"),
            (f64::from(0.01_f32), "0.0100"),
            (0.999_6, "1.00"),
            (0.000_999_99, "0.00100"),
            (1.0, "1.00"),
            (12.345, "12.3"),
            (1234.5, "1234"),
            (2.5e-7, "2.50e-7"),
            (f64::from(f32::MAX), "3.40e38"),
            (f64::from(f32::MIN_POSITIVE), "1.18e-38"),
        ] {
            assert_eq!(number(value), text);
            assert!(text.chars().all(|letter| glyph(letter) != [0; 7]), "{text}");
        }
        assert!("radius".chars().all(|letter| glyph(letter) != [0; 7]));
    }
}
