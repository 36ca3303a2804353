//! Ranks as processes of an MPI job. The only file that names the MPI library.

use std::fmt::Display;
use std::io::Write;
use std::time::Instant;

use mpi::collective::SystemOperation;
use mpi::datatype::PartitionMut;
use mpi::environment::{Universe, initialize_with_threading};
use mpi::point_to_point::Status;
use mpi::request::{LocalScope, Request, RequestCollection, multiple_scope};
use mpi::topology::SimpleCommunicator;
use mpi::traits::{
    Communicator as _, CommunicatorCollectives as _, Destination as _, Equivalence as _,
    MatchedReceiveVec as _, Source as _,
};
use mpi::{Count, Rank, Tag, Threading};

use super::order::{from_ordered, to_ordered};
use super::{CommError, Communicator, Exposed, Part, Progress, Traffic, check_letters};

const HALO: Tag = 1;
const SETUP: Tag = 2;

/// MPI counts bytes in 32 bits. Longer messages travel in pieces of this length; pieces of one
/// message keep their order, as MPI promises for messages of one sender and tag.
const PIECE: usize = 1 << 30;

/// The communicator of an MPI job: all its ranks.
///
/// Made once per process, on the main thread, which is the one that communicates; other threads
/// may compute (MPI's thread level *funneled*). When it is dropped, MPI is shut down.
///
/// A rank that fails must not leave the others waiting: a panic of the thread that holds an `Mpi`
/// ends the whole job, and a program that returns an error calls [`Mpi::abort`], or runs inside
/// [`Mpi::run`], which does it.
pub struct Mpi {
    // Dropped before the universe, which shuts MPI down.
    world: SimpleCommunicator,
    piece: usize,
    _universe: Universe,
}

impl Mpi {
    /// Starts MPI.
    pub fn start() -> Result<Self, CommError> {
        let Some((universe, level)) = initialize_with_threading(Threading::Funneled) else {
            let text = "it was started before in this process; make one `Mpi` and pass it on";
            return Err(CommError::Mpi(text.to_string()));
        };
        if level < Threading::Funneled {
            return Err(CommError::Mpi(format!(
                "the library gives thread level {level:?}, but ranks compute on several threads and \
                 need at least Funneled; use an MPI library with thread support"
            )));
        }
        // A communicator of our own, so that our messages never meet those of other libraries.
        let world = universe.world().duplicate();
        Ok(Self { world, piece: PIECE, _universe: universe })
    }

    /// Runs `work` as a rank of an MPI job. An error ends the whole job with its message.
    ///
    /// Returns an error only when MPI cannot be started.
    pub fn run<R, E: Display>(work: impl FnOnce(&Self) -> Result<R, E>) -> Result<R, CommError> {
        let mpi = Self::start()?;
        match work(&mpi) {
            Ok(result) => Ok(result),
            Err(error) => mpi.abort(&error.to_string()),
        }
    }

    /// Ends the job on all ranks at once, with exit code 1.
    ///
    /// The message goes to the standard error stream, because nobody can report it afterwards.
    pub fn abort(&self, message: &str) -> ! {
        // In one piece, because all ranks and the launcher write to the same stream. Nothing can be
        // done about a closed stream at this point.
        let line = format!("rank {}: {message}\n", self.rank());
        let _ = std::io::stderr().write_all(line.as_bytes());
        self.world.abort(1)
    }

    /// Lets messages travel in pieces of at most `bytes` bytes, the same on all ranks. The default
    /// is 2³⁰; smaller pieces serve tests.
    #[must_use]
    pub fn with_pieces_of(mut self, bytes: usize) -> Self {
        self.piece = bytes.clamp(1, PIECE);
        self
    }
}

impl Drop for Mpi {
    fn drop(&mut self) {
        if std::thread::panicking() {
            // Shutting down in good order would wait for the other ranks, and they for this one.
            self.world.abort(101);
        }
    }
}

/// Ends the job when a panic leaves messages in flight: their buffers are about to go away.
struct AbortOnPanic<'a>(&'a SimpleCommunicator);

impl Drop for AbortOnPanic<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.abort(101);
        }
    }
}

impl Communicator for Mpi {
    fn rank(&self) -> usize {
        self.world.rank() as usize
    }

    fn size(&self) -> usize {
        self.world.size() as usize
    }

    fn exchange_some(
        &self,
        mut send: Vec<(usize, Vec<u8>)>,
    ) -> Result<Vec<(usize, Vec<u8>)>, CommError> {
        check_letters(&send, self.size())?;
        send.retain(|(_, bytes)| !bytes.is_empty());
        let mut received: Vec<(usize, Vec<u8>)> = Vec::new();
        if let Some(own) = send.iter().position(|(rank, _)| *rank == self.rank()) {
            received.push(send.swap_remove(own));
        }
        // How many pieces will come. This call also keeps exchanges apart: it returns when all
        // ranks have entered, and by then they have received everything of the exchange before.
        let mut pieces = vec![0_u64; self.size()];
        for (rank, bytes) in &send {
            pieces[*rank] = bytes.len().div_ceil(self.piece) as u64;
        }
        let mut coming = 0_u64;
        self.world.reduce_scatter_block_into(&pieces[..], &mut coming, SystemOperation::sum());
        let send = &send;
        multiple_scope(send.len(), |scope, requests: &mut RequestCollection<'_, [u8]>| {
            for (rank, bytes) in send {
                let to = self.world.process_at_rank(*rank as Rank);
                for piece in bytes.chunks(self.piece) {
                    requests.add(to.immediate_send_with_tag(scope, piece, SETUP));
                }
            }
            for _ in 0..coming {
                let probe = self.world.any_process().matched_probe_with_tag(SETUP);
                let (bytes, status) = probe.matched_receive_vec::<u8>();
                let from = status.source_rank() as usize;
                match received.iter_mut().find(|(rank, _)| *rank == from) {
                    Some((_, start)) => start.extend_from_slice(&bytes),
                    None => received.push((from, bytes)),
                }
            }
            requests.wait_all(&mut Vec::new());
        });
        received.sort_by_key(|(rank, _)| *rank);
        Ok(received)
    }

    fn all_gather(&self, bytes: &[u8]) -> Result<Vec<Vec<u8>>, CommError> {
        let mut lengths = vec![0_u64; self.size()];
        self.world.all_gather_into(&(bytes.len() as u64), &mut lengths[..]);
        let total: u64 = lengths.iter().sum();
        if total == 0 {
            return Ok(vec![Vec::new(); self.size()]);
        }
        if total > self.piece as u64 {
            // The displacements within the result are counted in 32 bits too.
            let copies = (0..self.size()).map(|rank| (rank, bytes.to_vec())).collect();
            let mut all = vec![Vec::new(); self.size()];
            for (rank, bytes) in self.exchange_some(copies)? {
                all[rank] = bytes;
            }
            return Ok(all);
        }
        let counts: Vec<Count> = lengths.iter().map(|&length| length as Count).collect();
        let mut end = 0;
        let starts: Vec<Count> = counts
            .iter()
            .map(|count| {
                end += count;
                end - count
            })
            .collect();
        let mut all = vec![0_u8; total as usize];
        let mut parts = PartitionMut::new(&mut all[..], &counts[..], &starts[..]);
        self.world.all_gather_varcount_into(bytes, &mut parts);
        let part = |(&start, &count): (&Count, &Count)| {
            all[start as usize..(start + count) as usize].to_vec()
        };
        Ok(starts.iter().zip(&counts).map(part).collect())
    }

    fn overlap(
        &self,
        traffic: Traffic<'_>,
        inner: &mut dyn FnMut(&mut [u8]),
        local: &mut dyn FnMut(&mut dyn Progress),
    ) -> Result<Exposed, CommError> {
        traffic.check(self.size())?;
        let Traffic { send, send_parts, receive, receive_parts, maxima } = traffic;
        let mut exposed = Exposed::counting(self.rank(), send_parts);
        let mine: Vec<u64> = maxima.iter().map(|&x| to_ordered(x)).collect();
        let mut largest = vec![0_u64; mine.len()];
        let reduced = (&mine[..], &mut largest[..]);
        let places = carve(receive, receive_parts, self.piece);
        let expected = places.len();
        multiple_scope(2 * expected, |scope, requests: &mut RequestCollection<'_, [u8]>| {
            let _guard = AbortOnPanic(&self.world);
            for (rank, place) in places {
                let from = self.world.process_at_rank(rank);
                requests.add(from.immediate_receive_into_with_tag(scope, place, HALO));
            }
            let (mine, largest) = reduced;
            let reduction = (!mine.is_empty()).then(|| {
                let max = SystemOperation::max();
                self.world.immediate_all_reduce_into(scope, mine, largest, max)
            });
            inner(&mut *send);
            let send: &[u8] = send;
            for part in send_parts {
                let to = self.world.process_at_rank(part.rank as Rank);
                for piece in send[part.bytes.clone()].chunks(self.piece) {
                    requests.add(to.immediate_send_with_tag(scope, piece, HALO));
                }
            }
            let count = requests.incomplete();
            let mut flight = Flight {
                requests,
                reduction,
                complete: count == 0,
                receptions: expected,
                done: Vec::with_capacity(count),
                polls: 0,
                error: None,
            };
            local(&mut flight);
            let blocked = Instant::now();
            flight.wait();
            exposed.wait_seconds = blocked.elapsed().as_secs_f64();
            exposed.polls = flight.polls;
            flight.error.map_or(Ok(()), Err)
        })?;
        for (value, &largest) in maxima.iter_mut().zip(&largest) {
            *value = from_ordered(largest);
        }
        Ok(exposed)
    }

    fn sum_u64(&self, values: &mut [u64]) -> Result<(), CommError> {
        let mine = values.to_vec();
        self.world.all_reduce_into(&mine[..], values, SystemOperation::sum());
        Ok(())
    }

    fn max_f64(&self, values: &mut [f64]) -> Result<(), CommError> {
        let mine: Vec<u64> = values.iter().map(|&x| to_ordered(x)).collect();
        let mut largest = vec![0_u64; mine.len()];
        self.world.all_reduce_into(&mine[..], &mut largest[..], SystemOperation::max());
        for (value, &largest) in values.iter_mut().zip(&largest) {
            *value = from_ordered(largest);
        }
        Ok(())
    }
}

/// The pieces of a receive buffer, each with its sender.
fn carve<'a>(buffer: &'a mut [u8], parts: &[Part], piece: usize) -> Vec<(Rank, &'a mut [u8])> {
    let mut places = Vec::with_capacity(parts.len());
    let (mut rest, mut position) = (buffer, 0);
    for part in parts {
        let (_, from_start) = rest.split_at_mut(part.bytes.start - position);
        let (place, after) = from_start.split_at_mut(part.bytes.len());
        places.extend(place.chunks_mut(piece).map(|place| (part.rank as Rank, place)));
        (rest, position) = (after, part.bytes.end);
    }
    places
}

/// What an overlapped pass still waits for.
struct Flight<'s, 'a> {
    requests: &'s mut RequestCollection<'a, [u8]>,
    reduction: Option<Request<'a, [u64], &'s LocalScope<'a>>>,
    /// Whether all requests but the reduction are complete.
    complete: bool,
    /// The first so many requests are receptions.
    receptions: usize,
    done: Vec<(usize, Status, &'a [u8])>,
    polls: u64,
    error: Option<CommError>,
}

impl Flight<'_, '_> {
    /// Compares the lengths of what has arrived with what was expected.
    fn check(&mut self) {
        self.complete = true;
        for (request, status, place) in self.done.drain(..) {
            let (got, expected) = (status.count(u8::equivalent_datatype()) as usize, place.len());
            if request < self.receptions && got != expected {
                let rank = status.source_rank() as usize;
                self.error.get_or_insert(CommError::WrongLength { rank, got, expected });
            }
        }
    }

    fn wait(&mut self) {
        if !self.complete {
            self.requests.wait_all(&mut self.done);
            self.check();
        }
        if let Some(reduction) = self.reduction.take() {
            reduction.wait_without_status();
        }
    }
}

impl Progress for Flight<'_, '_> {
    fn poll(&mut self) {
        self.polls += 1;
        // One test of all requests moves all of them. (`test_some` of rsmpi 0.8 hands out the
        // statuses of other requests than those that were completed.)
        if !self.complete && self.requests.test_all(&mut self.done) {
            self.check();
        }
        self.reduction = self.reduction.take().and_then(|reduction| reduction.test().err());
    }
}
