//! Numbers and poses from bytes. Where the bytes end, zeros follow.

use arbitrary::Unstructured;
use glam::{Quat, Vec3};
use glamx::Pose3;

/// An integer or the like; zero where the bytes end.
pub(super) fn raw<'a, T: arbitrary::Arbitrary<'a> + Default>(u: &mut Unstructured<'a>) -> T {
    u.arbitrary().unwrap_or_default()
}

/// A number below `end`, which is at least 1.
pub(super) fn below(u: &mut Unstructured, end: u8) -> u8 {
    raw::<u8>(u) % end
}

/// From −8 to 8 in steps of 2⁻¹², coarse enough for coincidences.
pub(super) fn moderate(u: &mut Unstructured) -> f32 {
    f32::from(raw::<i16>(u)) / 4096.0
}

/// Three of them.
pub(super) fn moderate_vector(u: &mut Unstructured) -> Vec3 {
    Vec3::new(moderate(u), moderate(u), moderate(u))
}

/// 2 to the power of something from `-span` to `span`.
pub(super) fn power_of_two(u: &mut Unstructured, span: u8) -> f32 {
    (f32::from(below(u, 2 * span + 1)) - f32::from(span)).exp2()
}

/// Any bits; often one of the numbers at which arithmetic goes wrong.
pub(super) fn any_float(u: &mut Unstructured) -> f32 {
    const SPECIAL: [f32; 12] = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::MAX,
        f32::MIN,
        f32::MIN_POSITIVE,
        f32::EPSILON,
        1e-45,
    ];
    match SPECIAL.get(usize::from(below(u, 32))) {
        Some(special) => *special,
        None => f32::from_bits(raw(u)),
    }
}

/// Three of them.
pub(super) fn any_vector(u: &mut Unstructured) -> Vec3 {
    Vec3::new(any_float(u), any_float(u), any_float(u))
}

/// A finite number of any size.
pub(super) fn finite_float(u: &mut Unstructured) -> f32 {
    Some(any_float(u)).filter(|x| x.is_finite()).unwrap_or(0.5)
}

/// A rotation, mostly oblique, often none or about an axis.
pub(super) fn rotation(u: &mut Unstructured) -> Quat {
    let [x, y, z, w] = raw::<[i8; 4]>(u).map(f32::from);
    let rotation = Quat::from_xyzw(x, y, z, w);
    if rotation.length() > 0.0 { rotation.normalize() } else { Quat::IDENTITY }
}

/// A pose that places something of about `size` near the origin.
pub(super) fn pose(u: &mut Unstructured, size: f32) -> Pose3 {
    let translation = moderate_vector(u) * (0.25 * size);
    Pose3::from_parts(translation, rotation(u))
}

/// Any pose, also such as no body has.
pub(super) fn any_pose(u: &mut Unstructured) -> Pose3 {
    let translation = any_vector(u);
    let rotation = match below(u, 3) {
        0 => rotation(u),
        1 => rotation(u) * moderate(u),
        _ => Quat::from_xyzw(any_float(u), any_float(u), any_float(u), any_float(u)),
    };
    Pose3::from_parts(translation, rotation)
}

/// Whether queries take it: finite, with a rotation between 0.5 and 2 long.
pub(super) fn is_usable(pose: &Pose3) -> bool {
    let length = pose.rotation.length();
    pose.is_finite() && length > 0.5 && length < 2.0
}
