//! The LogGP parameters of a network.

use super::error::{ScaleError, positive};

/// A network in the LogGP model of Alexandrov, Ionescu, Schauser and Scheiman, *LogGP: incorporating
/// long messages into the LogP model*, SPAA 1995: a message of k bytes takes `o + L + (k − 1) G + o`
/// from one process to another, and one process begins messages `g` apart. The ranks of a node share
/// its interface, so that 1/G is the bandwidth of the node and k counts the bytes of all its ranks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Network {
    /// L: time on the wire, s.
    pub latency: f64,
    /// o: time of the core for sending or receiving one message, s.
    pub overhead: f64,
    /// g: least time between two messages of one rank, s.
    pub gap: f64,
    /// Bytes per second and direction of the interface of a node.
    pub node_bandwidth: f64,
    /// Ranks of a node, which send at the same time.
    pub ranks_per_node: f64,
}

impl Network {
    /// Names that [`Network::named`] knows.
    pub const NAMES: [&str; 3] = ["gemini", "slingshot", "infiniband"];

    /// Cray XE6 with the Gemini interconnect and two 16-core Interlagos processors per node, the
    /// machine of the paper. Latency 1.5 µs between nodes of neighbouring routers, and more than
    /// 6 GB/s of measured bandwidth per direction of at most 8.3: Alverson, Roweth and Kaplan, *The
    /// Gemini system interconnect*, Hot Interconnects 2010; van der Steen, *Overview of recent
    /// supercomputers*, 2010. Overhead and gap are assumed, a third of the latency each.
    pub const GEMINI: Self = Self {
        latency: 1.5e-6,
        overhead: 0.5e-6,
        gap: 0.5e-6,
        node_bandwidth: 6.0e9,
        ranks_per_node: 32.0,
    };

    /// HPE Slingshot with 200 Gb/s interfaces and 128 ranks per node. At most three hops between
    /// switches of 350 ns each, and about 2 µs from MPI to MPI: De Sensi, Di Girolamo, McMahon,
    /// Roweth and Hoefler, *An in-depth analysis of the Slingshot interconnect*, SC 2020. Overhead and
    /// gap are assumed.
    pub const SLINGSHOT: Self = Self {
        latency: 2.0e-6,
        overhead: 0.3e-6,
        gap: 0.3e-6,
        node_bandwidth: 25.0e9,
        ranks_per_node: 128.0,
    };

    /// InfiniBand HDR, 200 Gb/s, with 64 ranks per node. Below 1 µs at the interface and about
    /// 1.2 µs from MPI to MPI over a fat tree; 200 Gb/s are 25 GB/s, of which MPI reaches 24: data
    /// sheets of ConnectX-6 and Quantum, NVIDIA 2020. Overhead and gap are assumed.
    pub const INFINIBAND: Self = Self {
        latency: 1.2e-6,
        overhead: 0.3e-6,
        gap: 0.3e-6,
        node_bandwidth: 24.0e9,
        ranks_per_node: 64.0,
    };

    /// A network by its name, one of [`Network::NAMES`].
    ///
    /// # Errors
    ///
    /// When there is none of that name.
    pub fn named(name: &str) -> Result<Self, ScaleError> {
        match name {
            "gemini" => Ok(Self::GEMINI),
            "slingshot" => Ok(Self::SLINGSHOT),
            "infiniband" => Ok(Self::INFINIBAND),
            _ => Err(ScaleError::UnknownNetwork { name: name.into(), known: Self::NAMES.into() }),
        }
    }

    /// Refuses numbers that are no times and rates.
    ///
    /// # Errors
    ///
    /// Names the first number that is not positive and finite.
    pub fn check(&self) -> Result<(), ScaleError> {
        positive("latency", self.latency, " of seconds")?;
        positive("overhead", self.overhead, " of seconds")?;
        positive("gap", self.gap, " of seconds")?;
        positive("node_bandwidth", self.node_bandwidth, " of bytes per second")?;
        positive("ranks_per_node", self.ranks_per_node, "")
    }

    /// Time from the first send of a rank until the last of its `messages` has arrived (the
    /// receptions being posted), without the overhead of the cores, s. `node_bytes` is what all ranks
    /// of the node send or receive through its interface meanwhile.
    pub fn transfer(&self, messages: u32, node_bytes: f64) -> f64 {
        if messages == 0 {
            return 0.0;
        }
        // Either the gaps between messages or their bytes hold up the last one.
        let gaps = (f64::from(messages) - 1.0) * self.gap;
        self.latency + gaps.max((node_bytes - 1.0).max(0.0) / self.node_bandwidth)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_message_takes_what_loggp_says() {
        let net = Network::GEMINI;
        assert!((net.transfer(1, 6001.0) - (1.5e-6 + 6000.0 / 6.0e9)).abs() < 1e-15);
        assert_eq!(net.transfer(0, 0.0), 0.0);
        assert!((net.transfer(5, 10.0) - (1.5e-6 + 4.0 * 0.5e-6)).abs() < 1e-15);
    }

    #[test]
    fn networks_have_names_and_sense() {
        for name in Network::NAMES {
            Network::named(name).unwrap().check().unwrap();
        }
        let error = Network::named("token ring").unwrap_err().to_string();
        assert!(error.contains("no network `token ring`") && error.contains("slingshot"));
        let error = Network { gap: -1.0, ..Network::GEMINI }.check().unwrap_err().to_string();
        assert_eq!(error, "`gap` is -1; it must be a positive number of seconds");
    }
}
