//! The loops of [`near`](super::near) in AVX2 registers: the same operations in the same order, so
//! they find the same. No multiplication and addition are fused.

#![allow(unsafe_code)] // Loads and stores whose bounds are checked once a call.

use super::CLUSTER;
use super::near::{Around, Near};
use crate::list::{LANES, LANES_OF};
use core::arch::x86_64::*;

/// Keeps the sources of the rows within reach of the box.
///
/// # Panics
///
/// When a row, and a block behind it, exceeds the columns, or `near` has no room for
/// all sources of the rows and a block.
// No closures here nor below: `map` and `from_fn` are compiled without AVX2 and would call them.
#[target_feature(enable = "avx2,popcnt")]
pub fn cull<const D: usize>(columns: &[&[i32]; D], around: &Around<D>, near: &mut Near) {
    let zero = _mm256_setzero_ps();
    let (mut base, mut low, mut high) = ([_mm256_setzero_si256(); D], [zero; D], [zero; D]);
    let mut from = [std::ptr::null(); D];
    let mut to = [std::ptr::null_mut(); D];
    let (mut sources, mut end) = (0, 0);
    for row in &near.rows {
        sources += row.len();
        end = end.max(row.end as usize);
    }
    assert!(near.places.len() >= sources + LANES);
    for axis in 0..D {
        base[axis] = _mm256_set1_epi32(around.base[axis]);
        low[axis] = _mm256_set1_ps(around.low[axis]);
        high[axis] = _mm256_set1_ps(around.high[axis]);
        let (column, room) = (columns[axis], &mut near.coordinates[axis]);
        assert!(column.len() >= end + LANES && room.len() >= sources + LANES);
        from[axis] = column.as_ptr();
        to[axis] = room.as_mut_ptr();
    }
    let places = near.places.as_mut_ptr();
    let drop = _mm_cvtsi32_si128(around.drop as i32);
    let threshold = _mm256_set1_ps(around.threshold);
    let mut length = 0;
    for row in &near.rows {
        let (mut first, end) = (row.start as usize, row.end as usize);
        while first < end {
            let mut x = [zero; D];
            let mut distance2 = zero;
            for axis in 0..D {
                // SAFETY: `first` is below the end of a row, so a block from there on is in the
                // column, as asserted above.
                let block = unsafe { _mm256_loadu_si256(from[axis].add(first).cast()) };
                let relative = _mm256_sub_epi32(block, base[axis]);
                x[axis] = _mm256_cvtepi32_ps(_mm256_sra_epi32(relative, drop));
                let below = _mm256_sub_ps(low[axis], x[axis]);
                let above = _mm256_sub_ps(x[axis], high[axis]);
                let d = _mm256_max_ps(_mm256_max_ps(below, above), zero);
                distance2 = _mm256_add_ps(distance2, _mm256_mul_ps(d, d));
            }
            let hits = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(distance2, threshold));
            // Without those behind the end of the row.
            let here = (end - first).min(LANES);
            let pattern = hits as usize & (0xff >> (LANES - here));
            let lanes = _mm256_cvtepu16_epi32(bytemuck::cast(LANES_OF[pattern & 0xff]));
            for axis in 0..D {
                let kept = _mm256_permutevar8x32_ps(x[axis], lanes);
                // SAFETY: no more sources were kept than were in the rows so far, so a block fits,
                // as asserted above.
                unsafe { _mm256_storeu_ps(to[axis].add(length), kept) };
            }
            let kept = _mm256_add_epi32(lanes, _mm256_set1_epi32(first as i32));
            // SAFETY: as for the coordinates.
            unsafe { _mm256_storeu_si256(places.add(length).cast(), kept) };
            length += pattern.count_ones() as usize;
            first += LANES;
        }
    }
    near.length = length;
}

/// Tests the sources near the box against every target; writes those that are within reach of any
/// to the start of `room` and returns their number.
#[inline]
#[target_feature(enable = "avx2,popcnt")]
pub fn test<const D: usize>(
    around: &Around<D>,
    targets: &[[f32; CLUSTER]; D],
    near: &Near,
    counts: &mut [u32; CLUSTER],
    room: &mut [u32],
) -> usize {
    let n = near.length;
    let mut mine = [_mm256_setzero_ps(); D];
    for axis in 0..D {
        mine[axis] = bytemuck::cast(targets[axis]);
    }
    let [x, y, z] = &near.coordinates;
    let others = x[..n].iter().zip(&y[..n]).zip(&z[..n]).zip(&near.places[..n]);
    let threshold = _mm256_set1_ps(around.threshold);
    let mut hits_of: __m256i = bytemuck::cast(*counts);
    let mut kept = 0;
    for (((&x, &y), &z), &place) in others {
        let other = [x, y, z];
        let mut distance2 = _mm256_setzero_ps();
        for axis in 0..D {
            let d = _mm256_sub_ps(mine[axis], _mm256_set1_ps(other[axis]));
            distance2 = _mm256_add_ps(distance2, _mm256_mul_ps(d, d));
        }
        let hits = _mm256_cmp_ps::<_CMP_LT_OQ>(distance2, threshold);
        // A hit is −1 as an integer.
        hits_of = _mm256_sub_epi32(hits_of, _mm256_castps_si256(hits));
        room[kept] = place;
        kept += usize::from(_mm256_movemask_ps(hits) != 0);
    }
    *counts = bytemuck::cast(hits_of);
    kept
}
