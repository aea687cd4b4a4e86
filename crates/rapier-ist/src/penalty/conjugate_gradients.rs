//! Preconditioned conjugate gradients on block matrices: Y. Saad, *Iterative Methods for Sparse Linear Systems* (2003),
//! section 9.2.

use super::block_matrix::BlockMatrix;

/// Most iterations; a matrix of n bodies needs no more than 6 n in exact arithmetic.
const MAX_ITERATIONS: usize = 400;

/// Improves the solution `x` of `matrix · x = rhs` until `is_done` says so of the residual and of `x`, and returns whether it
/// did.
pub(crate) fn conjugate_gradients(
    matrix: &BlockMatrix,
    rhs: &[[f64; 6]],
    x: &mut [[f64; 6]],
    is_done: impl Fn(&[[f64; 6]], &[[f64; 6]]) -> bool,
) -> bool {
    let mut image = vec![[0.0; 6]; rhs.len()];
    matrix.times(x, &mut image);
    let mut residual = rhs.to_vec();
    add_scaled(&mut residual, &image, -1.0);
    let mut z = image.clone();
    let (mut direction, mut rz) = (Vec::new(), 0.0);
    for iteration in 0..MAX_ITERATIONS {
        if is_done(&residual, x) {
            return true;
        }
        matrix.precondition(&residual, &mut z);
        let next = dot(&residual, &z);
        if iteration == 0 {
            direction = z.clone();
        } else {
            let turn = next / rz;
            for (d, z) in direction.iter_mut().zip(&z) {
                *d = std::array::from_fn(|k| z[k] + d[k] * turn);
            }
        }
        rz = next;
        matrix.times(&direction, &mut image);
        let curvature = dot(&direction, &image);
        if !(curvature > 0.0 && curvature.is_finite()) {
            break;
        }
        let step = rz / curvature;
        add_scaled(x, &direction, step);
        add_scaled(&mut residual, &image, -step);
    }
    is_done(&residual, x)
}

fn add_scaled(sum: &mut [[f64; 6]], v: &[[f64; 6]], factor: f64) {
    for (sum, v) in sum.iter_mut().zip(v) {
        for (sum, v) in sum.iter_mut().zip(v) {
            *sum += v * factor;
        }
    }
}

/// The scalar product, summed in six lanes: one sum would wait for each addition.
pub(crate) fn dot(a: &[[f64; 6]], b: &[[f64; 6]]) -> f64 {
    let mut lanes = [0.0; 6];
    for (a, b) in a.iter().zip(b) {
        for (lane, (a, b)) in lanes.iter_mut().zip(a.iter().zip(b)) {
            *lane += a * b;
        }
    }
    lanes.iter().sum()
}
