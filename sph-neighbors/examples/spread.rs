//! Compares the search in levels with the search in k-d trees for radii that differ by 1 : 1 to
//! 1 : 10⁶.
//!
//! `cargo run --release --features kiddo --example spread` takes all ratios. To single one out, for
//! callgrind: `spread 50000 100 trees mean 5` takes 50 000 particles of radii 1 : 100, the search in
//! trees (or `levels`) and the mean (or `max`) of two radii, and searches 5 times.
//!
//! Particles fill a pyramid whose spacing grows with the distance from the apex: every factor of two
//! has as many of them.

use sph_neighbors::{Grid, LevelList, NeighborList, PairReach, TreeList};
use std::error::Error;
use std::time::Instant;

/// Radius / spacing.
const RADIUS: f64 = 3.3;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |place: usize, default: f64| {
        arguments.get(place).map_or(Ok(default), |argument| argument.parse::<f64>())
    };
    let chosen = |place: usize, name: &str| arguments.get(place).is_none_or(|a| a == name);
    let (n, repeats) = (number(0, 50_000.0)? as usize, number(4, 5.0)? as usize);
    let ratios = [1.0, 8.0, 100.0, 1e4, 1e6];
    println!("radii 1 :   rule   search   neighbours   tests   trees, ns   search, ns");
    for ratio in if arguments.len() > 1 { vec![number(1, 1.0)?] } else { ratios.to_vec() } {
        let (positions, radii) = pyramid(n, ratio);
        for (rule, name) in [(PairReach::Mean, "mean"), (PairReach::Max, "max")] {
            for way in ["levels", "trees"] {
                if !chosen(2, way) || !chosen(3, name) {
                    continue;
                }
                let cost = if way == "levels" {
                    levels(&positions, &radii, rule, repeats)?
                } else {
                    trees(&positions, &radii, rule, repeats)?
                };
                println!(
                    "{ratio:9}   {name:4}   {way:6}   {:10.1}   {:5.2}   {:9.2}   {:10.2}",
                    cost.pairs / n as f64,
                    cost.tests / cost.pairs,
                    cost.sorting / cost.pairs,
                    cost.searching / cost.pairs,
                );
            }
        }
    }
    println!("Tests and times are per neighbour.");
    Ok(())
}

struct Cost {
    /// Best times, ns.
    sorting: f64,
    searching: f64,
    pairs: f64,
    tests: f64,
}

/// Positions, radii and ids of particles that are stored in canonical order.
type Particles = (Vec<[f64; 3]>, Vec<f64>, Vec<u64>);

fn levels(
    positions: &[[f64; 3]],
    radii: &[f64],
    rule: PairReach,
    repeats: usize,
) -> Result<Cost, Box<dyn Error>> {
    let grid = grid(radii)?;
    let ids: Vec<u64> = (0..radii.len() as u64).collect();
    let order: Vec<u32> = LevelList::build(&grid, positions, radii, &ids)?.order().collect();
    let (positions, radii, ids) = sorted(&order, positions, radii);
    let mut levels = LevelList::build(&grid, &positions, &radii, &ids)?;
    let mut list = NeighborList::default();
    measure(repeats, &mut list, |list, clock| {
        levels.rebuild(&grid, &positions, &radii, &ids)?;
        clock();
        list.rebuild_with_radii(&levels, &positions, &radii, |t| t as u32, rule, 8);
        Ok(())
    })
}

fn trees(
    positions: &[[f64; 3]],
    radii: &[f64],
    rule: PairReach,
    repeats: usize,
) -> Result<Cost, Box<dyn Error>> {
    let grid = grid(radii)?;
    let ids: Vec<u64> = (0..radii.len() as u64).collect();
    let order = TreeList::build(&grid, positions, radii, &ids)?.order().to_vec();
    let (positions, radii, ids) = sorted(&order, positions, radii);
    let mut list = NeighborList::default();
    measure(repeats, &mut list, |list, clock| {
        let trees = TreeList::build(&grid, &positions, &radii, &ids)?;
        clock();
        list.rebuild_with_tree(&trees, &positions, &radii, |t| t as u32, rule, 8);
        Ok(())
    })
}

/// A grid for the largest of these radii.
fn grid(radii: &[f64]) -> Result<Grid<3>, Box<dyn Error>> {
    Ok(Grid::new([0.0; 3], radii.iter().copied().fold(0.0, f64::max) / 2.0)?)
}

/// Times a search, which calls the clock when it has sorted the particles.
fn measure(
    repeats: usize,
    list: &mut NeighborList,
    mut search: impl FnMut(&mut NeighborList, &mut dyn FnMut()) -> Result<(), Box<dyn Error>>,
) -> Result<Cost, Box<dyn Error>> {
    let (mut sorting, mut searching) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..repeats {
        let start = Instant::now();
        let mut middle = start;
        search(list, &mut || middle = Instant::now())?;
        sorting = sorting.min((middle - start).as_secs_f64() * 1e9);
        searching = searching.min(middle.elapsed().as_secs_f64() * 1e9);
    }
    Ok(Cost { sorting, searching, pairs: list.pairs() as f64, tests: list.tests() as f64 })
}

/// Particles with radii of 1 : `ratio`, at points of a low-discrepancy sequence (Roberts 2018), which
/// leaves no gaps and no clusters.
fn pyramid(n: usize, ratio: f64) -> (Vec<[f64; 3]>, Vec<f64>) {
    let point = |i: usize| {
        let [u, v, w] =
            [0.819_172_513, 0.671_043_607, 0.549_700_478].map(|a| (i as f64 * a).fract());
        // A pyramid cut off near the apex. As wide as high, it has n = (x / spacing)³ ln(ratio)
        // particles; a cube has n = 1 / spacing³.
        let (x, spacing) = if ratio > 1.0 {
            let x = ratio.powf(u);
            (x, x * (ratio.ln() / n as f64).cbrt())
        } else {
            (1.0, (1.0 / n as f64).cbrt())
        };
        let along = if ratio > 1.0 { x } else { u };
        ([along, (v - 0.5) * x, (w - 0.5) * x], RADIUS * spacing)
    };
    (0..n).map(point).unzip()
}

fn sorted(order: &[u32], positions: &[[f64; 3]], radii: &[f64]) -> Particles {
    (
        order.iter().map(|&i| positions[i as usize]).collect(),
        order.iter().map(|&i| radii[i as usize]).collect(),
        order.iter().map(|&i| u64::from(i)).collect(),
    )
}
