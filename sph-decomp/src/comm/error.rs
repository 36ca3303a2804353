//! What can go wrong between ranks.

use std::fmt;

/// A collective operation: what it is, and how many there have been before it on this rank.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Operation {
    /// The method of the communicator.
    pub name: &'static str,
    /// Its number, from 1.
    pub number: u64,
}

impl fmt::Display for Operation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "operation {} ({})", self.number, self.name)
    }
}

/// An error of a communicator.
///
/// Every operation is collective, so an error on one rank leaves the others waiting. Under
/// [`ThreadRanks`](crate::ThreadRanks) the error of one rank wakes all others; under MPI the
/// program ends the job with `Mpi::abort`, or runs inside `Mpi::run`, which does so.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CommError {
    /// Another rank failed, and this one stopped waiting for it.
    #[error("rank {rank} failed: {message}")]
    RankFailed {
        /// The rank that failed first.
        rank: usize,
        /// What it said.
        message: String,
    },
    /// The ranks are not in the same operation.
    #[error(
        "rank {rank} is in {theirs} while this rank is in {ours}: all ranks must call the same \
         collective operations in the same order"
    )]
    OutOfStep {
        /// The other rank.
        rank: usize,
        /// Its operation.
        theirs: Operation,
        /// The operation of this rank.
        ours: Operation,
    },
    /// A message is longer or shorter than the receiver was told.
    #[error(
        "rank {rank} sent {got} bytes where {expected} were expected: sender and receiver hold \
         different plans (was a plan restricted with different rules on the two sides?)"
    )]
    WrongLength {
        /// The sender.
        rank: usize,
        /// Bytes that came.
        got: usize,
        /// Bytes the receiver expected.
        expected: usize,
    },
    /// Slots of outer particles are numbered in 32 bits.
    #[error(
        "rank {rank} is about to send {count} particles besides {before} of others: a rank can hold \
         2^32 outer particles; use more ranks"
    )]
    TooManyOuter {
        /// The sender.
        rank: usize,
        /// Particles it announces.
        count: u64,
        /// Particles of ranks before it.
        before: u32,
    },
    /// A message is addressed to a rank that does not exist.
    #[error("a message is addressed to rank {rank}, but there are only {size} ranks")]
    NoSuchRank {
        /// The address.
        rank: usize,
        /// Number of ranks.
        size: usize,
    },
    /// Two messages of one exchange are addressed to the same rank.
    #[error("two messages of one exchange are addressed to rank {rank}; join them")]
    TwoMessages {
        /// The address.
        rank: usize,
    },
    /// The parts of a buffer overlap, are out of order or reach past its end.
    #[error(
        "part {start}..{end} of a buffer of {length} bytes overlaps the part before it or reaches \
         past the end: parts must be ascending, disjoint and inside the buffer"
    )]
    BadPart {
        /// First byte.
        start: usize,
        /// One past the last byte.
        end: usize,
        /// Length of the buffer.
        length: usize,
    },
    /// The ranks were not started from the same program.
    #[error(
        "rank {rank} runs a different build: it says `{theirs}`, most ranks say `{expected}`; start \
         the same program with the same settings on all machines"
    )]
    DifferentBuild {
        /// The first rank that differs from the majority.
        rank: usize,
        /// Its tag.
        theirs: String,
        /// The tag of the majority.
        expected: String,
    },
    /// The MPI library cannot be used.
    #[error("MPI cannot be used: {0}")]
    Mpi(String),
}
