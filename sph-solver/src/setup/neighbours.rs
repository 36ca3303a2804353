//! How many neighbours particles have on the lattice that they begin on.

use sph_geometry::Lattice;

/// Points of a lattice of spacing 1 closer than `radius` to one of them, itself left out.
pub fn lattice_neighbours<const D: usize>(radius: f64) -> usize {
    let rows = rows::<D>(radius);
    rows.iter().map(|(_, width)| 2 * *width as usize + 1).sum::<usize>() - 1
}

/// Of these, the points that are at least `layers` layers farther along the last axis: what a wall
/// particle `layers` below the first layer of fluid sees.
pub fn lattice_neighbours_beyond<const D: usize>(radius: f64, layers: i64) -> usize {
    let rows = rows::<D>(radius);
    let beyond = rows.iter().filter(|(offset, _)| offset[D - 1] >= layers);
    beyond.map(|(_, width)| 2 * *width as usize + 1).sum()
}

/// Offsets of the rows along the first axis that come closer than `radius` to the origin, and how
/// many points of them to either side.
fn rows<const D: usize>(radius: f64) -> Vec<([i64; D], i64)> {
    // Support over spacing is a round number up to rounding; points at just that distance weigh 0.
    let radius = radius * (1.0 - 1e-9);
    let most = radius.ceil() as i64;
    let side = 2 * most + 1;
    let mut rows = Vec::new();
    for row in 0..side.pow(D as u32 - 1) {
        let mut offset = [0; D];
        let mut rest = row;
        for o in offset.iter_mut().skip(1) {
            *o = rest % side - most;
            rest /= side;
        }
        let across: i64 = offset.iter().map(|o| o * o).sum();
        let along = radius * radius - across as f64;
        if along > 0.0 {
            rows.push((offset, along.sqrt().ceil() as i64 - 1));
        }
    }
    rows
}

/// 2 GiB of bits.
const MOST_WORDS: f64 = (1_u64 << 28) as f64;

/// Which points of a lattice hold a particle: one bit each.
#[derive(Debug, Clone)]
pub struct Occupancy<const D: usize> {
    lattice: Lattice<D>,
    first: [i64; D],
    sides: [i64; D],
    /// Words of a row along the first axis.
    stride: usize,
    bits: Vec<u64>,
}

impl<const D: usize> Occupancy<D> {
    /// Bits that surround the particles of a row, so that counts need no test of its ends.
    const MARGIN: i64 = 64;

    /// The lattice points of particles. Needs a bit per point of the box around them; `None` when
    /// that would be more than 2 GiB.
    pub fn new(lattice: &Lattice<D>, positions: &[[f64; D]]) -> Option<Self> {
        let (mut first, mut last) = ([i64::MAX; D], [i64::MIN; D]);
        for x in positions {
            let index = index(lattice, x);
            for axis in 0..D {
                first[axis] = first[axis].min(index[axis]);
                last[axis] = last[axis].max(index[axis]);
            }
        }
        if positions.is_empty() {
            (first, last) = ([0; D], [-1; D]);
        }
        let sides = std::array::from_fn(|axis| last[axis] - first[axis] + 1);
        let stride = ((sides[0] + 2 * Self::MARGIN) as usize).div_ceil(64) + 1;
        if sides[1..].iter().map(|side| *side as f64).product::<f64>() * stride as f64 > MOST_WORDS
        {
            return None;
        }
        let rows: i64 = sides[1..].iter().product();
        let mut all =
            Self { lattice: *lattice, first, sides, stride, bits: vec![0; rows as usize * stride] };
        for x in positions {
            let index = index(lattice, x);
            if let Some(row) = all.row(&index) {
                let bit = (index[0] - first[0] + Self::MARGIN) as usize;
                all.bits[row * stride + bit / 64] |= 1 << (bit % 64);
            }
        }
        Some(all)
    }

    fn row(&self, index: &[i64; D]) -> Option<usize> {
        let mut row = 0;
        for axis in (1..D).rev() {
            let place = index[axis] - self.first[axis];
            if !(0..self.sides[axis]).contains(&place) {
                return None;
            }
            row = row * self.sides[axis] + place;
        }
        Some(row as usize)
    }

    /// A counter of the particles closer than `reach` (m) to a lattice point, the point itself
    /// included. `reach` is at most 30 spacings; what is farther is not seen.
    pub fn within(&self, reach: f64) -> impl Fn(&[f64; D]) -> u32 + '_ {
        let rows = rows::<D>((reach / self.lattice.spacing()).min(30.0));
        move |x| {
            let center = index(&self.lattice, x);
            let place = center[0] - self.first[0] + Self::MARGIN;
            if place < 32 || place >= self.sides[0] + 2 * Self::MARGIN - 32 {
                return 0;
            }
            let mut count = 0;
            for (offset, width) in &rows {
                let there = std::array::from_fn(|axis| center[axis] + offset[axis]);
                let Some(row) = self.row(&there) else { continue };
                let start = (place - width) as usize;
                let words = &self.bits[row * self.stride + start / 64..];
                let pair = u128::from(words[0]) | u128::from(words[1]) << 64;
                let length = 2 * width + 1;
                let mask = (1_u64 << length) - 1;
                count += ((pair >> (start % 64)) as u64 & mask).count_ones();
            }
            count
        }
    }
}

fn index<const D: usize>(lattice: &Lattice<D>, x: &[f64; D]) -> [i64; D] {
    let origin = lattice.origin();
    std::array::from_fn(|axis| ((x[axis] - origin[axis]) / lattice.spacing() - 0.5).round() as i64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn particles_far_apart_are_too_many_bits() {
        let lattice = Lattice::new([0.0; 3], 1.0).unwrap();
        assert!(Occupancy::new(&lattice, &[[0.5; 3], [1e6; 3]]).is_none());
        assert_eq!(Occupancy::new(&lattice, &[]).unwrap().within(3.0)(&[0.5; 3]), 0);
    }

    #[test]
    fn neighbours_of_a_lattice_point() {
        assert_eq!(lattice_neighbours::<2>(3.0), 24);
        assert_eq!(lattice_neighbours::<3>(3.0), 92);
        assert_eq!(lattice_neighbours::<3>(1.1), 6);
        assert_eq!(lattice_neighbours_beyond::<3>(1.1, 1), 1);
        let (all, half) = (lattice_neighbours::<3>(3.3), lattice_neighbours_beyond::<3>(3.3, 1));
        let plane = lattice_neighbours::<2>(3.3);
        assert_eq!(all, 2 * half + plane);
    }

    proptest! {
        #[test]
        fn bits_count_as_brute_force(
            cells in prop::collection::btree_set(prop::array::uniform3(0_i64..12), 1..60),
            probe in prop::array::uniform3(-4_i64..16),
            reach in 0.3..4.7,
        ) {
            let lattice = Lattice::new([0.3, -0.2, 5.0], 0.1).unwrap();
            let positions: Vec<[f64; 3]> = cells.iter().map(|cell| lattice.point(cell)).collect();
            let occupancy = Occupancy::new(&lattice, &positions).unwrap();
            let square = |cell: &[i64; 3]| {
                (0..3).map(|k| (cell[k] - probe[k]).pow(2)).sum::<i64>() as f64
            };
            let expected = cells.iter().filter(|cell| square(cell) < reach * reach).count();
            let count = occupancy.within(reach * 0.1)(&lattice.point(&probe));
            prop_assert_eq!(count as usize, expected);
        }
    }
}
