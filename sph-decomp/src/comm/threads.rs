//! Ranks as threads of one process.

use std::any::Any;
use std::cell::RefCell;
use std::fmt::Display;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::Instant;

use super::mailbox::{Message, PostOffice};
use super::meeting::Content;
use super::order::{from_ordered, to_ordered};
use super::{CommError, Communicator, Exposed, Operation, Progress, Traffic, check_letters};

/// Runs a program on several ranks that are threads of this process: the embedded way to use and
/// to test a decomposition, without MPI.
#[derive(Debug)]
pub struct ThreadRanks;

/// Why [`ThreadRanks::run`] failed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RanksError<E> {
    /// A run needs at least one rank.
    #[error("a run needs at least one rank")]
    NoRanks,
    /// The system refused to start a thread.
    #[error("the thread of rank {rank} could not be started: {message}")]
    Spawn {
        /// The rank without a thread.
        rank: usize,
        /// What the system said.
        message: String,
    },
    /// A rank returned an error. Ranks that stopped only because of it are not named.
    #[error("rank {rank}: {error}")]
    Failed {
        /// The first rank that failed.
        rank: usize,
        /// Its error.
        error: E,
    },
    /// A rank panicked.
    #[error("rank {rank} panicked: {message}")]
    Panicked {
        /// The first rank that panicked.
        rank: usize,
        /// The text of the panic.
        message: String,
    },
}

impl ThreadRanks {
    /// Runs `work` on `ranks` ranks and returns their results in rank order.
    ///
    /// When a rank returns an error or panics, all others that wait for a message get
    /// [`CommError::RankFailed`], and the caller gets the first error in time.
    ///
    /// ```
    /// use sph_decomp::{CommError, Communicator, ThreadRanks};
    ///
    /// let sums = ThreadRanks::run(4, |comm| {
    ///     let mut sum = [comm.rank() as u64];
    ///     comm.sum_u64(&mut sum)?;
    ///     Ok::<_, CommError>(sum[0])
    /// });
    /// assert_eq!(sums, Ok(vec![6; 4]));
    /// ```
    pub fn run<R, E, F>(ranks: usize, work: F) -> Result<Vec<R>, RanksError<E>>
    where
        R: Send,
        E: Display + Send,
        F: Fn(ThreadRank) -> Result<R, E> + Sync,
    {
        if ranks == 0 {
            return Err(RanksError::NoRanks);
        }
        let office = Arc::new(PostOffice::new(ranks));
        let (office, work) = (&office, &work);
        let mut outcomes: Vec<Outcome<R, E>> = thread::scope(|scope| {
            let start = |rank: usize| {
                let thread = thread::Builder::new().name(format!("rank {rank}"));
                let started = thread.spawn_scoped(scope, move || run_rank(rank, office, work));
                if let Err(error) = &started {
                    office.fail(rank, format!("its thread could not be started: {error}"));
                }
                started
            };
            let threads: Vec<_> = (0..ranks).map(start).collect();
            let join = |thread: std::io::Result<thread::ScopedJoinHandle<'_, _>>| match thread {
                Ok(thread) => thread.join().unwrap_or(Outcome::Panicked),
                Err(error) => Outcome::NotStarted(error.to_string()),
            };
            threads.into_iter().map(join).collect()
        });
        let Some((rank, message)) = office.failure() else {
            let result = |outcome| match outcome {
                Outcome::Done(result) => Some(result),
                _ => None,
            };
            return Ok(outcomes.into_iter().filter_map(result).collect());
        };
        Err(match outcomes.swap_remove(rank) {
            Outcome::Failed(error) => RanksError::Failed { rank, error },
            Outcome::NotStarted(message) => RanksError::Spawn { rank, message },
            Outcome::Panicked | Outcome::Done(_) => RanksError::Panicked { rank, message },
        })
    }
}

/// How one rank ended.
enum Outcome<R, E> {
    Done(R),
    Failed(E),
    Panicked,
    NotStarted(String),
}

fn run_rank<R, E: Display>(
    rank: usize,
    office: &Arc<PostOffice>,
    work: &impl Fn(ThreadRank) -> Result<R, E>,
) -> Outcome<R, E> {
    let operations = Arc::new(AtomicU64::new(0));
    let comm = ThreadRank {
        rank,
        office: Arc::clone(office),
        operations: Arc::clone(&operations),
        spare: RefCell::default(),
    };
    // The closure is not used again after a panic, so no broken state can be seen.
    match catch_unwind(AssertUnwindSafe(|| work(comm))) {
        Ok(Ok(result)) => {
            office.finish(rank, operations.load(Ordering::Relaxed));
            Outcome::Done(result)
        }
        Ok(Err(error)) => {
            office.fail(rank, error.to_string());
            Outcome::Failed(error)
        }
        Err(panic) => {
            office.fail(rank, say(&*panic));
            Outcome::Panicked
        }
    }
}

/// The text of a panic.
fn say(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(ToString::to_string);
    text.or_else(|| panic.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "a panic without a message".to_string())
}

/// The communicator of one rank of [`ThreadRanks`].
#[derive(Debug)]
pub struct ThreadRank {
    rank: usize,
    office: Arc<PostOffice>,
    /// Number of operations so far: ranks that are out of step get an error instead of each other's
    /// data.
    operations: Arc<AtomicU64>,
    /// Buffers of messages that came, kept for messages that go: at most [`SPARE`].
    spare: RefCell<Vec<Vec<u8>>>,
}

/// More neighbours than a rank usually has.
const SPARE: usize = 64;

impl ThreadRank {
    fn next_operation(&self, name: &'static str) -> Operation {
        Operation { name, number: self.operations.fetch_add(1, Ordering::Relaxed) + 1 }
    }

    fn post(&self, to: usize, operation: Operation, bytes: &[u8]) {
        let mut copy = self.spare.borrow_mut().pop().unwrap_or_default();
        copy.clear();
        copy.extend_from_slice(bytes);
        self.office.post(self.rank, to, Message { operation, bytes: copy });
    }

    fn take(&self, from: usize, operation: Operation) -> Result<Vec<u8>, CommError> {
        let message = self.office.take(self.rank, from)?;
        Self::in_step(from, operation, message)
    }

    fn take_if_there(&self, from: usize) -> Option<Message> {
        self.office.try_take(self.rank, from)
    }

    fn in_step(rank: usize, ours: Operation, message: Message) -> Result<Vec<u8>, CommError> {
        let theirs = message.operation;
        if theirs != ours {
            return Err(CommError::OutOfStep { rank, theirs, ours });
        }
        Ok(message.bytes)
    }
}

impl Communicator for ThreadRank {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.office.hall.ranks()
    }

    fn exchange_some(
        &self,
        send: Vec<(usize, Vec<u8>)>,
    ) -> Result<Vec<(usize, Vec<u8>)>, CommError> {
        let (me, size, hall) = (self.rank, self.size(), &self.office.hall);
        check_letters(&send, size)?;
        let operation = self.next_operation("exchange_some");
        hall.come(me, operation, |content| {
            content.add_letters(size, me, send);
            Ok(())
        })?;
        let mut received = hall.wait(me, operation, |content| match content {
            Content::Letters(all) => std::mem::take(&mut all[me]),
            _ => vec![],
        })?;
        received.sort_by_key(|(rank, _)| *rank);
        Ok(received)
    }

    fn all_gather(&self, bytes: &[u8]) -> Result<Vec<Vec<u8>>, CommError> {
        let (me, size, hall) = (self.rank, self.size(), &self.office.hall);
        let operation = self.next_operation("all_gather");
        hall.come(me, operation, |content| {
            content.add_share(size, me, bytes);
            Ok(())
        })?;
        let all = hall.wait(me, operation, |content| match content {
            Content::Gathered(all) => all.clone(),
            _ => vec![],
        })?;
        Ok(all.iter().map(|bytes| bytes.as_deref().unwrap_or_default().to_vec()).collect())
    }

    fn overlap(
        &self,
        traffic: Traffic<'_>,
        inner: &mut dyn FnMut(&mut [u8]),
        local: &mut dyn FnMut(&mut dyn Progress),
    ) -> Result<Exposed, CommError> {
        traffic.check(self.size())?;
        let operation = self.next_operation("overlap");
        let reduces = !traffic.maxima.is_empty();
        let mine: Vec<u64> = traffic.maxima.iter().map(|&x| to_ordered(x)).collect();
        self.office.hall.come(self.rank, operation, |content| content.add_maxima(mine))?;
        if !reduces {
            self.office.hall.leave(operation);
        }
        inner(traffic.send);
        for part in traffic.send_parts.iter().filter(|part| !part.bytes.is_empty()) {
            self.post(part.rank, operation, &traffic.send[part.bytes.clone()]);
        }
        let parts = traffic.receive_parts.iter().filter(|part| !part.bytes.is_empty());
        let mut arrivals = Arrivals {
            comm: self,
            operation,
            receive: traffic.receive,
            maxima: traffic.maxima,
            wanted: parts.map(|part| (part.rank, part.bytes.clone())).collect(),
            reduces,
            polls: 0,
            error: None,
        };
        local(&mut arrivals);
        let blocked = Instant::now();
        arrivals.wait()?;
        let mut exposed = Exposed::counting(self.rank, traffic.send_parts);
        exposed.wait_seconds = blocked.elapsed().as_secs_f64();
        exposed.polls = arrivals.polls;
        Ok(exposed)
    }

    fn sum_u64(&self, values: &mut [u64]) -> Result<(), CommError> {
        let operation = self.next_operation("sum_u64");
        let mine = values.to_vec();
        self.office.hall.come(self.rank, operation, |content| content.add_sums(mine))?;
        let copy = |content: &mut Content| values.copy_from_slice(content.values());
        self.office.hall.wait(self.rank, operation, copy)
    }

    fn max_f64(&self, values: &mut [f64]) -> Result<(), CommError> {
        let operation = self.next_operation("max_f64");
        let mine = values.iter().map(|&x| to_ordered(x)).collect();
        self.office.hall.come(self.rank, operation, |content| content.add_maxima(mine))?;
        self.office.hall.wait(self.rank, operation, |content| decode(content, values))
    }
}

/// The result of a reduction by maximum.
fn decode(content: &mut Content, values: &mut [f64]) {
    for (value, &key) in values.iter_mut().zip(content.values()) {
        *value = from_ordered(key);
    }
}

/// What an overlapped pass still waits for.
struct Arrivals<'a> {
    comm: &'a ThreadRank,
    operation: Operation,
    receive: &'a mut [u8],
    maxima: &'a mut [f64],
    /// Senders and places, in the order in which each sender writes.
    wanted: Vec<(usize, Range<usize>)>,
    /// Whether the reduction is still to come.
    reduces: bool,
    polls: u64,
    error: Option<CommError>,
}

impl Arrivals<'_> {
    /// Puts a message in its place and keeps its buffer for a later message.
    fn place(&mut self, rank: usize, place: Range<usize>, bytes: Vec<u8>) -> Result<(), CommError> {
        if place.len() != bytes.len() {
            let (got, expected) = (bytes.len(), place.len());
            return Err(CommError::WrongLength { rank, got, expected });
        }
        self.receive[place].copy_from_slice(&bytes);
        let mut spare = self.comm.spare.borrow_mut();
        if spare.len() < SPARE {
            spare.push(bytes);
        }
        Ok(())
    }

    fn take_what_is_there(&mut self) -> Result<(), CommError> {
        let mut still: Vec<(usize, Range<usize>)> = Vec::new();
        for (rank, place) in std::mem::take(&mut self.wanted) {
            // A later message of a sender must not take the place of an earlier one.
            let silent = still.iter().any(|(other, _)| *other == rank);
            let message = if silent { None } else { self.comm.take_if_there(rank) };
            match message {
                Some(message) => {
                    let bytes = ThreadRank::in_step(rank, self.operation, message)?;
                    self.place(rank, place, bytes)?;
                }
                None => still.push((rank, place)),
            }
        }
        self.wanted = still;
        Ok(())
    }

    fn wait(&mut self) -> Result<(), CommError> {
        if let Some(error) = self.error.take() {
            return Err(error);
        }
        for (rank, place) in std::mem::take(&mut self.wanted) {
            let bytes = self.comm.take(rank, self.operation)?;
            self.place(rank, place, bytes)?;
        }
        if std::mem::take(&mut self.reduces) {
            let (hall, rank) = (&self.comm.office.hall, self.comm.rank);
            hall.wait(rank, self.operation, |content| decode(content, self.maxima))?;
        }
        Ok(())
    }
}

impl Progress for Arrivals<'_> {
    fn poll(&mut self) {
        self.polls += 1;
        if self.reduces {
            let hall = &self.comm.office.hall;
            let taken = hall.try_take(self.operation, |content| decode(content, self.maxima));
            self.reduces = taken.is_none();
        }
        if self.error.is_none() && !self.wanted.is_empty() {
            self.error = self.take_what_is_there().err();
        }
    }
}
