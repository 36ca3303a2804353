//! What one overlapped pass moves, and what it reports.

use std::ops::{AddAssign, Range};

use crate::CommError;

/// A piece of a buffer that goes to, or comes from, one rank.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Part {
    /// The other rank.
    pub rank: usize,
    /// Its bytes in the buffer.
    pub bytes: Range<usize>,
}

/// The buffers of one overlapped pass.
///
/// Parts are ascending and disjoint. Each part to a rank meets one part of the same length from
/// that rank on the other side; several parts between the same two ranks keep their order.
/// Parts without bytes are not sent.
#[derive(Debug)]
pub struct Traffic<'a> {
    /// What leaves this rank: filled while the pass runs.
    pub send: &'a mut [u8],
    /// Who gets which bytes of `send`.
    pub send_parts: &'a [Part],
    /// What arrives: nobody but the communicator can see it until the pass is over.
    pub receive: &'a mut [u8],
    /// Who fills which bytes of `receive`.
    pub receive_parts: &'a [Part],
    /// Reduced over all ranks by maximum while the pass runs. All ranks give the same number of
    /// values. A NaN on any rank gives NaN on all.
    pub maxima: &'a mut [f64],
}

impl Traffic<'_> {
    /// Checks that all parts are ascending, disjoint, inside their buffer, and of existing ranks.
    pub fn check(&self, ranks: usize) -> Result<(), CommError> {
        check_parts(self.send_parts, self.send.len(), ranks)?;
        check_parts(self.receive_parts, self.receive.len(), ranks)
    }
}

fn check_parts(parts: &[Part], length: usize, ranks: usize) -> Result<(), CommError> {
    let mut end = 0;
    for part in parts {
        if part.rank >= ranks {
            return Err(CommError::NoSuchRank { rank: part.rank, size: ranks });
        }
        let Range { start, end: stop } = part.bytes;
        if start < end || stop < start || stop > length {
            return Err(CommError::BadPart { start, end: stop, length });
        }
        end = stop;
    }
    Ok(())
}

/// Lets messages progress while a rank computes.
///
/// Some MPI libraries move large messages only inside their own calls. The computation that hides
/// the communication therefore calls [`Progress::poll`] now and then: once per some hundred
/// microseconds of work is enough, and one call costs well under a microsecond.
pub trait Progress {
    /// Moves what can be moved without waiting.
    fn poll(&mut self);
}

/// What an overlapped pass cost.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Exposed {
    /// Seconds this rank was blocked after its own work was done: the part of the communication
    /// that was not hidden.
    pub wait_seconds: f64,
    /// Seconds of the two closures of a pass of [`Halo`](crate::Halo), polls included: the work of
    /// this rank. Zero on one rank, where nobody has to be compared with.
    pub work_seconds: f64,
    /// The same in seconds for which the calling thread had a core: the measure of the work when
    /// there are more ranks than cores, as long as the closures leave no work to other threads.
    /// Equals `work_seconds` where the system does not tell.
    pub thread_seconds: f64,
    /// Bytes sent to other ranks.
    pub bytes_sent: u64,
    /// Messages sent to other ranks.
    pub messages: u64,
    /// How often the computation called [`Progress::poll`].
    pub polls: u64,
}

impl AddAssign for Exposed {
    fn add_assign(&mut self, other: Self) {
        self.wait_seconds += other.wait_seconds;
        self.work_seconds += other.work_seconds;
        self.thread_seconds += other.thread_seconds;
        self.bytes_sent += other.bytes_sent;
        self.messages += other.messages;
        self.polls += other.polls;
    }
}

impl Exposed {
    /// An empty account with the messages that `parts` will cause for `rank`.
    pub(crate) fn counting(rank: usize, parts: &[Part]) -> Self {
        let mut exposed = Self::default();
        for part in parts.iter().filter(|part| part.rank != rank && !part.bytes.is_empty()) {
            exposed.bytes_sent += part.bytes.len() as u64;
            exposed.messages += 1;
        }
        exposed
    }
}
