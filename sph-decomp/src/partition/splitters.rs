//! Finds, over all ranks at once, the keys at which sorted particles would be cut, without ever
//! sorting or gathering them.
//!
//! Several groups are cut at the same time, each at one or several places. In every round each
//! search splits its interval of keys into 64 bins, all ranks add up the weights in these bins,
//! and the search goes on in the bin that holds its target. After `bits / 6` rounds the key is
//! known. All sums are of integers, so the result does not depend on who holds which particle.

use crate::{CommError, Communicator};

/// Bits of the key that a round decides.
const ROUND: u32 = 6;
const BINS: usize = 1 << ROUND;

/// A particle as the search sees it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Keyed {
    /// The group it belongs to.
    pub group: u32,
    /// Its key.
    pub key: u64,
    /// Its weight.
    pub weight: u64,
}

/// A cut that is looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Target {
    /// The group to cut.
    pub group: u32,
    /// The weight that shall lie below the cut.
    pub weight: u64,
}

/// A cut that was found: keys below `key` lie on the low side. Of the two keys around the target,
/// the one whose weight is nearer to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Cut {
    /// The first key on the high side.
    pub key: u64,
}

/// What a search knows after some rounds: the high bits of the key, and the weight below them.
#[derive(Debug, Clone, Copy)]
struct Search {
    prefix: u64,
    below: u64,
    /// Weight in the last bin it went into.
    inside: u64,
}

/// Finds all cuts. Collective; `targets` and `bits` are the same on all ranks.
///
/// Keys are below 2^`bits`; `bits` is a multiple of six.
pub(super) fn find<C: Communicator>(
    comm: &C,
    particles: &[Keyed],
    targets: &[Target],
    bits: u32,
) -> Result<Vec<Cut>, CommError> {
    debug_assert!(bits.is_multiple_of(ROUND));
    let mut searches = vec![Search { prefix: 0, below: 0, inside: 0 }; targets.len()];
    for shift in (0..bits / ROUND).rev().map(|round| round * ROUND) {
        // Searches of one group that are still in the same interval share their bins.
        let mut intervals: Vec<(u32, u64)> =
            targets.iter().zip(&searches).map(|(t, s)| (t.group, s.prefix)).collect();
        intervals.sort_unstable();
        intervals.dedup();
        let mut bins = vec![0_u64; intervals.len() * BINS];
        let first = group_starts(&intervals);
        for particle in particles {
            let prefix = particle.key.checked_shr(shift + ROUND).unwrap_or(0);
            let group = particle.group as usize;
            let Some(&[start, end]) = first.get(group..group + 2) else { continue };
            let found = intervals[start..end].binary_search_by_key(&prefix, |interval| interval.1);
            if let Ok(interval) = found {
                let bin = (particle.key >> shift) as usize & (BINS - 1);
                bins[(start + interval) * BINS + bin] += particle.weight;
            }
        }
        comm.sum_u64(&mut bins)?;
        for (search, target) in searches.iter_mut().zip(targets) {
            let interval = intervals.partition_point(|i| *i < (target.group, search.prefix));
            descend(search, target.weight, &bins[interval * BINS..(interval + 1) * BINS]);
        }
    }
    let cut = |(search, target): (&Search, &Target)| {
        let missing = target.weight.saturating_sub(search.below);
        // Of two equally good cuts the higher one, so that no side stays empty without need.
        let nearer = missing >= search.inside.saturating_sub(missing);
        let above = u64::from(nearer && search.inside > 0);
        Cut { key: search.prefix + above }
    };
    Ok(searches.iter().zip(targets).map(cut).collect())
}

/// Goes into the bin that holds the target: the last one with no more than the target below it.
fn descend(search: &mut Search, target: u64, bins: &[u64]) {
    let mut below = search.below;
    let mut choice = (0, below, bins[0]);
    for (bin, &weight) in bins.iter().enumerate() {
        // An empty bin is not gone into, so that a cut lies beside a particle.
        if below <= target && (weight > 0 || bin == 0) {
            choice = (bin, below, weight);
        }
        below += weight;
    }
    search.prefix = search.prefix * BINS as u64 + choice.0 as u64;
    search.below = choice.1;
    search.inside = choice.2;
}

/// For each group the place of its first interval, and one more for the end.
fn group_starts(intervals: &[(u32, u64)]) -> Vec<usize> {
    let groups = intervals.last().map_or(0, |last| last.0 as usize + 1);
    let start = |group: usize| intervals.partition_point(|interval| (interval.0 as usize) < group);
    (0..=groups).map(start).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Solo;
    use proptest::prelude::*;

    /// The weight below a cut.
    fn below(particles: &[Keyed], group: u32, key: u64) -> u64 {
        let low = particles.iter().filter(|p| p.group == group && p.key < key);
        low.map(|p| p.weight).sum()
    }

    proptest! {
        #[test]
        fn no_other_cut_is_nearer_to_the_target(
            keys in prop::collection::vec((0_u32..3, 0_u64..4096, 0_u64..9), 0..60),
            parts in 2_u64..6,
        ) {
            let particles: Vec<Keyed> =
                keys.iter().map(|&(group, key, weight)| Keyed { group, key, weight }).collect();
            let mut targets = Vec::new();
            for group in 0..3 {
                let total = below(&particles, group, u64::MAX);
                targets.extend((1..parts).map(|k| Target { group, weight: total * k / parts }));
            }
            let cuts = find(&Solo, &particles, &targets, 12).unwrap();
            for (cut, target) in cuts.iter().zip(&targets) {
                let miss = |key| below(&particles, target.group, key).abs_diff(target.weight);
                let best = (0..=4096).map(miss).min().unwrap();
                prop_assert_eq!(miss(cut.key), best, "{:?} {:?}", cut, target);
            }
        }
    }
}
