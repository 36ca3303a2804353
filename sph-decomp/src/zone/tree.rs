//! Blocks of a few particles each, and a tree above them.

use super::boxes::{Aabb, Period};
use super::reach::PairReach;
use std::cmp::Ordering;

/// What another rank learns of a few neighbouring particles: their tight box and farthest reach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Block<const D: usize> {
    pub bounds: Aabb<D>,
    pub reach: f64,
}

impl<const D: usize> Block<D> {
    pub const EMPTY: Self = Self { bounds: Aabb::EMPTY, reach: 0.0 };

    pub fn merge(&mut self, other: &Self) {
        self.bounds.merge(&other.bounds);
        self.reach = self.reach.max(other.reach);
    }

    pub fn merged<'a>(blocks: impl IntoIterator<Item = &'a Self>) -> Self {
        let mut all = Self::EMPTY;
        blocks.into_iter().for_each(|block| all.merge(block));
        all
    }

    /// Whether particles in the two blocks may see each other.
    ///
    /// The reach is widened by a hair, because the search that follows may round distances in
    /// another way than this test does.
    pub fn touches<R: PairReach>(&self, other: &Self, period: &Period<D>) -> bool {
        let reach = R::pair(self.reach, other.reach) * (1.0 + MARGIN);
        self.bounds.distance_squared(&other.bounds, period) < reach * reach
    }

    /// A block of one particle.
    pub fn point(x: &[f64; D], reach: f64) -> Self {
        Self { bounds: Aabb { low: *x, high: *x }, reach }
    }
}

/// Relative widening of the reach. A neighbour search in 32-bit fixed point with 2²⁰ units per cell
/// of one reach may list pairs up to 5·10⁻⁶ beyond the reach; the zone must hold those too, or lists
/// would depend on the ranks.
const MARGIN: f64 = 1e-5;

/// The message that tells another rank of some blocks.
pub(super) fn to_bytes<const D: usize>(blocks: &[Block<D>]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(blocks.len() * 8 * (2 * D + 1));
    for block in blocks {
        bytes.extend_from_slice(bytemuck::cast_slice(&block.bounds.low));
        bytes.extend_from_slice(bytemuck::cast_slice(&block.bounds.high));
        bytes.extend_from_slice(&block.reach.to_ne_bytes());
    }
    bytes
}

/// The blocks of a message; `None` when it does not hold whole blocks.
pub(super) fn from_bytes<const D: usize>(bytes: &[u8]) -> Option<Vec<Block<D>>> {
    let stride = 8 * (2 * D + 1);
    if !bytes.len().is_multiple_of(stride) {
        return None;
    }
    let number =
        |chunk: &[u8], k: usize| -> f64 { bytemuck::pod_read_unaligned(&chunk[8 * k..8 * k + 8]) };
    let block = |chunk: &[u8]| Block {
        bounds: Aabb {
            low: std::array::from_fn(|axis| number(chunk, axis)),
            high: std::array::from_fn(|axis| number(chunk, D + axis)),
        },
        reach: number(chunk, 2 * D),
    };
    Some(bytes.chunks_exact(stride).map(block).collect())
}

/// No block is longer than this part of the smallest reach inside. Where particles are sparse for
/// their reach, a box around several of them is mostly empty and would touch too much.
const LONGEST: f64 = 0.5;

/// Tiles particles into blocks of at most `size`, by halving at the median of the longest side.
///
/// Neighbouring blocks in the result are neighbours in space, which [`BlockTree`] relies on.
pub(crate) fn tile<const D: usize>(
    particles: &mut [u32],
    positions: &[[f64; D]],
    reach: impl Fn(u32) -> f64 + Copy,
    size: usize,
    blocks: &mut Vec<Block<D>>,
) {
    if particles.is_empty() {
        return;
    }
    let bounds = Aabb::of(particles.iter().map(|&i| &positions[i as usize]));
    let side = |axis: usize| bounds.high[axis] - bounds.low[axis];
    let axis = (1..D).fold(0, |best, axis| if side(axis) > side(best) { axis } else { best });
    if particles.len() <= size {
        let reaches = || particles.iter().map(|&i| reach(i));
        if particles.len() == 1 || side(axis) <= LONGEST * reaches().fold(f64::INFINITY, f64::min) {
            blocks.push(Block { bounds, reach: reaches().fold(0.0, f64::max) });
            return;
        }
    }
    // Cuts at a multiple of the block size where there is one, so that most blocks are full.
    let half = particles.len() / 2;
    let middle = if particles.len() > size { half.div_ceil(size) * size } else { half };
    // On a lattice many coordinates are equal. The other axes decide then, so that the blocks, and
    // with them the zone, do not depend on the order in which the particles are stored.
    particles.select_nth_unstable_by(middle, |&a, &b| {
        let (x, y) = (&positions[a as usize], &positions[b as usize]);
        let others = || x.iter().zip(y).fold(Ordering::Equal, |o, (x, y)| o.then(x.total_cmp(y)));
        x[axis].total_cmp(&y[axis]).then_with(others).then(a.cmp(&b))
    });
    let (low, high) = particles.split_at_mut(middle);
    tile(low, positions, reach, size, blocks);
    tile(high, positions, reach, size, blocks);
}

/// Blocks and, above each eight of them, a block that holds them all, and so on to one root.
#[derive(Debug)]
pub(crate) struct BlockTree<const D: usize> {
    /// From the blocks themselves up to the root.
    levels: Vec<Vec<Block<D>>>,
}

const BRANCHES: usize = 8;

impl<const D: usize> BlockTree<D> {
    pub fn new(blocks: Vec<Block<D>>) -> Self {
        let mut levels = vec![blocks];
        while let Some(below) = levels.last()
            && below.len() > 1
        {
            levels.push(below.chunks(BRANCHES).map(Block::merged).collect());
        }
        Self { levels }
    }

    /// Whether any block touches `probe`.
    pub fn touches<R: PairReach>(&self, probe: &Block<D>, period: &Period<D>) -> bool {
        let top = self.levels.len() - 1;
        let roots = self.levels[top].len();
        self.any::<R>(top, 0, roots, probe, period)
    }

    fn any<R: PairReach>(
        &self,
        level: usize,
        start: usize,
        end: usize,
        probe: &Block<D>,
        period: &Period<D>,
    ) -> bool {
        let blocks = &self.levels[level];
        (start..end.min(blocks.len())).any(|k| {
            blocks[k].touches::<R>(probe, period)
                && (level == 0
                    || self.any::<R>(level - 1, BRANCHES * k, BRANCHES * (k + 1), probe, period))
        })
    }
}
