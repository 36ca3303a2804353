//! Packing and unpacking the messages of the force pass, and an exchange of this rank with itself.
#![allow(missing_docs, reason = "criterion's macros make public items")]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use sph_decomp::{Halo, HaloPlan, Solo};
use sph_solver::records::{Record, motion, record};
use std::hint::black_box;

fn halo(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("halo");
    for count in [1_000_u32, 20_000] {
        // Every third of the particles is sent: a zone is scattered over the cells it touches.
        let mut records: Vec<Record<f32>> = (0..3 * count).map(|i| [i as f32; 8]).collect();
        let sends = vec![(0, (0..count).map(|i| 3 * i).collect())];
        let plan = HaloPlan::new(&Solo, sends).expect("no ranks to disagree with");
        let mut send = vec![[0.0; 6]; plan.send_count()];
        group.throughput(Throughput::Bytes(24 * u64::from(count)));
        group.bench_function(BenchmarkId::new("pack", count), |bencher| {
            bencher.iter(|| plan.pack(black_box(&mut send), |i| motion(&records[i as usize])));
        });
        let mut halo = Halo::<[f32; 6]>::new();
        group.bench_function(BenchmarkId::new("exchange-with-itself", count), |bencher| {
            bencher.iter(|| {
                let element = |i: u32| motion(&records[i as usize]);
                halo.exchange_now(&Solo, &plan, element).expect("nobody to fail").len()
            });
        });
        let received = send.clone();
        group.bench_function(BenchmarkId::new("unpack", count), |bencher| {
            let records = &mut records;
            bencher.iter(|| {
                plan.unpack(black_box(&received), |slot, message| {
                    let [.., quantity, volume] = records[slot];
                    records[slot] = record(*message, quantity, volume);
                });
            });
        });
    }
    group.finish();
}

criterion_group!(benches, halo);
criterion_main!(benches);
