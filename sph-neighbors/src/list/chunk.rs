//! Lists of a run of targets: the unit of parallel work and of memory.

use super::plan::Plan;
use super::search::Search;
use std::mem::take;

/// Targets per chunk.
pub const CHUNK: usize = 256;

/// Groups of so many targets save more tests by culling their candidates once than it costs.
const CULL: usize = 12;

/// Lists of up to [`CHUNK`] targets.
#[derive(Debug, Clone, Default)]
pub struct Chunk {
    pub entries: Vec<u32>,
    /// First entry and true length of each list.
    pub spans: Vec<(u32, u32)>,
    pub pairs: u64,
    pub tests: u64,
    pub largest_filler: u32,
}

/// Working memory of a task.
#[derive(Debug, Default)]
pub struct Scratch {
    pub search: Search,
    #[cfg(feature = "kiddo")]
    pub near: super::near::Near,
    pub entries: Vec<u32>,
}

impl Chunk {
    /// Finds the neighbours of the targets from `first` on.
    ///
    /// `memory` and `spare` are of the task, with whatever earlier chunks left in them.
    pub fn fill<const D: usize, P: Plan<D>>(
        &mut self,
        plan: &P,
        targets: &[[f64; D]],
        first: usize,
        filler: impl Fn(usize) -> u32,
        pad: usize,
        (memory, spare): (&mut P::Memory, &mut Vec<u32>),
    ) {
        // The first time, entries are collected elsewhere to learn how many they are.
        let known = self.entries.capacity() > 0;
        let mut entries = take(if known { &mut self.entries } else { &mut *spare });
        (self.pairs, self.tests, self.largest_filler) = (0, 0, 0);
        self.spans.clear();
        entries.clear();
        let mut next = 0;
        while next < targets.len() {
            let (length, group) = plan.group(first + next, &targets[next..]);
            if let Some(group) = &group {
                plan.collect(group, memory);
                if length >= CULL {
                    self.tests += P::candidates(memory) as u64;
                    plan.cull(group, memory);
                }
            }
            for (k, x) in targets.iter().enumerate().skip(next).take(length) {
                let start = entries.len();
                let filler = filler(first + k);
                if let Some(group) = &group {
                    plan.test(group, first + k, x, memory, filler, &mut entries);
                    self.tests += P::candidates(memory) as u64;
                }
                let count = entries.len() - start;
                entries.resize(start + count.next_multiple_of(pad), filler);
                self.spans.push((start as u32, count as u32));
                self.pairs += count as u64;
                self.largest_filler = self.largest_filler.max(filler);
            }
            next += length;
        }
        if known {
            self.entries = entries;
        } else {
            // A little more, so that a later build with a few more neighbours fits.
            self.entries.reserve_exact(entries.len() + entries.len() / 32);
            self.entries.extend_from_slice(&entries);
            *spare = entries;
        }
    }

    /// Bytes in use.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + self.entries.capacity() * 4 + self.spans.capacity() * 8
    }
}
