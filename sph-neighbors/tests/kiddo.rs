//! Lists against a k-d tree, at sizes where all pairs would take too long.

mod support;

use kiddo::ImmutableKdTree;
use kiddo::dist::SquaredEuclidean;
use sph_neighbors::{CellList, Grid, NeighborList};
use support::MARGIN;

/// Points of a low-discrepancy sequence (Roberts 2018), with a dense corner.
fn points<const D: usize>(n: usize) -> Vec<[f64; D]> {
    let step: [f64; D] = std::array::from_fn(|axis| [0.819_172_5, 0.671_043_6, 0.549_700_5][axis]);
    (0..n)
        .map(|i| {
            let x: [f64; D] = std::array::from_fn(|axis| (i as f64 * step[axis]).fract());
            if i % 5 == 0 { x.map(|c| c * 0.3) } else { x }
        })
        .collect()
}

fn agree<const D: usize>(n: usize, reach: f64, cells_per_reach: f64) {
    let positions = points::<D>(n);
    let ids: Vec<u64> = (0..n as u64).rev().collect();
    let grid = Grid::new([-0.1; D], reach / cells_per_reach).unwrap();
    let cells = CellList::build(&grid, &positions, &ids);
    let list = NeighborList::build(&cells, &positions, |t| t as u32, reach, 8);
    let tree = ImmutableKdTree::<f64, D>::new_from_slice(&positions).unwrap();
    let mut pairs = 0;
    for (t, x) in positions.iter().enumerate() {
        let within = |reach: f64| {
            let mut found: Vec<u32> = tree
                .query(x)
                .within::<SquaredEuclidean<f64>>(reach * reach)
                .unsorted()
                .execute()
                .iter()
                .map(|hit| hit.item)
                .filter(|&j| j as usize != t)
                .collect();
            found.sort_unstable();
            found
        };
        let mut listed = list.neighbors(t).to_vec();
        listed.sort_unstable();
        let surely = within(reach);
        pairs += surely.len();
        if listed != surely {
            assert!(surely.iter().all(|j| listed.contains(j)));
            assert!(listed.iter().all(|j| within(reach * (1.0 + MARGIN)).contains(j)));
        }
    }
    assert!(pairs > 20 * n, "{pairs} pairs are too few to show anything");
}

#[test]
fn three_dimensions() {
    agree::<3>(6_000, 0.11, 1.0);
    agree::<3>(6_000, 0.11, 2.0);
}

#[test]
fn two_dimensions() {
    agree::<2>(10_000, 0.04, 1.0);
    agree::<2>(10_000, 0.04, 2.0);
}
