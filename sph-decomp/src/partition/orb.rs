//! Weighted orthogonal recursive bisection.

use super::splitters::{Keyed, Target, find};
use super::weights::{LARGEST, to_integers};
use super::{Partition, PartitionError, check_positions};
use crate::Communicator;
use crate::zone::Aabb;

/// Orthogonal recursive bisection: space is cut across its longest side so that the weights on
/// the two sides are as the numbers of ranks there, and each side is cut again. The longest side is
/// that of the box around the heavy particles, those of at least a quarter of the largest weight.
///
/// Built by all ranks together, level by level, with histograms of weights (as in Warren and
/// Salmon, *A parallel hashed oct-tree N-body algorithm*, 1993, and Boman et al., *Zoltan*, 2012):
/// no rank ever holds more than its own particles. Any number of ranks is possible, also more than
/// particles. The partition does not depend on which rank holds which particle.
#[derive(Debug, Clone, PartialEq)]
pub struct Orb<const D: usize> {
    /// The root comes first; without nodes there is one rank.
    pub(super) nodes: Vec<Node>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Node {
    pub axis: usize,
    /// Coordinates below the cut are on the low side.
    pub cut: f64,
    pub low: Child,
    pub high: Child,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Child {
    Node(u32),
    Rank(u32),
}

/// A piece of space that is still to be divided among several ranks.
#[derive(Debug, Clone, Copy)]
pub(super) struct Region {
    pub node: u32,
    pub first_rank: usize,
    pub ranks: usize,
}

/// Bits of a coordinate within its region that the search for a cut resolves.
const BITS: u32 = 42;
/// Particles of at least a quarter of the largest weight decide across which axis a region is cut.
const HEAVY: u64 = (LARGEST * HEAVY_SHARE) as u64;
/// That quarter.
pub(crate) const HEAVY_SHARE: f64 = 0.25;
/// A particle that is in no region any more, because its rank is known.
pub(super) const DONE: u32 = u32::MAX;

impl<const D: usize> Orb<D> {
    /// Divides the particles of all ranks. Collective.
    ///
    /// `weights` is the cost of each particle, for example the measured length of its neighbour
    /// list; an empty slice means that all cost the same.
    ///
    /// ```
    /// use sph_decomp::{Orb, Partition, Solo, ThreadRanks, Communicator, PartitionError};
    ///
    /// // Rank 0 holds all particles at first.
    /// let counts = ThreadRanks::run(3, |comm| {
    ///     let positions: Vec<[f64; 2]> = match comm.rank() {
    ///         0 => (0..300).map(|i| [f64::from(i % 30), f64::from(i / 30)]).collect(),
    ///         _ => vec![],
    ///     };
    ///     let orb = Orb::build(&comm, &positions, &[])?;
    ///     let owners = orb.owners(&positions);
    ///     Ok::<_, PartitionError>([0, 1, 2].map(|rank| owners.iter().filter(|&&o| o == rank).count()))
    /// });
    /// assert_eq!(counts.unwrap()[0], [100, 100, 100]);
    /// ```
    pub fn build<C: Communicator>(
        comm: &C,
        positions: &[[f64; D]],
        weights: &[f64],
    ) -> Result<Self, PartitionError> {
        check_positions(positions)?;
        let weights = to_integers(comm, weights, positions.len())?;
        let mut nodes = Vec::new();
        let mut regions = Vec::new();
        if comm.size() > 1 {
            regions.push(Region { node: 0, first_rank: 0, ranks: comm.size() });
        }
        let mut region_of = vec![if regions.is_empty() { DONE } else { 0 }; positions.len()];
        while !regions.is_empty() {
            let level = Level { positions, weights: &weights, region_of: &region_of };
            let cuts = level.cut(comm, &regions)?;
            // Children get their numbers in the order of the regions, the same on all ranks.
            let mut next = Vec::new();
            let next_node = (nodes.len() + regions.len()) as u32;
            let mut child = |first_rank: usize, ranks: usize| match ranks {
                1 => (Child::Rank(first_rank as u32), DONE),
                _ => {
                    let node = next_node + next.len() as u32;
                    next.push(Region { node, first_rank, ranks });
                    (Child::Node(node), next.len() as u32 - 1)
                }
            };
            let mut heirs = Vec::new();
            for (region, &(axis, cut)) in regions.iter().zip(&cuts) {
                debug_assert_eq!(region.node as usize, nodes.len());
                let below = region.ranks / 2;
                let (low, low_region) = child(region.first_rank, below);
                let (high, high_region) = child(region.first_rank + below, region.ranks - below);
                nodes.push(Node { axis, cut, low, high });
                heirs.push((low_region, high_region));
            }
            for (region, x) in region_of.iter_mut().zip(positions) {
                if let Some(&(low, high)) = heirs.get(*region as usize) {
                    let (axis, cut) = cuts[*region as usize];
                    *region = if x[axis] < cut { low } else { high };
                }
            }
            regions = next;
        }
        Ok(Self { nodes })
    }

    /// The piece of space of every rank: its lower corner, which belongs to it, and its upper one,
    /// which does not. Outer pieces reach to infinity.
    ///
    /// ```
    /// use sph_decomp::{Orb, Solo};
    ///
    /// let orb = Orb::build(&Solo, &[[1.0, 2.0]], &[])?;
    /// assert_eq!(orb.regions(), [([f64::NEG_INFINITY; 2], [f64::INFINITY; 2])]);
    /// # Ok::<(), sph_decomp::PartitionError>(())
    /// ```
    pub fn regions(&self) -> Vec<([f64; D], [f64; D])> {
        let everything = ([f64::NEG_INFINITY; D], [f64::INFINITY; D]);
        let mut regions = vec![everything; self.nodes.len() + 1];
        let mut of_node = vec![everything; self.nodes.len()];
        // A node comes before its children.
        for (number, node) in self.nodes.iter().enumerate() {
            let (mut low, mut high) = (of_node[number], of_node[number]);
            low.1[node.axis] = node.cut;
            high.0[node.axis] = node.cut;
            for (child, region) in [(node.low, low), (node.high, high)] {
                match child {
                    Child::Node(child) => of_node[child as usize] = region,
                    Child::Rank(rank) => regions[rank as usize] = region,
                }
            }
        }
        regions
    }

    /// Calls `visit` with each rank whose piece of space has a point nearer to `x` than `reach`; for a
    /// positive reach, that of `x` itself is one of them.
    ///
    /// What is at rest can be sent by it to whoever will ever come near, as long as the partition
    /// lasts.
    pub fn within(&self, x: &[f64; D], reach: f64, mut visit: impl FnMut(usize)) {
        let root = if self.nodes.is_empty() { Child::Rank(0) } else { Child::Node(0) };
        // Pieces to look at, with their distance from x along each axis.
        let mut pieces = vec![(root, [0.0_f64; D])];
        while let Some((piece, gaps)) = pieces.pop() {
            let node = match piece {
                Child::Rank(rank) => {
                    visit(rank as usize);
                    continue;
                }
                Child::Node(node) => &self.nodes[node as usize],
            };
            let beyond = x[node.axis] - node.cut;
            for (child, gap) in [(node.low, beyond), (node.high, -beyond)] {
                let mut gaps = gaps;
                gaps[node.axis] = gaps[node.axis].max(gap);
                if gaps.iter().map(|gap| gap * gap).sum::<f64>() < reach * reach {
                    pieces.push((child, gaps));
                }
            }
        }
    }
}

impl<const D: usize> Partition<D> for Orb<D> {
    fn owner(&self, x: &[f64; D]) -> usize {
        let mut place = if self.nodes.is_empty() { Child::Rank(0) } else { Child::Node(0) };
        loop {
            match place {
                Child::Rank(rank) => return rank as usize,
                Child::Node(node) => {
                    let node = &self.nodes[node as usize];
                    place = if x[node.axis] < node.cut { node.low } else { node.high };
                }
            }
        }
    }
}

/// One level of the bisection: all regions are cut at the same time.
pub(super) struct Level<'a, const D: usize> {
    pub positions: &'a [[f64; D]],
    pub weights: &'a [u64],
    pub region_of: &'a [u32],
}

impl<const D: usize> Level<'_, D> {
    /// The axis and coordinate at which each region is cut.
    pub fn cut<C: Communicator>(
        &self,
        comm: &C,
        regions: &[Region],
    ) -> Result<Vec<(usize, f64)>, PartitionError> {
        let boxes = self.boxes(comm, regions.len(), 0)?;
        // Many light particles around a few heavy ones, such as the dry walls of a tank around its
        // water, must not decide across which axis the work is cut: it would end in thin slices.
        let heavy = self.boxes(comm, regions.len(), HEAVY)?;
        let axis = |(heavy, all)| longest_side(if Aabb::is_empty(heavy) { all } else { heavy });
        let axes: Vec<usize> = heavy.iter().zip(&boxes).map(axis).collect();
        let mut totals = vec![0; regions.len()];
        let mut keyed = Vec::with_capacity(self.positions.len());
        for ((x, &weight), &group) in self.positions.iter().zip(self.weights).zip(self.region_of) {
            if group != DONE {
                let axis = axes[group as usize];
                let bounds = &boxes[group as usize];
                let key = key(x[axis], bounds.low[axis], bounds.high[axis]);
                totals[group as usize] += weight;
                keyed.push((x[axis], Keyed { group, key, weight }));
            }
        }
        comm.sum_u64(&mut totals)?;
        let target = |(group, (region, &total)): (u32, (&Region, &u64))| {
            let weight = u128::from(total) * (region.ranks / 2) as u128 / region.ranks as u128;
            Target { group, weight: weight as u64 }
        };
        let targets: Vec<Target> = (0..).zip(regions.iter().zip(&totals)).map(target).collect();
        let particles: Vec<Keyed> = keyed.iter().map(|(_, particle)| *particle).collect();
        let cuts = find(comm, &particles, &targets, BITS)?;
        // The last coordinate below each key and, negated, the first at or above it.
        let mut beside = vec![f64::NEG_INFINITY; 2 * regions.len()];
        for (x, particle) in &keyed {
            let group = particle.group as usize;
            if particle.key < cuts[group].key {
                beside[2 * group] = beside[2 * group].max(*x);
            } else {
                beside[2 * group + 1] = beside[2 * group + 1].max(-x);
            }
        }
        comm.max_f64(&mut beside)?;
        let cut = |(&axis, beside): (&usize, &[f64])| (axis, between(beside[0], -beside[1]));
        Ok(axes.iter().zip(beside.chunks_exact(2)).map(cut).collect())
    }

    /// The tight box of the particles in each region that weigh at least so much.
    fn boxes<C: Communicator>(
        &self,
        comm: &C,
        regions: usize,
        least: u64,
    ) -> Result<Vec<Aabb<D>>, PartitionError> {
        let mut boxes = vec![Aabb::EMPTY; regions];
        for ((x, &region), &weight) in self.positions.iter().zip(self.region_of).zip(self.weights) {
            if region != DONE && weight >= least {
                boxes[region as usize].add(x);
            }
        }
        let mut sides = Vec::with_capacity(2 * D * regions);
        for bounds in &boxes {
            sides.extend(bounds.low.map(|low| -low));
            sides.extend(bounds.high);
        }
        comm.max_f64(&mut sides)?;
        let bounds = |sides: &[f64]| Aabb {
            low: std::array::from_fn(|axis| -sides[axis]),
            high: std::array::from_fn(|axis| sides[D + axis]),
        };
        Ok(sides.chunks_exact(2 * D).map(bounds).collect())
    }
}

/// The longest side of a box; the first of equals.
fn longest_side<const D: usize>(bounds: &Aabb<D>) -> usize {
    let side = |axis: usize| bounds.high[axis] - bounds.low[axis];
    (1..D).fold(0, |best, axis| if side(axis) > side(best) { axis } else { best })
}

/// A coordinate as an integer within its region: a larger coordinate never has a smaller key.
fn key(x: f64, low: f64, high: f64) -> u64 {
    let largest = (1_u64 << BITS) - 1;
    let part = (x - low) / (high - low);
    // 0/0 when all coordinates are equal: the cast makes NaN zero.
    ((part * largest as f64) as u64).min(largest)
}

/// A coordinate between the last particle below a cut and the first above it, as far as possible
/// from both, so that a cut falls between two layers of a lattice and not into the rounding errors
/// of one. A side may be empty.
fn between(last: f64, first: f64) -> f64 {
    match (last.is_finite(), first.is_finite()) {
        (true, true) => {
            let middle = 0.5 * last + 0.5 * first;
            if middle > last { middle } else { first }
        }
        (true, false) => last.next_up(),
        (false, true) => first,
        (false, false) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cuts_lie_between_their_neighbours() {
        assert_eq!(between(1.0, 2.0), 1.5);
        assert_eq!(between(1.0, 1.0_f64.next_up()), 1.0_f64.next_up());
        assert!(between(1.0, f64::INFINITY) > 1.0);
        assert_eq!(between(f64::NEG_INFINITY, 1.0), 1.0);
    }

    #[test]
    fn coincident_coordinates_have_one_key() {
        assert_eq!(key(3.0, 3.0, 3.0), 0);
        assert_eq!(key(4.0, 3.0, 4.0), (1 << BITS) - 1);
    }
}
