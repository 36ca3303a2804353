//! The search: sources within reach of any target of a cluster.

#![allow(unsafe_code)] // Calls of functions that are compiled for the CPU at hand.

use super::near::{Near, Search};
use super::{CHUNK, CLUSTER, Clusters};
use crate::CellList;
use crate::list::{Group, Query};
use std::array::from_fn;
use std::ops::Range;

/// Lists of up to [`CHUNK`] clusters.
#[derive(Debug, Clone, Default)]
pub struct Chunk {
    entries: Vec<u32>,
    /// First entry of each list, and the end.
    pub(super) starts: Vec<u32>,
    pub(super) first_target: usize,
    /// Sources within reach of each target.
    pub(super) counts: Vec<u32>,
    pub pairs: u64,
    pub tests: u64,
}

/// Working memory of a task.
#[derive(Debug, Default)]
pub struct Scratch {
    near: Near,
    pub(super) entries: Vec<u32>,
}

impl Chunk {
    /// Makes the lists of these targets empty.
    pub(super) fn begin(&mut self, first_target: usize) {
        (self.first_target, self.pairs, self.tests) = (first_target, 0, 0);
        self.starts.clear();
        self.counts.clear();
    }

    /// Notes how many sources the targets of a cluster reach, of which they may be one themselves.
    pub(super) fn count_targets(&mut self, counts: &[u32], own: bool) {
        for count in counts {
            let count = count.saturating_sub(u32::from(own));
            self.pairs += u64::from(count);
            self.counts.push(count);
        }
    }

    /// Takes over the entries of all lists.
    pub(super) fn end(&mut self, entries: &[u32]) {
        self.starts.push(entries.len() as u32);
        self.entries.clear();
        if self.entries.capacity() < entries.len() {
            // A little more, so that a later build with a few more neighbours fits.
            self.entries.reserve_exact(entries.len() + entries.len() / 32);
        }
        self.entries.extend_from_slice(entries);
    }

    /// Clusters of these targets from the list of each target; that of a cluster of several is empty.
    pub fn of_lists(clusters: impl Iterator<Item = Range<usize>>, lists: &[Vec<u32>]) -> Self {
        let mut chunk = Self { starts: vec![0], ..Self::default() };
        for (number, targets) in clusters.enumerate() {
            if number == 0 {
                chunk.first_target = targets.start;
            }
            for target in targets {
                let list = &lists[target];
                let others = list.iter().filter(|s| **s as usize != target).count();
                chunk.entries.extend_from_slice(list);
                chunk.counts.push(others as u32);
                chunk.pairs += others as u64;
            }
            chunk.starts.push(chunk.entries.len() as u32);
        }
        chunk
    }

    #[inline]
    pub fn sources(&self, cluster: usize) -> &[u32] {
        &self.entries[self.starts[cluster] as usize..self.starts[cluster + 1] as usize]
    }

    #[inline]
    pub fn count(&self, target: usize) -> usize {
        self.counts[target - self.first_target] as usize
    }

    pub fn counts(&self) -> impl Iterator<Item = usize> {
        self.counts.iter().map(|&count| count as usize)
    }

    pub fn entries(&self) -> usize {
        self.entries.len()
    }

    pub fn bytes(&self) -> usize {
        size_of::<Self>()
            + (self.entries.capacity() + self.starts.capacity() + self.counts.capacity()) * 4
    }
}

/// Sorts the entries from `start` on and drops those that are there twice.
pub(super) fn sort_and_dedup(entries: &mut Vec<u32>, start: usize) {
    entries[start..].sort_unstable();
    let mut kept = start;
    for k in start..entries.len() {
        if kept == start || entries[kept - 1] != entries[k] {
            entries[kept] = entries[k];
            kept += 1;
        }
    }
    entries.truncate(kept);
}

/// Finds the sources of the clusters `some`, with the widest vectors of this CPU.
#[expect(clippy::too_many_arguments, reason = "an entry point between two modules")]
pub fn fill<const D: usize>(
    chunk: &mut Chunk,
    scratch: &mut Scratch,
    query: &Query,
    cells: &CellList<D>,
    clusters: &Clusters,
    some: Range<usize>,
    targets: &[[f64; D]],
    own: bool,
) {
    let task = Task { query, cells, clusters, targets, own };
    #[cfg(target_arch = "x86_64")]
    if std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("popcnt") {
        // SAFETY: the CPU has just been found to have the features of the callee.
        unsafe { fill_avx2(&task, chunk, scratch, some) };
        return;
    }
    // SAFETY: without AVX2 nothing is asked of the CPU.
    unsafe { task.fill::<false>(chunk, scratch, some) };
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,popcnt")]
fn fill_avx2<const D: usize>(
    task: &Task<'_, D>,
    chunk: &mut Chunk,
    scratch: &mut Scratch,
    some: Range<usize>,
) {
    // SAFETY: this function is called where the CPU has these features.
    unsafe { task.fill::<true>(chunk, scratch, some) };
}

struct Task<'a, const D: usize> {
    query: &'a Query,
    cells: &'a CellList<D>,
    clusters: &'a Clusters,
    targets: &'a [[f64; D]],
    own: bool,
}

impl<const D: usize> Task<'_, D> {
    /// # Safety
    ///
    /// With `AVX2`, the CPU has AVX2 and POPCNT.
    #[inline(always)]
    unsafe fn fill<const AVX2: bool>(
        &self,
        chunk: &mut Chunk,
        scratch: &mut Scratch,
        some: Range<usize>,
    ) {
        debug_assert!(some.len() <= CHUNK);
        let Scratch { near, entries } = scratch;
        let search = Search::new(self.cells, self.query);
        let first_target = self.clusters.targets_of(some.start).start;
        chunk.begin(first_target);
        entries.clear();
        for cluster in some {
            chunk.starts.push(entries.len() as u32);
            let targets = &self.targets[self.clusters.targets_of(cluster)];
            let mut counts = [0; CLUSTER];
            let start = entries.len();
            let mut passes = 0;
            let mut next = 0;
            while next < targets.len() {
                let first = next;
                let Some(group) = self.group(targets, &mut next) else { continue };
                let places = self.places(&group, &targets[..next], first);
                // SAFETY: the caller vouches for the features of the CPU.
                let (tests, images) =
                    unsafe { search.find::<AVX2>(&group, &places, near, &mut counts, entries) };
                chunk.tests += tests;
                passes += images;
            }
            if passes > 1 {
                // Found from several sides, each in order.
                sort_and_dedup(entries, start);
            }
            let order = self.cells.order();
            entries[start..].iter_mut().for_each(|place| *place = order[*place as usize]);
            chunk.count_targets(&counts[..targets.len()], self.own);
        }
        chunk.end(entries);
    }

    /// The group of the targets from `next` on that are close together, and moves on behind them;
    /// none for a target that the grid cannot place. Mostly, these are all targets of a cluster.
    #[inline(always)]
    fn group(&self, targets: &[[f64; D]], next: &mut usize) -> Option<Group<D>> {
        let grid = self.cells.grid();
        let mut low = grid.place(&targets[*next]);
        *next += 1;
        let mut high = low;
        if let (Some(low), Some(high)) = (&mut low, &mut high) {
            // A longer box has many sources near it that no target can reach.
            let longest = self.query.reach as i64;
            for x in &targets[*next..] {
                let Some(fixed) = grid.place(x) else { break };
                let (l, h): ([i64; D], [i64; D]) =
                    (from_fn(|a| low[a].min(fixed[a])), from_fn(|a| high[a].max(fixed[a])));
                if (0..D).any(|a| h[a] - l[a] > longest) {
                    break;
                }
                (*low, *high) = (l, h);
                *next += 1;
            }
        }
        let (low, high) = (low?, high?);
        Some(Group { low, high, base: low.map(|q| q >> self.query.drop << self.query.drop) })
    }

    /// Coordinates of the targets from `first` on in the units of the test; far away for the other
    /// lanes.
    #[inline(always)]
    fn places(&self, group: &Group<D>, targets: &[[f64; D]], first: usize) -> [[f32; CLUSTER]; D] {
        let mut places = [[f32::INFINITY; CLUSTER]; D];
        for (lane, target) in targets.iter().enumerate().skip(first) {
            let fixed = self.cells.grid().fixed(target);
            for axis in 0..D {
                places[axis][lane] = ((fixed[axis] - group.base[axis]) >> self.query.drop) as f32;
            }
        }
        places
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;
    use crate::Grid;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn avx2_finds_the_same(
            positions in prop::collection::vec(prop::array::uniform3(0.0..5.0_f64), 1..200),
            reach in 0.1..2.0,
            cell in 0.3..2.0,
        ) {
            if !std::is_x86_feature_detected!("avx2") {
                return Ok(());
            }
            let grid = Grid::new([-1.0; 3], reach * cell).unwrap();
            let ids: Vec<u64> = (0..positions.len() as u64).collect();
            let cells = CellList::build(&grid, &positions, &ids);
            let query = Query::new(&grid, reach);
            let clusters = Clusters::new(positions.len(), &[]);
            let (cells, query, clusters, targets) = (&cells, &query, &clusters, &positions[..]);
            let task = Task { query, cells, clusters, targets, own: true };
            let some = 0..clusters.len().min(CHUNK);
            let (mut plain, mut fast) = (Chunk::default(), Chunk::default());
            // SAFETY: without AVX2 nothing is asked of the CPU.
            unsafe { task.fill::<false>(&mut plain, &mut Scratch::default(), some.clone()) };
            // SAFETY: the CPU has AVX2, and with it POPCNT.
            unsafe { fill_avx2(&task, &mut fast, &mut Scratch::default(), some) };
            prop_assert_eq!(&plain.entries, &fast.entries);
            prop_assert_eq!(&plain.starts, &fast.starts);
            prop_assert_eq!(&plain.counts, &fast.counts);
        }
    }
}
