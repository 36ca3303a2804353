//! The exchange of particle data between neighbouring ranks, hidden behind computation.

mod plan;

pub use plan::{HaloPlan, PlanError};

use bytemuck::{Pod, Zeroable};

use crate::comm::clock::WorkClock;
use crate::{CommError, Communicator, Exposed, Part, Progress, Traffic};

/// Reusable buffers for the exchange of one element `T` per particle.
///
/// Several fields travel in one message when `T` is a record of them: `[f64; 8]`, or any
/// `#[repr(C)]` struct that is [`Pod`].
///
/// A received element cannot be used before it is there. Within the pass the receive buffer is
/// borrowed by the pass, and the compiler refuses to read it:
///
/// ```compile_fail,E0502
/// use sph_decomp::{Halo, HaloPlan, Solo};
///
/// let mut halo = Halo::<f64>::new();
/// let plan = HaloPlan::empty();
/// halo.exchange(&Solo, &plan, &mut [], |_send| (), |_progress| {
///     let too_early = halo.received(); // the outer data is still in flight
/// });
/// ```
///
/// Nor can outer data be written, so that no rank computes what another rank owns:
///
/// ```compile_fail,E0594
/// use sph_decomp::{Halo, HaloPlan, Solo};
///
/// let mut halo = Halo::<f64>::new();
/// let plan = HaloPlan::empty();
/// let (outer, _) = halo.exchange(&Solo, &plan, &mut [], |_| (), |_| ()).unwrap();
/// outer[0] = 1.0; // belongs to another rank
/// ```
///
/// Afterwards it is free to read:
///
/// ```
/// use sph_decomp::{Halo, HaloPlan, Solo};
///
/// let mut halo = Halo::<f64>::new();
/// let plan = HaloPlan::empty();
/// let (outer, exposed) = halo.exchange(&Solo, &plan, &mut [], |_| (), |_| ()).unwrap();
/// assert!(outer.is_empty() && exposed.messages == 0);
/// assert!(halo.received().is_empty());
/// ```
#[derive(Debug, Clone, Default)]
pub struct Halo<T> {
    send: Vec<T>,
    receive: Vec<T>,
    send_parts: Vec<Part>,
    receive_parts: Vec<Part>,
}

impl<T: Pod> Halo<T> {
    /// Buffers that grow on first use.
    pub fn new() -> Self {
        Self { send: vec![], receive: vec![], send_parts: vec![], receive_parts: vec![] }
    }

    /// One overlapped pass. Collective.
    ///
    /// Posts the receptions, starts the reduction of `maxima` by maximum over all ranks, runs
    /// `inner` (which computes what others need and fills the send buffer, for example with
    /// [`HaloPlan::pack`]), posts the sends, runs `local` (which computes the rest and polls), and
    /// waits. Returns what arrived, in the order of arrival that [`HaloPlan::unpack`] knows, and
    /// what the pass cost.
    pub fn exchange<C: Communicator>(
        &mut self,
        comm: &C,
        plan: &HaloPlan,
        maxima: &mut [f64],
        inner: impl FnOnce(&mut [T]),
        local: impl FnOnce(&mut dyn Progress),
    ) -> Result<(&[T], Exposed), CommError> {
        self.send.resize(plan.send_count(), Zeroable::zeroed());
        self.receive.resize(plan.receive_count(), Zeroable::zeroed());
        parts::<T>(&mut self.send_parts, plan.sends());
        parts::<T>(&mut self.receive_parts, plan.receives());
        let traffic = Traffic {
            send: bytemuck::cast_slice_mut(&mut self.send),
            send_parts: &self.send_parts,
            receive: bytemuck::cast_slice_mut(&mut self.receive),
            receive_parts: &self.receive_parts,
            maxima,
        };
        let (mut inner, mut local) = (Some(inner), Some(local));
        let clock = WorkClock::new(comm.size() > 1);
        let mut exposed = comm.overlap(
            traffic,
            &mut |send| {
                if let Some(inner) = inner.take() {
                    clock.time(|| inner(bytemuck::cast_slice_mut(send)));
                }
            },
            &mut |progress| {
                if let Some(local) = local.take() {
                    clock.time(|| local(progress));
                }
            },
        )?;
        let work = clock.total();
        (exposed.work_seconds, exposed.thread_seconds) = (work.wall, work.thread);
        Ok((&self.receive, exposed))
    }

    /// Sends one element per particle of the plan and waits: for set-up, where nothing is there to
    /// hide the communication behind. Collective.
    pub fn exchange_now<C: Communicator>(
        &mut self,
        comm: &C,
        plan: &HaloPlan,
        element: impl FnMut(u32) -> T,
    ) -> Result<&[T], CommError> {
        let (received, _) =
            self.exchange(comm, plan, &mut [], |send| plan.pack(send, element), |_| ())?;
        Ok(received)
    }

    /// What arrived in the last pass.
    pub fn received(&self) -> &[T] {
        &self.receive
    }

    /// Bytes held by the buffers.
    pub fn memory(&self) -> usize {
        (self.send.capacity() + self.receive.capacity()) * size_of::<T>()
    }
}

/// The byte ranges of consecutive messages.
fn parts<T>(parts: &mut Vec<Part>, messages: &[(usize, Vec<u32>)]) {
    parts.clear();
    let mut start = 0;
    for (rank, elements) in messages {
        let end = start + elements.len() * size_of::<T>();
        parts.push(Part { rank: *rank, bytes: start..end });
        start = end;
    }
}
