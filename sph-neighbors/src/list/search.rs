//! The search: all sources within reach of a group of targets that are close together.

use super::compress::{LANES, compress, less};
use super::query::Group;
use crate::CellList;
use std::array::from_fn;
use std::ops::Range;
use wide::{f32x8, i32x8};

/// Blocks of candidates that are tested before their hits are read: their numbers fit 16 bits.
const WINDOW: usize = 4096;

/// The candidates of a group of targets, and room for the hits of one.
#[derive(Debug, Clone, Default)]
pub struct Search {
    /// Number of candidates.
    length: usize,
    /// Coordinates relative to the base of the group, in units of the test, by axis; longer than
    /// needed, like the next two.
    coordinates: Vec<Vec<f32>>,
    /// Radius of each candidate, if the test needs it.
    radii: Vec<f32>,
    /// Index of each candidate in the input of the cell list.
    index: Vec<u32>,
    /// Hits as numbers of candidates of a window.
    hits: Vec<u16>,
}

impl Search {
    /// Number of candidates of the group.
    pub fn candidates(&self) -> usize {
        self.length
    }

    /// Forgets all candidates.
    pub fn clear<const D: usize>(&mut self) {
        self.coordinates.resize_with(D, Vec::new);
        self.length = 0;
        self.make_room(0);
    }

    /// Adds the sources that may be within reach of a group, in canonical order.
    ///
    /// * `drop`: bits of the coordinates that the test does without.
    /// * `radii`: those of the sources in canonical order, and a margin; none if the test needs none.
    /// * `closer`: may shorten the reach for a part of a row, given the numbers of its cells.
    pub fn collect<const D: usize>(
        &mut self,
        cells: &CellList<D>,
        group: &Group<D>,
        reach: f64,
        drop: u32,
        radii: Option<&[f32]>,
        closer: impl Fn(Range<usize>) -> Option<f64>,
    ) {
        group.for_each_image(cells, reach, |image| {
            image.for_each_row(cells, reach, &closer, |range| {
                let (old, new) = (self.length, range.len());
                self.make_room(old + new);
                for (axis, column) in self.coordinates.iter_mut().enumerate() {
                    let base = i32x8::splat(image.base[axis] as i32);
                    let relative = |c: [i32; LANES]| {
                        f32x8::from_i32x8((i32x8::from(c) - base) >> drop).to_array()
                    };
                    let source = &cells.coordinates(axis)[range.start..];
                    copy_lanes(source, &mut column[old..], new, relative);
                }
                if let Some(radii) = radii {
                    copy_lanes(&radii[range.start..], &mut self.radii[old..], new, |r| r);
                }
                let order = &cells.order_and_margin()[range.start..];
                copy_lanes(order, &mut self.index[old..], new, |i| i);
                self.length += new;
            });
        });
        self.close();
    }

    /// Drops the candidates that are not within reach of the box of a group, given the threshold of
    /// the target with the largest reach, as for [`test`](Self::test).
    ///
    /// A candidate is as near to the box as to any target in it, also after rounding.
    pub fn cull<const D: usize>(
        &mut self,
        group: &Group<D>,
        drop: u32,
        threshold: impl Fn(&[[f32; LANES]], usize) -> f32x8,
    ) {
        let edge = |q: &[i64; D]| -> [f32x8; D] {
            from_fn(|axis| f32x8::splat(((q[axis] - group.base[axis]) >> drop) as f32))
        };
        let (low, high) = (edge(&group.low), edge(&group.high));
        let blocks = self.length.div_ceil(LANES);
        let mut kept = 0;
        for first in (0..blocks).step_by(WINDOW) {
            let last = blocks.min(first + WINDOW);
            let mut n = 0;
            for block in first..last {
                let mut distance2 = f32x8::ZERO;
                for (axis, column) in self.coordinates.iter().enumerate() {
                    let x = f32x8::from(column.as_chunks().0[block]);
                    let d = (low[axis] - x).fast_max(x - high[axis]).fast_max(f32x8::ZERO);
                    distance2 += d * d;
                }
                let Some(room) = self.hits[n..].first_chunk_mut() else {
                    break;
                };
                let pattern = less(distance2, threshold(self.radii.as_chunks().0, block));
                n += compress(pattern, ((block - first) * LANES) as u16, room);
            }
            let (from, hits) = (first * LANES, &self.hits[..n]);
            for column in &mut self.coordinates {
                keep(column, from, hits, kept);
            }
            keep(&mut self.radii, from, hits, kept);
            keep(&mut self.index, from, hits, kept);
            kept += n;
        }
        self.length = kept;
        self.close();
    }

    /// Makes sure that nobody hits the candidates that fill up the last block.
    fn close(&mut self) {
        for column in &mut self.coordinates {
            column[self.length..][..LANES].fill(f32::INFINITY);
        }
    }

    /// Makes room for candidates and a block more.
    fn make_room(&mut self, candidates: usize) {
        let room = candidates + LANES;
        if self.index.len() < room || self.coordinates.iter().any(|c| c.len() < room) {
            let room = room.next_power_of_two();
            self.index.resize(room, 0);
            self.radii.resize(room, 0.0);
            self.coordinates.iter_mut().for_each(|column| column.resize(room, f32::INFINITY));
            self.hits.resize((WINDOW + 1) * LANES, 0);
        }
    }

    /// Appends the indices of the candidates within reach of the target to `found`, but for `own`.
    ///
    /// `threshold` gives the squares of the reach for a block of candidates, in units of the test,
    /// from the radii of all blocks and the number of the block.
    #[inline]
    pub fn test<const D: usize>(
        &mut self,
        group: &Group<D>,
        target: &[i64; D],
        drop: u32,
        threshold: impl Fn(&[[f32; LANES]], usize) -> f32x8,
        own: u32,
        found: &mut Vec<u32>,
    ) {
        let me: [f32x8; D] =
            from_fn(|axis| f32x8::splat(((target[axis] - group.base[axis]) >> drop) as f32));
        let blocks = self.length.div_ceil(LANES);
        let columns: [&[[f32; LANES]]; D] =
            from_fn(|axis| &self.coordinates[axis].as_chunks().0[..blocks]);
        let radii = &self.radii.as_chunks().0[..blocks];
        for first in (0..blocks).step_by(WINDOW) {
            let last = blocks.min(first + WINDOW);
            let mut n = 0;
            for block in first..last {
                let mut distance2 = f32x8::ZERO;
                for (column, me) in columns.iter().zip(&me) {
                    let d = f32x8::from(column[block]) - *me;
                    distance2 += d * d;
                }
                let Some(room) = self.hits[n..].first_chunk_mut() else {
                    break;
                };
                let pattern = less(distance2, threshold(radii, block));
                n += compress(pattern, ((block - first) * LANES) as u16, room);
            }
            let index = &self.index[first * LANES..];
            let start = found.len();
            found.resize(start + n, 0);
            let room = &mut found[start..];
            let mut kept = 0;
            for &hit in &self.hits[..n] {
                let j = index[usize::from(hit)];
                room[kept] = j;
                kept += usize::from(j != own);
            }
            found.truncate(start + kept);
        }
    }
}

/// Maps `length` elements from the start of `source` to the start of `room`, and up to a block more
/// in both: whole blocks take no remainder loop, and rows are short.
#[inline(always)]
fn copy_lanes<S: Copy, T>(
    source: &[S],
    room: &mut [T],
    length: usize,
    map: impl Fn([S; LANES]) -> [T; LANES],
) {
    let blocks = length.div_ceil(LANES);
    let source = &source.as_chunks::<LANES>().0[..blocks];
    let room = &mut room.as_chunks_mut::<LANES>().0[..blocks];
    for (source, room) in source.iter().zip(room) {
        *room = map(*source);
    }
}

/// Moves the elements `from + hit` of each hit to `to` and on; they come from the same place or
/// further on.
#[inline]
fn keep<T: Copy>(column: &mut [T], from: usize, hits: &[u16], to: usize) {
    for (to, &hit) in (to..).zip(hits) {
        column[to] = column[from + usize::from(hit)];
    }
}
