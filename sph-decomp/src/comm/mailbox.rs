//! Mailboxes of ranks that are threads of one process.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use super::{CommError, Operation};

/// A message and the number of the operation it belongs to.
#[derive(Debug)]
pub(super) struct Message {
    pub operation: Operation,
    pub bytes: Vec<u8>,
}

#[derive(Debug, Default)]
struct Inbox {
    /// One queue per sender, first in, first out.
    queues: Vec<VecDeque<Message>>,
    /// Senders that have returned and will never write again.
    finished: Vec<bool>,
}

#[derive(Debug)]
struct Mailbox {
    inbox: Mutex<Inbox>,
    changed: Condvar,
}

/// The mailboxes of all ranks, and the first failure among them.
#[derive(Debug)]
pub(super) struct PostOffice {
    boxes: Vec<Mailbox>,
    failed: AtomicBool,
    failure: Mutex<Option<(usize, String)>>,
}

/// Nothing in this module panics while it holds a lock, so a poisoned lock still guards sound data.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl PostOffice {
    pub fn new(ranks: usize) -> Self {
        let inbox = || Inbox {
            queues: (0..ranks).map(|_| VecDeque::new()).collect(),
            finished: vec![false; ranks],
        };
        let boxes = (0..ranks)
            .map(|_| Mailbox { inbox: Mutex::new(inbox()), changed: Condvar::new() })
            .collect();
        Self { boxes, failed: AtomicBool::new(false), failure: Mutex::new(None) }
    }

    pub fn ranks(&self) -> usize {
        self.boxes.len()
    }

    pub fn post(&self, from: usize, to: usize, message: Message) {
        let mailbox = &self.boxes[to];
        lock(&mailbox.inbox).queues[from].push_back(message);
        mailbox.changed.notify_all();
    }

    /// The next message from a rank, if it is already there.
    pub fn try_take(&self, to: usize, from: usize) -> Option<Message> {
        lock(&self.boxes[to].inbox).queues[from].pop_front()
    }

    /// The next message from a rank; waits for it, but not for a rank that has failed or returned.
    pub fn take(&self, to: usize, from: usize) -> Result<Message, CommError> {
        let mailbox = &self.boxes[to];
        let mut inbox = lock(&mailbox.inbox);
        loop {
            if let Some(message) = inbox.queues[from].pop_front() {
                return Ok(message);
            }
            if self.failed.load(Ordering::Acquire) {
                drop(inbox);
                let (rank, message) = self.failure().unwrap_or_default();
                return Err(CommError::RankFailed { rank, message });
            }
            if inbox.finished[from] {
                let message = format!("it returned while rank {to} waited for a message from it");
                return Err(CommError::RankFailed { rank: from, message });
            }
            inbox = mailbox.changed.wait(inbox).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Notes the first failure and wakes everybody.
    pub fn fail(&self, rank: usize, message: String) {
        lock(&self.failure).get_or_insert((rank, message));
        self.failed.store(true, Ordering::Release);
        self.wake(|_| ());
    }

    /// Notes that a rank has returned and wakes everybody.
    pub fn finish(&self, rank: usize) {
        self.wake(|inbox| inbox.finished[rank] = true);
    }

    pub fn failure(&self) -> Option<(usize, String)> {
        lock(&self.failure).clone()
    }

    fn wake(&self, change: impl Fn(&mut Inbox)) {
        for mailbox in &self.boxes {
            // Taken and released, so that nobody is between its check and its wait.
            change(&mut lock(&mailbox.inbox));
            mailbox.changed.notify_all();
        }
    }
}
