//! Building neighbour lists, beside a naive loop over cells and a k-d tree.
//!
//! All three find the same neighbours; this is checked first.
#![allow(missing_docs, reason = "criterion's macros make public items")]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use kiddo::ImmutableKdTree;
use kiddo::dist::SquaredEuclidean;
use sph_benches::Lattice;
use sph_neighbors::{CellList, Grid, NeighborList};
use std::hint::black_box;

/// Support radius and skin, in spacings.
const REACH: f64 = 3.3;

/// Neighbours of each particle by testing everyone in the 27 cells around, one after another.
fn naive(cells: &CellList<3>, grid: &Grid<3>, positions: &[[f64; 3]], reach: f64) -> Vec<Vec<u32>> {
    let near = |i: usize, j: u32| {
        let (a, b) = (&positions[i], &positions[j as usize]);
        let distance2: f64 = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum();
        i != j as usize && distance2 < reach * reach
    };
    let around = |i: usize| {
        let [x, y, z] = grid.cell(&positions[i]);
        let mut found = Vec::new();
        for row in (-1..=1).flat_map(|dz| (-1..=1).map(move |dy| [x - 1, y + dy, z + dz])) {
            let candidates = &cells.order()[cells.row(row, x + 1)];
            found.extend(candidates.iter().copied().filter(|&j| near(i, j)));
        }
        found
    };
    (0..positions.len()).map(around).collect()
}

/// Neighbours of each particle from a tree that is built for it.
fn tree(positions: &[[f64; 3]], reach: f64) -> Vec<Vec<u32>> {
    let tree: ImmutableKdTree<f64, 3> =
        ImmutableKdTree::new_from_slice(positions).expect("finite positions");
    let around = |(i, x): (usize, &[f64; 3])| {
        let found =
            tree.query(x).within::<SquaredEuclidean<f64>>(reach * reach).unsorted().execute();
        found.iter().map(|hit| hit.item).filter(|&j| j as usize != i).collect()
    };
    positions.iter().enumerate().map(around).collect()
}

fn lists(criterion: &mut Criterion) {
    // One thread for all three.
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("the first pool");
    let mut group = criterion.benchmark_group("lists");
    group.sample_size(10);
    for count in [10_000, 60_000] {
        let lattice = Lattice::cube(count);
        let reach = REACH * lattice.spacing;
        let (lattice, grid) = lattice.sorted(reach);
        let positions = &lattice.positions;
        let cells = CellList::build(&grid, positions, &lattice.ids);
        let itself = |t: usize| t as u32;
        let mut list = NeighborList::build(&cells, positions, itself, reach, 8);
        let pairs = list.pairs();
        let count_all = |lists: Vec<Vec<u32>>| lists.iter().map(|l| l.len() as u64).sum::<u64>();
        // Lists may hold a few pairs just beyond the reach.
        for other in
            [count_all(naive(&cells, &grid, positions, reach)), count_all(tree(positions, reach))]
        {
            assert!(pairs >= other && pairs <= other + other / 1000, "{pairs} pairs, not {other}");
        }
        group.throughput(Throughput::Elements(pairs));
        group.bench_function(BenchmarkId::new("ours", count), |bencher| {
            bencher.iter(|| list.rebuild(&cells, black_box(positions), itself, reach, 8));
        });
        group.bench_function(BenchmarkId::new("naive", count), |bencher| {
            bencher.iter(|| naive(&cells, &grid, black_box(positions), reach));
        });
        group.bench_function(BenchmarkId::new("kiddo", count), |bencher| {
            bencher.iter(|| tree(black_box(positions), reach));
        });
    }
    group.finish();
}

criterion_group!(benches, lists);
criterion_main!(benches);
