//! Which bytes leave a node.

use super::load::Layout;
use super::network::Network;

/// What a rank and its node exchange in a pass, in elements of messages.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RankTraffic {
    /// Elements that the rank sends to ranks of its own node: copied in memory.
    pub inside: f64,
    /// Elements that all ranks of the node send to other nodes.
    pub node_out: f64,
    /// Elements that all ranks of the node receive from other nodes.
    pub node_in: f64,
}

impl RankTraffic {
    /// The traffic of every rank, consecutive ranks sharing a node. Consecutive ranks of a bisection
    /// are neighbours in space, so that much of what they send stays inside.
    pub fn of(layout: &Layout, net: &Network) -> Vec<Self> {
        let node = |rank: u32| (f64::from(rank) / net.ranks_per_node) as usize;
        let nodes = layout.ranks.len().checked_sub(1).map_or(0, |last| node(last as u32) + 1);
        let (mut leaving, mut coming) = (vec![0.0; nodes], vec![0.0; nodes]);
        let mut ranks = vec![Self::default(); layout.ranks.len()];
        for link in &layout.links {
            let (from, to) = (node(link.from), node(link.to));
            if from == to {
                ranks[link.from as usize].inside += link.elements;
            } else {
                leaving[from] += link.elements;
                coming[to] += link.elements;
            }
        }
        for (rank, traffic) in (0..).zip(&mut ranks) {
            traffic.node_out = leaving[node(rank)];
            traffic.node_in = coming[node(rank)];
        }
        ranks
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scale::{BlockClass, LatticeBlock};

    #[test]
    fn nodes_exchange_what_their_ranks_do() {
        // Four ranks in a line, two per node: only the middle link leaves a node.
        let line = LatticeBlock { first: [0, 0], end: [40, 1], class: 0 };
        let class = BlockClass { active: true, density: 1.0, cost: 1.0, pairs: 6.0 };
        let layout = Layout::of_blocks(4, vec![line], &[class], 3.3).unwrap();
        let net = Network { ranks_per_node: 2.0, ..Network::GEMINI };
        let traffic = RankTraffic::of(&layout, &net);
        assert_eq!(traffic.len(), 4);
        assert!(traffic.iter().all(|rank| (rank.node_out, rank.node_in) == (3.0, 3.0)));
        assert!(traffic.iter().all(|rank| rank.inside == 3.0));
        let single = Network { ranks_per_node: 1.0, ..net };
        assert_eq!(RankTraffic::of(&layout, &single)[1].node_out, 6.0);
        assert!(RankTraffic::of(&Layout::default(), &net).is_empty());
    }
}
