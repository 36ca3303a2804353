//! The sources near a cluster: first those near the box of its targets, eight at a time, then each
//! of them against all targets at once.

#![allow(unsafe_code)] // Calls of functions that are compiled for the CPU at hand.

use super::CLUSTER;
#[cfg(target_arch = "x86_64")]
use super::avx2;
use crate::CellList;
use crate::list::{Group, LANES, Query};
use std::array::from_fn;
use std::ops::Range;

/// Sources near the box of a cluster, in canonical order; all columns are longer than needed.
#[derive(Debug, Default)]
pub struct Near {
    /// Coordinates relative to the base of the group, in units of the test, by axis.
    pub coordinates: [Vec<f32>; 3],
    /// Places in canonical order.
    pub places: Vec<u32>,
    pub length: usize,
    /// Places in canonical order that are to be tested against the box.
    pub rows: Vec<Range<u32>>,
}

impl Near {
    /// Makes room for all sources of the rows and a block.
    #[inline(always)]
    fn make_room(&mut self, sources: usize) {
        let room = sources + LANES;
        if self.places.len() < room {
            let room = room.next_power_of_two();
            self.places.resize(room, 0);
            self.coordinates.iter_mut().for_each(|column| column.resize(room, 0.0));
        }
    }
}

/// The box of some targets, and where coordinates are relative to.
#[derive(Debug, Clone, Copy)]
pub struct Around<const D: usize> {
    /// Low 32 bits: whoever is tested is near.
    pub base: [i32; D],
    /// Bits of the coordinates that the test does without.
    pub drop: u32,
    /// Corners relative to the base, in units of the test.
    pub low: [f32; D],
    pub high: [f32; D],
    /// Square of the reach in these units.
    pub threshold: f32,
}

impl<const D: usize> Around<D> {
    #[inline(always)]
    fn new(image: &Group<D>, query: &Query) -> Self {
        let corner = |q: &[i64; D]| from_fn(|a| ((q[a] - image.base[a]) >> query.drop) as f32);
        Self {
            base: image.base.map(|q| q as i32),
            drop: query.drop,
            low: corner(&image.low),
            high: corner(&image.high),
            threshold: query.threshold,
        }
    }
}

/// What is searched, for what.
#[derive(Debug)]
pub struct Search<'a, const D: usize> {
    cells: &'a CellList<D>,
    query: &'a Query,
    columns: [&'a [i32]; D],
}

impl<'a, const D: usize> Search<'a, D> {
    pub fn new(cells: &'a CellList<D>, query: &'a Query) -> Self {
        const { assert!(D <= 3, "there is room for three coordinates") };
        let columns = from_fn(|axis| cells.coordinates(axis));
        Self { cells, query, columns }
    }

    /// Appends the places of the sources within reach of any of the targets of a group to `found`,
    /// ascending for each image of the group. Adds to `counts` how many each target reaches. Returns
    /// how many sources were tested and how many images of the group had any.
    ///
    /// `targets`: coordinates relative to the base of the group, in units of the test, by axis.
    ///
    /// # Safety
    ///
    /// With `AVX2`, the CPU has AVX2 and POPCNT.
    #[inline(always)]
    pub unsafe fn find<const AVX2: bool>(
        &self,
        group: &Group<D>,
        targets: &[[f32; CLUSTER]; D],
        near: &mut Near,
        counts: &mut [u32; CLUSTER],
        found: &mut Vec<u32>,
    ) -> (u64, usize) {
        let (mut tests, mut images) = (0, 0);
        group.for_each_image(
            self.cells,
            self.query.reach,
            #[inline(always)]
            |image| {
                let around = Around::new(image, self.query);
                let sources = self.rows(image, near);
                near.length = 0;
                if sources == 0 {
                    return;
                }
                images += 1;
                near.make_room(sources);
                #[cfg(target_arch = "x86_64")]
                if AVX2 {
                    // SAFETY: the caller vouches for the features of the callee.
                    unsafe { avx2::cull(&self.columns, &around, near) };
                } else {
                    cull(&self.columns, &around, near);
                }
                #[cfg(not(target_arch = "x86_64"))]
                cull(&self.columns, &around, near);
                tests += near.length as u64;
                let start = found.len();
                found.resize(start + near.length, 0);
                let room = &mut found[start..];
                #[cfg(target_arch = "x86_64")]
                let kept = if AVX2 {
                    // SAFETY: the caller vouches for the features of the callee.
                    unsafe { avx2::test(&around, targets, near, counts, room) }
                } else {
                    test(&around, targets, near, counts, room)
                };
                #[cfg(not(target_arch = "x86_64"))]
                let kept = test(&around, targets, near, counts, room);
                found.truncate(start + kept);
            },
        );
        (tests, images)
    }
}

impl<const D: usize> Search<'_, D> {
    /// Notes the rows of cells that may hold sources within reach of a group, in canonical order;
    /// returns how many sources they hold.
    #[inline(always)]
    fn rows(&self, image: &Group<D>, near: &mut Near) -> usize {
        near.rows.clear();
        let reach2 = self.query.reach * self.query.reach;
        let mut sources = 0;
        image.for_each_row_across(
            self.cells,
            self.query.reach,
            #[inline(always)]
            |row, across| {
                let part = image.part_of_row(self.cells, row, reach2 - across);
                let places = self.cells.places(part);
                if !places.is_empty() {
                    sources += places.len();
                    near.rows.push(places.start as u32..places.end as u32);
                }
            },
        );
        sources
    }
}

/// Keeps the sources of the rows within reach of the box. A source is as near to the box as to any
/// target in it, also after rounding.
fn cull<const D: usize>(columns: &[&[i32]; D], around: &Around<D>, near: &mut Near) {
    let Near { coordinates, places, length, rows } = near;
    for place in rows.iter().cloned().flatten() {
        let place = place as usize;
        let x: [f32; D] =
            from_fn(|a| (columns[a][place].wrapping_sub(around.base[a]) >> around.drop) as f32);
        let mut distance2 = 0.0;
        for axis in 0..D {
            let d = (around.low[axis] - x[axis]).max(x[axis] - around.high[axis]).max(0.0);
            distance2 += d * d;
            coordinates[axis][*length] = x[axis];
        }
        places[*length] = place as u32;
        *length += usize::from(distance2 < around.threshold);
    }
}

/// Tests the sources near the box against every target; writes those that are within reach of any
/// to the start of `room` and returns their number.
fn test<const D: usize>(
    around: &Around<D>,
    targets: &[[f32; CLUSTER]; D],
    near: &Near,
    counts: &mut [u32; CLUSTER],
    room: &mut [u32],
) -> usize {
    let mut kept = 0;
    for (k, &place) in near.places[..near.length].iter().enumerate() {
        let mut distance2 = [0.0_f32; CLUSTER];
        for (targets, column) in targets.iter().zip(&near.coordinates) {
            for (distance2, target) in distance2.iter_mut().zip(targets) {
                let d = target - column[k];
                *distance2 += d * d;
            }
        }
        let mut any = false;
        for lane in 0..CLUSTER {
            let hit = distance2[lane] < around.threshold;
            counts[lane] += u32::from(hit);
            any |= hit;
        }
        room[kept] = place;
        kept += usize::from(any);
    }
    kept
}
