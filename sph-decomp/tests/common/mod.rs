//! Clouds of particles for the tests.
#![allow(dead_code, reason = "each test program uses a part of it")]

pub mod graded;
pub mod scenario;

use proptest::prelude::*;
use sph_decomp::{Communicator, HilbertCurve, Orb, Partition, PartitionError, ThreadRanks};

/// Particles with their reaches.
#[derive(Debug, Clone)]
pub struct Cloud<const D: usize> {
    pub positions: Vec<[f64; D]>,
    pub reach: Vec<f64>,
}

/// Numbers in [0, 1) from a seed: the same in every run.
pub fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

impl<const D: usize> Cloud<D> {
    /// A lattice of `side` particles per axis in the unit box, moved by up to `jitter` spacings,
    /// that see three spacings far; `grading` times farther at the high end of the first axis.
    pub fn lattice(side: usize, spacing: f64, jitter: f64, grading: f64, seed: u64) -> Self {
        let mut random = random(seed);
        let mut cloud = Self { positions: vec![], reach: vec![] };
        for number in 0..side.pow(D as u32) {
            let x: [f64; D] = std::array::from_fn(|axis| {
                let cell = number / side.pow(axis as u32) % side;
                (cell as f64 + 0.5 + jitter * (random() - 0.5)) * spacing
            });
            cloud.reach.push(3.0 * spacing * grading.powf(x[0] - 1.0));
            cloud.positions.push(x);
        }
        cloud
    }

    /// Four slabs of a bar, each with half the spacing and reach of the one before.
    pub fn graded(seed: u64) -> Self {
        let mut random = random(seed);
        let mut cloud = Self { positions: vec![], reach: vec![] };
        let mut start = 0.0;
        for (width, spacing) in [(0.5, 0.1), (0.25, 0.05), (0.15, 0.025), (0.1, 0.0125)] {
            let cells: [usize; D] = std::array::from_fn(|axis| {
                (if axis == 0 { width } else { 0.4 } / spacing) as usize
            });
            for mut number in 0..cells.iter().product() {
                let x: [f64; D] = std::array::from_fn(|axis| {
                    let cell = number % cells[axis];
                    number /= cells[axis];
                    let origin = if axis == 0 { start } else { 0.0 };
                    origin + (cell as f64 + 0.5 + 0.4 * (random() - 0.5)) * spacing
                });
                cloud.positions.push(x);
                cloud.reach.push(3.0 * spacing);
            }
            start += width;
        }
        cloud
    }

    /// The distance of two particles, to the nearest image on periodic axes.
    pub fn distance(&self, i: usize, j: usize, period: &[Option<f64>; D]) -> f64 {
        let mut sum = 0.0;
        for (axis, length) in period.iter().enumerate() {
            let d = (self.positions[i][axis] - self.positions[j][axis]).abs();
            let d = length.map_or(d, |length| d.min(length - d));
            sum += d * d;
        }
        sum.sqrt()
    }
}

/// Clouds of up to 120 particles in a box of side 1, with reaches 1:8: scattered, in clusters,
/// flat in one direction, or on a coarse lattice where many coordinates are equal.
pub fn clouds<const D: usize>() -> impl Strategy<Value = Cloud<D>> {
    (0_usize..120, 0_u8..4, any::<u64>()).prop_map(|(count, kind, seed)| {
        let mut random = random(seed);
        let centres: Vec<[f64; D]> = (0..4).map(|_| std::array::from_fn(|_| random())).collect();
        let positions = (0..count).map(|i| {
            std::array::from_fn(|axis| match kind {
                0 => random(),
                1 => centres[i % 4][axis] + 0.03 * random(),
                2 if axis + 1 == D => 0.02 * random(),
                2 => random(),
                _ => (random() * 6.0).floor() / 6.0,
            })
        });
        let positions: Vec<[f64; D]> = positions.collect();
        let reach = positions.iter().map(|_| 0.04 * 8.0_f64.powf(random())).collect();
        Cloud { positions, reach }
    })
}

/// Divides a cloud: 0 by bisection, 1 along a Hilbert curve, 2 at random, 3 all but a few to one.
pub fn owners<const D: usize>(cloud: &Cloud<D>, ranks: usize, split: u8) -> Vec<usize> {
    let positions = &cloud.positions;
    // A partition does not depend on who holds the particles, so rank 0 may hold them all.
    let all = |rank: usize| if rank == 0 { &positions[..] } else { &[] };
    let by_partition = |hilbert: bool| {
        ThreadRanks::run(ranks, |comm| {
            let mine = all(comm.rank());
            Ok::<_, PartitionError>(if hilbert {
                HilbertCurve::build(&comm, mine, &[])?.owners(mine)
            } else {
                Orb::build(&comm, mine, &[])?.owners(mine)
            })
        })
        .expect("the partition is built")
        .swap_remove(0)
    };
    match split {
        0 | 1 => by_partition(split == 1).into_iter().map(|rank| rank as usize).collect(),
        2 => (0..positions.len()).map(|i| i * 7919 % 104_729 % ranks).collect(),
        _ => (0..positions.len()).map(|i| if i % 50 == 7 { ranks - 1 } else { 0 }).collect(),
    }
}
