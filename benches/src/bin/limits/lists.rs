//! Rebuilding cell lists and neighbour lists of particles that are nearly sorted.

use crate::Effort;
use serde::Serialize;
use sph_benches::{Clock, Lattice, Spent, median};
use sph_neighbors::{CLUSTER, CellList, ClusterList, Clusters, Grid, NeighborList};
use sph_solver::team::Team;
use std::error::Error;

/// Cost of the lists of one case.
#[derive(Debug, Serialize)]
pub struct ListRow {
    /// `cluster` or `particle`: what a list belongs to.
    pub kind: &'static str,
    /// Number of particles.
    pub particles: usize,
    /// Reach / spacing.
    pub reach: f64,
    /// Mean number of neighbours.
    pub neighbors: f64,
    /// Distance tests of two particles per neighbour.
    pub tests_per_neighbor: f64,
    /// Cell list, core nanoseconds per particle.
    pub cells: f64,
    /// Lists, core nanoseconds per particle.
    pub lists: f64,
    /// Neighbours found per core second.
    pub rate: f64,
    /// Bytes of the lists per particle.
    pub bytes: f64,
    /// Wall time with one thread / with two.
    pub two_threads: f64,
}

/// Measures all cases.
pub fn measure(effort: Effort) -> Result<Vec<ListRow>, Box<dyn Error>> {
    let counts: &[usize] = if effort.quick { &[20_000] } else { &[100_000, 1_000_000] };
    let mut rows = Vec::new();
    for &count in counts {
        // Support and skin: the default of scenes, and the comparison case.
        for reach in [3.45, 3.98] {
            rows.push(of_clusters(count, reach, effort)?);
            rows.push(of_particles(count, reach, effort)?);
        }
    }
    Ok(rows)
}

fn of_particles(count: usize, reach: f64, effort: Effort) -> Result<ListRow, Box<dyn Error>> {
    let lattice = Lattice::cube(count);
    let distance = reach * lattice.spacing;
    let (lattice, grid) = lattice.sorted(distance);
    let mut list = NeighborList::default();
    let build = |cells: &CellList<3>| {
        list.rebuild(cells, &lattice.positions, |t| t as u32, distance, 8);
    };
    let spent = spent(&lattice, &grid, effort, build)?;
    let (tests, bytes) = (list.tests(), list.bytes());
    Ok(row("particle", &lattice, reach, list.pairs(), tests, bytes, &spent))
}

fn of_clusters(count: usize, reach: f64, effort: Effort) -> Result<ListRow, Box<dyn Error>> {
    let lattice = Lattice::cube(count).in_columns();
    let distance = reach * lattice.spacing;
    let grid = Grid::new([0.0; 3], 0.67 * distance)?;
    let clusters = Clusters::new(lattice.len(), &[]);
    let mut list = ClusterList::default();
    let build = |cells: &CellList<3>| {
        list.rebuild(&clusters, cells, &lattice.positions, true, distance);
    };
    let spent = spent(&lattice, &grid, effort, build)?;
    let (tests, bytes) = (CLUSTER as u64 * list.tests(), list.bytes());
    Ok(row("cluster", &lattice, reach, list.pairs(), tests, bytes, &spent))
}

/// Time of cells and of lists, on one thread and on two.
type Round = ((Spent, Spent), (Spent, Spent));

fn spent(
    lattice: &Lattice,
    grid: &Grid<3>,
    effort: Effort,
    mut build: impl FnMut(&CellList<3>) + Send,
) -> Result<Vec<Round>, Box<dyn Error>> {
    let mut cells = CellList::build(grid, &lattice.positions, &lattice.ids);
    let mut once = |team: &Team| -> (Spent, Spent) {
        team.install(|| {
            let sorted = Clock::repeat(1, effort.seconds, || {
                cells.rebuild(grid, &lattice.positions, &lattice.ids);
            });
            (sorted, Clock::repeat(1, effort.seconds, || build(&cells)))
        })
    };
    let (one, two) = (Team::new(1)?, Team::new(2)?);
    once(&one);
    Ok((0..effort.rounds).map(|_| (once(&one), once(&two))).collect())
}

fn row(
    kind: &'static str,
    lattice: &Lattice,
    reach: f64,
    pairs: u64,
    tests: u64,
    bytes: usize,
    rounds: &[Round],
) -> ListRow {
    let n = lattice.len() as f64;
    let middle = |of: &dyn Fn((Spent, Spent), (Spent, Spent)) -> f64| {
        median(rounds.iter().map(|&(one, two)| of(one, two)))
    };
    ListRow {
        kind,
        particles: lattice.len(),
        reach,
        neighbors: pairs as f64 / n,
        tests_per_neighbor: tests as f64 / pairs as f64,
        cells: middle(&|one, _| one.0.core / n * 1e9),
        lists: middle(&|one, _| one.1.core / n * 1e9),
        rate: middle(&|one, _| pairs as f64 / one.1.core),
        bytes: bytes as f64 / n,
        two_threads: middle(&|one, two| (one.0.wall + one.1.wall) / (two.0.wall + two.1.wall)),
    }
}
