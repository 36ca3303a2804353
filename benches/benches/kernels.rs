//! Slopes of all kernels on 4096 distances in cache: one lane, portable lanes, AVX2 lanes.
#![allow(missing_docs, reason = "criterion's macros make public items")]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use sph_kernels::{
    CubicSpline, Gaussian, Kernel, Lanes, QuinticSpline, Real, Vectorized, WendlandC2, WendlandC4,
    WendlandC6,
};
use std::hint::black_box;
use std::marker::PhantomData;

const COUNT: usize = 4096;

/// Slopes at `q`, into `slopes`.
struct Slopes<'a, K, S> {
    q: &'a [S],
    slopes: &'a mut [S],
    kernel: PhantomData<K>,
}

impl<K: Kernel, S: Real> Vectorized for Slopes<'_, K, S> {
    type Scalar = S;
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes<Scalar = S>>(self) {
        let q = self.q.chunks_exact(L::LANES);
        for (q, slopes) in q.zip(self.slopes.chunks_exact_mut(L::LANES)) {
            K::slope(L::load(q)).store(slopes);
        }
    }
}

fn kernel<K: Kernel, S: Real>(criterion: &mut Criterion, scalar: &str) {
    let mut group = criterion.benchmark_group(format!("kernel/{}/{scalar}", K::NAME));
    group.throughput(Throughput::Elements(COUNT as u64));
    // One in five is outside of the support, as in a list with a skin.
    let q: Vec<S> = (0..COUNT).map(|i| S::from_f64(1.25 * i as f64 / COUNT as f64)).collect();
    let mut slopes = vec![S::default(); COUNT];
    let mut measure = |name: &str, run: fn(Slopes<'_, K, S>)| {
        group.bench_function(BenchmarkId::from_parameter(name), |bencher| {
            bencher.iter(|| {
                let slopes = black_box(slopes.as_mut_slice());
                run(Slopes { q: black_box(&q), slopes, kernel: PhantomData });
            });
        });
    };
    measure("scalar", |slopes| slopes.run::<S>());
    measure("portable", |slopes| S::dispatch_portable(slopes));
    if sph_kernels::simd_level() != "portable" {
        measure(sph_kernels::simd_level(), |slopes| S::dispatch(slopes));
    }
    group.finish();
}

fn kernels(criterion: &mut Criterion) {
    both::<WendlandC2>(criterion);
    both::<WendlandC4>(criterion);
    both::<WendlandC6>(criterion);
    both::<CubicSpline>(criterion);
    both::<QuinticSpline>(criterion);
    both::<Gaussian>(criterion);
}

fn both<K: Kernel>(criterion: &mut Criterion) {
    kernel::<K, f32>(criterion, "f32");
    kernel::<K, f64>(criterion, "f64");
}

criterion_group!(benches, kernels);
criterion_main!(benches);
