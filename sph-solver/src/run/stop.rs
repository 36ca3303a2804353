//! Requests to end a run before its time: signals and a limit of wall-clock time.

use std::fmt;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Whether somebody wants the run to end. Clones share the request.
#[derive(Debug, Clone, Default)]
pub struct Stop {
    requested: Arc<AtomicBool>,
    deadline: Option<Instant>,
}

/// Why a run ended before its time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum StopReason {
    /// The limit of wall-clock time was reached.
    Limit,
    /// A signal asked for it.
    Signal,
}

impl Stop {
    /// A request that SIGTERM, SIGINT and SIGUSR1 make; `mpirun` passes the last one on to its ranks.
    /// A second SIGINT ends the process at once.
    pub fn on_signals() -> io::Result<Self> {
        let stop = Self::default();
        #[cfg(unix)]
        {
            use signal_hook::consts::{SIGINT, SIGTERM, SIGUSR1};
            use signal_hook::flag;
            // Registered before what sets it, so that the first SIGINT finds it unset.
            let interrupted = Arc::new(AtomicBool::new(false));
            flag::register_conditional_shutdown(SIGINT, 128 + SIGINT, Arc::clone(&interrupted))?;
            flag::register(SIGINT, interrupted)?;
            for signal in [SIGTERM, SIGINT, SIGUSR1] {
                flag::register(signal, Arc::clone(&stop.requested))?;
            }
        }
        Ok(stop)
    }

    /// The same with a deadline; without one when it is `None`.
    #[must_use]
    pub fn with_deadline(self, deadline: Option<Instant>) -> Self {
        Self { deadline, ..self }
    }

    /// Asks for the end.
    pub fn request(&self) {
        self.requested.store(true, Ordering::Relaxed);
    }

    /// Why this process should end now, if it should.
    pub fn reason(&self) -> Option<StopReason> {
        if self.requested.load(Ordering::Relaxed) {
            return Some(StopReason::Signal);
        }
        let over = self.deadline.is_some_and(|deadline| Instant::now() >= deadline);
        over.then_some(StopReason::Limit)
    }
}

impl StopReason {
    /// As a number that ranks can reduce by maximum; 0 is no reason.
    pub fn to_number(reason: Option<Self>) -> f64 {
        match reason {
            None => 0.0,
            Some(Self::Limit) => 1.0,
            Some(Self::Signal) => 2.0,
        }
    }

    /// Back from [`to_number`](Self::to_number).
    pub fn from_number(number: f64) -> Option<Self> {
        match number {
            n if n >= 2.0 => Some(Self::Signal),
            n if n >= 1.0 => Some(Self::Limit),
            _ => None,
        }
    }
}

impl fmt::Display for StopReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Limit => "at the limit of wall-clock time (--max-wall)",
            Self::Signal => "by a signal",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn a_request_is_seen_by_clones_and_a_deadline_passes() {
        let stop = Stop::default();
        let clone = stop.clone();
        assert_eq!(clone.reason(), None);
        let now = Instant::now();
        let later = clone.clone().with_deadline(Some(now + Duration::from_secs(3600)));
        assert_eq!(later.reason(), None);
        assert_eq!(clone.clone().with_deadline(Some(now)).reason(), Some(StopReason::Limit));
        stop.request();
        assert_eq!(clone.reason(), Some(StopReason::Signal));
    }

    #[test]
    fn reasons_survive_a_reduction() {
        for reason in [None, Some(StopReason::Limit), Some(StopReason::Signal)] {
            assert_eq!(StopReason::from_number(StopReason::to_number(reason)), reason);
        }
    }
}
