//! Rebuilding cell lists and neighbour lists of particles that are nearly sorted.

use crate::Effort;
use serde::Serialize;
use sph_benches::{Clock, Lattice, Spent, median};
use sph_neighbors::{CellList, NeighborList};
use sph_solver::team::Team;
use std::error::Error;

/// Cost of the lists of one case.
#[derive(Debug, Serialize)]
pub struct ListRow {
    /// Number of particles.
    pub particles: usize,
    /// Reach / spacing.
    pub reach: f64,
    /// Mean number of list entries.
    pub entries: f64,
    /// Distance tests per entry.
    pub tests_per_entry: f64,
    /// Cell list, core nanoseconds per particle.
    pub cells: f64,
    /// Neighbour list, core nanoseconds per particle.
    pub lists: f64,
    /// Entries found per core second.
    pub entry_rate: f64,
    /// Bytes of the neighbour list per particle.
    pub bytes: f64,
    /// Wall time with one thread / with two.
    pub two_threads: f64,
}

/// Measures all cases.
pub fn measure(effort: Effort) -> Result<Vec<ListRow>, Box<dyn Error>> {
    let counts: &[usize] = if effort.quick { &[20_000] } else { &[100_000, 1_000_000] };
    let mut rows = Vec::new();
    for &count in counts {
        // Support and skin of a tenth of it: the default of scenes, and the comparison case.
        for reach in [3.3, 3.8] {
            rows.push(case(count, reach, effort)?);
        }
    }
    Ok(rows)
}

fn case(count: usize, reach: f64, effort: Effort) -> Result<ListRow, Box<dyn Error>> {
    let lattice = Lattice::cube(count);
    let distance = reach * lattice.spacing;
    let (lattice, grid) = lattice.sorted(distance);
    let mut cells = CellList::build(&grid, &lattice.positions, &lattice.ids);
    let mut list = NeighborList::default();
    let mut build = |team: &Team| -> (Spent, Spent) {
        team.install(|| {
            let sorted = Clock::repeat(1, effort.seconds, || {
                cells.rebuild(&grid, &lattice.positions, &lattice.ids);
            });
            let found = Clock::repeat(1, effort.seconds, || {
                list.rebuild(&cells, &lattice.positions, |t| t as u32, distance, 8);
            });
            (sorted, found)
        })
    };
    let (one, two) = (Team::new(1)?, Team::new(2)?);
    build(&one);
    let rounds: Vec<_> = (0..effort.rounds).map(|_| (build(&one), build(&two))).collect();
    let n = lattice.len() as f64;
    let middle = |of: &dyn Fn((Spent, Spent), (Spent, Spent)) -> f64| {
        median(rounds.iter().map(|&(one, two)| of(one, two)))
    };
    Ok(ListRow {
        particles: lattice.len(),
        reach,
        entries: list.pairs() as f64 / n,
        tests_per_entry: list.tests() as f64 / list.pairs() as f64,
        cells: middle(&|one, _| one.0.core / n * 1e9),
        lists: middle(&|one, _| one.1.core / n * 1e9),
        entry_rate: middle(&|one, _| list.pairs() as f64 / one.1.core),
        bytes: list.bytes() as f64 / n,
        two_threads: middle(&|one, two| (one.0.wall + one.1.wall) / (two.0.wall + two.1.wall)),
    })
}
