//! Collective operations in the LogGP model.

use super::network::Network;

/// Rounds of a tree over so many ranks.
fn rounds(ranks: usize) -> f64 {
    f64::from(ranks.max(1).next_power_of_two().trailing_zeros())
}

impl Network {
    /// An all-reduce of few words by recursive doubling: log₂ P rounds of one short message each,
    /// `o + L + o` (Thakur, Rabenseifner and Gropp, *Optimization of collective communication
    /// operations in MPICH*, 2005), s.
    pub fn short_reduction(&self, ranks: usize) -> f64 {
        rounds(ranks) * (self.latency + 2.0 * self.overhead)
    }

    /// An all-reduce of many bytes: the ranks of a node first, then a reduce-scatter and an
    /// all-gather between nodes, each of which moves all bytes once (Rabenseifner 2004), s.
    pub fn long_reduction(&self, bytes: f64, ranks: usize) -> f64 {
        2.0 * self.short_reduction(ranks) + 2.0 * bytes / self.node_bandwidth
    }

    /// A reduce-scatter or an all-gather with so many bytes in the end, s.
    pub fn gathering(&self, bytes: f64, ranks: usize) -> f64 {
        self.short_reduction(ranks) + bytes / self.node_bandwidth
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trees_have_the_logarithm_of_the_ranks_as_height() {
        assert_eq!([1, 2, 3, 8, 9, 32768].map(rounds), [0.0, 1.0, 2.0, 3.0, 4.0, 15.0]);
        let seconds = Network::GEMINI.short_reduction(32768);
        assert!((seconds - 15.0 * 2.5e-6).abs() < 1e-12);
    }
}
