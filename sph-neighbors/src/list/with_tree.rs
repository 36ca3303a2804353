//! Neighbour lists from k-d trees.

use super::near::Trees;
use super::{NeighborList, PairReach};
use crate::TreeList;

impl NeighborList {
    /// Like [`build_with_radii`](Self::build_with_radii), with k-d trees, for radii that differ by
    /// more than 1 : 10⁴. Needs the feature `kiddo`; [`TreeList`] says when to choose it.
    ///
    /// Other arguments are as for [`build_with_radii`](Self::build_with_radii). Distances and reaches
    /// are computed in `f64`, and a list holds exactly the sources whose distance is then less than
    /// the reach. Targets that are not numbers, or beyond 10¹⁵⁰, have no neighbours. Fastest when
    /// targets are in the order of [`TreeList::order`].
    ///
    /// # Panics
    ///
    /// As [`build_with_radii`](Self::build_with_radii).
    pub fn build_with_tree<const D: usize>(
        trees: &TreeList<D>,
        targets: &[[f64; D]],
        radii: &[f64],
        filler: impl Fn(usize) -> u32 + Sync,
        rule: PairReach,
        pad: usize,
    ) -> Self {
        let mut list = Self::default();
        list.rebuild_with_tree(trees, targets, radii, filler, rule, pad);
        list
    }

    /// Like [`build_with_tree`](Self::build_with_tree), in the memory of this list.
    ///
    /// # Panics
    ///
    /// As [`build_with_tree`](Self::build_with_tree).
    pub fn rebuild_with_tree<const D: usize>(
        &mut self,
        trees: &TreeList<D>,
        targets: &[[f64; D]],
        radii: &[f64],
        filler: impl Fn(usize) -> u32 + Sync,
        rule: PairReach,
        pad: usize,
    ) {
        assert_eq!(targets.len(), radii.len(), "every target needs a radius");
        let plan = Trees::new(trees, radii, rule);
        self.sources = trees.len() as u32;
        self.periods = trees.grid().periods().to_vec();
        self.fill(&plan, |scratch| &mut scratch.near, targets, filler, pad);
    }
}
