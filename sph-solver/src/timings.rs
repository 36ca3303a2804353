//! Wall-clock seconds by phase of a run.

use std::cell::Cell;
use std::time::Instant;

/// A part of the work of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Migration, overlap zone, sorting, cell and neighbour lists.
    Rebuild,
    /// Density pass.
    Density,
    /// Force pass.
    Force,
    /// Snapshots, probes, checkpoints.
    Output,
}

/// Seconds by phase. Filled through shared references, so that a timer does not block the rest.
#[derive(Debug, Clone, Default)]
pub struct Timings {
    seconds: [std::rc::Rc<Cell<f64>>; 4],
}

/// Adds its lifetime to a phase.
#[derive(Debug)]
pub struct Timer {
    account: std::rc::Rc<Cell<f64>>,
    start: Instant,
}

impl Timings {
    /// Starts a timer that ends when it is dropped.
    #[must_use]
    pub fn measure(&self, phase: Phase) -> Timer {
        Timer { account: self.seconds[phase as usize].clone(), start: Instant::now() }
    }

    /// Seconds spent in a phase.
    pub fn seconds(&self, phase: Phase) -> f64 {
        self.seconds[phase as usize].get()
    }
}

impl Drop for Timer {
    fn drop(&mut self) {
        self.account.set(self.account.get() + self.start.elapsed().as_secs_f64());
    }
}

/// What a run counts besides time.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Counters {
    /// Steps made by this process (not by the runs it continues).
    pub steps: u64,
    /// Fluid particles of this rank, summed over those steps.
    pub particle_updates: u64,
    /// Pairs in the lists of this rank (true ones and those in the skin), summed over both passes.
    pub pairs: u64,
    /// List rebuilds.
    pub rebuilds: u64,
    /// Steps in which a particle had moved farther than the lists allow for.
    pub stale_steps: u64,
}
