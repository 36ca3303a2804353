//! The progress bar of a run.

use crate::run::Status;
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::time::Duration;

/// Steps of the bar: simulated time is a fraction, the bar counts whole things.
const LENGTH: u64 = 10_000;
/// The bar is drawn at most this often.
const FRAMES_PER_SECOND: u8 = 5;

/// Shows how far a run has come, or nothing. Without a terminal nothing is drawn.
#[derive(Debug, Clone)]
pub struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// A bar on standard error; `silent` for none.
    pub fn new(silent: bool) -> Self {
        let target = if silent {
            ProgressDrawTarget::hidden()
        } else {
            ProgressDrawTarget::stderr_with_hz(FRAMES_PER_SECOND)
        };
        let bar = ProgressBar::with_draw_target(Some(LENGTH), target);
        if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {msg}") {
            bar.set_style(style);
        }
        Self { bar }
    }

    /// Draws the state of the run.
    pub fn show(&self, status: Status) {
        if self.bar.is_hidden() {
            return;
        }
        let done = ((status.time - status.start) / (status.end - status.start)).clamp(0.0, 1.0);
        let seconds = status.elapsed.as_secs_f64();
        // Without a step there is nothing to extrapolate from.
        let left = if done > 0.0 { seconds * (1.0 - done) / done } else { 0.0 };
        self.bar.set_position((done * LENGTH as f64) as u64);
        self.bar.set_message(format!(
            "t = {:.4} s, step {}, {:.2} M updates/s, {:.1} % exposed, {} to go",
            status.time,
            status.step,
            status.particle_updates as f64 / seconds.max(1e-9) / 1e6,
            100.0 * status.exposed_seconds / seconds.max(1e-9),
            HumanDuration(Duration::from_secs_f64(left.min(1e9))),
        ));
    }

    /// Writes something else on standard error while the bar steps aside.
    pub fn above(&self, write: impl FnOnce()) {
        self.bar.suspend(write);
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
