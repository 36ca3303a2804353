//! When to divide anew.

use crate::{CommError, Communicator};

/// How evenly a cost is spread over the ranks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Imbalance {
    /// The largest cost of a rank.
    pub max: f64,
    /// The mean cost.
    pub mean: f64,
    /// The rank with the largest cost; the first of equals.
    pub slowest: usize,
}

impl Imbalance {
    /// Gathers the cost of every rank, for example the measured seconds of its sweeps. Collective,
    /// with the same result on all ranks.
    pub fn measure<C: Communicator>(comm: &C, cost: f64) -> Result<Self, CommError> {
        let mut costs = Vec::with_capacity(comm.size());
        for (rank, bytes) in comm.all_gather(&cost.to_ne_bytes())?.into_iter().enumerate() {
            let (got, expected) = (bytes.len(), 8);
            let bytes: [u8; 8] =
                bytes.try_into().map_err(|_| CommError::WrongLength { rank, got, expected })?;
            costs.push(f64::from_ne_bytes(bytes));
        }
        Ok(Self::of(&costs))
    }

    /// The imbalance of these costs, in rank order.
    pub fn of(costs: &[f64]) -> Self {
        let mean = costs.iter().sum::<f64>() / costs.len().max(1) as f64;
        let mut slowest = 0;
        for (rank, cost) in costs.iter().enumerate() {
            if *cost > costs[slowest] {
                slowest = rank;
            }
        }
        Self { max: costs.get(slowest).copied().unwrap_or(0.0), mean, slowest }
    }

    /// Largest over mean cost: 1 is perfect, and the run takes this many times longer than it
    /// could.
    pub fn ratio(&self) -> f64 {
        if self.mean > 0.0 { self.max / self.mean } else { 1.0 }
    }
}

/// Decides when to divide the particles anew: with a threshold, and with hysteresis against
/// dividing again and again for what a new partition cannot mend.
///
/// ```
/// use sph_decomp::Rebalance;
///
/// let mut rebalance = Rebalance::new(1.05);
/// assert!(!rebalance.due(1.04));
/// assert!(rebalance.due(1.20));
/// // The new partition reached only 1.10. That is its best: not due again …
/// assert!(!rebalance.due(1.10));
/// assert!(!rebalance.due(1.12));
/// // … until it has become worse by as much as the threshold allows.
/// assert!(rebalance.due(1.16));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rebalance {
    threshold: f64,
    /// What the last partition reached, or nothing when it has not been measured yet.
    reached: Option<f64>,
}

impl Rebalance {
    /// Tolerates an imbalance of `threshold` (largest over mean cost, such as 1.05).
    pub fn new(threshold: f64) -> Self {
        Self { threshold, reached: Some(1.0) }
    }

    /// Whether to divide anew at this imbalance. The first call after a division notes what that
    /// division has reached.
    ///
    /// Every rank must give the same number ([`Imbalance::measure`] does), so that all divide at
    /// the same time.
    pub fn due(&mut self, imbalance: f64) -> bool {
        let reached = *self.reached.get_or_insert(imbalance);
        // A partition may get better by itself; then that is the mark.
        let reached = reached.min(imbalance).max(1.0);
        self.reached = Some(reached);
        let due = imbalance > reached * self.threshold;
        if due {
            self.reached = None;
        }
        due
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slowest_rank_counts() {
        let imbalance = Imbalance::of(&[1.0, 3.0, 2.0]);
        assert_eq!(imbalance, Imbalance { max: 3.0, mean: 2.0, slowest: 1 });
        assert_eq!(imbalance.ratio(), 1.5);
        assert_eq!(Imbalance::of(&[0.0, 0.0]).ratio(), 1.0);
    }
}
