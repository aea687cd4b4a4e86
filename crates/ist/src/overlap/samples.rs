//! The overlap as a cloud of contact samples, for a solver.

use super::lens_lanes::LensLanes;
use super::pairs::PairBuffer;
use super::relative_pose::RelativePose;
use super::traversal::PairSink;
use crate::tree::{TreeData, WIDTH};
use alloc::vec::Vec;
use fearless_simd::Simd;
use glam::Vec3;

/// One overlapping pair of spheres, in A's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactSample {
    /// Centroid of the lens (m).
    pub point: Vec3,
    /// Unit vector from the centre of A's sphere to that of B's; zero for concentric spheres.
    pub center_line: Vec3,
    /// Stored outward normal of A's sphere minus that of B's sphere: where the fields of depth push B.
    /// Length 0 to 2.
    pub outward: Vec3,
    /// Volume of the lens (m³).
    pub volume: f32,
    /// Area of the lens across the centre line (m²): minus the derivative of the volume by the distance.
    pub area: f32,
}

/// Appends every pair to a list of [`ContactSample`]s.
pub(super) struct SampleSink<'a> {
    a: &'a TreeData,
    b: &'a TreeData,
    pose: &'a RelativePose,
    /// Scale of A.
    scale: f32,
    samples: &'a mut Vec<ContactSample>,
}

impl<'a> SampleSink<'a> {
    pub(super) fn new(
        (a, b): (&'a TreeData, &'a TreeData),
        pose: &'a RelativePose,
        scale: f32,
        samples: &'a mut Vec<ContactSample>,
    ) -> Self {
        Self { a, b, pose, scale, samples }
    }
}

impl PairSink for SampleSink<'_> {
    #[inline(always)]
    fn take<S: Simd>(&mut self, simd: S, pairs: &PairBuffer) {
        let scale2 = self.scale * self.scale;
        for first in (0..pairs.len()).step_by(WIDTH) {
            let lens = LensLanes::new(simd, pairs, first);
            for lane in 0..WIDTH.min(pairs.len() - first) {
                let volume = lens.volume[lane];
                if volume <= 0.0 {
                    continue;
                }
                let moment = Vec3::new(lens.moment.x[lane], lens.moment.y[lane], lens.moment.z[lane]);
                let [a, b] = [pairs.a.index[first + lane], pairs.b.index[first + lane]].map(|i| i as usize);
                self.samples.push(ContactSample {
                    point: moment * (self.scale / volume),
                    center_line: Vec3::new(lens.axis.x[lane], lens.axis.y[lane], lens.axis.z[lane]),
                    outward: self.a.normals[a] - self.pose.rotation * self.b.normals[b],
                    volume: volume * scale2 * self.scale,
                    area: lens.area[lane] * scale2,
                });
            }
        }
    }
}
