//! The seam between the algorithms of this crate and whatever carries their messages.

mod blocking;
mod build;
pub(crate) mod clock;
mod error;
mod mailbox;
mod meeting;
mod metered;
#[cfg(feature = "mpi")]
mod mpi;
pub(crate) mod order;
mod solo;
mod threads;
mod traffic;

#[cfg(feature = "mpi")]
pub use self::mpi::Mpi;
pub use blocking::Blocking;
pub use build::check_same_build;
pub use error::{CommError, Operation};
pub use metered::{Collectives, Metered};
pub use solo::Solo;
pub use threads::{RanksError, ThreadRank, ThreadRanks};
pub use traffic::{Exposed, Part, Progress, Traffic};

use order::max_ordered;

/// A group of ranks that exchange messages.
///
/// All operations are collective: every rank calls the same ones in the same order. Everything
/// but [`overlap`](Communicator::overlap) blocks and is meant for set-up, rebuilds and reports.
pub trait Communicator {
    /// The number of this rank, from 0.
    fn rank(&self) -> usize;

    /// The number of ranks.
    fn size(&self) -> usize;

    /// Sends at most one message to each rank; returns what came, sorted by sender. The receivers
    /// need not know who sends. Empty messages are not delivered. A rank may write to itself.
    fn exchange_some(
        &self,
        send: Vec<(usize, Vec<u8>)>,
    ) -> Result<Vec<(usize, Vec<u8>)>, CommError>;

    /// Gives every rank the bytes of every rank, in rank order. Lengths may differ.
    fn all_gather(&self, bytes: &[u8]) -> Result<Vec<Vec<u8>>, CommError>;

    /// Computes and communicates at the same time: the pass of the local–inner–outer scheme.
    ///
    /// 1. posts all receptions into `traffic.receive`;
    /// 2. starts the reduction of `traffic.maxima`;
    /// 3. runs `inner`, which fills the send buffer;
    /// 4. posts all sends;
    /// 5. runs `local`, which does the rest of the work and polls;
    /// 6. waits for everything.
    ///
    /// Neither closure can see the receive buffer, because this call holds it mutably.
    fn overlap(
        &self,
        traffic: Traffic<'_>,
        inner: &mut dyn FnMut(&mut [u8]),
        local: &mut dyn FnMut(&mut dyn Progress),
    ) -> Result<Exposed, CommError>;

    /// One message to every rank and one from every rank, in rank order; they may be empty.
    fn all_to_all(&self, send: Vec<Vec<u8>>) -> Result<Vec<Vec<u8>>, CommError> {
        if send.len() > self.size() {
            return Err(CommError::NoSuchRank { rank: send.len() - 1, size: self.size() });
        }
        let mut received = vec![Vec::new(); self.size()];
        for (rank, bytes) in self.exchange_some(send.into_iter().enumerate().collect())? {
            received[rank] = bytes;
        }
        Ok(received)
    }

    /// Sums integers over all ranks, element by element, modulo 2⁶⁴. All ranks give the same
    /// number of values.
    fn sum_u64(&self, values: &mut [u64]) -> Result<(), CommError> {
        let all = self.all_gather(bytemuck::cast_slice(values))?;
        values.fill(0);
        for (rank, bytes) in all.iter().enumerate() {
            let theirs = words(rank, bytes, values.len())?;
            for (value, word) in values.iter_mut().zip(theirs) {
                *value = value.wrapping_add(u64::from_ne_bytes(word));
            }
        }
        Ok(())
    }

    /// The largest over all ranks, element by element; NaN on any rank gives NaN on all. All ranks
    /// give the same number of values.
    fn max_f64(&self, values: &mut [f64]) -> Result<(), CommError> {
        let all = self.all_gather(bytemuck::cast_slice(values))?;
        values.fill(f64::NEG_INFINITY);
        for (rank, bytes) in all.iter().enumerate() {
            let theirs = words(rank, bytes, values.len())?;
            for (value, word) in values.iter_mut().zip(theirs) {
                *value = max_ordered(*value, f64::from_ne_bytes(word));
            }
        }
        Ok(())
    }
}

/// Checks that letters go to existing ranks, at most one to each.
pub(crate) fn check_letters(send: &[(usize, Vec<u8>)], size: usize) -> Result<(), CommError> {
    let mut written = vec![false; size];
    for &(rank, _) in send {
        match written.get_mut(rank) {
            None => return Err(CommError::NoSuchRank { rank, size }),
            Some(true) => return Err(CommError::TwoMessages { rank }),
            Some(written) => *written = true,
        }
    }
    Ok(())
}

/// The bytes of a message of `count` words of eight bytes.
pub(crate) fn words(
    rank: usize,
    bytes: &[u8],
    count: usize,
) -> Result<impl Iterator<Item = [u8; 8]>, CommError> {
    if bytes.len() != 8 * count {
        return Err(CommError::WrongLength { rank, got: bytes.len(), expected: 8 * count });
    }
    Ok(bytes.as_chunks::<8>().0.iter().copied())
}

impl<C: Communicator + ?Sized> Communicator for &C {
    fn rank(&self) -> usize {
        (**self).rank()
    }

    fn size(&self) -> usize {
        (**self).size()
    }

    fn exchange_some(
        &self,
        send: Vec<(usize, Vec<u8>)>,
    ) -> Result<Vec<(usize, Vec<u8>)>, CommError> {
        (**self).exchange_some(send)
    }

    fn all_gather(&self, bytes: &[u8]) -> Result<Vec<Vec<u8>>, CommError> {
        (**self).all_gather(bytes)
    }

    fn overlap(
        &self,
        traffic: Traffic<'_>,
        inner: &mut dyn FnMut(&mut [u8]),
        local: &mut dyn FnMut(&mut dyn Progress),
    ) -> Result<Exposed, CommError> {
        (**self).overlap(traffic, inner, local)
    }

    fn all_to_all(&self, send: Vec<Vec<u8>>) -> Result<Vec<Vec<u8>>, CommError> {
        (**self).all_to_all(send)
    }

    fn sum_u64(&self, values: &mut [u64]) -> Result<(), CommError> {
        (**self).sum_u64(values)
    }

    fn max_f64(&self, values: &mut [f64]) -> Result<(), CommError> {
        (**self).max_f64(values)
    }
}
