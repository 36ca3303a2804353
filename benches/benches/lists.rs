//! Building neighbour lists, per particle, per cluster of eight and from our trees, beside a naive loop
//! over cells and a k-d tree that is asked for every particle.
//!
//! All find the same neighbours; this is checked first. Elements are pairs within reach, so that lists
//! per cluster do not count the lanes that are beyond it.
#![allow(missing_docs, reason = "criterion's macros make public items")]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use kiddo::ImmutableKdTree;
use kiddo::dist::SquaredEuclidean;
use sph_benches::Lattice;
use sph_neighbors::{CellList, ClusterList, Clusters, Grid, NeighborList, PairReach, TreeList};
use std::hint::black_box;

/// Support radius and skin, in spacings.
const REACH: f64 = 3.3;

/// Cells of cluster lists, relative to the reach: with these the search is fastest.
const CLUSTER_CELL: f64 = 0.67;

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

/// A list of clusters that is ready to be built again, and what does so.
fn clusters(lattice: Lattice, reach: f64) -> (ClusterList, impl Fn(&mut ClusterList)) {
    // The order in which the solver stores particles.
    let Lattice { positions, ids, .. } = lattice.in_columns();
    let grid = Grid::new([0.0; 3], CLUSTER_CELL * reach).expect("a positive cell size");
    let cells = CellList::build(&grid, &positions, &ids);
    let layout = Clusters::new(positions.len(), &[]);
    let rebuild = move |list: &mut ClusterList| {
        list.rebuild(&layout, &cells, black_box(&positions), true, reach);
    };
    let mut list = ClusterList::default();
    rebuild(&mut list);
    (list, rebuild)
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
    // One thread for all.
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("the first pool");
    let mut group = criterion.benchmark_group("lists");
    group.sample_size(10);
    for count in [10_000, 60_000] {
        let lattice = Lattice::cube(count);
        let reach = REACH * lattice.spacing;
        let (mut cluster_list, rebuild_clusters) = clusters(lattice.clone(), reach);
        let (lattice, grid) = lattice.sorted(reach);
        let positions = &lattice.positions;
        let cells = CellList::build(&grid, positions, &lattice.ids);
        let itself = |t: usize| t as u32;
        let mut list = NeighborList::build(&cells, positions, itself, reach, 8);
        let pairs = list.pairs();
        let count_all = |lists: Vec<Vec<u32>>| lists.iter().map(|l| l.len() as u64).sum::<u64>();
        // Lists may hold a few pairs just beyond the reach.
        let exact = count_all(naive(&cells, &grid, positions, reach));
        assert_eq!(exact, count_all(tree(positions, reach)));
        let (radii, mut from_trees) = (vec![reach; lattice.len()], NeighborList::default());
        let trees = |list: &mut NeighborList| {
            let trees = TreeList::build(&grid, black_box(positions), &radii, &lattice.ids)
                .expect("radii that fit the grid");
            list.rebuild_with_tree(&trees, positions, &radii, itself, PairReach::Mean, 8);
        };
        trees(&mut from_trees);
        assert_eq!(exact, from_trees.pairs());
        for pairs in [pairs, cluster_list.pairs()] {
            assert!(pairs >= exact && pairs <= exact + exact / 1000, "{pairs} pairs, not {exact}");
        }
        group.throughput(Throughput::Elements(pairs));
        group.bench_function(BenchmarkId::new("ours", count), |bencher| {
            bencher.iter(|| list.rebuild(&cells, black_box(positions), itself, reach, 8));
        });
        group.bench_function(BenchmarkId::new("clusters", count), |bencher| {
            bencher.iter(|| rebuild_clusters(&mut cluster_list));
        });
        group.bench_function(BenchmarkId::new("trees", count), |bencher| {
            bencher.iter(|| trees(&mut from_trees));
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
