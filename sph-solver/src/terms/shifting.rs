use super::{BesideWall, Crowding, Pair, PairTerm, Source, Target, WallPair, WallTerm, lanes};
use sph_kernels::{Kernel, Lanes};
use std::marker::PhantomData;

/// How crowded the surroundings of a particle are: Σ_j [1 + 0.2 (W_ij/W(Δx))⁴] ∇W_ij V_j over fluid and
/// walls, 1/m. It points to where there are too few neighbours; [`shift`] makes a velocity of it.
///
/// Source: Sun, Colagrossi, Marrone, Antuono & Zhang (2019), Comput. Phys. Commun. 236, eq. 12, after
/// Lind, Xu, Stansby & Rogers (2012), J. Comput. Phys. 231; the bracket keeps pairs from clumping.
#[derive(Debug, Clone, Copy)]
pub struct Shifting<K> {
    /// Support radius R, the largest where radii vary, m.
    support_radius: f64,
    /// 1/w(Δx/R).
    inverse_at_spacing: f64,
    kernel: PhantomData<K>,
}

impl<K: Kernel> Shifting<K> {
    /// For a support radius and an initial particle distance Δx, m.
    pub fn new(support_radius: f64, spacing: f64) -> Self {
        let inverse_at_spacing = 1.0 / K::w(spacing / support_radius);
        Self { support_radius, inverse_at_spacing, kernel: PhantomData }
    }

    #[inline(always)]
    fn bracket<L: Lanes>(&self, distance2: L, unit: L, inverse: Option<L>) -> L {
        let q = distance2.sqrt() * (unit * lanes(1.0 / self.support_radius));
        let q = inverse.map_or(q, |inverse| q * inverse);
        let ratio = K::w(q) * lanes(self.inverse_at_spacing);
        let square = ratio * ratio;
        (square * square).mul_add(lanes(0.2), lanes(1.0))
    }
}

impl<const D: usize, K: Kernel> PairTerm<D, Crowding> for Shifting<K> {
    #[inline(always)]
    fn coefficient<L: Lanes>(&self, _: &Target<D, L>, _: &Source<D, L>, pair: &Pair<D, L>) -> L {
        self.bracket(pair.distance2, pair.unit, pair.stretch.map(|stretch| stretch.inverse))
    }
}

impl<const D: usize, K: Kernel> WallTerm<D, Crowding> for Shifting<K> {
    type Total<L: Lanes> = [L; D];

    #[inline(always)]
    fn zero<L: Lanes>() -> [L; D] {
        [L::zero(); D]
    }

    #[inline(always)]
    fn add<L: Lanes>(
        &self,
        _: &Target<D, L>,
        _: &BesideWall<D, L>,
        pair: &WallPair<D, L>,
        sum: &mut [L; D],
    ) {
        let factor =
            self.bracket(pair.distance2, pair.unit, pair.stretch.map(|stretch| stretch.inverse))
                * pair.weight;
        for (sum, offset) in sum.iter_mut().zip(pair.offset) {
            *sum = factor.mul_add(offset, *sum);
        }
    }

    #[inline(always)]
    fn finish<L: Lanes>(&self, _: &Target<D, L>, _: &BesideWall<D, L>, total: &[L; D]) -> [L; D] {
        *total
    }
}

/// A support that is filled less than this belongs to a particle near a free surface, which is not
/// shifted.
const SURFACE: f64 = 0.9;
/// From here on it is shifted in full.
const INSIDE: f64 = 0.97;

/// The largest shift as a share of the largest speed.
pub const MOST: f64 = 0.5;

/// The velocity by which a particle is shifted, as a share of the largest speed U that the flow has had: −R Σ with the
/// sum of [`Shifting`], at most ½, with `filled` the share of the support that is filled.
///
/// Source: Sun et al. (2019), eq. 12 and 13, whose factor Ma 2h c0 is U R. They take the speed that is
/// expected; with that of the present step a decaying flow is no longer shifted enough.
pub fn shift<const D: usize>(crowding: &[f64; D], filled: f64, support_radius: f64) -> [f64; D] {
    let inside = ((filled - SURFACE) / (INSIDE - SURFACE)).clamp(0.0, 1.0);
    let shift = crowding.map(|sum| -inside * support_radius * sum);
    let length = shift.iter().map(|s| s * s).sum::<f64>().sqrt();
    if length > MOST { shift.map(|s| s * (MOST / length)) } else { shift }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::{VectorSum, scalar};
    use sph_kernels::WendlandC2;

    #[test]
    fn a_neighbour_on_one_side_pushes_away() {
        let term = Shifting::<WendlandC2>::new(0.3, 0.1);
        let pair = scalar::pair([-0.1, 0.0], ([0.0; 2], [0.0; 2]), (0.0, 0.0), 0.01, -50.0);
        let VectorSum(sum) = scalar::rate::<Crowding, _>(&term, &pair);
        assert!((sum[0] - 1.2 * -50.0 * 0.01 * -0.1).abs() < 1e-12 && sum[1] == 0.0);
        let [u, v] = shift(&sum, 1.0, 0.3);
        assert!((u + 0.3 * sum[0]).abs() < 1e-12 && v == 0.0);
    }

    #[test]
    fn shifts_are_limited_and_end_at_the_surface() {
        assert_eq!(shift(&[-1e3, 0.0], 1.0, 0.3), [0.5, 0.0]);
        assert_eq!(shift(&[-1e3, 0.0], 0.8, 0.3), [0.0, 0.0]);
    }
}
