//! Groups of points that hang together, point by point nearer than a reach: drops in a spray, halos of galaxies
//! ("friends of friends", Davis, Efstathiou, Frenk & White 1985, Astrophys. J. 292).
//!
//! `cargo run --release -p sph-neighbors --example groups -- [points]`

use sph_neighbors::{CellList, Grid, GridError, NeighborList};

/// Points around so many centres in the unit cube, always the same ones.
fn spray(points: usize, centres: usize) -> Vec<[f64; 3]> {
    let noise = |n: usize| ((n as f64 * 12.9898).sin() * 43_758.545_3).rem_euclid(1.0);
    let around = |n: usize| {
        let centre = n % centres;
        std::array::from_fn(|k| noise(3 * centre + k) + 0.02 * (noise(7 * n + k) - 0.5))
    };
    (0..points).map(around).collect()
}

/// The number of the group of each point, from 0.
fn groups(points: &[[f64; 3]], reach: f64) -> Result<Vec<usize>, GridError> {
    let ids: Vec<u64> = (0..points.len() as u64).collect();
    let cells = CellList::build(&Grid::new([0.0; 3], reach)?, points, &ids);
    let list = NeighborList::build(&cells, points, |target| target as u32, reach, 1);
    let mut group = vec![usize::MAX; points.len()];
    let mut count = 0;
    for first in 0..points.len() {
        if group[first] != usize::MAX {
            continue;
        }
        let mut open = vec![first];
        group[first] = count;
        while let Some(point) = open.pop() {
            for &near in list.neighbors(point) {
                if group[near as usize] == usize::MAX {
                    group[near as usize] = count;
                    open.push(near as usize);
                }
            }
        }
        count += 1;
    }
    Ok(group)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let count = std::env::args().nth(1).map_or(Ok(20_000), |text| text.parse())?;
    let points = spray(count, 40);
    for reach in [0.001, 0.004, 0.02, 0.1] {
        let group = groups(&points, reach)?;
        let mut sizes = vec![0_usize; group.iter().max().map_or(0, |last| last + 1)];
        group.iter().for_each(|&group| sizes[group] += 1);
        let largest = sizes.iter().max().copied().unwrap_or(0);
        println!("reach {reach}: {} groups, the largest of {largest} points", sizes.len());
    }
    Ok(())
}
