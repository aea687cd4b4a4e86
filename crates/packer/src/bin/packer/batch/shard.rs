//! Which part of the meshes a run packs.
//!
//! A mesh belongs to a shard by the hash of its path relative to the input folder. So shards agree without a word,
//! also when files come and go between their starts.

use std::fmt;
use std::path::Path;
use std::str::FromStr;

/// Part `index` of `count`, from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shard {
    index: u32,
    count: u32,
}

impl Shard {
    /// Whether what has this hash belongs to the shard.
    pub(crate) fn owns(self, hash: u32) -> bool {
        hash % self.count == self.index - 1
    }

    /// A hash that this shard owns.
    pub(crate) fn own_hash(self) -> u32 {
        self.index - 1
    }
}

impl Default for Shard {
    fn default() -> Self {
        Self { index: 1, count: 1 }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        match numbers {
            None => Err("a shard is two whole numbers, as in 3/8".to_owned()),
            Some((_, 0)) => Err("there is at least one shard, as in 1/1".to_owned()),
            Some((0, _)) => Err("shards are counted from 1; add 1 to an index that starts at 0".to_owned()),
            Some((index, count)) if index > count => {
                Err(format!("there is no shard {index} of {count}; the last one is {count}/{count}"))
            }
            Some((index, count)) => Ok(Self { index, count }),
        }
    }
}

/// CRC-32 of a relative path with `/` between its parts: the same on every platform and in every version.
pub(crate) fn path_hash(path: &Path) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    for (index, part) in path.components().enumerate() {
        if index > 0 {
            hasher.update(b"/");
        }
        hasher.update(part.as_os_str().as_encoded_bytes());
    }
    hasher.finalize()
}

/// Mark in the names of temporary files that tells whose they are.
pub(crate) fn tag(hash: u32) -> String {
    format!("{hash:08x}-")
}

/// The hash in the name of a temporary file, after its prefix.
pub(crate) fn hash_of_tag(rest: &str) -> Option<u32> {
    let (digits, _) = rest.split_once('-')?;
    let is_tag = digits.len() == 8 && digits.bytes().all(|b| b.is_ascii_hexdigit());
    is_tag.then(|| u32::from_str_radix(digits, 16).ok()).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_path_belongs_to_one_shard() {
        for count in 1..=9 {
            let mut sizes = vec![0; count as usize];
            for file in 0..1_000 {
                let hash = path_hash(Path::new(&format!("part_{:02}/mesh_{file:04}.obj", file % 7)));
                let owners: Vec<u32> =
                    (1..=count).filter(|index| Shard { index: *index, count }.owns(hash)).collect();
                assert_eq!(owners.len(), 1);
                sizes[owners[0] as usize - 1] += 1;
            }
            let fair = 1_000 / count;
            assert!(sizes.iter().all(|size| (fair / 2..=2 * fair).contains(size)), "{count}: {sizes:?}");
        }
    }

    #[test]
    fn the_hash_is_fixed() {
        // The check value of CRC-32/ISO-HDLC.
        assert_eq!(path_hash(Path::new("123456789")), 0xCBF4_3926);
        assert_eq!(path_hash(&Path::new("a").join("b.obj")), crc32fast::hash(b"a/b.obj"));
    }

    #[test]
    fn tags_are_read_back_and_nothing_else_is() {
        for hash in [0, 1, 0xdead_beef, u32::MAX] {
            assert_eq!(hash_of_tag(&format!("{}Ab3kLm", tag(hash))), Some(hash));
        }
        for name in ["", "Ab3kLm", "notes-2024", "+0000001-a", "00000001", "0000000g-x"] {
            assert_eq!(hash_of_tag(name), None, "{name}");
        }
    }

    #[test]
    fn shards_are_parsed_strictly() {
        assert_eq!("3/8".parse(), Ok(Shard { index: 3, count: 8 }));
        for (text, message) in [
            ("0/0", "at least one"),
            ("0/4", "add 1"),
            ("3/2", "the last one is 2/2"),
            ("3", "two whole numbers"),
            ("/", "two whole numbers"),
            ("-1/2", "two whole numbers"),
            ("1/2/3", "two whole numbers"),
            ("1/99999999999", "two whole numbers"),
        ] {
            let error = text.parse::<Shard>().unwrap_err();
            assert!(error.contains(message), "{text}: {error}");
        }
    }
}
