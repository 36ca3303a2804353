//! Blocks of a lattice that stand for the particles on their points, and their division.

use super::error::ScaleError;
use super::load::Layout;
use crate::partition::HEAVY_SHARE;

/// A box of lattice points: from `first` to before `end` along each axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LatticeBlock<const D: usize> {
    /// Lowest index.
    pub first: [i32; D],
    /// One more than the highest index.
    pub end: [i32; D],
    /// Its [`BlockClass`].
    pub class: u16,
}

/// What the particles of blocks have in common.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlockClass {
    /// Whether they are computed in passes; otherwise they are only read.
    pub active: bool,
    /// Particles per lattice point: 1, or less where a thick block stands for a thin layer.
    pub density: f64,
    /// By how much the partition weighs a particle.
    pub cost: f64,
    /// Active: entries of the lists of a particle. Passive: active particles that see it.
    pub pairs: f64,
}

impl<const D: usize> LatticeBlock<D> {
    /// Number of lattice points.
    pub fn points(&self) -> f64 {
        (0..D).map(|axis| f64::from(self.end[axis] - self.first[axis])).product()
    }

    /// The two parts below and from an index on; either may be empty.
    fn split(self, axis: usize, at: i32) -> [Option<Self>; 2] {
        let (mut low, mut high) = (self, self);
        low.end[axis] = at.min(self.end[axis]);
        high.first[axis] = at.max(self.first[axis]);
        [low, high].map(|part| (part.first[axis] < part.end[axis]).then_some(part))
    }
}

impl Layout {
    /// Divides lattice blocks among `ranks` and counts what each would hold and send.
    ///
    /// Cuts go through blocks, between two layers of lattice points, where bisection of the single
    /// particles would have put them. `reach` is in lattice spacings, skin included. The zone is the
    /// exact one of the lattice points up to the gaps inside the blocks of the *receiving* rank,
    /// which a spacing is wide. The work grows with the number of blocks and the surface of the
    /// regions, not with the number of particles.
    ///
    /// ```
    /// use sph_decomp::scale::{BlockClass, LatticeBlock, Layout, ScaleError};
    ///
    /// // 64 million particles in one block, on 512 ranks.
    /// let cube = LatticeBlock { first: [0; 3], end: [400; 3], class: 0 };
    /// let water = BlockClass { active: true, density: 1.0, cost: 1.0, pairs: 100.0 };
    /// let layout = Layout::of_blocks(512, vec![cube], &[water], 3.3)?;
    /// assert_eq!(layout.sum(|rank| rank.active()), 6.4e7);
    /// assert!(layout.imbalance(|rank| rank.active()).ratio() < 1.03);
    /// # Ok::<(), ScaleError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// When a block is empty or its class not in `classes`, when `reach` is not a positive number,
    /// and when there are more ranks than particles.
    pub fn of_blocks<const D: usize>(
        ranks: usize,
        blocks: Vec<LatticeBlock<D>>,
        classes: &[BlockClass],
        reach: f64,
    ) -> Result<Self, ScaleError> {
        super::error::positive("reach", reach, " of lattice spacings")?;
        for (block, one) in blocks.iter().enumerate() {
            let empty = (0..D).any(|axis| one.first[axis] >= one.end[axis]);
            if empty || usize::from(one.class) >= classes.len() {
                return Err(ScaleError::Block { block, class: one.class });
            }
        }
        let particles: f64 = blocks
            .iter()
            .map(|block| block.points() * classes[usize::from(block.class)].density)
            .sum();
        if ranks as f64 > particles {
            return Err(ScaleError::TooManyRanks { ranks, particles: particles as u64 });
        }
        let mut owned = Vec::with_capacity(ranks.max(1));
        divide(blocks, classes, ranks.max(1), &mut owned);
        Ok(super::block_zone::count(&owned, classes, reach))
    }
}

/// Appends the blocks of each rank, in rank order.
fn divide<const D: usize>(
    blocks: Vec<LatticeBlock<D>>,
    classes: &[BlockClass],
    ranks: usize,
    owned: &mut Vec<Vec<LatticeBlock<D>>>,
) {
    if ranks == 1 {
        owned.push(blocks);
        return;
    }
    let below = ranks / 2;
    let (axis, at) = cut(&blocks, classes, below as f64 / ranks as f64);
    let (mut low, mut high) = (Vec::new(), Vec::new());
    for block in blocks {
        let [a, b] = block.split(axis, at);
        low.extend(a);
        high.extend(b);
    }
    divide(low, classes, below, owned);
    divide(high, classes, ranks - below, owned);
}

/// The axis of the longest side and the first layer of the high part, so that the cost below is as
/// near as possible to this share of all.
fn cut<const D: usize>(
    blocks: &[LatticeBlock<D>],
    classes: &[BlockClass],
    share: f64,
) -> (usize, i32) {
    let Some((low, high)) = bounds(blocks.iter()) else { return (0, 0) };
    // As for particles, what is light does not decide across which axis the work is cut.
    let most = classes.iter().map(|class| class.cost).fold(0.0, f64::max);
    let heavy =
        |block: &&LatticeBlock<D>| classes[usize::from(block.class)].cost >= HEAVY_SHARE * most;
    let (from, to) = bounds(blocks.iter().filter(heavy)).unwrap_or((low, high));
    let side = |axis: usize| to[axis] - from[axis];
    let axis = (1..D).fold(0, |best, axis| if side(axis) > side(best) { axis } else { best });
    // Cost of each layer, from the changes where blocks begin and end.
    let mut layers = vec![0.0; (high[axis] - low[axis]) as usize + 1];
    for block in blocks {
        let class = &classes[usize::from(block.class)];
        let thickness = f64::from(block.end[axis] - block.first[axis]);
        let cost = block.points() / thickness * class.density * class.cost;
        layers[(block.first[axis] - low[axis]) as usize] += cost;
        layers[(block.end[axis] - low[axis]) as usize] -= cost;
    }
    let mut cost = 0.0;
    for layer in &mut layers {
        cost += *layer;
        *layer = cost;
    }
    // Sums of differences leave crumbs where there is nothing.
    let crumb = 1e-9 * layers.iter().copied().fold(0.0, f64::max);
    let target = share * layers.iter().filter(|layer| **layer > crumb).sum::<f64>();
    let mut below = 0.0;
    let mut best = (0, 0.0, 0.0);
    for (layer, &cost) in layers.iter().enumerate().filter(|(_, cost)| **cost > crumb) {
        if below <= target * (1.0 + 1e-12) {
            best = (layer, below, cost);
        }
        below += cost;
    }
    let (layer, below, inside) = best;
    let missing = (target - below).max(0.0);
    let above = missing >= (inside - missing) * (1.0 - 1e-12);
    (axis, low[axis] + layer as i32 + i32::from(above))
}

/// The box around blocks, if there are any.
fn bounds<'a, const D: usize>(
    blocks: impl Iterator<Item = &'a LatticeBlock<D>>,
) -> Option<([i32; D], [i32; D])> {
    blocks.fold(None, |all, block| {
        let (mut low, mut high) = all.unwrap_or((block.first, block.end));
        for axis in 0..D {
            low[axis] = low[axis].min(block.first[axis]);
            high[axis] = high[axis].max(block.end[axis]);
        }
        Some((low, high))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scale::Point;
    use crate::{Orb, Partition};

    const ANY: BlockClass = BlockClass { active: true, density: 1.0, cost: 1.0, pairs: 1.0 };

    #[test]
    fn blocks_are_cut_where_their_particles_are() {
        // An L of two costs, in blocks of several sizes.
        // Costs in whole powers of two, so that equally good cuts are equally good in integers too.
        let heavy = BlockClass { cost: 4.0, ..ANY };
        let blocks = vec![
            LatticeBlock { first: [0, 0, 0], end: [9, 13, 11], class: 0 },
            LatticeBlock { first: [9, 0, 0], end: [24, 5, 4], class: 1 },
            LatticeBlock { first: [9, 0, 4], end: [24, 5, 11], class: 0 },
        ];
        for ranks in [1, 2, 3, 5, 8, 13, 64] {
            let mut positions = Vec::new();
            let mut points = Vec::new();
            for block in &blocks {
                let class = [ANY, heavy][usize::from(block.class)];
                for z in block.first[2]..block.end[2] {
                    for y in block.first[1]..block.end[1] {
                        for x in block.first[0]..block.end[0] {
                            positions.push([x, y, z].map(f64::from));
                            let cost = class.cost as f32;
                            points.push(Point { active: true, cost, pairs: 1.0 });
                        }
                    }
                }
            }
            let cost = |point: &Point| f64::from(point.cost);
            let (orb, _) = Orb::divide(ranks, &mut positions, &mut points, cost).unwrap();
            let mut owned = Vec::new();
            divide(blocks.clone(), &[ANY, heavy], ranks, &mut owned);
            assert_eq!(owned.len(), ranks);
            for (rank, blocks) in owned.iter().enumerate() {
                let points: f64 = blocks.iter().map(LatticeBlock::points).sum();
                let theirs = positions.iter().filter(|x| orb.owner(x) == rank).count();
                assert_eq!(points, theirs as f64, "rank {rank} of {ranks}");
                for block in blocks {
                    for corner in [block.first, block.end.map(|end| end - 1)] {
                        assert_eq!(orb.owner(&corner.map(f64::from)), rank, "{corner:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn bad_blocks_are_refused() {
        let block = LatticeBlock { first: [0, 0], end: [4, 0], class: 0 };
        let error = Layout::of_blocks(2, vec![block], &[ANY], 3.0).unwrap_err();
        assert!(matches!(error, ScaleError::Block { block: 0, class: 0 }), "{error}");
        let block = LatticeBlock { first: [0, 0], end: [2, 2], class: 3 };
        assert!(Layout::of_blocks(2, vec![block], &[ANY], 3.0).is_err());
        let block = LatticeBlock { class: 0, ..block };
        let error = Layout::of_blocks(5, vec![block], &[ANY], 3.0).unwrap_err();
        assert_eq!(error.to_string(), "5 ranks cannot share 4 particles; use fewer ranks");
        assert!(Layout::of_blocks(2, vec![block], &[ANY], f64::NAN).is_err());
    }
}
