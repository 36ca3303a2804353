//! The time of a step on all ranks.

use super::load::{Layout, RankLoad};
use super::network::Network;
use super::step::{Rates, StepTime, Variant};
use super::traffic::RankTraffic;

/// What a layout means in seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction {
    /// Number of ranks.
    pub ranks: usize,
    /// Seconds of a step: of the slowest rank, because the time step is that of all.
    pub step: f64,
    /// The parts of that step.
    pub slowest: StepTime,
    /// Seconds of a step of the same particles on one rank.
    pub one_rank: f64,
    /// Largest over mean number of pairs.
    pub imbalance: f64,
}

impl Prediction {
    /// Predicts the step of a layout.
    ///
    /// Not in the model: noise of the operating system, contention on the links between nodes, the
    /// caches of cores that get few particles, output.
    pub fn of(layout: &Layout, rates: &Rates, net: &Network, variant: Variant) -> Self {
        let ranks = layout.ranks.len();
        let traffic = RankTraffic::of(layout, net);
        let times = layout.ranks.iter().zip(&traffic);
        let times =
            times.map(|(load, traffic)| StepTime::of(load, traffic, rates, net, ranks, variant));
        let slowest = times.fold(StepTime::default(), |slowest, time| {
            if time.total() > slowest.total() { time } else { slowest }
        });
        let compute = 2.0 * layout.sum(RankLoad::pairs) / rates.pairs;
        Self {
            ranks,
            step: slowest.total(),
            slowest,
            one_rank: compute + rates.rebuilds.computing(compute),
            imbalance: layout.imbalance(RankLoad::pairs).ratio(),
        }
    }

    /// How many times faster than on one rank.
    pub fn speedup(&self) -> f64 {
        if self.step > 0.0 { self.one_rank / self.step } else { 0.0 }
    }

    /// Speedup per rank: 1 is perfect.
    pub fn efficiency(&self) -> f64 {
        self.speedup() / self.ranks.max(1) as f64
    }

    /// Share of the step that the slowest rank waits in passes.
    pub fn exposed(&self) -> f64 {
        if self.step > 0.0 { self.slowest.exposed / self.step } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scale::{BlockClass, LatticeBlock, Rebuilds};

    #[test]
    fn efficiency_falls_with_ranks_and_without_overlap() {
        let rates = Rates {
            pairs: 1e9,
            packs: 1e8,
            element_bytes: [12.0, 24.0],
            rebuilds: Rebuilds { share: 0.3, steps: 10.0, per_partition: 20.0 },
        };
        let cube = LatticeBlock { first: [0; 3], end: [128; 3], class: 0 };
        let water = BlockClass { active: true, density: 1.0, cost: 1.0, pairs: 150.0 };
        let mut last = 1.0 + 1e-9;
        for ranks in [1, 8, 64, 512] {
            let layout = Layout::of_blocks(ranks, vec![cube], &[water], 3.3).unwrap();
            let of = |overlap| {
                let variant = Variant { overlap, ..Variant::BEST };
                Prediction::of(&layout, &rates, &Network::GEMINI, variant)
            };
            let (with, without) = (of(true), of(false));
            assert!(with.efficiency() < last, "{ranks} {}", with.efficiency());
            assert!(without.efficiency() <= with.efficiency());
            assert!((with.one_rank - 2.0 * 128_f64.powi(3) * 150.0 / 1e9 / 0.7).abs() < 1e-9);
            last = with.efficiency();
        }
        assert!(last > 0.5, "{last}");
    }
}
