//! Counts neighbours on a jittered lattice and prints what the search costs.
//!
//! `cargo run --release --example cost -- 100 3.3` searches 100³ particles within 3.3 spacings.

use sph_neighbors::{CellList, Grid, NeighborList};
use std::error::Error;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let edge = arguments.next().map_or(Ok(50), |n| n.parse::<usize>())?;
    let reach = arguments.next().map_or(Ok(3.3), |r| r.parse::<f64>())?;

    let lattice = jittered_lattice(edge);
    let ids: Vec<u64> = (0..lattice.len() as u64).collect();
    println!(
        "{} particles, reach {reach} spacings, {} threads",
        ids.len(),
        rayon::current_num_threads()
    );
    for cells_per_reach in [1.0, 1.5, 2.0, 3.0] {
        let grid = Grid::new([0.0; 3], reach / cells_per_reach)?;
        // Particles are stored in canonical order, as a simulation does.
        let cells = CellList::build(&grid, &lattice, &ids);
        let positions: Vec<[f64; 3]> = cells.order().iter().map(|&i| lattice[i as usize]).collect();

        let mut cells = CellList::build(&grid, &positions, &ids);
        let mut list = NeighborList::build(&cells, &positions, |t| t as u32, reach, 8);
        let (mut sorting, mut searching) = (f64::INFINITY, f64::INFINITY);
        for _ in 0..10 {
            let start = Instant::now();
            cells.rebuild(&grid, &positions, &ids);
            sorting = sorting.min(start.elapsed().as_secs_f64());
            let start = Instant::now();
            list.rebuild(&cells, &positions, |t| t as u32, reach, 8);
            searching = searching.min(start.elapsed().as_secs_f64());
        }
        let (particles, pairs, tests) =
            (list.len() as f64, list.pairs() as f64, list.tests() as f64);
        println!(
            "cells of reach / {cells_per_reach}: {:.1} neighbours, {:.2} tests per neighbour, \
             {:.0} ns per particle to sort and {:.0} to search, {:.2} G tests/s, {:.0} bytes per particle",
            pairs / particles,
            tests / pairs,
            sorting / particles * 1e9,
            searching / particles * 1e9,
            tests / searching * 1e-9,
            list.bytes() as f64 / particles,
        );
    }
    Ok(())
}

/// Particles of spacing 1 that are off their lattice points by up to a fifth.
fn jittered_lattice(edge: usize) -> Vec<[f64; 3]> {
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut jitter = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64 * 0.4 - 0.2
    };
    (0..edge * edge * edge)
        .map(|i| [i % edge, i / edge % edge, i / edge / edge].map(|n| n as f64 + 0.5 + jitter()))
        .collect()
}
