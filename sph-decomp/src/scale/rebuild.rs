//! What rebuilds of lists, zones and partitions cost.

use super::load::RankLoad;
use super::network::Network;
use super::traffic::RankTraffic;

/// How often a run rebuilds, and what it computes then.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rebuilds {
    /// Share of the time of one rank that goes into rebuilds: search, sorting, lists.
    pub share: f64,
    /// Steps between two rebuilds.
    pub steps: f64,
    /// Rebuilds between two partitions.
    pub per_partition: f64,
}

/// Bytes of the whole state of a particle that is sent at a rebuild.
const STATE_BYTES: f64 = 80.0;
/// Bytes of a block summary (two corners and a reach in three dimensions) and particles per block.
const BLOCK_BYTES: f64 = 56.0;
const PER_BLOCK: f64 = 4.0;
/// Exchanges with whoever has something to say: migration, blocks, plan, state.
const EXCHANGES: f64 = 4.0;
/// Rounds of the search for a cut, each with an all-reduce of 64 eight-byte bins per region; and
/// all-reduces of boxes, weights and neighbours of the cut besides.
const CUT_ROUNDS: f64 = 7.0;
const BIN_BYTES: f64 = 64.0 * 8.0;
const SHORT_ROUNDS: f64 = 3.0;

impl Rebuilds {
    /// Computing for rebuilds, s per step, of a rank whose passes take `compute` seconds per step.
    pub(super) fn computing(&self, compute: f64) -> f64 {
        compute * self.share / (1.0 - self.share)
    }

    /// Communication for rebuilds, none of it hidden, s per step.
    ///
    /// A rebuild gathers the boxes of all ranks, tells who will send (a word per rank, four times),
    /// and sends blocks and the state of the outer particles. A partition makes seven histograms per
    /// level of the bisection, of 64 bins for each region of the level.
    pub(super) fn communicating(
        &self,
        load: &RankLoad,
        traffic: &RankTraffic,
        net: &Network,
        ranks: usize,
    ) -> f64 {
        if ranks == 1 {
            return 0.0;
        }
        let p = ranks as f64;
        let messages = load.messages_in.max(load.messages_out);
        // Passive particles need to travel at partitions only; they are few beside what a node
        // exchanges, and counted here they err on the safe side.
        let elements = traffic.node_in.max(traffic.node_out) + load.outer_passive;
        let bytes = elements * (STATE_BYTES + BLOCK_BYTES / PER_BLOCK);
        let each = net.gathering(BLOCK_BYTES * p, ranks)
            + EXCHANGES * net.gathering(8.0 * p, ranks)
            + net.transfer(messages, bytes);
        let levels = p.log2().ceil();
        let partition = CUT_ROUNDS * net.long_reduction(0.0, ranks) * levels
            + CUT_ROUNDS * 2.0 * BIN_BYTES * p / net.node_bandwidth
            + SHORT_ROUNDS * levels * net.short_reduction(ranks);
        each / self.steps + partition / (self.steps * self.per_partition)
    }
}
