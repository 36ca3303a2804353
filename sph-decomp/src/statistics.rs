//! What a rank holds and what its communication cost.

use bytemuck::{Pod, Zeroable};

use crate::{CommError, Communicator, Exposed, HaloPlan, Parts};

/// The numbers of one rank: plain data, for reports in any format.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
#[repr(C)]
pub struct RankStatistics {
    /// The rank.
    pub rank: u64,
    /// Owned particles that no other rank needs.
    pub local: u64,
    /// Owned particles that some other rank needs.
    pub inner: u64,
    /// Particles of other ranks that this rank needs.
    pub outer: u64,
    /// Ranks that this rank sends to or receives from.
    pub neighbours: u64,
    /// Overlapped passes so far.
    pub passes: u64,
    /// Messages sent in these passes.
    pub messages: u64,
    /// Bytes sent in these passes.
    pub bytes_sent: u64,
    /// Seconds for which these passes were blocked after their own work was done.
    pub exposed_seconds: f64,
}

impl RankStatistics {
    /// The names of the numbers, in the order of [`RankStatistics::values`].
    pub const NAMES: [&str; 9] = [
        "rank",
        "local",
        "inner",
        "outer",
        "neighbours",
        "passes",
        "messages",
        "bytes_sent",
        "exposed_seconds",
    ];

    /// The numbers, for tables. Integers are exact up to 2⁵³.
    pub fn values(&self) -> [f64; 9] {
        [
            self.rank as f64,
            self.local as f64,
            self.inner as f64,
            self.outer as f64,
            self.neighbours as f64,
            self.passes as f64,
            self.messages as f64,
            self.bytes_sent as f64,
            self.exposed_seconds,
        ]
    }

    /// Notes the layout after a rebuild. The sums over passes go on.
    pub fn layout<C: Communicator>(&mut self, comm: &C, parts: &Parts, plan: &HaloPlan) {
        let senders = plan.receives().iter().map(|(rank, _)| rank);
        let mut neighbours: Vec<_> =
            plan.sends().iter().map(|(rank, _)| rank).chain(senders).collect();
        neighbours.sort_unstable();
        neighbours.dedup();
        self.rank = comm.rank() as u64;
        self.local = parts.local as u64;
        self.inner = parts.inner as u64;
        self.outer = parts.outer as u64;
        self.neighbours = neighbours.len() as u64;
    }

    /// Adds one pass.
    pub fn pass(&mut self, exposed: &Exposed) {
        self.passes += 1;
        self.messages += exposed.messages;
        self.bytes_sent += exposed.bytes_sent;
        self.exposed_seconds += exposed.wait_seconds;
    }

    /// The statistics of all ranks, in rank order. Collective.
    pub fn gather<C: Communicator>(&self, comm: &C) -> Result<Vec<Self>, CommError> {
        let mut all = Vec::with_capacity(comm.size());
        for (rank, bytes) in comm.all_gather(bytemuck::bytes_of(self))?.into_iter().enumerate() {
            let (got, expected) = (bytes.len(), size_of::<Self>());
            let one = bytemuck::try_pod_read_unaligned(&bytes);
            all.push(one.map_err(|_| CommError::WrongLength { rank, got, expected })?);
        }
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ThreadRanks;

    #[test]
    fn every_rank_learns_of_all() {
        let result = ThreadRanks::run(3, |comm| {
            let other = (comm.rank() + 1) % 3;
            let plan = HaloPlan::new(&comm, vec![(other, vec![0, 2])])?;
            let (parts, _) = Parts::arrange(4 + comm.rank(), &plan, |i| i);
            let mut mine = RankStatistics::default();
            mine.layout(&comm, &parts, &plan);
            mine.pass(&Exposed { bytes_sent: 10, messages: 1, ..Exposed::default() });
            mine.pass(&Exposed { bytes_sent: 10, messages: 1, ..Exposed::default() });
            mine.gather(&comm)
        });
        for all in result.unwrap() {
            for (rank, one) in all.iter().enumerate() {
                let local = 2.0 + rank as f64;
                assert_eq!(one.values(), [rank as f64, local, 2.0, 2.0, 2.0, 2.0, 2.0, 20.0, 0.0]);
            }
        }
    }
}
