//! Blocks of a lattice that stand for the particles on their points, and their division.

use super::error::ScaleError;
use super::load::Layout;

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
    pub(super) fn split(self, axis: usize, at: i32) -> [Option<Self>; 2] {
        let (mut low, mut high) = (self, self);
        low.end[axis] = at.min(self.end[axis]);
        high.first[axis] = at.max(self.first[axis]);
        [low, high].map(|part| (part.first[axis] < part.end[axis]).then_some(part))
    }
}

impl Layout {
    /// Divides lattice blocks among `ranks` and counts what each would hold and send.
    ///
    /// Cuts go through blocks where slightly tilted cuts would have divided the single particles: where
    /// one falls into a layer of lattice points, the layer is divided along the next axis, and its row
    /// along the one after, so that both sides have their share to within one particle. `reach` is in lattice spacings, skin included. The zone is the
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
    /// assert!(layout.imbalance(|rank| rank.active()).ratio() < 1.0001);
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
        super::block_cut::divide(blocks, classes, ranks.max(1), &mut owned);
        Ok(super::block_zone::count(&owned, classes, reach))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ANY: BlockClass = BlockClass { active: true, density: 1.0, cost: 1.0, pairs: 1.0 };

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
