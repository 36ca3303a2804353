//! Compares the search with radii that differ by a factor of 8 with the search within one reach.
//!
//! `cargo run --release --example radii -- 100000` takes that many particles. To single a search out,
//! for callgrind: `radii 50000 one 5` searches 5 times within one reach; `equal` and `differ` search
//! with equal and with different radii, by their mean.
//!
//! Particles fill a pyramid whose cross-section and spacing grow together, so that there are as many
//! large particles along its axis as small ones, and a straight bar with one spacing.

use sph_neighbors::{CellList, Grid, LevelList, NeighborList, PairReach};
use std::error::Error;
use std::time::Instant;

/// Radius / spacing.
const RADIUS: f64 = 3.3;
/// Spacings across the pyramid and the bar.
const WIDTH: f64 = 24.0;
/// Largest radius / smallest radius.
const SPREAD: f64 = 8.0;

struct Particles {
    positions: Vec<[f64; 3]>,
    radii: Vec<f64>,
    ids: Vec<u64>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let n = std::env::args().nth(1).map_or(Ok(50_000), |n| n.parse::<usize>())?;
    let only = std::env::args().nth(2);
    let chosen = |case: &str| only.as_deref().is_none_or(|only| only == case);
    let repeats = std::env::args().nth(3).map_or(Ok(30), |r| r.parse::<usize>())?;

    let bar = pyramid(n, 1.0);
    let grid = Grid::new([0.0; 3], RADIUS)?;
    let order = CellList::build(&grid, &bar.positions, &bar.ids).order().to_vec();
    let bar = bar.sorted(&order);
    let mut cells = CellList::build(&grid, &bar.positions, &bar.ids);
    let mut list = NeighborList::default();
    let mut one = f64::NAN;
    if chosen("one") {
        one = measure("one reach", n, repeats, &mut list, |list| {
            cells.rebuild(&grid, &bar.positions, &bar.ids);
            list.rebuild(&cells, &bar.positions, |t| t as u32, RADIUS, 8);
            Ok(())
        })?;
    }

    for (case, name, spread) in [("equal", "equal radii", 1.0), ("differ", "radii 1 : 8", SPREAD)] {
        if !chosen(case) {
            continue;
        }
        let particles = pyramid(n, spread);
        let largest = particles.radii.iter().copied().fold(0.0, f64::max);
        let grid = Grid::new([0.0; 3], largest / 2.0)?;
        let Particles { positions, radii, ids } = &particles;
        let order: Vec<u32> = LevelList::build(&grid, positions, radii, ids)?.order().collect();
        let Particles { positions, radii, ids } = &particles.sorted(&order);
        let mut levels = LevelList::build(&grid, positions, radii, ids)?;
        let rules: &[PairReach] =
            if only.is_some() { &[PairReach::Mean] } else { &[PairReach::Mean, PairReach::Max] };
        for &rule in rules {
            let name = format!("{name}, {rule:?}");
            let cost = measure(&name, n, repeats, &mut list, |list| {
                levels.rebuild(&grid, positions, radii, ids)?;
                list.rebuild_with_radii(&levels, positions, radii, |t| t as u32, rule, 8);
                Ok(())
            })?;
            if only.is_none() {
                println!("    {:.2} × one reach, per neighbour", cost / one);
            }
        }
    }
    Ok(())
}

/// Prints and returns the cost of a search per neighbour, in ns.
fn measure(
    name: &str,
    n: usize,
    repeats: usize,
    list: &mut NeighborList,
    mut search: impl FnMut(&mut NeighborList) -> Result<(), Box<dyn Error>>,
) -> Result<f64, Box<dyn Error>> {
    let mut best = f64::INFINITY;
    for _ in 0..repeats {
        let start = Instant::now();
        search(list)?;
        best = best.min(start.elapsed().as_secs_f64() * 1e9);
    }
    let pairs = list.pairs() as f64;
    println!(
        "{name}: {:.1} neighbours, {:.2} tests per neighbour, {:.0} ns per particle, {:.2} per neighbour",
        pairs / n as f64,
        list.tests() as f64 / pairs,
        best / n as f64,
        best / pairs
    );
    Ok(best / pairs)
}

/// Particles whose spacing grows from 1 to `spread` along x, at points of a low-discrepancy sequence
/// (Roberts 2018), which leaves no gaps and no clusters.
fn pyramid(n: usize, spread: f64) -> Particles {
    let length = n as f64 / (WIDTH * WIDTH);
    let mut particles = Particles { positions: Vec::new(), radii: Vec::new(), ids: Vec::new() };
    for i in 0..n {
        let [u, v, w] =
            [0.819_172_513, 0.671_043_607, 0.549_700_478].map(|a| (i as f64 * a).fract());
        // Along x there are 1 / spacing particles: u is the part of them up to x.
        let (x, spacing) = if spread > 1.0 {
            let growth = (1.0 - 1.0 / spread) / length;
            let spacing = 1.0 / (1.0 - u * (1.0 - 1.0 / spread));
            (spacing.ln() / growth, spacing)
        } else {
            (u * length, 1.0)
        };
        particles.positions.push([x, (v - 0.5) * WIDTH * spacing, (w - 0.5) * WIDTH * spacing]);
        particles.radii.push(RADIUS * spacing);
        particles.ids.push(i as u64);
    }
    particles
}

impl Particles {
    fn sorted(&self, order: &[u32]) -> Self {
        Self {
            positions: order.iter().map(|&i| self.positions[i as usize]).collect(),
            radii: order.iter().map(|&i| self.radii[i as usize]).collect(),
            ids: order.iter().map(|&i| self.ids[i as usize]).collect(),
        }
    }
}
