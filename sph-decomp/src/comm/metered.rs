//! How long a rank is blocked in collective operations.

use std::cell::Cell;
use std::time::Instant;

use super::{CommError, Communicator, Exposed, Progress, Traffic};

/// Blocking operations so far, and their time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Collectives {
    /// Seconds that this rank was inside them. Some of it is copying; the rest is waiting for the
    /// slowest rank and for messages.
    pub seconds: f64,
    /// Their number.
    pub calls: u64,
}

/// A communicator that measures the blocking operations of another.
///
/// Passes are not blocking operations: what they cost is in the [`Exposed`] that they return.
///
/// ```
/// use sph_decomp::{CommError, Communicator, Metered, Solo};
///
/// let comm = Metered::new(Solo);
/// comm.max_f64(&mut [1.0])?;
/// comm.all_gather(b"state")?;
/// assert_eq!(comm.collectives().calls, 2);
/// # Ok::<_, CommError>(())
/// ```
#[derive(Debug)]
pub struct Metered<C> {
    comm: C,
    collectives: Cell<Collectives>,
}

impl<C: Communicator> Metered<C> {
    /// Measures a communicator from now on.
    pub fn new(comm: C) -> Self {
        Self { comm, collectives: Cell::default() }
    }

    /// What was measured so far.
    pub fn collectives(&self) -> Collectives {
        self.collectives.get()
    }

    fn time<R>(&self, operation: impl FnOnce(&C) -> R) -> R {
        let start = Instant::now();
        let result = operation(&self.comm);
        let Collectives { seconds, calls } = self.collectives.get();
        let seconds = seconds + start.elapsed().as_secs_f64();
        self.collectives.set(Collectives { seconds, calls: calls + 1 });
        result
    }
}

impl<C: Communicator> Communicator for Metered<C> {
    fn rank(&self) -> usize {
        self.comm.rank()
    }

    fn size(&self) -> usize {
        self.comm.size()
    }

    fn exchange_some(
        &self,
        send: Vec<(usize, Vec<u8>)>,
    ) -> Result<Vec<(usize, Vec<u8>)>, CommError> {
        self.time(|comm| comm.exchange_some(send))
    }

    fn all_gather(&self, bytes: &[u8]) -> Result<Vec<Vec<u8>>, CommError> {
        self.time(|comm| comm.all_gather(bytes))
    }

    fn overlap(
        &self,
        traffic: Traffic<'_>,
        inner: &mut dyn FnMut(&mut [u8]),
        local: &mut dyn FnMut(&mut dyn Progress),
    ) -> Result<Exposed, CommError> {
        self.comm.overlap(traffic, inner, local)
    }

    fn all_to_all(&self, send: Vec<Vec<u8>>) -> Result<Vec<Vec<u8>>, CommError> {
        self.time(|comm| comm.all_to_all(send))
    }

    fn sum_u64(&self, values: &mut [u64]) -> Result<(), CommError> {
        self.time(|comm| comm.sum_u64(values))
    }

    fn max_f64(&self, values: &mut [f64]) -> Result<(), CommError> {
        self.time(|comm| comm.max_f64(values))
    }
}
