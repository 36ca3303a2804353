//! A partition along a Hilbert curve.

use super::splitters::{Keyed, Target, find};
use super::weights::to_integers;
use super::{Partition, PartitionError, check_positions};
use crate::Communicator;

/// A partition along a Hilbert curve: particles in the order of the curve are cut into pieces of
/// equal weight.
///
/// Pieces are compact but ragged: about the same size of overlap zone as [`Orb`](super::Orb) on
/// average, cheaper to adjust, but with more neighbours. The index of a point is computed after
/// Skilling, *Programming the Hilbert curve*, AIP Conf. Proc. 707 (2004).
#[derive(Debug, Clone, PartialEq)]
pub struct HilbertCurve<const D: usize> {
    low: [f64; D],
    /// Cells per length: one scale for all axes, so that the cells are cubes.
    scale: f64,
    /// First index of each rank but rank 0.
    splitters: Vec<u64>,
}

impl<const D: usize> HilbertCurve<D> {
    /// Bits per axis, so that an index fits in 60 bits (a multiple of six).
    const BITS: u32 = if D < 3 { 30 } else { 60 / D as u32 };

    /// Divides the particles of all ranks. Collective. Weights are as in
    /// [`Orb::build`](super::Orb::build).
    pub fn build<C: Communicator>(
        comm: &C,
        positions: &[[f64; D]],
        weights: &[f64],
    ) -> Result<Self, PartitionError> {
        check_positions(positions)?;
        let weights = to_integers(comm, weights, positions.len())?;
        let mut sides = vec![f64::NEG_INFINITY; 2 * D];
        for x in positions {
            for axis in 0..D {
                sides[axis] = sides[axis].max(-x[axis]);
                sides[D + axis] = sides[D + axis].max(x[axis]);
            }
        }
        comm.max_f64(&mut sides)?;
        let low: [f64; D] = std::array::from_fn(|axis| -sides[axis]);
        let longest = (0..D).map(|axis| sides[D + axis] - low[axis]).fold(0.0, f64::max);
        let scale = if longest > 0.0 { ((1_u64 << Self::BITS) - 1) as f64 / longest } else { 0.0 };
        let mut curve = Self { low, scale, splitters: vec![] };
        let keyed = |(x, &weight)| Keyed { group: 0, key: curve.index(x), weight };
        let particles: Vec<Keyed> = positions.iter().zip(&weights).map(keyed).collect();
        let mut total = [weights.iter().sum::<u64>()];
        comm.sum_u64(&mut total)?;
        let ranks = comm.size() as u128;
        let target =
            |rank: u128| Target { group: 0, weight: (u128::from(total[0]) * rank / ranks) as u64 };
        let targets: Vec<Target> = (1..ranks).map(target).collect();
        let bits = (Self::BITS * D as u32).next_multiple_of(6);
        let cuts = find(comm, &particles, &targets, bits)?;
        curve.splitters = cuts.iter().map(|cut| cut.key).collect();
        Ok(curve)
    }

    /// The place of a point along the curve. Points outside the box of the particles count as the
    /// nearest point of its cube.
    pub fn index(&self, x: &[f64; D]) -> u64 {
        let largest = (1_u64 << Self::BITS) - 1;
        let cell = |axis: usize| (((x[axis] - self.low[axis]) * self.scale) as u64).min(largest);
        hilbert_index::<D>(std::array::from_fn(cell), Self::BITS)
    }
}

impl<const D: usize> Partition<D> for HilbertCurve<D> {
    fn owner(&self, x: &[f64; D]) -> usize {
        let index = self.index(x);
        self.splitters.partition_point(|&first| first <= index)
    }
}

/// The place along the Hilbert curve of a cell with `bits` bits per axis (Skilling 2004).
fn hilbert_index<const D: usize>(mut cell: [u64; D], bits: u32) -> u64 {
    let top = 1_u64 << (bits - 1);
    // Undo the rotations and reflections of the sub-cubes, coarse to fine.
    let mut bit = top;
    while bit > 1 {
        let mask = bit - 1;
        for axis in 0..D {
            if cell[axis] & bit != 0 {
                cell[0] ^= mask;
            } else {
                let swap = (cell[0] ^ cell[axis]) & mask;
                cell[0] ^= swap;
                cell[axis] ^= swap;
            }
        }
        bit >>= 1;
    }
    // Gray code.
    for axis in 1..D {
        cell[axis] ^= cell[axis - 1];
    }
    let mut flip = 0;
    bit = top;
    while bit > 1 {
        if cell[D - 1] & bit != 0 {
            flip ^= bit - 1;
        }
        bit >>= 1;
    }
    // Interleave the bits of the axes.
    let mut index = 0;
    for place in (0..bits).rev() {
        for axis in cell {
            index = index << 1 | ((axis ^ flip) >> place & 1);
        }
    }
    index
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Neighbours along the curve are neighbours in space, and every cell is visited once.
    fn is_a_curve<const D: usize>(bits: u32) {
        let side = 1_u64 << bits;
        let cells = side.pow(D as u32);
        let mut order: Vec<Option<[u64; D]>> = vec![None; cells as usize];
        for number in 0..cells {
            let cell = std::array::from_fn(|axis| number / side.pow(axis as u32) % side);
            let place = &mut order[hilbert_index(cell, bits) as usize];
            assert_eq!(place.replace(cell), None);
        }
        for pair in order.windows(2) {
            let (a, b) = (pair[0].unwrap(), pair[1].unwrap());
            let steps: u64 = a.iter().zip(&b).map(|(a, b)| a.abs_diff(*b)).sum();
            assert_eq!(steps, 1, "{a:?} {b:?}");
        }
    }

    #[test]
    fn visits_every_cell_in_steps_of_one() {
        is_a_curve::<2>(4);
        is_a_curve::<3>(3);
    }
}
