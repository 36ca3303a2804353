//! Neighbour lists.

mod compress;
mod pool;
mod search;

use crate::{CellList, Grid};
use pool::Pool;
use rayon::prelude::*;
use search::{Group, Query, Search};
use std::array::from_fn;
use std::mem::take;

/// Targets per chunk: a chunk is searched by one task and has memory of its own.
const CHUNK: usize = 256;

/// For each target, the sources within reach, in canonical order.
///
/// Entries are indices into the arrays that the [`CellList`] was built from. Each list is padded to
/// a multiple of `pad` with the *filler* of its target. Choose as filler the index of the target in
/// the source arrays: then the target is not its own neighbour, and kernels that read whole lanes see
/// pairs at distance zero. For targets that are not sources, choose an index that no source has, such
/// as that of an extra record that contributes nothing.
///
/// ```
/// use sph_neighbors::{CellList, Grid, NeighborList};
///
/// let positions = [[0.1, 0.2], [0.9, 0.2], [0.3, 0.2]];
/// let grid = Grid::new([0.0, 0.0], 0.5)?;
/// let cells = CellList::build(&grid, &positions, &[10, 11, 12]);
/// let list = NeighborList::build(&cells, &positions, |t| t as u32, 0.5, 4);
/// assert_eq!(list.of(0), [2, 0, 0, 0]); // one neighbour and three fillers
/// assert_eq!(list.count(0), 1);
/// assert_eq!(list.pairs(), 2);
/// # Ok::<(), sph_neighbors::GridError>(())
/// ```
#[derive(Debug, Clone)]
pub struct NeighborList {
    chunks: Vec<Chunk>,
    targets: usize,
    sources: u32,
    pad: usize,
    pool: Pool<Scratch>,
}

impl Default for NeighborList {
    /// Lists of no targets.
    fn default() -> Self {
        Self { chunks: Vec::new(), targets: 0, sources: 0, pad: 1, pool: Pool::default() }
    }
}

/// Lists of up to [`CHUNK`] targets.
#[derive(Debug, Clone, Default)]
struct Chunk {
    entries: Vec<u32>,
    /// First entry and true length of each list.
    spans: Vec<(u32, u32)>,
    pairs: u64,
    tests: u64,
    largest_filler: u32,
}

impl NeighborList {
    /// Finds the sources of `cells` within `reach` of each target.
    ///
    /// * `targets`: fastest when targets close in space are close in the slice.
    /// * `filler`: given the number of a target, the index that pads its list and never occurs as a
    ///   neighbour in it.
    /// * `reach`: every source nearer than this is in the list. Sources may be in it that are further
    ///   by up to a few times [`Grid::resolution`](crate::Grid::resolution) or 10⁻⁶ of the reach, but
    ///   then on every rank and for both particles of a pair.
    /// * `pad`: lists are padded to a multiple of this; 0 and 1 pad nothing.
    ///
    /// Targets that the grid cannot place have no neighbours.
    ///
    /// # Panics
    ///
    /// When `reach` is negative, not a number or larger than 256 cells.
    pub fn build<const D: usize>(
        cells: &CellList<D>,
        targets: &[[f64; D]],
        filler: impl Fn(usize) -> u32 + Sync,
        reach: f64,
        pad: usize,
    ) -> Self {
        let mut list = Self::default();
        list.rebuild(cells, targets, filler, reach, pad);
        list
    }

    /// Like [`build`](Self::build), in the memory of this list.
    ///
    /// # Panics
    ///
    /// As [`build`](Self::build).
    pub fn rebuild<const D: usize>(
        &mut self,
        cells: &CellList<D>,
        targets: &[[f64; D]],
        filler: impl Fn(usize) -> u32 + Sync,
        reach: f64,
        pad: usize,
    ) {
        let query = Query::new(cells.grid(), reach);
        self.pad = pad.max(1);
        self.targets = targets.len();
        self.sources = cells.len() as u32;
        self.chunks.resize_with(targets.len().div_ceil(CHUNK), Chunk::default);
        let (pad, pool) = (self.pad, &self.pool);
        self.chunks.par_iter_mut().zip(targets.par_chunks(CHUNK)).enumerate().for_each(
            |(number, (chunk, targets))| {
                let filler = |k| filler(number * CHUNK + k);
                pool.with(|scratch| chunk.fill(cells, &query, targets, filler, pad, scratch));
            },
        );
    }

    /// Number of targets.
    pub fn len(&self) -> usize {
        self.targets
    }

    /// Whether there are no targets.
    pub fn is_empty(&self) -> bool {
        self.targets == 0
    }

    /// Neighbours of a target, padded.
    ///
    /// # Panics
    ///
    /// When there is no such target.
    #[inline]
    pub fn of(&self, target: usize) -> &[u32] {
        let chunk = &self.chunks[target / CHUNK];
        let (start, count) = chunk.spans[target % CHUNK];
        &chunk.entries[start as usize..][..(count as usize).next_multiple_of(self.pad)]
    }

    /// Number of neighbours of a target, without the padding.
    ///
    /// # Panics
    ///
    /// When there is no such target.
    #[inline]
    pub fn count(&self, target: usize) -> usize {
        self.chunks[target / CHUNK].spans[target % CHUNK].1 as usize
    }

    /// Neighbours of a target, without the padding.
    ///
    /// # Panics
    ///
    /// When there is no such target.
    #[inline]
    pub fn neighbors(&self, target: usize) -> &[u32] {
        &self.of(target)[..self.count(target)]
    }

    /// Number of pairs, without the padding. A pair of targets counts twice.
    pub fn pairs(&self) -> u64 {
        self.chunks.iter().map(|chunk| chunk.pairs).sum()
    }

    /// Number of pairs that are nearer than `distance` now, given the present positions.
    ///
    /// # Panics
    ///
    /// When `targets` has another length than the list, or `sources` lacks an index.
    pub fn pairs_within<const D: usize>(
        &self,
        targets: &[[f64; D]],
        sources: &[[f64; D]],
        distance: f64,
    ) -> u64 {
        assert_eq!(targets.len(), self.targets, "one position per target");
        let near = |x: &[f64; D], y: &[f64; D]| {
            (0..D).map(|axis| (x[axis] - y[axis]).powi(2)).sum::<f64>() < distance * distance
        };
        let count = |(t, x): (usize, &[f64; D])| {
            self.neighbors(t).iter().filter(|&&s| near(x, &sources[s as usize])).count() as u64
        };
        targets.par_iter().with_min_len(CHUNK).enumerate().map(count).sum()
    }

    /// The largest index that the lists may hold, padding included: of all sources and fillers.
    /// None when there are no targets.
    ///
    /// One comparison with it replaces a check of every entry.
    pub fn max_index(&self) -> Option<u32> {
        let fillers = self.chunks.iter().map(|chunk| chunk.largest_filler).max()?;
        Some(fillers.max(self.sources.saturating_sub(1)))
    }

    /// Number of distance tests that the last build took.
    pub fn tests(&self) -> u64 {
        self.chunks.iter().map(|chunk| chunk.tests).sum()
    }

    /// Bytes in use.
    pub fn bytes(&self) -> usize {
        let chunk = |chunk: &Chunk| {
            size_of::<Chunk>() + chunk.entries.capacity() * 4 + chunk.spans.capacity() * 8
        };
        self.chunks.iter().map(chunk).sum()
    }
}

/// Working memory of a task.
#[derive(Debug, Default)]
struct Scratch {
    search: Search,
    entries: Vec<u32>,
}

impl Chunk {
    fn fill<const D: usize>(
        &mut self,
        cells: &CellList<D>,
        query: &Query,
        targets: &[[f64; D]],
        filler: impl Fn(usize) -> u32,
        pad: usize,
        scratch: &mut Scratch,
    ) {
        let search = &mut scratch.search;
        // The first time, entries are collected elsewhere to learn how many they are.
        let known = self.entries.capacity() > 0;
        let mut entries = take(if known { &mut self.entries } else { &mut scratch.entries });
        (self.pairs, self.tests, self.largest_filler) = (0, 0, 0);
        self.spans.clear();
        entries.clear();
        let mut first = 0;
        while first < targets.len() {
            let (length, group) = group(cells.grid(), query, &targets[first..]);
            if let Some(group) = &group {
                search.collect(cells, query, group);
            }
            for (k, x) in targets.iter().enumerate().skip(first).take(length) {
                let start = entries.len();
                let filler = filler(k);
                if let Some(group) = &group {
                    search.test(query, group, &cells.grid().fixed(x), filler, &mut entries);
                    self.tests += search.candidates() as u64;
                }
                let count = entries.len() - start;
                entries.resize(start + count.next_multiple_of(pad), filler);
                self.spans.push((start as u32, count as u32));
                self.pairs += count as u64;
                self.largest_filler = self.largest_filler.max(filler);
            }
            first += length;
        }
        if known {
            self.entries = entries;
        } else {
            // A little more, so that a later build with a few more neighbours fits.
            self.entries.reserve_exact(entries.len() + entries.len() / 32);
            self.entries.extend_from_slice(&entries);
            scratch.entries = entries;
        }
    }
}

/// The group that starts `targets`, with its length; none for a target that the grid cannot place.
///
/// Targets of a group are consecutive and in one row of cells.
fn group<const D: usize>(
    grid: &Grid<D>,
    query: &Query,
    targets: &[[f64; D]],
) -> (usize, Option<Group<D>>) {
    let Some(mut low) = grid.place(&targets[0]) else {
        return (1, None);
    };
    let mut high = low;
    let cell = low.map(|q| q >> Grid::<D>::CELL_BITS);
    let mut length = 1;
    for x in &targets[1..] {
        let Some(fixed) = grid.place(x) else {
            break;
        };
        let away = |axis: usize| ((fixed[axis] >> Grid::<D>::CELL_BITS) - cell[axis]).abs();
        if away(0) >= query.group_cells || (1..D).any(|axis| away(axis) != 0) {
            break;
        }
        low = from_fn(|axis| low[axis].min(fixed[axis]));
        high = from_fn(|axis| high[axis].max(fixed[axis]));
        length += 1;
    }
    (length, Some(Group::new(query, low, high)))
}
