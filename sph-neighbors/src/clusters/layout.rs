//! Which targets form a cluster.

use super::CLUSTER;
use std::ops::Range;

/// Divides consecutive targets into clusters of [`CLUSTER`](crate::CLUSTER), such that no cluster
/// crosses a break.
///
/// Lists of one set of targets share a layout, so that a sweep visits the sources of several lists
/// for one cluster.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Clusters {
    /// Number of targets in front of each segment, and of all.
    starts: Vec<usize>,
    /// Number of clusters in front of each segment, and of all.
    clusters: Vec<usize>,
}

impl Clusters {
    /// Clusters of `targets` targets; a new one begins at each of `breaks`, which ascend.
    ///
    /// # Panics
    ///
    /// When the breaks descend or exceed `targets`.
    ///
    /// ```
    /// use sph_neighbors::Clusters;
    ///
    /// let clusters = Clusters::new(20, &[9]);
    /// let ranges: Vec<_> = clusters.within(0..20).map(|(_, targets)| targets).collect();
    /// assert_eq!(ranges, [0..8, 8..9, 9..17, 17..20]);
    /// ```
    pub fn new(targets: usize, breaks: &[usize]) -> Self {
        let mut starts = vec![0];
        let mut clusters = vec![0];
        for &end in breaks.iter().chain([&targets]) {
            let start = starts[starts.len() - 1];
            assert!(start <= end && end <= targets, "breaks ascend up to the number of targets");
            if start < end {
                clusters.push(clusters[clusters.len() - 1] + (end - start).div_ceil(CLUSTER));
                starts.push(end);
            }
        }
        Self { starts, clusters }
    }

    /// Clusters of these targets; a new one also begins where a target is farther than `jump` from
    /// the one before it, along any axis. The targets of a cluster are then never farther than
    /// seven jumps from each other, which keeps coordinates that wrap around from meeting.
    ///
    /// # Panics
    ///
    /// As [`new`](Self::new).
    pub fn without_jumps<const D: usize>(
        targets: &[[f64; D]],
        breaks: &[usize],
        jump: f64,
    ) -> Self {
        // Written so that a target without a place is far from all others.
        let near =
            |x: &[f64; D], y: &[f64; D]| (0..D).all(|axis| (x[axis] - y[axis]).abs() <= jump);
        let pairs = targets.windows(2).enumerate();
        let jumps = pairs.filter(|(_, pair)| !near(&pair[0], &pair[1])).map(|(t, _)| t + 1);
        let mut all: Vec<usize> = breaks.iter().copied().chain(jumps).collect();
        all.sort_unstable();
        Self::new(targets.len(), &all)
    }

    /// Number of clusters.
    pub fn len(&self) -> usize {
        self.clusters.last().copied().unwrap_or(0)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of targets.
    pub fn targets(&self) -> usize {
        self.starts.last().copied().unwrap_or(0)
    }

    /// The cluster of a target.
    ///
    /// # Panics
    ///
    /// When there is no such target.
    #[inline]
    pub fn containing(&self, target: usize) -> usize {
        assert!(target < self.targets(), "no target {target} among {}", self.targets());
        let segment = self.starts.partition_point(|&start| start <= target) - 1;
        self.clusters[segment] + (target - self.starts[segment]) / CLUSTER
    }

    /// The targets of a cluster.
    ///
    /// # Panics
    ///
    /// When there is no such cluster.
    #[inline]
    pub fn targets_of(&self, cluster: usize) -> Range<usize> {
        assert!(cluster < self.len(), "no cluster {cluster} among {}", self.len());
        let segment = self.clusters.partition_point(|&first| first <= cluster) - 1;
        let start = self.starts[segment] + (cluster - self.clusters[segment]) * CLUSTER;
        start..self.starts[segment + 1].min(start + CLUSTER)
    }

    /// The first target at or behind `target` with which a cluster begins, or the number of targets.
    pub fn next_start(&self, target: usize) -> usize {
        if target >= self.targets() {
            return self.targets();
        }
        let own = self.targets_of(self.containing(target));
        if own.start == target { target } else { own.end }
    }

    /// The clusters that hold targets of a range, with those of their targets that are in it.
    ///
    /// Work is divided best where clusters begin: at a break or a multiple of
    /// [`CLUSTER`](crate::CLUSTER) behind one.
    ///
    /// # Panics
    ///
    /// When the range exceeds the targets.
    pub fn within(&self, range: Range<usize>) -> impl Iterator<Item = (usize, Range<usize>)> {
        let mut next = range.start;
        let mut cluster = if range.is_empty() { 0 } else { self.containing(range.start) };
        std::iter::from_fn(move || {
            if next >= range.end {
                return None;
            }
            let end = self.targets_of(cluster).end.min(range.end);
            let item = (cluster, next..end);
            next = end;
            cluster += 1;
            Some(item)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_jump_ends_a_cluster() {
        let targets = [[0.0, 0.0], [1.0, 0.0], [1.0, 9.0], [f64::NAN, 9.0], [1.0, 9.0], [0.0, 9.0]];
        let clusters = Clusters::without_jumps(&targets, &[1], 2.0);
        let ranges: Vec<_> = clusters.within(0..6).map(|(_, targets)| targets).collect();
        assert_eq!(ranges, [0..1, 1..2, 2..3, 3..4, 4..6]);
    }

    proptest! {
        #[test]
        fn every_target_is_in_one_cluster(
            targets in 0_usize..100,
            a in 0_usize..100,
            b in 0_usize..100,
            from in 0_usize..100,
            to in 0_usize..100,
        ) {
            let breaks = [a.min(b).min(targets), a.max(b).min(targets)];
            let clusters = Clusters::new(targets, &breaks);
            prop_assert_eq!(clusters.targets(), targets);
            let range = from.min(to).min(targets)..from.max(to).min(targets);
            let mut next = range.start;
            for (cluster, some) in clusters.within(range.clone()) {
                let all = clusters.targets_of(cluster);
                prop_assert_eq!(some.start, next);
                prop_assert!(all.start <= some.start && some.end <= all.end && !some.is_empty());
                prop_assert!(all.len() <= CLUSTER);
                prop_assert!(breaks.iter().all(|b| *b <= all.start || all.end <= *b));
                for t in some.clone() {
                    prop_assert_eq!(clusters.containing(t), cluster);
                }
                next = some.end;
                let start = clusters.next_start(some.start);
                prop_assert!(start == all.start || (some.start > all.start && start == all.end));
            }
            prop_assert_eq!(next, range.end.max(range.start));
        }
    }
}
