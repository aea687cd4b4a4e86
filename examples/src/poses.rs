//! Files of relative poses of two solids, with exact overlaps where they are known.

use anyhow::{Context, Result, ensure};
use glam::{Quat, Vec3};
use glamx::Pose3;
use serde::Deserialize;
use std::path::Path;

/// Poses of a solid B in the frame of a solid A.
#[derive(Clone, Debug)]
pub struct PoseFile {
    /// Size of B relative to its mesh, where the file says.
    pub scale_b: Option<f32>,
    /// Volume of the smaller solid, where the file says.
    pub smaller_volume: Option<f64>,
    /// The poses.
    pub poses: Vec<KnownPose>,
}

/// A pose of B in A's frame.
#[derive(Clone, Copy, Debug)]
pub struct KnownPose {
    /// The pose itself, with a unit rotation.
    pub pose: Pose3,
    /// Exact volume of the overlap, where the file says.
    pub volume: Option<f64>,
}

#[derive(Deserialize)]
struct File {
    scale_b: Option<f32>,
    volume_a: Option<f64>,
    volume_b: Option<f64>,
    poses: Vec<Record>,
}

#[derive(Deserialize)]
struct Record {
    translation: [f32; 3],
    rotation_xyzw: [f32; 4],
    volume: Option<f64>,
}

impl PoseFile {
    /// Reads a JSON file with `poses`, each of them `translation` and `rotation_xyzw`, and `volume` where it is known.
    ///
    /// # Errors
    /// Where the file cannot be read, is no such file, or a pose is no pose.
    pub fn load(path: &Path) -> Result<Self> {
        let name = path.display();
        let text = std::fs::read_to_string(path).with_context(|| format!("cannot read {name}"))?;
        let file: File = serde_json::from_str(&text).with_context(|| {
            format!("{name} is not a pose file: it needs poses with translation and rotation_xyzw")
        })?;
        let known = |record: &Record| KnownPose {
            pose: Pose3::from_parts(
                Vec3::from_array(record.translation),
                Quat::from_array(record.rotation_xyzw).normalize(),
            ),
            volume: record.volume,
        };
        let poses: Vec<KnownPose> = file.poses.iter().map(known).collect();
        let finite = poses.iter().all(|known| known.pose.is_finite());
        ensure!(finite, "{name}: a pose is not finite or its rotation is zero");
        let smaller_volume = file.volume_a.zip(file.volume_b).map(|(a, b)| a.min(b));
        Ok(Self { scale_b: file.scale_b, smaller_volume, poses })
    }

    /// The same poses for a B of another size, for which nothing exact is known unless it is the file's.
    #[must_use]
    pub fn for_scale(mut self, scale_b: f32) -> Self {
        if self.scale_b.is_some_and(|scale| (scale - scale_b).abs() > 1e-6 * scale) {
            self.smaller_volume = None;
            for known in &mut self.poses {
                known.volume = None;
            }
        }
        self
    }

    /// Poses at which one solid is wholly inside the other, as far as the file says.
    #[must_use]
    pub fn contained(&self) -> Vec<Pose3> {
        let whole = |known: &&KnownPose| {
            known.volume.zip(self.smaller_volume).is_some_and(|(volume, smaller)| volume >= 0.9999 * smaller)
        };
        self.poses.iter().filter(whole).map(|known| known.pose).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn load(text: &str) -> Result<PoseFile> {
        let file = tempfile::NamedTempFile::new()?;
        std::fs::write(file.path(), text)?;
        PoseFile::load(file.path())
    }

    #[test]
    fn exact_volumes_belong_to_a_size() {
        let text = r#"{"scale_b": 0.5, "volume_a": 8.0, "volume_b": 1.0, "poses": [
            {"translation": [1, 2, 3], "rotation_xyzw": [0, 0, 0, 2], "volume": 1.0},
            {"translation": [1, 2, 4], "rotation_xyzw": [0, 0, 0, 1], "volume": 0.5}]}"#;
        let file = load(text).unwrap();
        assert_eq!(file.contained(), [Pose3::translation(1.0, 2.0, 3.0)]);
        assert_eq!(file.clone().for_scale(0.5).poses[1].volume, Some(0.5));
        let other = file.for_scale(1.0);
        assert!(other.smaller_volume.is_none() && other.poses.iter().all(|known| known.volume.is_none()));
    }

    #[test]
    fn what_is_no_pose_is_refused() {
        for text in ["", "{}", r#"{"poses": [{"translation": [0, 0, 0], "rotation_xyzw": [0, 0, 0, 0]}]}"#] {
            assert!(load(text).is_err(), "{text}");
        }
        assert!(load(r#"{"poses": []}"#).unwrap().contained().is_empty());
    }
}
