//! Cluster lists: the sources near any of a few targets that are close together.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod fill;
mod layout;
mod near;
mod order;
mod radii;

use crate::list::{PairReach, Pool, Query, are_near};
use crate::{CellList, LevelList};
use fill::{Chunk, Scratch};
pub use layout::Clusters;
pub use order::ColumnOrder;
use rayon::prelude::*;

/// Targets of a cluster.
pub const CLUSTER: usize = 8;

/// Clusters of a parallel task.
const CHUNK: usize = 32;

/// For each cluster of targets, the sources within reach of any of them, in canonical order.
///
/// Made for vector units whose lanes hold the *targets*: every source is read once for all of them,
/// without gathering or transposing, as Páll and Hess do for molecular dynamics (*A flexible
/// algorithm for calculating pair interactions on SIMD architectures*, Comput. Phys. Commun. 184,
/// 2013). About half of the lanes are pairs beyond the reach; the caller's kernel must vanish there.
/// In return a list takes an eighth of the memory or less, and a fraction of the time to build.
///
/// What a target sums does not depend on who shares its cluster, as long as sources out of reach
/// contribute zero: it adds its neighbours one after the other, in canonical order.
///
/// Targets of a cluster are consecutive, so order them such that consecutive ones are close
/// together: see [`ColumnOrder`].
///
/// ```
/// use sph_neighbors::{CellList, ClusterList, Clusters, Grid};
///
/// let positions = [[0.1, 0.2], [0.2, 0.2], [0.9, 0.2], [5.0, 5.0]];
/// let grid = Grid::new([0.0, 0.0], 0.5)?;
/// let cells = CellList::build(&grid, &positions, &[10, 11, 12, 13]);
/// let mut list = ClusterList::default();
/// list.rebuild(&Clusters::new(4, &[2]), &cells, &positions, true, 0.75);
/// assert_eq!(list.sources(0), [0, 1, 2]); // of the targets 0 and 1
/// assert_eq!((list.count(0), list.count(1)), (1, 2));
/// # Ok::<(), sph_neighbors::GridError>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct ClusterList {
    clusters: Clusters,
    chunks: Vec<Chunk>,
    /// Periods of the axes.
    periods: Vec<Option<f64>>,
    pool: Pool<Scratch>,
}

impl ClusterList {
    /// Finds the sources of `cells` within `reach` of the targets of each cluster, in the memory of
    /// this list.
    ///
    /// * `targets`: as many as `clusters` has.
    /// * `own`: whether target `t` is the source with index `t`. It is then in the list of its
    ///   cluster, as the others are, but does not count as its own neighbour.
    /// * `reach`: every source nearer than this is in the list. Sources may count that are further
    ///   by up to a few times [`Grid::resolution`](crate::Grid::resolution) or 10⁻⁶ of the reach, but
    ///   then on every rank and for both particles of a pair.
    ///
    /// Targets that the grid cannot place have no neighbours.
    ///
    /// # Panics
    ///
    /// When there is another number of targets than `clusters` has, or
    /// [`Grid::check_reach`](crate::Grid::check_reach) refuses the reach.
    pub fn rebuild<const D: usize>(
        &mut self,
        clusters: &Clusters,
        cells: &CellList<D>,
        targets: &[[f64; D]],
        own: bool,
        reach: f64,
    ) {
        assert_eq!(targets.len(), clusters.targets(), "clusters are of all targets");
        let query = Query::new(cells.grid(), reach);
        self.periods = cells.grid().periods().to_vec();
        self.clusters.clone_from(clusters);
        self.chunks.resize_with(clusters.len().div_ceil(CHUNK), Chunk::default);
        let pool = &self.pool;
        self.chunks.par_iter_mut().enumerate().for_each(|(number, chunk)| {
            let first = number * CHUNK;
            let some = first..clusters.len().min(first + CHUNK);
            pool.with(|scratch| {
                fill::fill(chunk, scratch, &query, cells, clusters, some, targets, own);
            });
        });
    }

    /// Finds the sources of `levels` within the reach of each pair, which follows from the radii of both,
    /// in the memory of this list. The sources of a cluster are in the order of the levels.
    ///
    /// * `targets`, `radii`: as many as `clusters` has. Targets of a cluster should have about the same
    ///   radius.
    /// * `own`: as for [`rebuild`](Self::rebuild).
    ///
    /// For a Verlet skin, add it to all radii. Sources may count that are too far by a few times the
    /// resolution of the coarsest grid.
    ///
    /// # Panics
    ///
    /// When there is another number of targets or radii than `clusters` has, or
    /// [`Grid::check_radius`](crate::Grid::check_radius) refuses a radius.
    pub fn rebuild_with_radii<const D: usize>(
        &mut self,
        clusters: &Clusters,
        levels: &LevelList<D>,
        targets: &[[f64; D]],
        radii: &[f64],
        own: bool,
        rule: PairReach,
    ) {
        assert_eq!(targets.len(), clusters.targets(), "clusters are of all targets");
        assert_eq!(targets.len(), radii.len(), "every target needs a radius");
        if let Some(error) = radii.iter().find_map(|&r| levels.grid().check_radius(r).err()) {
            panic!("{error}");
        }
        self.periods = levels.grid().periods().to_vec();
        self.clusters.clone_from(clusters);
        self.chunks.resize_with(clusters.len().div_ceil(CHUNK), Chunk::default);
        let pool = &self.pool;
        let task = radii::Task { levels, clusters, targets, radii, own, rule };
        self.chunks.par_iter_mut().enumerate().for_each(|(number, chunk)| {
            let first = number * CHUNK;
            let some = first..clusters.len().min(first + CHUNK);
            pool.with(|scratch| task.fill(chunk, scratch, some));
        });
    }

    /// A list of a part of the pairs: `keep` says which sources of its cluster a target has, and sees all of
    /// them, with what `prepare` made of the target. A target that has any is a cluster of its own; the
    /// others share clusters without sources.
    ///
    /// ```
    /// use sph_neighbors::{CellList, ClusterList, Clusters, Grid};
    ///
    /// let positions = [[0.1, 0.2], [0.2, 0.2], [0.9, 0.2]];
    /// let cells = CellList::build(&Grid::new([0.0, 0.0], 0.5)?, &positions, &[10, 11, 12]);
    /// let mut list = ClusterList::default();
    /// list.rebuild(&Clusters::new(3, &[]), &cells, &positions, true, 0.75);
    /// let right = list.one_by_one(|_| (), |_, target, source| source as usize > target);
    /// let clusters: Vec<_> = right.clusters().within(0..3).collect();
    /// assert_eq!(clusters, [(0, 0..1), (1, 1..2), (2, 2..3)]);
    /// assert_eq!([0, 1, 2].map(|cluster| right.sources(cluster).len()), [2, 1, 0]);
    /// # Ok::<(), sph_neighbors::GridError>(())
    /// ```
    #[must_use]
    pub fn one_by_one<T>(
        &self,
        prepare: impl Fn(usize) -> T + Sync,
        keep: impl Fn(&T, usize, u32) -> bool + Sync,
    ) -> Self {
        let targets = self.len();
        let kept: Vec<Vec<u32>> = (0..targets)
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|target| {
                let all = self.sources(self.clusters.containing(target)).iter().copied();
                let prepared = prepare(target);
                all.filter(|source| keep(&prepared, target, *source)).collect()
            })
            .collect();
        let having = (0..targets).filter(|&target| !kept[target].is_empty());
        let mut breaks: Vec<usize> = having.flat_map(|target| [target, target + 1]).collect();
        breaks.dedup();
        let clusters = Clusters::new(targets, &breaks);
        let chunk = |number: usize| {
            let first = number * CHUNK;
            let some = first..clusters.len().min(first + CHUNK);
            Chunk::of_lists(some.map(|cluster| clusters.targets_of(cluster)), &kept)
        };
        let chunks = (0..clusters.len().div_ceil(CHUNK)).into_par_iter().map(chunk).collect();
        Self { clusters, chunks, periods: self.periods.clone(), pool: Pool::default() }
    }

    /// The layout of the clusters.
    pub fn clusters(&self) -> &Clusters {
        &self.clusters
    }

    /// Number of targets.
    pub fn len(&self) -> usize {
        self.clusters.targets()
    }

    /// Whether there are no targets.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Indices of the sources near a cluster.
    ///
    /// # Panics
    ///
    /// When there is no such cluster.
    #[inline]
    pub fn sources(&self, cluster: usize) -> &[u32] {
        self.chunks[cluster / CHUNK].sources(cluster % CHUNK)
    }

    /// Number of sources within reach of a target, itself not counted.
    ///
    /// # Panics
    ///
    /// When there is no such target.
    #[inline]
    pub fn count(&self, target: usize) -> usize {
        self.chunks[self.clusters.containing(target) / CHUNK].count(target)
    }

    /// [`count`](Self::count) of every target, in order.
    pub fn counts(&self) -> impl Iterator<Item = usize> {
        self.chunks.iter().flat_map(Chunk::counts)
    }

    /// Number of pairs of a target and a source within reach. A pair of targets counts twice.
    pub fn pairs(&self) -> u64 {
        self.chunks.iter().map(|chunk| chunk.pairs).sum()
    }

    /// Number of lanes that a sweep works on: [`CLUSTER`] for each entry.
    pub fn lanes(&self) -> u64 {
        self.chunks.iter().map(|chunk| (chunk.entries() * CLUSTER) as u64).sum()
    }

    /// The share of the lanes that are pairs, 0 without any: about one half when the targets of
    /// clusters are close together.
    pub fn compactness(&self) -> f64 {
        match self.lanes() {
            0 => 0.0,
            lanes => self.pairs() as f64 / lanes as f64,
        }
    }

    /// Number of pairs that are nearer than `distance` now, given the present positions; distances
    /// are to the nearest image if the grid is periodic. A target that is a source is no pair with
    /// itself.
    ///
    /// # Panics
    ///
    /// When `targets` has another length than the list, or `sources` lacks an index.
    pub fn pairs_within<const D: usize>(
        &self,
        targets: &[[f64; D]],
        sources: &[[f64; D]],
        own: bool,
        distance: f64,
    ) -> u64 {
        assert_eq!(targets.len(), self.len(), "one position per target");
        let near = |x: &[f64; D], y: &[f64; D]| are_near(x, y, &self.periods, distance);
        let count = |cluster: usize| {
            let some = self.sources(cluster);
            let of = |t: usize| {
                let near = |s: &&u32| {
                    !(own && **s as usize == t) && near(&targets[t], &sources[**s as usize])
                };
                some.iter().filter(near).count() as u64
            };
            self.clusters.targets_of(cluster).map(of).sum::<u64>()
        };
        (0..self.clusters.len()).into_par_iter().with_min_len(CHUNK).map(count).sum()
    }

    /// Number of distance tests of a source with a whole cluster that the last build took.
    pub fn tests(&self) -> u64 {
        self.chunks.iter().map(|chunk| chunk.tests).sum()
    }

    /// Bytes in use.
    pub fn bytes(&self) -> usize {
        self.chunks.iter().map(Chunk::bytes).sum()
    }
}
