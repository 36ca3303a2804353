//! Keeps the measured cost even: what particles cost, and when to divide anew.

use bytemuck::{Pod, Zeroable};

use super::{Imbalance, Rebalance};
use crate::{CommError, Communicator};

/// What a rank did between two rebuilds.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
#[repr(C)]
pub struct Load {
    /// Predicted cost of one step, in any unit: the sum over the owned particles of what is known
    /// of them, such as the lengths of their neighbour lists. Finite and not negative.
    pub predicted: f64,
    /// Measured seconds of the sweeps of all these steps, or 0 where nothing was measured.
    pub seconds: f64,
    /// Steps since the last rebuild, the same on all ranks.
    pub steps: u64,
}

/// What a [`Balancer`] has found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Review {
    /// Whether to divide the particles anew, now. The same on all ranks.
    pub divide: bool,
    /// What a unit of predicted cost really costs on this rank, relative to the mean of all ranks:
    /// the weight of a particle is its predicted cost times this.
    pub rate: f64,
}

/// How evenly the cost was spread over a run. All means are over steps.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Evenness {
    /// Mean of largest over mean predicted cost: does not depend on clocks.
    pub predicted: f64,
    /// Mean of largest over mean measured seconds; `None` when nothing was measured.
    pub measured: Option<f64>,
    /// How often the particles were divided; never on one rank.
    pub partitions: u64,
}

/// Decides at rebuilds whether to divide the particles anew, and with which weights.
///
/// The weight of a particle is its predicted cost times the *rate* of its rank: measured seconds
/// per predicted cost, relative to the mean of all ranks and smoothed exponentially in time, so that a slow processor or a poor prediction shows and a disturbance does not. The
/// particles are divided anew when the imbalance of predicted cost times rate exceeds a threshold,
/// with the hysteresis of [`Rebalance`].
///
/// A review is one small gathering of all ranks, at rebuilds only; on one rank it is nothing.
///
/// ```
/// use sph_decomp::{Balancer, CommError, Communicator, Load, ThreadRanks};
///
/// let reviews = ThreadRanks::run(2, |comm| {
///     let mut balancer = Balancer::new(1.05);
///     // The first review asks for the first partition.
///     assert!(balancer.review(&comm, Load::default())?.divide);
///     // Even by prediction, but rank 1 takes three times as long.
///     let seconds = if comm.rank() == 1 { 0.03 } else { 0.01 };
///     balancer.review(&comm, Load { predicted: 100.0, seconds, steps: 20 })
/// });
/// let [fast, slow] = reviews?[..] else { panic!("two ranks") };
/// assert!(fast.divide && slow.divide && slow.rate > 1.1 && fast.rate < 0.9);
/// # Ok::<_, sph_decomp::RanksError<CommError>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Balancer {
    rebalance: Rebalance,
    /// The smoothed rate of every rank, the same on all ranks. Empty before the first review.
    rates: Vec<f64>,
    partitions: u64,
    predicted: Mean,
    measured: Mean,
}

/// A mean over steps.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Mean {
    sum: f64,
    steps: u64,
}

impl Mean {
    fn add(&mut self, value: f64, steps: u64) {
        self.sum += value * steps as f64;
        self.steps += steps;
    }

    fn get(self) -> Option<f64> {
        (self.steps > 0).then(|| self.sum / self.steps as f64)
    }
}

/// Steps after which a measurement counts 1/e: a time of few steps is noisier than one of many.
const MEMORY: f64 = 50.0;

/// Rates are believed within this factor. A rank with a handful of particles spends its time on
/// anything but them, and must not take their cost for a thousand times that of others.
const CREDIBLE: f64 = 4.0;

impl Balancer {
    /// Tolerates an imbalance of `threshold` (largest over mean cost, such as 1.05) beyond the best
    /// that the present partition has reached.
    pub fn new(threshold: f64) -> Self {
        Self {
            rebalance: Rebalance::new(threshold),
            rates: Vec::new(),
            partitions: 0,
            predicted: Mean::default(),
            measured: Mean::default(),
        }
    }

    /// Looks at what all ranks did since the last review. Collective, with the same answer on all
    /// ranks whether to divide. The caller divides when told to.
    pub fn review<C: Communicator>(&mut self, comm: &C, load: Load) -> Result<Review, CommError> {
        if comm.size() == 1 {
            self.predicted.add(1.0, load.steps);
            if load.seconds > 0.0 {
                self.measured.add(1.0, load.steps);
            }
            return Ok(Review { divide: false, rate: 1.0 });
        }
        let mut loads = Vec::with_capacity(comm.size());
        for (rank, bytes) in comm.all_gather(bytemuck::bytes_of(&load))?.into_iter().enumerate() {
            let (got, expected) = (bytes.len(), size_of::<Load>());
            let one: Load = bytemuck::try_pod_read_unaligned(&bytes)
                .map_err(|_| CommError::WrongLength { rank, got, expected })?;
            loads.push(one);
        }
        let divide = self.consider(&loads);
        Ok(Review { divide, rate: self.rates[comm.rank()] })
    }

    /// What was found over the run so far.
    pub fn evenness(&self) -> Evenness {
        Evenness {
            predicted: self.predicted.get().unwrap_or(1.0),
            measured: self.measured.get(),
            partitions: self.partitions,
        }
    }

    /// The decision, from the loads of all ranks.
    fn consider(&mut self, loads: &[Load]) -> bool {
        let first = self.rates.is_empty();
        if first {
            self.rates = vec![1.0; loads.len()];
        }
        let predicted: Vec<f64> = loads.iter().map(|load| load.predicted).collect();
        let seconds: Vec<f64> = loads.iter().map(|load| load.seconds).collect();
        let steps = loads[0].steps;
        if steps > 0 {
            self.predicted.add(Imbalance::of(&predicted).ratio(), steps);
        }
        let (cost, time) = (predicted.iter().sum::<f64>(), seconds.iter().sum::<f64>());
        if steps > 0 && cost > 0.0 && time > 0.0 {
            self.measured.add(Imbalance::of(&seconds).ratio(), steps);
            let new = 1.0 - (-(steps as f64) / MEMORY).exp();
            for (rate, load) in self.rates.iter_mut().zip(loads) {
                // An empty rank has nothing to measure and keeps what is known of it.
                if load.predicted > 0.0 && load.seconds > 0.0 {
                    let measured = load.seconds / load.predicted * (cost / time);
                    let measured = measured.clamp(1.0 / CREDIBLE, CREDIBLE);
                    *rate += new * (measured - *rate);
                }
            }
        }
        let expected: Vec<f64> = predicted.iter().zip(&self.rates).map(|(p, r)| p * r).collect();
        let divide = first || self.rebalance.due(Imbalance::of(&expected).ratio());
        self.partitions += u64::from(divide);
        divide
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Solo;

    fn loads(predicted: &[f64], seconds: &[f64]) -> Vec<Load> {
        let load = |(&predicted, &seconds)| Load { predicted, seconds, steps: 10 };
        predicted.iter().zip(seconds).map(load).collect()
    }

    #[test]
    fn one_rank_never_divides() {
        let mut balancer = Balancer::new(1.05);
        let load = Load { predicted: 7.0, seconds: 0.0, steps: 3 };
        for _ in 0..3 {
            let review = balancer.review(&Solo, load);
            assert_eq!(review, Ok(Review { divide: false, rate: 1.0 }));
        }
        let evenness = Evenness { predicted: 1.0, measured: None, partitions: 0 };
        assert_eq!(balancer.evenness(), evenness);
    }

    #[test]
    fn a_disturbance_does_not_show_but_a_slow_rank_does() {
        let mut balancer = Balancer::new(1.15);
        assert!(balancer.consider(&loads(&[10.0; 4], &[0.0; 4])));
        let calm = loads(&[10.0; 4], &[1.0; 4]);
        let slow = loads(&[10.0; 4], &[1.0, 1.0, 1.0, 1.5]);
        for _ in 0..20 {
            assert!(!balancer.consider(&calm));
        }
        assert!(!balancer.consider(&slow), "once is a disturbance");
        assert!((0..12).any(|_| balancer.consider(&slow)), "always is a slow rank");
        let exact = 1.5 * 40.0 / 45.0;
        for _ in 0..40 {
            balancer.consider(&slow);
        }
        assert!((balancer.rates[3] - exact).abs() < 1e-3, "{:?}", balancer.rates);
        // Now the particles of rank 3 weigh more, so it gets fewer of them.
        let share = [10.0, 10.0, 10.0, 10.0 / 1.5];
        let even = loads(&share, &[1.0; 4]);
        for _ in 0..20 {
            balancer.consider(&even);
        }
        assert!(!balancer.consider(&even));
    }

    #[test]
    fn prediction_alone_decides_where_nothing_is_measured() {
        let mut balancer = Balancer::new(1.05);
        balancer.consider(&loads(&[0.0; 2], &[0.0; 2]));
        assert!(!balancer.consider(&loads(&[100.0, 98.0], &[0.0; 2])));
        assert!(balancer.consider(&loads(&[100.0, 80.0], &[0.0; 2])));
        let evenness = balancer.evenness();
        assert_eq!((evenness.measured, evenness.partitions), (None, 2));
        let mean = (100.0 / 99.0 + 100.0 / 90.0 + 1.0) / 3.0;
        assert!((evenness.predicted - mean).abs() < 1e-12, "{evenness:?}");
    }

    #[test]
    fn empty_ranks_and_absurd_times_are_taken_calmly() {
        let mut balancer = Balancer::new(1.05);
        for _ in 0..50 {
            balancer.consider(&loads(&[0.0, 1e-9, 10.0], &[0.0, 1.0, 1.0]));
        }
        assert_eq!(balancer.rates[0], 1.0);
        assert!(balancer.rates[1] <= CREDIBLE && balancer.rates[2] >= 1.0 / CREDIBLE);
    }
}
