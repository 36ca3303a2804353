//! Building and rebuilding the cell list of a jittered lattice.
#![allow(missing_docs, reason = "criterion's macros make public items")]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use sph_benches::Lattice;
use sph_neighbors::{CellList, Grid};
use std::hint::black_box;

/// Support radius and skin, in spacings.
const REACH: f64 = 3.3;

fn cells(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("cells");
    group.sample_size(10);
    for count in [10_000, 100_000] {
        let rows = Lattice::cube(count);
        let reach = REACH * rows.spacing;
        let grid = Grid::new([0.0; 3], reach).expect("a positive cell size");
        group.throughput(Throughput::Elements(rows.len() as u64));
        group.bench_function(BenchmarkId::new("build", count), |bencher| {
            bencher.iter(|| CellList::build(&grid, black_box(&rows.positions), &rows.ids));
        });
        // What a simulation does: sorted particles, and memory that is there.
        let (sorted, grid) = rows.sorted(reach);
        let mut cells = CellList::build(&grid, &sorted.positions, &sorted.ids);
        group.bench_function(BenchmarkId::new("rebuild-sorted", count), |bencher| {
            bencher.iter(|| cells.rebuild(&grid, black_box(&sorted.positions), &sorted.ids));
        });
    }
    group.finish();
}

criterion_group!(benches, cells);
criterion_main!(benches);
