//! Names of bodies as frames and topics.

use std::collections::{HashMap, HashSet};

/// Frames and topics of the file itself.
const RESERVED: [&str; 3] = [super::WORLD_FRAME, super::ROOT_FRAME, "scene"];

/// The names given so far.
#[derive(Default)]
pub(super) struct Names {
    taken: HashSet<String>,
    /// The number that the next body of a name gets: a thousand bodies may share one.
    next_number: HashMap<String, u32>,
}

impl Names {
    /// The name closest to `wanted` that can stand in a topic and is not taken: other characters than letters,
    /// digits, `-`, `_` and `.` become `_`, and a number is added to a name that has been given.
    pub(super) fn unique(&mut self, wanted: &str) -> String {
        let allowed = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
        let clean = wanted.trim().chars().map(|c| if allowed(c) { c } else { '_' });
        let mut base: String = clean.take(MAX_LENGTH).collect();
        if base.is_empty() {
            base.push_str("body");
        }
        let mut name = base.clone();
        while RESERVED.contains(&name.as_str()) || !self.taken.insert(name.clone()) {
            let number = self.next_number.entry(base.clone()).or_insert(2);
            name = format!("{base}_{number}");
            *number += 1;
        }
        name
    }
}

/// Longer names make unreadable topic lists.
const MAX_LENGTH: usize = 64;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_fit_into_topics() {
        let mut names = Names::default();
        assert_eq!(names.unique("ring"), "ring");
        assert_eq!(names.unique("ring"), "ring_2");
        assert_eq!(names.unique("ring_2"), "ring_2_2");
        assert_eq!(names.unique("ring"), "ring_3");
        assert_eq!(names.unique("große/Kugel"), "gro_e_Kugel");
        assert_eq!(names.unique(" "), "body");
        assert_eq!(names.unique(""), "body_2");
        assert_eq!(names.unique("world"), "world_2");
        assert_eq!(names.unique(&"x".repeat(1000)).len(), MAX_LENGTH);
    }
}
