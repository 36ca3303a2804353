//! Mailboxes of ranks that are threads of one process, for the messages of passes.

use std::collections::{BTreeMap, VecDeque};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use super::meeting::Hall;
use super::{CommError, Operation};

/// A message and the operation it belongs to.
#[derive(Debug)]
pub(super) struct Message {
    pub operation: Operation,
    pub bytes: Vec<u8>,
}

/// Messages by sender, first in, first out; only of those that have ever written.
type Inbox = BTreeMap<usize, VecDeque<Message>>;

#[derive(Debug, Default)]
struct Mailbox {
    inbox: Mutex<Inbox>,
    changed: Condvar,
    /// Whether the owner has returned and will never write again.
    returned: AtomicBool,
}

/// The mailboxes of all ranks, and the hall in which they meet.
#[derive(Debug)]
pub(super) struct PostOffice {
    boxes: Vec<Mailbox>,
    failed: AtomicBool,
    pub hall: Hall,
}

/// Nothing in this module panics while it holds a lock, so a poisoned lock still guards sound data.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn next(inbox: &mut Inbox, from: usize) -> Option<Message> {
    inbox.get_mut(&from)?.pop_front()
}

impl PostOffice {
    pub fn new(ranks: usize) -> Self {
        let boxes = (0..ranks).map(|_| Mailbox::default()).collect();
        Self { boxes, failed: AtomicBool::new(false), hall: Hall::new(ranks) }
    }

    pub fn post(&self, from: usize, to: usize, message: Message) {
        let mailbox = &self.boxes[to];
        lock(&mailbox.inbox).entry(from).or_default().push_back(message);
        mailbox.changed.notify_all();
    }

    /// The next message from a rank, if it is already there.
    pub fn try_take(&self, to: usize, from: usize) -> Option<Message> {
        next(&mut lock(&self.boxes[to].inbox), from)
    }

    /// The next message from a rank; waits for it, but not for a rank that has failed or returned.
    pub fn take(&self, to: usize, from: usize) -> Result<Message, CommError> {
        let mailbox = &self.boxes[to];
        let mut inbox = lock(&mailbox.inbox);
        loop {
            if let Some(message) = next(&mut inbox, from) {
                return Ok(message);
            }
            if self.failed.load(Ordering::Acquire) {
                drop(inbox);
                let (rank, message) = self.failure().unwrap_or_default();
                return Err(CommError::RankFailed { rank, message });
            }
            if self.boxes[from].returned.load(Ordering::Acquire) {
                let message = format!("it returned while rank {to} waited for a message from it");
                return Err(CommError::RankFailed { rank: from, message });
            }
            inbox = mailbox.changed.wait(inbox).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Notes the first failure and wakes everybody.
    pub fn fail(&self, rank: usize, message: String) {
        self.hall.fail(rank, message);
        self.failed.store(true, Ordering::Release);
        self.wake();
    }

    /// Notes that a rank has returned after so many operations, and wakes everybody.
    pub fn finish(&self, rank: usize, operations: u64) {
        self.hall.finish(rank, operations);
        self.boxes[rank].returned.store(true, Ordering::Release);
        self.wake();
    }

    pub fn failure(&self) -> Option<(usize, String)> {
        self.hall.failure()
    }

    fn wake(&self) {
        for mailbox in &self.boxes {
            // Taken and released, so that nobody is between its check and its wait.
            drop(lock(&mailbox.inbox));
            mailbox.changed.notify_all();
        }
    }
}
