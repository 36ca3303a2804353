//! Arithmetic and memory of the machine.

use crate::Effort;
use serde::Serialize;
use sph_benches::{Clock, Triad, fma_flops, median, triad_bytes};
use sph_kernels::{Real, simd_level};
use sph_solver::team::Team;
use std::error::Error;

/// Limits of the machine.
#[derive(Debug, Serialize)]
pub struct Machine {
    /// Lanes that the solver uses here.
    pub simd: String,
    /// Cores that this process may use.
    pub cores: usize,
    /// Multiply-adds in single precision, GFLOP/s of one core.
    pub fma_single: f64,
    /// The same in double precision.
    pub fma_double: f64,
    /// Triad on one core, GB/s.
    pub triad_one: f64,
    /// Triad on two threads, GB/s of wall time.
    pub triad_two: f64,
}

/// Operations per core second of one core.
pub fn peak<S: Real>(seconds: f64) -> f64 {
    let mut flops = 0.0;
    let spent = Clock::repeat(1, seconds, || flops = fma_flops::<S>(1 << 20));
    flops / spent.core
}

/// Measures all limits.
pub fn measure(effort: Effort) -> Result<Machine, Box<dyn Error>> {
    let rounds = |mut one: Box<dyn FnMut() -> f64>| median((0..effort.rounds).map(|_| one()));
    // 128 MiB an array; in a quick run still more than the caches of most machines.
    let length = if effort.quick { 1 << 22 } else { 1 << 24 };
    let triad = |threads: usize| -> Result<f64, Box<dyn Error>> {
        let team = Team::new(threads)?;
        let mut arrays = Triad::new(length);
        triad_bytes(&team, &mut arrays);
        Ok(rounds(Box::new(move || {
            let mut bytes = 0.0;
            let spent =
                Clock::repeat(2, effort.seconds, || bytes = triad_bytes(&team, &mut arrays));
            bytes / if threads == 1 { spent.core } else { spent.wall }
        })))
    };
    Ok(Machine {
        simd: simd_level().to_owned(),
        cores: std::thread::available_parallelism()?.get(),
        fma_single: 1e-9 * rounds(Box::new(|| peak::<f32>(effort.seconds))),
        fma_double: 1e-9 * rounds(Box::new(|| peak::<f64>(effort.seconds))),
        triad_one: 1e-9 * triad(1)?,
        triad_two: 1e-9 * triad(2)?,
    })
}
