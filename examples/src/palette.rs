//! Colours that stay apart for every kind of colour vision.

/// The qualitative palette of Okabe and Ito (*Color Universal Design*, 2008) without its black, as 8-bit sRGB, in
/// an order that keeps neighbours far apart.
const COLORS: [[u8; 3]; 7] = [
    [0x00, 0x72, 0xB2], // blue
    [0xE6, 0x9F, 0x00], // orange
    [0x00, 0x9E, 0x73], // bluish green
    [0xCC, 0x79, 0xA7], // reddish purple
    [0x56, 0xB4, 0xE9], // sky blue
    [0xD5, 0x5E, 0x00], // vermilion
    [0xF0, 0xE4, 0x42], // yellow
];

/// Warm light grey for what is scenery: bowls, floors, tools.
pub const NEUTRAL: [f32; 3] = [0.80, 0.78, 0.75];

/// Colour number `index` as sRGB, 0 to 1 each; the seven colours repeat.
#[must_use]
pub fn color(index: usize) -> [f32; 3] {
    COLORS[index % COLORS.len()].map(|channel| f32::from(channel) / 255.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_differ_and_the_palette_repeats() {
        for i in 0..COLORS.len() {
            assert_ne!(color(i), color(i + 1));
            assert_eq!(color(i), color(i + COLORS.len()));
        }
    }
}
