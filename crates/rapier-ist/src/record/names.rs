//! Names of bodies as frames and topics.

use std::collections::HashSet;

/// Frames of the file that no body may take.
const RESERVED: [&str; 4] = [super::WORLD_FRAME, super::ROOT_FRAME, "scene", ""];

/// The names given so far.
#[derive(Default)]
pub(super) struct Names {
    taken: HashSet<String>,
}

impl Names {
    /// The name closest to `wanted` that can stand in a topic and is not taken: other characters than letters,
    /// digits, `-`, `_` and `.` become `_`, and a number is added to a name that has been given.
    pub(super) fn unique(&mut self, wanted: &str) -> String {
        let allowed = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
        let clean: String =
            wanted.trim().chars().map(|c| if allowed(c) { c } else { '_' }).take(MAX_LENGTH).collect();
        let mut name = if clean.is_empty() { "body".to_owned() } else { clean.clone() };
        let base = name.clone();
        // Bodies named alike are numbered in turn: start where the last one of that name must be.
        let mut number = 2;
        while RESERVED.contains(&name.as_str()) || !self.taken.insert(name.clone()) {
            name = format!("{base}_{number}");
            number += 1;
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
