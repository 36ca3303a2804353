//! `--log`: progress as lines with the time, for batch jobs.

use crate::run::Status;
use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// A line comes after so much of a run has been done, but not more often than [`SHORTEST`] and not
/// more rarely than [`LONGEST`].
const SHARE: f64 = 0.01;
const SHORTEST: Duration = Duration::from_secs(10);
const LONGEST: Duration = Duration::from_secs(60);

/// The log of a run. Every line goes to the system at once, begins with the time (UTC) and holds no
/// control characters.
#[derive(Debug)]
pub struct Log {
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    file: File,
    told: Option<(Instant, f64)>,
}

impl Log {
    /// Opens a file to add lines to it.
    pub fn open(path: &Path) -> io::Result<Self> {
        let file = File::options().create(true).append(true).open(path)?;
        Ok(Self { state: Mutex::new(State { file, told: None }) })
    }

    /// Adds a line. A log that cannot be written ends no run.
    pub fn line(&self, text: &str) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let _ = state.file.write_all(stamped(SystemTime::now(), text).as_bytes());
    }

    /// Adds the state of a run when it is time to.
    pub fn show(&self, status: Status) {
        let done = ((status.time - status.start) / (status.end - status.start)).clamp(0.0, 1.0);
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        if !due(state.told.map(|(when, done)| (when.elapsed(), done)), done) {
            return;
        }
        state.told = Some((Instant::now(), done));
        drop(state);
        let seconds = status.elapsed.as_secs_f64().max(1e-9);
        self.line(&format!(
            "t = {:.6} s, step {}, {:.1} %, {:.2} M updates/s, {:.1} % exposed",
            status.time,
            status.step,
            100.0 * done,
            status.particle_updates as f64 / seconds / 1e6,
            100.0 * status.exposed_seconds / seconds,
        ));
    }
}

/// Whether a line is due: `told` is how long ago the last one was, and what was done then.
fn due(told: Option<(Duration, f64)>, done: f64) -> bool {
    told.is_none_or(|(ago, before)| ago >= LONGEST || (ago >= SHORTEST && done - before >= SHARE))
}

/// The text as one line after the time.
fn stamped(now: SystemTime, text: &str) -> String {
    let plain: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let seconds = now.duration_since(UNIX_EPOCH).unwrap_or_default().as_secs();
    let (days, rest) = (seconds / 86_400, seconds % 86_400);
    let (year, month, day) = civil(days);
    let (hour, minute, second) = (rest / 3600, rest / 60 % 60, rest % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z {plain}\n")
}

/// Year, month and day of a day counted from 1970-01-01, in years that begin in March, so that the
/// day that leap years add is their last.
fn civil(days: u64) -> (u64, u64, u64) {
    // From 0000-03-01; an era is 400 years.
    let days = days + 719_468;
    let (era, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let (day, month) =
        (day - (153 * month + 2) / 5 + 1, if month < 10 { month + 3 } else { month - 9 });
    (400 * era + year + u64::from(month <= 2), month, day)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_those_of_the_calendar() {
        for (seconds, text) in [
            (0, "1970-01-01T00:00:00Z a b\n"),
            (951_782_399, "2000-02-28T23:59:59Z a b\n"),
            (951_782_400, "2000-02-29T00:00:00Z a b\n"),
            (1_709_251_199, "2024-02-29T23:59:59Z a b\n"),
            (4_107_542_400, "2100-03-01T00:00:00Z a b\n"),
        ] {
            assert_eq!(stamped(UNIX_EPOCH + Duration::from_secs(seconds), "a\nb"), text);
        }
    }

    #[test]
    fn lines_come_neither_too_often_nor_too_rarely() {
        let after = |seconds, before, done| due(Some((Duration::from_secs(seconds), before)), done);
        assert!(due(None, 0.0));
        assert!(!after(5, 0.0, 0.5) && after(11, 0.0, 0.5));
        assert!(!after(30, 0.5, 0.501) && after(61, 0.5, 0.501));
    }
}
