//! The clock of the work of a pass.

use std::cell::Cell;
use std::time::Instant;

/// Seconds of work, on the wall and on a core.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Work {
    pub wall: f64,
    pub thread: f64,
}

/// Adds up the time of several pieces of work of this thread.
#[derive(Debug)]
pub(crate) struct WorkClock {
    /// A clock that is off costs nothing.
    on: bool,
    total: Cell<Work>,
}

impl WorkClock {
    pub fn new(on: bool) -> Self {
        Self { on, total: Cell::default() }
    }

    /// Does a piece of work.
    pub fn time(&self, work: impl FnOnce()) {
        if !self.on {
            return work();
        }
        let (wall, thread) = (Instant::now(), thread_seconds());
        work();
        let wall = wall.elapsed().as_secs_f64();
        let thread = match (thread, thread_seconds()) {
            (Some(before), Some(now)) => now - before,
            _ => wall,
        };
        let total = self.total.get();
        self.total.set(Work { wall: total.wall + wall, thread: total.thread + thread });
    }

    pub fn total(&self) -> Work {
        self.total.get()
    }
}

/// Seconds that this thread has had a core, or `None` where the system does not tell.
#[cfg(unix)]
fn thread_seconds() -> Option<f64> {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Some(time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9)
}

/// Seconds that this thread has had a core, or `None` where the system does not tell.
#[cfg(not(unix))]
fn thread_seconds() -> Option<f64> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn work_counts_and_a_clock_that_is_off_does_not() {
        for on in [true, false] {
            let clock = WorkClock::new(on);
            let mut pieces = 0;
            for _ in 0..2 {
                clock.time(|| {
                    std::thread::sleep(Duration::from_millis(5));
                    pieces += 1;
                });
            }
            assert_eq!(pieces, 2);
            assert_eq!(clock.total().wall >= 0.01, on);
            // Whoever sleeps has no core.
            #[cfg(unix)]
            assert!(clock.total().thread <= 0.5 * clock.total().wall);
        }
    }
}
