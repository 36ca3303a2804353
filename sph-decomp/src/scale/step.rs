//! The time of a step on one rank.

use super::error::{ScaleError, positive};
use super::load::RankLoad;
use super::network::Network;
use super::rebuild::Rebuilds;
use super::traffic::RankTraffic;

/// What a core does per second, and what a pass sends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rates {
    /// List entries that a pass evaluates per second, everything of the pass included.
    pub pairs: f64,
    /// Elements of messages that are packed, or unpacked, per second.
    pub packs: f64,
    /// Bytes of an element in the density pass and in the force pass.
    pub element_bytes: [f64; 2],
    /// Rebuilds.
    pub rebuilds: Rebuilds,
}

impl Rates {
    /// Refuses numbers that are no rates.
    ///
    /// # Errors
    ///
    /// Names the first number that is out of range.
    pub fn check(&self) -> Result<(), ScaleError> {
        positive("pair rate", self.pairs, " of pairs per second")?;
        positive("pack rate", self.packs, " of elements per second")?;
        positive("element bytes", self.element_bytes[0].min(self.element_bytes[1]), "")?;
        positive("steps between rebuilds", self.rebuilds.steps, "")?;
        positive("rebuilds between partitions", self.rebuilds.per_partition, "")?;
        if (0.0..1.0).contains(&self.rebuilds.share) {
            return Ok(());
        }
        Err(ScaleError::NotPositive {
            name: "rebuild share",
            value: self.rebuilds.share,
            unit: " below 1",
        })
    }
}

/// How the program works.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Variant {
    /// Messages travel while local particles are computed; otherwise all is done one after another.
    pub overlap: bool,
    /// Every rank computes the passive particles within its reach for itself, as the paper's code did
    /// with boundaries.
    pub repeats_walls: bool,
}

impl Variant {
    /// Overlapped, nothing done twice.
    pub const BEST: Self = Self { overlap: true, repeats_walls: false };
}

/// Seconds of a step on one rank.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StepTime {
    /// Pairs of both passes.
    pub compute: f64,
    /// Pairs that other ranks compute as well.
    pub repeated: f64,
    /// Packing, unpacking and the overhead of messages: work of the core that overlap cannot hide.
    pub messages: f64,
    /// Waiting for messages, and for the reduction of the time step.
    pub exposed: f64,
    /// Computing for rebuilds.
    pub rebuild: f64,
    /// Communication for rebuilds.
    pub rebuild_messages: f64,
}

impl StepTime {
    /// All of it.
    pub fn total(&self) -> f64 {
        self.compute
            + self.repeated
            + self.messages
            + self.exposed
            + self.rebuild
            + self.rebuild_messages
    }

    /// The time of a step on a rank with this load, one of `ranks`.
    ///
    /// A step is two passes. In each the inner particles are computed and packed, their messages
    /// sent, the local particles computed, and what has arrived unpacked. With overlap a pass waits
    /// for
    ///
    /// ```text
    /// max(0, transfer − local work)        transfer = L + max((m − 1) g, (k − 1) G)
    /// ```
    ///
    /// with m messages of the rank and k bytes through the interface of its node. Messages inside a
    /// node are copied once more instead.
    ///
    /// and without for all of the transfer. The reduction of the time step, log₂ P rounds of
    /// `o + L + o`, travels beside the density pass, or is waited for.
    pub fn of(
        load: &RankLoad,
        traffic: &RankTraffic,
        rates: &Rates,
        net: &Network,
        ranks: usize,
        variant: Variant,
    ) -> Self {
        let repeated = if variant.repeats_walls { load.repeated_pairs / rates.pairs } else { 0.0 };
        let local = load.local_pairs / rates.pairs + repeated;
        let inner = load.inner_pairs / rates.pairs;
        let mut time = Self {
            compute: 2.0 * load.pairs() / rates.pairs,
            repeated: 2.0 * repeated,
            ..Self::default()
        };
        time.rebuild = rates.rebuilds.computing(time.compute);
        time.rebuild_messages = rates.rebuilds.communicating(load, traffic, net, ranks);
        let messages = f64::from(load.messages_in + load.messages_out);
        for (pass, bytes) in rates.element_bytes.into_iter().enumerate() {
            let elements = load.sent + traffic.inside + load.outer;
            let work = elements / rates.packs + messages * net.overhead;
            time.messages += work;
            let out = net.transfer(load.messages_out, traffic.node_out * bytes);
            let back = net.transfer(load.messages_in, traffic.node_in * bytes);
            let hidden = if variant.overlap { local } else { 0.0 };
            time.exposed += (out.max(back) - hidden).max(0.0);
            if pass == 0 {
                let hidden = if variant.overlap { local + inner + work } else { 0.0 };
                time.exposed += (net.short_reduction(ranks) - hidden).max(0.0);
            }
        }
        time
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rates() -> Rates {
        Rates {
            pairs: 1e9,
            packs: 1e8,
            element_bytes: [12.0, 24.0],
            rebuilds: Rebuilds { share: 0.25, steps: 10.0, per_partition: 20.0 },
        }
    }

    fn load() -> RankLoad {
        RankLoad {
            local: 800.0,
            inner: 200.0,
            outer: 300.0,
            sent: 300.0,
            messages_in: 4,
            messages_out: 4,
            local_pairs: 80_000.0,
            inner_pairs: 20_000.0,
            repeated_pairs: 5_000.0,
            ..RankLoad::default()
        }
    }

    const TRAFFIC: RankTraffic = RankTraffic { inside: 0.0, node_out: 300.0, node_in: 300.0 };

    #[test]
    fn a_step_by_hand() {
        let net = Network { ranks_per_node: 1.0, ..Network::GEMINI };
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12 + 1e-9 * b.abs(), "{a} {b}");
        let best = StepTime::of(&load(), &TRAFFIC, &rates(), &net, 8, Variant::BEST);
        close(best.compute, 200e-6);
        close(best.rebuild, 200e-6 / 3.0);
        // Twice: 600 elements and eight messages.
        close(best.messages, 2.0 * (6e-6 + 8.0 * 0.5e-6));
        // 80 µs of local work hide messages of about 3 µs.
        assert_eq!((best.exposed, best.repeated), (0.0, 0.0));
        let plain = StepTime::of(
            &load(),
            &TRAFFIC,
            &rates(),
            &net,
            8,
            Variant { overlap: false, repeats_walls: true },
        );
        close(plain.repeated, 10e-6);
        let pass = |bytes: f64| 1.5e-6 + ((300.0 * bytes - 1.0) / 6e9_f64).max(3.0 * 0.5e-6);
        close(plain.exposed, pass(12.0) + pass(24.0) + 3.0 * 2.5e-6);
        assert!(plain.total() > best.total());
    }

    #[test]
    fn little_work_hides_little() {
        let tiny = RankLoad { local_pairs: 1_000.0, ..load() };
        let busy = RankTraffic { node_out: 32.0 * 300.0, ..TRAFFIC };
        let net = Network::GEMINI;
        let exposed = |load| StepTime::of(load, &busy, &rates(), &net, 4096, Variant::BEST).exposed;
        assert!(exposed(&tiny) > 0.0 && exposed(&tiny) > exposed(&load()));
    }

    #[test]
    fn one_rank_only_computes() {
        let alone = RankLoad { local_pairs: 1e6, local: 1e4, ..RankLoad::default() };
        let time = StepTime::of(
            &alone,
            &RankTraffic::default(),
            &rates(),
            &Network::GEMINI,
            1,
            Variant::BEST,
        );
        assert_eq!(time.total(), time.compute + time.rebuild);
    }

    #[test]
    fn rates_must_make_sense() {
        rates().check().unwrap();
        let error = Rates { packs: 0.0, ..rates() }.check().unwrap_err();
        assert!(error.to_string().contains("`pack rate` is 0"), "{error}");
        let rebuilds = Rebuilds { share: 1.0, ..rates().rebuilds };
        assert!(Rates { rebuilds, ..rates() }.check().is_err());
    }
}
