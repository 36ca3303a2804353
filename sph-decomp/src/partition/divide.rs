//! A bisection for more ranks than there are processes.

use super::orb::{Child, Level, Node, Orb, Region};
use super::weights::to_integers;
use super::{PartitionError, check_positions};
use crate::Solo;
use std::ops::Range;

impl<const D: usize> Orb<D> {
    /// Divides particles that one process holds among any number of ranks, and sorts them by rank.
    ///
    /// The cuts are those that [`Orb::build`] makes when so many ranks hold the same particles. The
    /// work per level is one look at each particle in the order of memory, so that ten million
    /// particles take seconds for thousands of ranks.
    ///
    /// `tags` holds what stays with each particle, and `weight` tells its cost from that. Afterwards
    /// the particles of rank `r` are those from `starts[r]` to before `starts[r + 1]`.
    ///
    /// ```
    /// use sph_decomp::{Orb, Partition, PartitionError};
    ///
    /// let mut positions: Vec<[f64; 2]> =
    ///     (0..300).map(|i| [f64::from(i % 30), f64::from(i / 30)]).collect();
    /// let mut ids: Vec<u32> = (0..300).collect();
    /// let (orb, starts) = Orb::divide(3, &mut positions, &mut ids, |_| 1.0)?;
    /// assert_eq!(starts, [0, 100, 200, 300]);
    /// assert!(positions[100..200].iter().all(|x| orb.owner(x) == 1));
    /// # Ok::<(), PartitionError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`Orb::build`]; also when `tags` and `positions` differ in length. No rank at all counts as
    /// one.
    pub fn divide<T>(
        ranks: usize,
        positions: &mut [[f64; D]],
        tags: &mut [T],
        weight: impl Fn(&T) -> f64,
    ) -> Result<(Self, Vec<usize>), PartitionError> {
        if tags.len() != positions.len() {
            let (weights, particles) = (tags.len(), positions.len());
            return Err(PartitionError::Length { weights, particles });
        }
        check_positions(positions)?;
        let costs: Vec<f64> = tags.iter().map(weight).collect();
        let mut weights = to_integers(&Solo, &costs, positions.len())?;
        drop(costs);
        let one_group = vec![0; positions.len()];
        let mut starts = vec![0; ranks.max(1)];
        let mut nodes = Vec::new();
        let mut regions = Vec::new();
        if ranks > 1 {
            regions.push((Region { node: 0, first_rank: 0, ranks }, 0..positions.len()));
        }
        // Breadth first, as all ranks together do it, so that the nodes get the same numbers.
        while !regions.is_empty() {
            let next_node = (nodes.len() + regions.len()) as u32;
            let mut next = Vec::new();
            for (region, range) in regions {
                let level = Level {
                    positions: &positions[range.clone()],
                    weights: &weights[range.clone()],
                    region_of: &one_group[range.clone()],
                };
                let (axis, cut) = level.cut(&Solo, &[region])?[0];
                let is_low = |x: &[f64; D]| x[axis] < cut;
                let middle = split(range.clone(), positions, is_low, &mut weights, tags);
                let below = region.ranks / 2;
                let mut child = |first_rank: usize, ranks: usize, range: Range<usize>| {
                    if ranks == 1 {
                        starts[first_rank] = range.start;
                        return Child::Rank(first_rank as u32);
                    }
                    let node = next_node + next.len() as u32;
                    next.push((Region { node, first_rank, ranks }, range));
                    Child::Node(node)
                };
                let low = child(region.first_rank, below, range.start..middle);
                let high =
                    child(region.first_rank + below, region.ranks - below, middle..range.end);
                nodes.push(Node { axis, cut, low, high });
            }
            regions = next;
        }
        starts.push(positions.len());
        Ok((Self { nodes }, starts))
    }
}

/// Brings the low particles of a range before the others; returns where the others begin.
fn split<const D: usize, T>(
    range: Range<usize>,
    positions: &mut [[f64; D]],
    is_low: impl Fn(&[f64; D]) -> bool,
    weights: &mut [u64],
    tags: &mut [T],
) -> usize {
    let (mut low, mut high) = (range.start, range.end);
    loop {
        while low < high && is_low(&positions[low]) {
            low += 1;
        }
        while low < high && !is_low(&positions[high - 1]) {
            high -= 1;
        }
        if low >= high {
            return low;
        }
        positions.swap(low, high - 1);
        weights.swap(low, high - 1);
        tags.swap(low, high - 1);
    }
}
