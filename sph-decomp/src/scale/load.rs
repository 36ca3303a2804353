//! What a rank holds, computes and sends.

use crate::Imbalance;

/// The numbers of one rank. Counts may be fractions when blocks of a lattice stand for particles.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RankLoad {
    /// Active particles that no other rank needs.
    pub local: f64,
    /// Active particles that some other rank needs.
    pub inner: f64,
    /// Active particles of other ranks that this rank needs.
    pub outer: f64,
    /// Passive particles of this rank.
    pub passive: f64,
    /// Passive particles of other ranks that this rank needs: those near its active particles. A run
    /// that sends them once, before active particles move, sends those near its piece of space, which
    /// are more.
    pub outer_passive: f64,
    /// Elements of the messages of a pass: one per inner particle and receiver.
    pub sent: f64,
    /// Messages that this rank sends in a pass.
    pub messages_out: u32,
    /// Messages that this rank receives in a pass.
    pub messages_in: u32,
    /// List entries of the local particles: pairs that a pass evaluates while messages travel.
    pub local_pairs: f64,
    /// List entries of the inner particles.
    pub inner_pairs: f64,
    /// Pairs of the outer passive particles, which a rank that computes these for itself repeats.
    pub repeated_pairs: f64,
    /// Cost by which the partition weighed this rank.
    pub cost: f64,
}

impl RankLoad {
    /// Active particles that the rank owns.
    pub fn active(&self) -> f64 {
        self.local + self.inner
    }

    /// Pairs that a pass evaluates.
    pub fn pairs(&self) -> f64 {
        self.local_pairs + self.inner_pairs
    }
}

/// What one rank sends to another in a pass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Link {
    /// The sender.
    pub from: u32,
    /// The receiver.
    pub to: u32,
    /// Elements of the message.
    pub elements: f64,
}

/// The loads of all ranks, in rank order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Layout {
    /// One per rank.
    pub ranks: Vec<RankLoad>,
    /// Who sends how much to whom in a pass, ordered by sender and receiver.
    pub links: Vec<Link>,
}

impl Layout {
    /// Ranks with these loads; the links say what they send to each other.
    pub(super) fn new(mut ranks: Vec<RankLoad>, mut links: Vec<Link>) -> Self {
        links.sort_unstable_by_key(|link| (link.from, link.to));
        for link in &links {
            let from = &mut ranks[link.from as usize];
            from.sent += link.elements;
            from.messages_out += 1;
            let to = &mut ranks[link.to as usize];
            to.outer += link.elements;
            to.messages_in += 1;
        }
        Self { ranks, links }
    }

    /// A sum over all ranks.
    pub fn sum(&self, number: impl Fn(&RankLoad) -> f64) -> f64 {
        self.ranks.iter().map(number).sum()
    }

    /// The largest over all ranks.
    pub fn max(&self, number: impl Fn(&RankLoad) -> f64) -> f64 {
        self.ranks.iter().map(number).fold(0.0, f64::max)
    }

    /// The smallest over all ranks.
    pub fn min(&self, number: impl Fn(&RankLoad) -> f64) -> f64 {
        self.ranks.iter().map(number).fold(f64::INFINITY, f64::min)
    }

    /// How evenly a number is spread.
    pub fn imbalance(&self, number: impl Fn(&RankLoad) -> f64) -> Imbalance {
        Imbalance::of(&self.ranks.iter().map(number).collect::<Vec<_>>())
    }

    /// Outer over owned active particles of all ranks: the share that is stored twice.
    pub fn redundancy(&self) -> f64 {
        let active = self.sum(RankLoad::active);
        if active > 0.0 { self.sum(|rank| rank.outer) / active } else { 0.0 }
    }
}
