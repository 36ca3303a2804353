//! Sorting particles by cell, then by id.

use super::TASK;
use super::table::{Table, number, volume};
use crate::Grid;
use rayon::prelude::*;

/// A dense table may have this many cells per particle.
const CELLS_PER_PARTICLE: usize = 2;
/// A dense table may always have this many cells.
const FREE_CELLS: usize = 4096;

/// Fills `order` and `table`.
///
/// A box that is not much larger than the number of particles is sorted by counting. A few particles
/// far away would make the box huge; then keys are compared instead.
pub fn sort<const D: usize>(keys: &[u64], ids: &[u64], order: &mut Vec<u32>, table: &mut Table<D>) {
    let Some((low, high)) = bounds(keys) else {
        table.clear();
        order.clear();
        order.extend(0..keys.len() as u32);
        order.sort_unstable_by_key(|&i| (ids[i as usize], i));
        return;
    };
    let limit = FREE_CELLS.max(keys.len() * CELLS_PER_PARTICLE);
    if let Some(volume) = volume(&low, &high, limit) {
        count(keys, ids, order, table, (low, high, volume));
    } else {
        compare(keys, ids, order);
        let inside =
            order.iter().map(|&i| keys[i as usize]).take_while(|&k| k != Grid::<D>::OUTSIDE);
        table.sparse(low, high, inside);
    }
}

/// Lowest and highest occupied cell along each axis.
fn bounds<const D: usize>(keys: &[u64]) -> Option<([i64; D], [i64; D])> {
    let none = || ([i64::MAX; D], [i64::MIN; D]);
    let join = |(low, high): ([i64; D], [i64; D]), (l, h): ([i64; D], [i64; D])| {
        let low = std::array::from_fn(|axis| low[axis].min(l[axis]));
        (low, std::array::from_fn(|axis| high[axis].max(h[axis])))
    };
    let (low, high) = keys
        .par_iter()
        .with_min_len(TASK)
        .filter(|&&key| key != Grid::<D>::OUTSIDE)
        .map(|&key| (Grid::<D>::cell_of(key), Grid::<D>::cell_of(key)))
        .reduce(none, join);
    (low[0] <= high[0]).then_some((low, high))
}

fn count<const D: usize>(
    keys: &[u64],
    ids: &[u64],
    order: &mut Vec<u32>,
    table: &mut Table<D>,
    (low, high, volume): ([i64; D], [i64; D], usize),
) {
    let starts = table.dense(low, high, volume);
    // Particles outside use the spare element.
    let cell = |key: u64| {
        if key == Grid::<D>::OUTSIDE { volume } else { number(&Grid::cell_of(key), &low, &high) }
    };
    for &key in keys {
        starts[cell(key)] += 1;
    }
    let mut sum = 0;
    for start in starts.iter_mut() {
        sum += std::mem::replace(start, sum);
    }
    order.clear();
    order.resize(keys.len(), 0);
    for (i, &key) in keys.iter().enumerate() {
        let place = &mut starts[cell(key)];
        order[*place as usize] = i as u32;
        *place += 1;
    }
    // Every start has moved to the end of its cell, which is the start of the next.
    starts.copy_within(0..volume, 1);
    starts[0] = 0;
    let inside = starts[volume] as usize;
    let (inside, outside) = order.split_at_mut(inside);
    by_id(inside, 0, table.starts(), ids);
    outside.sort_unstable_by_key(|&i| (ids[i as usize], i));
}

/// Sorts each cell by id; `starts` are those of the cells in `order`, which begins at `offset`.
fn by_id(order: &mut [u32], offset: usize, starts: &[u32], ids: &[u64]) {
    if order.len() > TASK && starts.len() > 2 {
        let middle = starts.len() / 2;
        let split = starts[middle] as usize;
        let (left, right) = order.split_at_mut(split - offset);
        rayon::join(
            || by_id(left, offset, &starts[..=middle], ids),
            || by_id(right, split, &starts[middle..], ids),
        );
        return;
    }
    for ends in starts.windows(2) {
        let cell = &mut order[ends[0] as usize - offset..ends[1] as usize - offset];
        // The input of a rebuild is mostly in order.
        if !cell.is_sorted_by_key(|&i| ids[i as usize]) {
            cell.sort_unstable_by_key(|&i| (ids[i as usize], i));
        }
    }
}

fn compare(keys: &[u64], ids: &[u64], order: &mut Vec<u32>) {
    order.clear();
    order.extend(0..keys.len() as u32);
    let key = |&i: &u32| (keys[i as usize], ids[i as usize], i);
    if order.len() > TASK {
        order.par_sort_unstable_by_key(key);
    } else {
        order.sort_unstable_by_key(key);
    }
}
