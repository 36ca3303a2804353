//! Density and force sweep of δ-SPH on a jittered lattice, mixed and double precision, one thread.
//!
//! Elements are list entries within the support radius; the skin is a tenth of it.
#![allow(missing_docs, reason = "criterion's macros make public items")]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use sph_benches::{SweepCase, density_terms, force_terms};
use sph_kernels::Real;
use sph_solver::terms::{Acceleration, DensityRate};
use std::hint::black_box;

fn precision<S: Real>(criterion: &mut Criterion, name: &str) {
    let mut group = criterion.benchmark_group(format!("sweep/{name}"));
    group.sample_size(10);
    for count in [10_000, 60_000] {
        let case = SweepCase::<S>::new(count, 3.0, 0.1);
        let radius = case.scale.support_radius;
        group.throughput(Throughput::Elements(case.true_pairs));
        let mut rates = vec![DensityRate::default(); case.len()];
        group.bench_function(BenchmarkId::new("density", count), |bencher| {
            bencher.iter(|| case.density_sweep(density_terms(radius), black_box(&mut rates), None));
        });
        let mut rates = vec![Acceleration::default(); case.len()];
        group.bench_function(BenchmarkId::new("force", count), |bencher| {
            bencher.iter(|| case.force_sweep(force_terms(radius), black_box(&mut rates), None));
        });
    }
    group.finish();
}

fn sweeps(criterion: &mut Criterion) {
    precision::<f32>(criterion, "mixed");
    precision::<f64>(criterion, "double");
}

criterion_group!(benches, sweeps);
criterion_main!(benches);
