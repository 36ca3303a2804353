//! The arithmetic peak of one core.

use sph_kernels::{Lanes, Real, Vectorized};
use std::hint::black_box;

/// Independent chains: more than latency × units of fused multiply-add on current cores, and few
/// enough for 16 registers with the two constants.
const CHAINS: usize = 12;

/// Does `rounds` multiply-adds in each lane of each chain, with the lanes that the solver uses, and
/// returns the floating-point operations done. Time it for the peak: one multiply-add is two
/// operations.
pub fn fma_flops<S: Real>(rounds: u64) -> f64 {
    let lanes = S::dispatch(Chains {
        rounds: black_box(rounds),
        factor: black_box(S::from_f64(0.999)),
        summand: black_box(S::from_f64(0.001)),
    });
    2.0 * rounds as f64 * (CHAINS * lanes) as f64
}

struct Chains<S> {
    rounds: u64,
    factor: S,
    summand: S,
}

impl<S: Real> Vectorized for Chains<S> {
    type Scalar = S;
    type Output = usize;

    #[inline(always)]
    fn run<L: Lanes<Scalar = S>>(self) -> usize {
        let (factor, summand) = (L::splat(self.factor), L::splat(self.summand));
        let mut chains: [L; CHAINS] =
            std::array::from_fn(|k| L::splat(S::from_f64(1.0 + k as f64)));
        for _ in 0..self.rounds {
            for chain in &mut chains {
                *chain = chain.mul_add(factor, summand);
            }
        }
        let mut sum = L::zero();
        chains.iter().for_each(|chain| sum += *chain);
        black_box(sum.sum());
        L::LANES
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_every_lane_of_every_chain() {
        assert_eq!(fma_flops::<f32>(10), 2.0 * 10.0 * 12.0 * 8.0);
        assert_eq!(fma_flops::<f64>(10), 2.0 * 10.0 * 12.0 * 4.0);
    }
}
