//! The second derivative of the overlap volume.
//!
//! Let B be displaced by the twist (t, ω) about a point: x ↦ t + exp(ω)x, with x from that point. A pair of balls with
//! overlap V(d) at the distance d of the centres, axis n from A to B and B's centre at r contributes, with V' = −A,
//!
//! ```text
//! H = p w wᵀ + q JᵀJ + V' [ 0  0 ; 0  sym(n rᵀ) − (n·r) I ],   p = V'' − V'/d,   q = V'/d,
//! w = (n, r × n),   J = [ I  −[r]× ].
//! ```
//!
//! The last term is the second order of exp(ω). V' and V'' follow from the disc that the intersection circle bounds, at
//! x from A's centre and at y = d − x from B's: A = π(a² − x²), dx/dd = y/d, hence V'' = 2πxy/d.

use super::lens_lanes::{Lanes3, LensLanes};
use super::totals::sum;
use crate::tree::TreeData;
use fearless_simd::{Simd, f32x8};
use glam::{DMat3, DVec3, Mat3, Vec3};

/// How the wrench of [`ForceLaw::VolumeGradient`](super::ForceLaw::VolumeGradient) answers to a displacement of B: minus
/// its derivative by a translation t and a rotation vector ω about the overlap's centroid, for a pressure of 1 N/m².
///
/// This is the second derivative of the volume, a symmetric 6×6 matrix in blocks. It is indefinite in general:
/// deep inside, where the contact area falls with the depth, the force of the volume's gradient falls too. The
/// energy φ(V) of any other conservative law has the second derivative φ'·H + φ''·g gᵀ with the gradient
/// g = (gradient, rotation gradient).
///
/// At the distances of two spheres' centres where their contact begins or one of them is wholly inside, V has no second
/// derivative and this is the one from one side; pairs with coincident centres count as nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct StiffnessMatrix {
    /// By two translations (N/m).
    pub translation: Mat3,
    /// By a translation (row) and a rotation (column), N/rad.
    pub coupling: Mat3,
    /// By two rotations (N·m/rad).
    pub rotation: Mat3,
}

impl StiffnessMatrix {
    /// All six rows and columns: three of translation, three of rotation.
    #[must_use]
    pub fn to_rows(&self) -> [[f32; 6]; 6] {
        let (top, turned) = (self.coupling, self.coupling.transpose());
        core::array::from_fn(|i| {
            let (left, right, row) =
                if i < 3 { (self.translation, top, i) } else { (turned, self.rotation, i - 3) };
            let (left, right) = (left.row(row), right.row(row));
            [left.x, left.y, left.z, right.x, right.y, right.z]
        })
    }
}

/// Sums of the terms of H about [`origin`].
#[derive(Clone, Copy, Debug)]
pub(super) struct StiffnessSum {
    /// Σ p n nᵀ.
    nn: DMat3,
    /// Σ p n mᵀ with m = r × n.
    nm: DMat3,
    /// Σ p m mᵀ.
    mm: DMat3,
    /// Σ q.
    transverse: f64,
    /// Σ q r.
    transverse_r: DVec3,
    /// Σ q r rᵀ.
    transverse_rr: DMat3,
    /// Σ V' n rᵀ.
    first: DMat3,
}

/// The point of A's unscaled frame that r is measured from: the middle of its root. About the origin of the frame, which may be far from
/// the solid, squares of distances would leave single precision nothing of what they differ by.
pub(super) fn origin(a: &TreeData) -> Vec3 {
    a.root().get(0).0
}

/// Zero; the default of a matrix is the identity.
impl Default for StiffnessSum {
    fn default() -> Self {
        Self {
            nn: DMat3::ZERO,
            nm: DMat3::ZERO,
            mm: DMat3::ZERO,
            transverse: 0.0,
            transverse_r: DVec3::ZERO,
            transverse_rr: DMat3::ZERO,
            first: DMat3::ZERO,
        }
    }
}

impl StiffnessSum {
    pub(super) fn add(&mut self, other: &Self) {
        self.nn += other.nn;
        self.nm += other.nm;
        self.mm += other.mm;
        self.transverse += other.transverse;
        self.transverse_r += other.transverse_r;
        self.transverse_rr += other.transverse_rr;
        self.first += other.first;
    }

    /// H about `pivot`, which is measured from [`origin`]: each sum is shifted by r ↦ r − pivot. A is at `scale`, and `force` is
    /// Σ A n.
    pub(super) fn about(&self, pivot: DVec3, force: DVec3, scale: f64) -> StiffnessMatrix {
        let cross = cross_matrix(pivot);
        let outer = |a: DVec3, b: DVec3| DMat3::from_cols(a * b.x, a * b.y, a * b.z);
        // m ↦ m − pivot × n.
        let nm = self.nm + self.nn * cross;
        let turned = cross * self.nm;
        let mm = self.mm - turned - turned.transpose() - cross * self.nn * cross;
        let shift = outer(self.transverse_r, pivot);
        let r = self.transverse_r - self.transverse * pivot;
        let rr = self.transverse_rr - shift - shift.transpose() + self.transverse * outer(pivot, pivot);
        let first = self.first + outer(force, pivot);
        let identity = |x: f64| DMat3::from_diagonal(DVec3::splat(x));
        let rotation =
            mm + identity(trace(rr)) - rr + 0.5 * (first + first.transpose()) - identity(trace(first));
        StiffnessMatrix {
            translation: ((self.nn + identity(self.transverse)) * scale).as_mat3(),
            coupling: ((nm - cross_matrix(r)) * (scale * scale)).as_mat3(),
            rotation: (rotation * (scale * scale * scale)).as_mat3(),
        }
    }
}

/// The matrix of v ↦ `w` × v.
fn cross_matrix(w: DVec3) -> DMat3 {
    DMat3::from_cols(w.cross(DVec3::X), w.cross(DVec3::Y), w.cross(DVec3::Z))
}

fn trace(m: DMat3) -> f64 {
    m.x_axis.x + m.y_axis.y + m.z_axis.z
}

/// Eight partial sums of a [`StiffnessSum`].
#[derive(Clone, Copy)]
pub(super) struct StiffnessLanes<S: Simd> {
    nn: Symmetric<S>,
    nm: [Lanes3<S>; 3],
    mm: Symmetric<S>,
    transverse: f32x8<S>,
    transverse_r: Lanes3<S>,
    transverse_rr: Symmetric<S>,
    first: [Lanes3<S>; 3],
}

/// Diagonal, and the entries yz, zx and xy.
#[derive(Clone, Copy)]
struct Symmetric<S: Simd>(Lanes3<S>, Lanes3<S>);

impl<S: Simd> StiffnessLanes<S> {
    #[inline(always)]
    pub(super) fn zero(simd: S) -> Self {
        let zero = Lanes3::zero(simd);
        let symmetric = Symmetric(zero, zero);
        Self {
            nn: symmetric,
            nm: [zero; 3],
            mm: symmetric,
            transverse: zero.x,
            transverse_r: zero,
            transverse_rr: symmetric,
            first: [zero; 3],
        }
    }

    /// Adds the pairs of `lens` with B's centres at `r` from [`origin`].
    #[inline(always)]
    pub(super) fn add(&mut self, lens: &LensLanes<S>, r: Lanes3<S>) {
        let n = lens.axis;
        let m = r.cross(n);
        let (pn, pm) = (n.scale(lens.longitudinal), m.scale(lens.longitudinal));
        let (qr, an) = (r.scale(lens.transverse), n.scale(lens.area));
        self.nn.add(pn, n);
        self.mm.add(pm, m);
        self.transverse_rr.add(qr, r);
        self.transverse += lens.transverse;
        self.transverse_r = self.transverse_r.plus(qr);
        for (columns, (left, right)) in [(&mut self.nm, (pn, m)), (&mut self.first, (an, r))] {
            columns[0] = columns[0].add_scaled(right.x, left);
            columns[1] = columns[1].add_scaled(right.y, left);
            columns[2] = columns[2].add_scaled(right.z, left);
        }
    }

    #[inline(always)]
    pub(super) fn add_to(self, total: &mut StiffnessSum) {
        total.nn += self.nn.sum();
        total.nm += matrix(&self.nm);
        total.mm += self.mm.sum();
        total.transverse += sum(self.transverse);
        total.transverse_r += self.transverse_r.sum();
        total.transverse_rr += self.transverse_rr.sum();
        // V' is minus the area.
        total.first -= matrix(&self.first);
    }
}

#[inline(always)]
fn matrix<S: Simd>([x, y, z]: &[Lanes3<S>; 3]) -> DMat3 {
    DMat3::from_cols(x.sum(), y.sum(), z.sum())
}

impl<S: Simd> Symmetric<S> {
    /// Adds `a` `b`ᵀ, which must be symmetric.
    #[inline(always)]
    fn add(&mut self, a: Lanes3<S>, b: Lanes3<S>) {
        let diagonal = Lanes3 { x: a.x * b.x, y: a.y * b.y, z: a.z * b.z };
        let rest = Lanes3 { x: a.y * b.z, y: a.z * b.x, z: a.x * b.y };
        self.0 = self.0.plus(diagonal);
        self.1 = self.1.plus(rest);
    }

    #[inline(always)]
    fn sum(self) -> DMat3 {
        let (d, o) = (self.0.sum(), self.1.sum());
        DMat3::from_cols(DVec3::new(d.x, o.z, o.y), DVec3::new(o.z, d.y, o.x), DVec3::new(o.y, o.x, d.z))
    }
}
