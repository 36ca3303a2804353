//! A k-d tree of sources: the only place that knows the crate `kiddo`.

use kiddo::ImmutableKdTree;
use kiddo::dist::SquaredEuclidean;
use std::fmt;
use std::sync::Arc;

/// Places in a slice of positions, by position.
///
/// The tree splits axes in turn, and an axis along which all points of a branch are equal not at all:
/// its leaves then hold far more than the 32 points that they should. Particles do lie on lines and
/// planes along the axes, so the tree holds mirrored positions, and the mirror is askew. Points that
/// coincide stay together in a leaf of any size, which costs nothing: they are found together.
#[derive(Clone)]
pub struct Tree<const D: usize> {
    tree: Arc<ImmutableKdTree<f64, D>>,
    mirror: Mirror<D>,
}

impl<const D: usize> fmt::Debug for Tree<D> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Tree").field("size", &self.tree.size()).finish_non_exhaustive()
    }
}

impl<const D: usize> Tree<D> {
    /// # Panics
    ///
    /// When there are 2³² positions or more.
    pub fn new(positions: impl Iterator<Item = [f64; D]>) -> Self {
        let mirror = Mirror::new();
        let mirrored: Vec<[f64; D]> = positions.map(|x| mirror.of(&x)).collect();
        // The one other error is that of buckets of fixed size, which these are not.
        let tree = ImmutableKdTree::new_from_slice(&mirrored).expect("indices have 32 bits");
        Self { tree: Arc::new(tree), mirror }
    }

    /// Calls `visit` with the place of every point within `reach` of `x` and the square of its
    /// distance, in no particular order. Points may be found, and distances be wrong, by the rounding
    /// of coordinates: see [`slack`](Self::slack).
    #[inline]
    pub fn for_each_within(&self, x: &[f64; D], reach: f64, mut visit: impl FnMut(u32, f64)) {
        let x = self.mirror.of(x);
        self.tree
            .query(&x)
            .within::<SquaredEuclidean<f64>>(reach * reach)
            .unsorted()
            .visit(|hit| visit(hit.item, hit.distance));
    }

    /// How far distances of points within `reach` of `x` may be off.
    pub fn slack(x: &[f64; D], reach: f64) -> f64 {
        // Mirroring takes two sums of D terms, for both ends of a distance.
        let largest = x.iter().fold(reach, |sum, c| sum + c.abs());
        largest * (8 * (D + 2)) as f64 * f64::EPSILON
    }
}

/// A reflection at a plane that is parallel to no axis and to no plane of a lattice (Householder
/// 1958).
#[derive(Debug, Clone, Copy)]
struct Mirror<const D: usize> {
    /// Unit vector across the plane.
    normal: [f64; D],
}

impl<const D: usize> Mirror<D> {
    fn new() -> Self {
        let normal: [f64; D] = std::array::from_fn(|axis| (0.1 * axis as f64).exp());
        let length = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
        Self { normal: normal.map(|n| n / length) }
    }

    #[inline]
    fn of(&self, x: &[f64; D]) -> [f64; D] {
        let across: f64 = x.iter().zip(&self.normal).map(|(x, n)| x * n).sum();
        std::array::from_fn(|axis| x[axis] - 2.0 * across * self.normal[axis])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of a lattice along some of the axes, the same along the others.
    fn flat(edge: usize, axes: [usize; 2]) -> Vec<[f64; 3]> {
        let points = |i: usize| {
            let mut x = [0.3; 3];
            x[axes[0]] = (i % edge) as f64 * 0.1;
            x[axes[1]] = (i / edge) as f64 * 0.1;
            x
        };
        (0..4096).map(points).collect()
    }

    #[test]
    fn leaves_stay_small_when_coordinates_are_equal() {
        for axes in [[0, 1], [1, 2], [2, 0]] {
            // Lines and planes.
            for edge in [4096, 64] {
                let points = flat(edge, axes);
                let leaf = Tree::new(points.iter().copied()).tree.max_leaf_len();
                assert!(leaf <= 64, "{axes:?} {edge}: {leaf} points");
            }
        }
    }

    #[test]
    fn a_leaf_of_any_size_holds_points_that_coincide() {
        let points = [[[1.0, 2.0, 3.0]; 1000], [[1.0, 2.0, 3.5]; 1000]].concat();
        let tree = Tree::new(points.into_iter());
        let mut found = Vec::new();
        tree.for_each_within(&[1.0, 2.0, 3.1], 0.2, |place, _| found.push(place));
        found.sort_unstable();
        assert_eq!(found, (0..1000).collect::<Vec<u32>>());
    }

    #[test]
    fn mirroring_is_within_the_slack() {
        let x = [1e6, -3e5, 7.0];
        let y = [1e6 + 1e-3, -3e5 - 1e-3, 7.0 + 2e-3];
        let mut found = Vec::new();
        let tree = Tree::new([y].into_iter());
        tree.for_each_within(&x, 1.0, |_, distance2| found.push(distance2.sqrt()));
        let distance = (0..3).map(|a| (x[a] - y[a]).powi(2)).sum::<f64>().sqrt();
        let slack = Tree::slack(&x, 1.0);
        assert!((found[0] - distance).abs() <= slack && slack < 1e-7, "{found:?} {distance}");
    }
}
