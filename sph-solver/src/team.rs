//! The threads of a rank.

use crate::block::Block;
use crate::lio::{Extremes, Pass};
use crate::records::Record;
use sph_kernels::Real;

/// Particles that one task advances: their rates stay in cache between flux and update.
const GRAIN: usize = 256;

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

    /// Fluxes and update of a block, task by task.
    pub fn advance<const D: usize, S: Real, P: Pass<D, S>>(
        &self,
        pass: &P,
        old: &[Record<S>],
        block: &mut Block<'_, D, S, P::Rate>,
    ) -> Extremes {
        if self.threads() == 1 {
            // On the calling thread: a hand-over per piece would only cost time.
            return block
                .pieces(GRAIN)
                .map(|mut task| advance_task(pass, old, &mut task))
                .fold(Extremes::NONE, Extremes::max);
        }
        let block = block.reborrow();
        self.pool.install(|| halve(pass, old, block))
    }
}

fn halve<const D: usize, S: Real, P: Pass<D, S>>(
    pass: &P,
    old: &[Record<S>],
    mut block: Block<'_, D, S, P::Rate>,
) -> Extremes {
    if block.len() <= GRAIN {
        return advance_task(pass, old, &mut block);
    }
    let middle = (block.len() / 2).next_multiple_of(GRAIN).min(block.len());
    let (left, right) = block.split_at(middle);
    let (a, b) = rayon::join(|| halve(pass, old, left), || halve(pass, old, right));
    a.max(b)
}

fn advance_task<const D: usize, S: Real, P: Pass<D, S>>(
    pass: &P,
    old: &[Record<S>],
    block: &mut Block<'_, D, S, P::Rate>,
) -> Extremes {
    if block.is_empty() {
        return Extremes::NONE;
    }
    pass.flux(block.first, old, block.density, block.rates);
    pass.update(old, block)
}
