//! Building the overlap zone between two ranks that are threads of this process.
#![allow(missing_docs, reason = "criterion's macros make public items")]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use sph_benches::Lattice;
use sph_decomp::{MaxReach, Reach, ThreadRanks, Zone, ZoneError, ZoneOptions};
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Support radius and skin, in spacings.
const REACH: f64 = 3.3;

/// Seconds of the slowest rank for `times` builds of the zone between the halves of a cube.
fn build(halves: &[Vec<[f64; 3]>; 2], reach: f64, times: u64) -> Duration {
    let ranks = ThreadRanks::run(2, |comm| {
        let positions = &halves[sph_decomp::Communicator::rank(&comm)];
        let options = ZoneOptions::default();
        let start = Instant::now();
        for _ in 0..times {
            let reach = Reach::Uniform(reach);
            black_box(Zone::build(&comm, black_box(positions), reach, MaxReach, &options)?);
        }
        Ok::<_, ZoneError>(start.elapsed())
    });
    ranks.expect("ranks that do not fail").into_iter().max().unwrap_or_default()
}

fn zone(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("zone");
    group.sample_size(10);
    for count in [10_000, 100_000] {
        let lattice = Lattice::cube(count);
        let reach = REACH * lattice.spacing;
        let (lattice, _) = lattice.sorted(reach);
        let middle = 0.5 * (count as f64).cbrt() * lattice.spacing;
        let (left, right) = lattice.positions.iter().partition(|x| x[0] < middle);
        let halves = [left, right];
        group.throughput(Throughput::Elements(lattice.len() as u64));
        group.bench_function(BenchmarkId::new("build", count), |bencher| {
            bencher.iter_custom(|times| build(&halves, reach, times));
        });
    }
    group.finish();
}

criterion_group!(benches, zone);
criterion_main!(benches);
