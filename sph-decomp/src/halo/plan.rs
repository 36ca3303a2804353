//! Which particles go to whom, and where each received one lies.

use crate::{CommError, Communicator};

/// The plan of a halo exchange.
///
/// It names for each neighbour the owned particles that go there, and for each particle that
/// comes its slot among the outer particles. A plan is made at a rebuild and used in many passes.
///
/// Set up in this order:
/// 1. [`HaloPlan::new`] with the lists of the overlap zone;
/// 2. [`HaloPlan::renumber_owned`] after the owned particles were sorted;
/// 3. one exchange of what is needed to sort the outer particles (ids, positions);
/// 4. [`HaloPlan::arrange_outer`] with their order;
/// 5. where useful, [`HaloPlan::restrict`] for passes that concern only a part of the particles.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct HaloPlan {
    sends: Vec<(usize, Vec<u32>)>,
    receives: Vec<(usize, Vec<u32>)>,
    outer: usize,
}

/// Two ranks hold plans that do not fit.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// One side sends another number of particles than the other expects.
    #[error(
        "rank {rank} sends {sent} particles where {expected} are expected: the plan was restricted \
         by something that the two ranks see differently"
    )]
    Unequal {
        /// The sender.
        rank: usize,
        /// Particles it sends.
        sent: u64,
        /// Particles this rank expects.
        expected: u64,
    },
    /// The ranks could not compare.
    #[error(transparent)]
    Comm(#[from] CommError),
}

impl HaloPlan {
    /// A plan without messages.
    pub fn empty() -> Self {
        Self::default()
    }

    /// Tells every receiver how many particles will come. Collective.
    ///
    /// `sends` names ranks, each at most once, with the owned particles that go there. Outer slots
    /// are numbered in the order of arrival: by rank, then in the order of the sender.
    pub fn new<C: Communicator>(
        comm: &C,
        mut sends: Vec<(usize, Vec<u32>)>,
    ) -> Result<Self, CommError> {
        sends.retain(|(_, particles)| !particles.is_empty());
        sends.sort_by_key(|(rank, _)| *rank);
        let counts = sends.iter().map(|(rank, p)| (*rank, (p.len() as u64).to_ne_bytes().to_vec()));
        let mut outer = 0;
        let mut receives = Vec::new();
        for (rank, bytes) in comm.exchange_some(counts.collect())? {
            let (got, expected) = (bytes.len(), 8);
            let count: [u8; 8] =
                bytes.try_into().map_err(|_| CommError::WrongLength { rank, got, expected })?;
            let count = u64::from_ne_bytes(count);
            let next = u32::try_from(u64::from(outer) + count)
                .map_err(|_| CommError::TooManyOuter { rank, count, before: outer })?;
            receives.push((rank, (outer..next).collect()));
            outer = next;
        }
        Ok(Self { sends, receives, outer: outer as usize })
    }

    /// For each neighbour the owned particles that go there.
    pub fn sends(&self) -> &[(usize, Vec<u32>)] {
        &self.sends
    }

    /// For each neighbour the outer slots of the particles that come from there.
    pub fn receives(&self) -> &[(usize, Vec<u32>)] {
        &self.receives
    }

    /// Elements of a send buffer: one per particle and receiver.
    pub fn send_count(&self) -> usize {
        self.sends.iter().map(|(_, particles)| particles.len()).sum()
    }

    /// Elements of a receive buffer.
    pub fn receive_count(&self) -> usize {
        self.receives.iter().map(|(_, slots)| slots.len()).sum()
    }

    /// Number of outer particles. A restricted plan receives fewer but knows all slots.
    pub fn outer(&self) -> usize {
        self.outer
    }

    /// For each of `owned` particles whether it is sent to anybody, that is, whether it is inner.
    pub fn is_inner(&self, owned: usize) -> Vec<bool> {
        let mut inner = vec![false; owned];
        for &particle in self.sends.iter().flat_map(|(_, particles)| particles) {
            inner[particle as usize] = true;
        }
        inner
    }

    /// Follows a sort of the owned particles: the particle at new place `k` was at `order[k]`.
    /// All particles that are sent must be in `order`.
    pub fn renumber_owned(&mut self, order: &[u32]) {
        let mut place = vec![u32::MAX; order.iter().max().map_or(0, |&last| last as usize + 1)];
        for (new, &old) in (0..).zip(order) {
            place[old as usize] = new;
        }
        for particle in self.sends.iter_mut().flat_map(|(_, particles)| particles) {
            *particle = place[*particle as usize];
        }
    }

    /// Follows a sort of the outer particles: slot `k` takes the particle that was in slot
    /// `order[k]`.
    pub fn arrange_outer(&mut self, order: &[u32]) {
        let mut place = vec![u32::MAX; self.outer];
        for (new, &old) in (0..).zip(order) {
            place[old as usize] = new;
        }
        for slot in self.receives.iter_mut().flat_map(|(_, slots)| slots) {
            *slot = place[*slot as usize];
        }
    }

    /// Fills a send buffer with one element per particle and receiver.
    pub fn pack<T>(&self, send: &mut [T], mut element: impl FnMut(u32) -> T) {
        let particles = self.sends.iter().flat_map(|(_, particles)| particles);
        for (place, &particle) in send.iter_mut().zip(particles) {
            *place = element(particle);
        }
    }

    /// Hands each received element with its outer slot to `store`.
    pub fn unpack<T>(&self, received: &[T], mut store: impl FnMut(usize, &T)) {
        let slots = self.receives.iter().flat_map(|(_, slots)| slots);
        for (element, &slot) in received.iter().zip(slots) {
            store(slot as usize, element);
        }
    }

    /// The plan of a pass that concerns only some particles, such as those that move. No message.
    ///
    /// Sender and receiver decide for themselves, so both must decide from data that both hold:
    /// the class of a particle, its id, its material. `owned(i)` says whether owned particle `i`
    /// takes part, `outer(k)` whether the outer particle in slot `k` does. Slots keep their
    /// numbers. [`HaloPlan::verify`] checks that the two sides agree.
    pub fn restrict(
        &self,
        mut owned: impl FnMut(u32) -> bool,
        mut outer: impl FnMut(u32) -> bool,
    ) -> Self {
        let sends = restrict(&self.sends, &mut owned);
        let receives = restrict(&self.receives, &mut outer);
        Self { sends, receives, outer: self.outer }
    }

    /// Checks that every rank sends what the others expect. Collective; for tests and rebuilds.
    pub fn verify<C: Communicator>(&self, comm: &C) -> Result<(), PlanError> {
        let counts = self.sends.iter().map(|(rank, particles)| {
            let count = particles.len() as u64;
            (*rank, count.to_ne_bytes().to_vec())
        });
        let mut sent: Vec<(usize, u64)> = Vec::new();
        for (rank, bytes) in comm.exchange_some(counts.collect())? {
            let (got, expected) = (bytes.len(), 8);
            let count: [u8; 8] =
                bytes.try_into().map_err(|_| CommError::WrongLength { rank, got, expected })?;
            sent.push((rank, u64::from_ne_bytes(count)));
        }
        let expected: Vec<_> =
            self.receives.iter().map(|(r, slots)| (*r, slots.len() as u64)).collect();
        let find = |list: &[(usize, u64)], rank| {
            list.iter().find(|(r, _)| *r == rank).map_or(0, |(_, count)| *count)
        };
        for &(rank, _) in sent.iter().chain(&expected) {
            let (sent, expected) = (find(&sent, rank), find(&expected, rank));
            if sent != expected {
                return Err(PlanError::Unequal { rank, sent, expected });
            }
        }
        Ok(())
    }
}

fn restrict(
    lists: &[(usize, Vec<u32>)],
    keep: &mut impl FnMut(u32) -> bool,
) -> Vec<(usize, Vec<u32>)> {
    let mut kept = Vec::new();
    for (rank, list) in lists {
        let list: Vec<u32> = list.iter().copied().filter(|&i| keep(i)).collect();
        if !list.is_empty() {
            kept.push((*rank, list));
        }
    }
    kept
}
