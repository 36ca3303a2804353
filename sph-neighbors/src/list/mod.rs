//! Neighbour lists.

mod chunk;
mod compress;
#[cfg(feature = "kiddo")]
mod near;
mod plan;
mod pool;
mod query;
mod search;
#[cfg(feature = "kiddo")]
mod with_tree;

use crate::{CellList, LevelList};
use chunk::{CHUNK, Chunk, Scratch};
use plan::{Plan, Uniform, Variable};
use rayon::prelude::*;
use std::mem::take;

pub(crate) use compress::{LANES, LANES_OF};
pub use plan::PairReach;
pub(crate) use plan::radius_in_units;
pub(crate) use pool::Pool;
pub(crate) use query::{Group, Query};

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
#[derive(Debug, Clone, Default)]
pub struct NeighborList {
    chunks: Vec<Chunk>,
    targets: usize,
    sources: u32,
    /// Periods of the axes.
    periods: Vec<Option<f64>>,
    pad: usize,
    pool: Pool<Scratch>,
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
    /// When [`Grid::check_reach`](crate::Grid::check_reach) refuses the reach: when it is negative or
    /// not a number, larger than 256 cells, or larger than half a period.
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
        let plan = Uniform { cells, query: Query::new(cells.grid(), reach) };
        self.sources = cells.len() as u32;
        self.periods = cells.grid().periods().to_vec();
        self.fill(&plan, |scratch| &mut scratch.search, targets, filler, pad);
    }

    /// Finds the sources within the reach of each pair, which follows from the radii of both.
    ///
    /// For a Verlet skin, add it to all radii. Other arguments are as for [`build`](Self::build);
    /// sources may be found that are too far by a few times the resolution of the coarsest grid.
    /// Fastest when targets are in the order of [`LevelList::order`].
    ///
    /// # Panics
    ///
    /// When `radii` has another length than `targets`, or holds a radius that
    /// [`Grid::check_radius`](crate::Grid::check_radius) refuses.
    pub fn build_with_radii<const D: usize>(
        levels: &LevelList<D>,
        targets: &[[f64; D]],
        radii: &[f64],
        filler: impl Fn(usize) -> u32 + Sync,
        rule: PairReach,
        pad: usize,
    ) -> Self {
        let mut list = Self::default();
        list.rebuild_with_radii(levels, targets, radii, filler, rule, pad);
        list
    }

    /// Like [`build_with_radii`](Self::build_with_radii), in the memory of this list.
    ///
    /// # Panics
    ///
    /// As [`build_with_radii`](Self::build_with_radii).
    pub fn rebuild_with_radii<const D: usize>(
        &mut self,
        levels: &LevelList<D>,
        targets: &[[f64; D]],
        radii: &[f64],
        filler: impl Fn(usize) -> u32 + Sync,
        rule: PairReach,
        pad: usize,
    ) {
        assert_eq!(targets.len(), radii.len(), "every target needs a radius");
        let plan = Variable::new(levels, radii, rule);
        self.sources = levels.len() as u32;
        self.periods = levels.grid().periods().to_vec();
        self.fill(&plan, |scratch| &mut scratch.search, targets, filler, pad);
    }

    /// Fills all lists; `memory` is where the scratch keeps the candidates of this kind of plan.
    fn fill<const D: usize, P: Plan<D>>(
        &mut self,
        plan: &P,
        memory: impl Fn(&mut Scratch) -> &mut P::Memory + Sync,
        targets: &[[f64; D]],
        filler: impl Fn(usize) -> u32 + Sync,
        pad: usize,
    ) {
        self.pad = pad.max(1);
        self.targets = targets.len();
        self.chunks.resize_with(targets.len().div_ceil(CHUNK), Chunk::default);
        let (pad, pool) = (self.pad, &self.pool);
        self.chunks.par_iter_mut().zip(targets.par_chunks(CHUNK)).enumerate().for_each(
            |(number, (chunk, targets))| {
                let first = number * CHUNK;
                pool.with(|scratch| {
                    let mut entries = take(&mut scratch.entries);
                    let memory = (memory(scratch), &mut entries);
                    chunk.fill(plan, targets, first, &filler, pad, memory);
                    scratch.entries = entries;
                });
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

    /// Number of pairs that are nearer than `distance` now, given the present positions. Distances
    /// are to the nearest image if the grid is periodic.
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
        let near = |x: &[f64; D], y: &[f64; D]| are_near(x, y, &self.periods, distance);
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

    /// Number of distance tests that the last build took; with k-d trees, without those inside the
    /// trees.
    pub fn tests(&self) -> u64 {
        self.chunks.iter().map(|chunk| chunk.tests).sum()
    }

    /// Bytes in use.
    pub fn bytes(&self) -> usize {
        self.chunks.iter().map(Chunk::bytes).sum()
    }
}

/// Whether two points, or images of them where axes have a period, are nearer than a distance.
pub(crate) fn are_near<const D: usize>(
    x: &[f64; D],
    y: &[f64; D],
    periods: &[Option<f64>],
    distance: f64,
) -> bool {
    let along = |axis: usize, d: f64| match periods.get(axis).copied().flatten() {
        Some(period) => d - period * (d / period).round(),
        None => d,
    };
    let squares = (0..D).map(|axis| along(axis, x[axis] - y[axis]).powi(2));
    squares.sum::<f64>() < distance * distance
}
