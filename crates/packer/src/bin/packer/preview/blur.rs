//! Depth darkening: what lies behind its surroundings is darker.
//!
//! T. Luft, C. Colditz and O. Deussen, *Image enhancement by unsharp masking the depth buffer* (SIGGRAPH 2006). The
//! depth of a pixel is compared with the mean depth around it. Departures: places where nothing is seen do not count
//! in the mean, and two sizes of surroundings are used, one for the gaps between small balls and one for hollows.

use super::camera::{Camera, FACTOR};
use super::raster::{COLUMNS, Sample, Seen};
use super::{HEIGHT, WIDTH};
use rayon::prelude::*;

/// Half the sides of the surroundings (pixels), and how dark each makes what lies as deep as they are wide: choices.
const SURROUNDINGS: [(usize, f32); 2] = [(7, 0.9), (32, 0.8)];

/// Share of the light that reaches each pixel, 0 to 1.
pub(super) fn openness(samples: &[Sample], camera: &Camera) -> Vec<f32> {
    let middle = |pixel: usize| {
        let (row, column) = (pixel / WIDTH * FACTOR + FACTOR / 2, pixel % WIDTH * FACTOR + FACTOR / 2);
        let sample = samples[row * COLUMNS + column];
        if sample.seen == Seen::Nothing { [0.0, 0.0] } else { [sample.depth, 1.0] }
    };
    let depths: Vec<[f32; 2]> = (0..WIDTH * HEIGHT).map(middle).collect();
    let mut open = vec![1.0; depths.len()];
    for (reach, strength) in SURROUNDINGS {
        let around = mean_around(&depths, reach);
        let size = (reach * FACTOR) as f32 / camera.scale;
        open.par_iter_mut().zip(&depths).zip(&around).for_each(|((open, depth), around)| {
            if depth[1] > 0.0 && around[1] > 0.0 {
                let below = (around[0] / around[1] - depth[0]) / size;
                *open *= 1.0 - strength * below.clamp(0.0, 1.0) / (0.5 + below.clamp(0.0, 1.0));
            }
        });
    }
    open
}

/// The mean over the pixels around each one, weighted towards it: two passes of a square.
fn mean_around(field: &[[f32; 2]], reach: usize) -> Vec<[f32; 2]> {
    let once = |field: &[[f32; 2]]| {
        let rows = along_rows(field, WIDTH, reach);
        transposed(&along_rows(&transposed(&rows, WIDTH), HEIGHT, reach), HEIGHT)
    };
    once(&once(field))
}

fn along_rows(field: &[[f32; 2]], width: usize, reach: usize) -> Vec<[f32; 2]> {
    let mut out = vec![[0.0; 2]; field.len()];
    out.par_chunks_mut(width).zip(field.par_chunks(width)).for_each(|(out, row)| {
        // Running sums, in double precision so that nothing is left over at the far end.
        let mut sum = [0.0_f64; 2];
        let mut add = |at: usize, sign: f64| {
            sum[0] += sign * f64::from(row[at][0]);
            sum[1] += sign * f64::from(row[at][1]);
            sum
        };
        (0..reach.min(width)).for_each(|at| {
            add(at, 1.0);
        });
        for (at, out) in out.iter_mut().enumerate() {
            if at > reach {
                add(at - reach - 1, -1.0);
            }
            let sum = if at + reach < width { add(at + reach, 1.0) } else { add(at, 0.0) };
            let count = (2 * reach + 1) as f64;
            *out = [(sum[0] / count) as f32, (sum[1] / count) as f32];
        }
    });
    out
}

fn transposed(field: &[[f32; 2]], width: usize) -> Vec<[f32; 2]> {
    let height = field.len() / width;
    (0..field.len()).map(|at| field[at % height * width + at / height]).collect()
}
