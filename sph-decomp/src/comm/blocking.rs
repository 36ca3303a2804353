//! A pass without overlap, to show what the overlap is worth.

use std::cell::Cell;

use super::{CommError, Communicator, Exposed, Progress, Traffic};

/// A communicator whose passes wait for all messages before the local part begins.
///
/// The same program runs on it with the same bits, because the local part of a pass cannot see
/// what arrives; only nothing is hidden. The difference in time is what the overlap is worth.
///
/// ```
/// use sph_decomp::{Blocking, CommError, Communicator, Halo, HaloPlan, ThreadRanks};
///
/// let result = ThreadRanks::run(2, |comm| {
///     let comm = Blocking::new(&comm);
///     let plan = HaloPlan::new(&comm, vec![(1 - comm.rank(), vec![0])])?;
///     let mut halo = Halo::<u64>::new();
///     Ok::<_, CommError>(halo.exchange_now(&comm, &plan, |_| 7 + comm.rank() as u64)?.to_vec())
/// });
/// assert_eq!(result, Ok(vec![vec![8], vec![7]]));
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Blocking<C>(C);

impl<C: Communicator> Blocking<C> {
    /// Takes the overlap away from the passes of a communicator.
    pub fn new(comm: C) -> Self {
        Self(comm)
    }
}

/// Nothing is in flight any more.
struct Landed<'a>(&'a Cell<u64>);

impl Progress for Landed<'_> {
    fn poll(&mut self) {
        self.0.set(self.0.get() + 1);
    }
}

impl<C: Communicator> Communicator for Blocking<C> {
    fn rank(&self) -> usize {
        self.0.rank()
    }

    fn size(&self) -> usize {
        self.0.size()
    }

    fn exchange_some(
        &self,
        send: Vec<(usize, Vec<u8>)>,
    ) -> Result<Vec<(usize, Vec<u8>)>, CommError> {
        self.0.exchange_some(send)
    }

    fn all_gather(&self, bytes: &[u8]) -> Result<Vec<Vec<u8>>, CommError> {
        self.0.all_gather(bytes)
    }

    fn overlap(
        &self,
        traffic: Traffic<'_>,
        inner: &mut dyn FnMut(&mut [u8]),
        local: &mut dyn FnMut(&mut dyn Progress),
    ) -> Result<Exposed, CommError> {
        let mut exposed = self.0.overlap(traffic, inner, &mut |_| ())?;
        let polls = Cell::new(0);
        local(&mut Landed(&polls));
        exposed.polls = polls.get();
        Ok(exposed)
    }

    fn all_to_all(&self, send: Vec<Vec<u8>>) -> Result<Vec<Vec<u8>>, CommError> {
        self.0.all_to_all(send)
    }

    fn sum_u64(&self, values: &mut [u64]) -> Result<(), CommError> {
        self.0.sum_u64(values)
    }

    fn max_f64(&self, values: &mut [f64]) -> Result<(), CommError> {
        self.0.max_f64(values)
    }
}
