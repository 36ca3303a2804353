//! The threads of a rank.

use crate::block::Block;
use crate::lio::{Outcome, Pass};
use crate::records::Record;
use sph_kernels::Real;

/// Particles that one task advances: their rates stay in cache between flux and update.
pub const GRAIN: usize = 256;

/// The threads that share the work of one rank. The thread that owns the team talks to the other
/// ranks; nothing that runs on the team does.
#[derive(Debug)]
pub struct Team {
    pool: rayon::ThreadPool,
}

impl Team {
    /// A team of `threads` threads.
    pub fn new(threads: usize) -> Result<Self, rayon::ThreadPoolBuildError> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.max(1)).build()?;
        Ok(Self { pool })
    }

    /// Number of threads.
    pub fn threads(&self) -> usize {
        self.pool.current_num_threads()
    }

    /// Runs parallel work on the team.
    pub fn install<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        self.pool.install(work)
    }

    /// Fluxes and update of a block, task by task. Tasks end where clusters do.
    pub fn advance<const D: usize, S: Real, P: Pass<D, S>>(
        &self,
        pass: &P,
        old: &[Record<S>],
        block: &mut Block<'_, D, S, P::Rate>,
    ) -> Outcome {
        if self.threads() == 1 {
            // On the calling thread: a hand-over per piece would only cost time.
            return block
                .pieces(GRAIN, pass.clusters())
                .map(|mut task| advance_task(pass, old, &mut task))
                .fold(Outcome::NONE, Outcome::join);
        }
        let block = block.reborrow();
        self.pool.install(|| halve(pass, old, block))
    }
}

fn halve<const D: usize, S: Real, P: Pass<D, S>>(
    pass: &P,
    old: &[Record<S>],
    mut block: Block<'_, D, S, P::Rate>,
) -> Outcome {
    let middle = block.cut(block.len().div_ceil(2), pass.clusters());
    if block.len() <= GRAIN || middle == block.len() {
        return advance_task(pass, old, &mut block);
    }
    let (left, right) = block.split_at(middle);
    let (a, b) = rayon::join(|| halve(pass, old, left), || halve(pass, old, right));
    a.join(b)
}

fn advance_task<const D: usize, S: Real, P: Pass<D, S>>(
    pass: &P,
    old: &[Record<S>],
    block: &mut Block<'_, D, S, P::Rate>,
) -> Outcome {
    if block.is_empty() {
        return Outcome::NONE;
    }
    let effects = pass.flux(old, block);
    Outcome { extremes: pass.update(old, block), effects }
}
