//! Where ranks that are threads of one process meet for an operation of all.
//!
//! Every operation is a meeting with a number: each rank comes once, may leave a contribution, may
//! wait until all have come, and goes. What the ranks bring is combined in place, in an order that
//! does not matter, so that a reduction holds one copy of its values and not one per pair of ranks.

use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

use super::{CommError, Operation};

/// What lies on the table of a meeting. All ranks bring the same kind.
#[derive(Debug)]
pub(super) enum Content {
    /// Nothing but the presence of all.
    Nothing,
    /// Keys of `order::to_ordered`, combined by maximum.
    Maxima(Vec<u64>),
    /// Combined by addition modulo 2⁶⁴.
    Sums(Vec<u64>),
    /// Something of each rank, in rank order.
    Gathered(Vec<Option<Arc<[u8]>>>),
    /// For each rank its letters, with their senders.
    Letters(Vec<Vec<(usize, Vec<u8>)>>),
}

#[derive(Debug)]
struct Meeting {
    name: &'static str,
    /// The rank that came first, and how many have come and gone.
    first: usize,
    came: usize,
    gone: usize,
    content: Content,
}

#[derive(Debug, Default)]
struct Agenda {
    /// Number of the meeting at the front.
    front: u64,
    meetings: VecDeque<Meeting>,
    /// For each rank that has returned, its number of operations.
    returned: Vec<Option<u64>>,
    failure: Option<(usize, String)>,
}

/// The meetings in progress, and the first failure of a rank.
#[derive(Debug)]
pub(super) struct Hall {
    ranks: usize,
    agenda: Mutex<Agenda>,
    changed: Condvar,
}

/// Nothing in this module panics while it holds the lock, so a poisoned lock still guards sound
/// data.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Agenda {
    fn meeting(&mut self, number: u64) -> Option<&mut Meeting> {
        self.meetings.get_mut(number.checked_sub(self.front)? as usize)
    }
}

impl Hall {
    pub fn new(ranks: usize) -> Self {
        let agenda = Agenda { front: 1, returned: vec![None; ranks], ..Agenda::default() };
        Self { ranks, agenda: Mutex::new(agenda), changed: Condvar::new() }
    }

    pub fn ranks(&self) -> usize {
        self.ranks
    }

    /// Comes to the meeting of an operation: `combine` adds what this rank brings to what lies
    /// there, which is `Nothing` when it is the first. An error when the others are in another
    /// operation.
    pub fn come(
        &self,
        rank: usize,
        operation: Operation,
        combine: impl FnOnce(&mut Content) -> Result<(), Mismatch>,
    ) -> Result<(), CommError> {
        let Operation { name, number } = operation;
        let mut agenda = lock(&self.agenda);
        if agenda.meeting(number).is_none() {
            // Meetings begin in the order of their numbers, because each rank counts from one.
            let content = Content::Nothing;
            agenda.meetings.push_back(Meeting { name, first: rank, came: 0, gone: 0, content });
        }
        let ranks = self.ranks;
        let Some(meeting) = agenda.meeting(number) else { return Ok(()) };
        let first = meeting.first;
        if meeting.name != name {
            let theirs = Operation { name: meeting.name, number };
            return Err(CommError::OutOfStep { rank: first, theirs, ours: operation });
        }
        combine(&mut meeting.content).map_err(|Mismatch { got, expected }| {
            CommError::WrongLength { rank: first, got, expected }
        })?;
        meeting.came += 1;
        if meeting.came == ranks {
            self.changed.notify_all();
        }
        Ok(())
    }

    /// Waits until all have come, but not for a rank that has failed or returned; takes something
    /// of what lies there, and goes.
    pub fn wait<R>(
        &self,
        rank: usize,
        operation: Operation,
        take: impl FnOnce(&mut Content) -> R,
    ) -> Result<R, CommError> {
        let number = operation.number;
        let mut agenda = lock(&self.agenda);
        loop {
            if let Some(meeting) = agenda.meeting(number)
                && meeting.came == self.ranks
            {
                let result = take(&mut meeting.content);
                Self::go(&mut agenda, number, self.ranks);
                return Ok(result);
            }
            if let Some((rank, message)) = agenda.failure.clone() {
                return Err(CommError::RankFailed { rank, message });
            }
            let missing = |count: &Option<u64>| count.is_some_and(|count| count < number);
            if let Some(missing) = agenda.returned.iter().position(missing) {
                let message = format!("it returned while rank {rank} waited for a message from it");
                return Err(CommError::RankFailed { rank: missing, message });
            }
            agenda = self.changed.wait(agenda).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Like [`Hall::wait`] when all have come; otherwise nothing.
    pub fn try_take<R>(
        &self,
        operation: Operation,
        take: impl FnOnce(&mut Content) -> R,
    ) -> Option<R> {
        let mut agenda = lock(&self.agenda);
        let meeting = agenda.meeting(operation.number)?;
        if meeting.came < self.ranks {
            return None;
        }
        let result = take(&mut meeting.content);
        Self::go(&mut agenda, operation.number, self.ranks);
        Some(result)
    }

    /// Goes without waiting for anybody.
    pub fn leave(&self, operation: Operation) {
        Self::go(&mut lock(&self.agenda), operation.number, self.ranks);
    }

    fn go(agenda: &mut Agenda, number: u64, ranks: usize) {
        if let Some(meeting) = agenda.meeting(number) {
            meeting.gone += 1;
        }
        while agenda.meetings.front().is_some_and(|meeting| meeting.gone == ranks) {
            agenda.meetings.pop_front();
            agenda.front += 1;
        }
    }

    /// Notes the first failure and wakes everybody.
    pub fn fail(&self, rank: usize, message: String) {
        lock(&self.agenda).failure.get_or_insert((rank, message));
        self.changed.notify_all();
    }

    /// Notes that a rank has returned after so many operations, and wakes everybody.
    pub fn finish(&self, rank: usize, operations: u64) {
        lock(&self.agenda).returned[rank] = Some(operations);
        self.changed.notify_all();
    }

    pub fn failure(&self) -> Option<(usize, String)> {
        lock(&self.agenda).failure.clone()
    }
}

/// Ranks bring unequal numbers of bytes to a reduction.
#[derive(Debug)]
pub(super) struct Mismatch {
    got: usize,
    expected: usize,
}

/// Combines values of equal number, element by element.
fn reduce(
    total: &mut Vec<u64>,
    mine: Vec<u64>,
    first: bool,
    combine: fn(u64, u64) -> u64,
) -> Result<(), Mismatch> {
    if first {
        *total = mine;
        return Ok(());
    }
    if total.len() != mine.len() {
        return Err(Mismatch { got: 8 * total.len(), expected: 8 * mine.len() });
    }
    for (total, mine) in total.iter_mut().zip(mine) {
        *total = combine(*total, mine);
    }
    Ok(())
}

impl Content {
    /// Adds the keys of this rank to a reduction by maximum.
    pub fn add_maxima(&mut self, mine: Vec<u64>) -> Result<(), Mismatch> {
        let first = matches!(self, Self::Nothing);
        if first {
            *self = Self::Maxima(vec![]);
        }
        match self {
            Self::Maxima(total) => reduce(total, mine, first, u64::max),
            _ => Ok(()),
        }
    }

    /// Adds the numbers of this rank to a sum.
    pub fn add_sums(&mut self, mine: Vec<u64>) -> Result<(), Mismatch> {
        let first = matches!(self, Self::Nothing);
        if first {
            *self = Self::Sums(vec![]);
        }
        match self {
            Self::Sums(total) => reduce(total, mine, first, u64::wrapping_add),
            _ => Ok(()),
        }
    }

    /// Lays down something of this rank for all.
    pub fn add_share(&mut self, ranks: usize, rank: usize, bytes: &[u8]) {
        if matches!(self, Self::Nothing) {
            *self = Self::Gathered(vec![None; ranks]);
        }
        if let Self::Gathered(all) = self {
            all[rank] = Some(bytes.into());
        }
    }

    /// Lays down the letters of this rank.
    pub fn add_letters(&mut self, ranks: usize, rank: usize, letters: Vec<(usize, Vec<u8>)>) {
        if matches!(self, Self::Nothing) {
            *self = Self::Letters((0..ranks).map(|_| Vec::new()).collect());
        }
        if let Self::Letters(all) = self {
            for (to, bytes) in letters.into_iter().filter(|(_, bytes)| !bytes.is_empty()) {
                all[to].push((rank, bytes));
            }
        }
    }

    /// The result of a reduction.
    pub fn values(&self) -> &[u64] {
        match self {
            Self::Maxima(values) | Self::Sums(values) => values,
            _ => &[],
        }
    }
}
