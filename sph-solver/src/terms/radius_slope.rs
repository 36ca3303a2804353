use super::{Pair, PairTerm, Slope, Source, Target};
use sph_kernels::Lanes;

/// How the support radius grows from place to place: Σ_j (R_j − R_i) ∇W_ij V_j, from which the sweep makes
/// ∇R_i, here over the largest radius.
///
/// A wall has no radii of its own: it goes on as the fluid beside it does. With pairs of the radius
/// R_ij = (R_i + R_j)/2 the sum Σ_j ∇W_ij V_j over the half of a support above a plane has a part along
/// the plane, −½ (z/R) ∇R Σ_w |∇W_iw V_w| at a height z: differentiate ∫ ∇W (x_j − x_i)·∇R dV = ∇R F,
/// F the share that fluid fills, by R. The other half would cancel it; [`WallPush`](super::WallPush) leans
/// by as much. Without that, water at rest runs along the floor from fine to coarse.
#[derive(Debug, Clone, Copy)]
pub struct RadiusSlope;

impl<const D: usize> PairTerm<D, Slope> for RadiusSlope {
    #[inline(always)]
    fn coefficient<L: Lanes>(&self, _: &Target<D, L>, _: &Source<D, L>, pair: &Pair<D, L>) -> L {
        pair.stretch.map_or(L::zero(), |stretch| stretch.difference)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::{SlopeSum, Stretch, scalar};

    #[test]
    fn radii_that_grow_linearly_have_their_slope() {
        // Neighbours on four sides; R/R_max = 0.5 + 2 x.
        let mut all = SlopeSum::default();
        for r in [[0.1, 0.0], [-0.1, 0.0], [0.0, 0.1], [0.0, -0.1]] {
            let (i, j, mut pair) = scalar::pair(r, ([0.0; 2], [0.0; 2]), (0.0, 0.0), 0.01, -5000.0);
            let difference = -2.0 * r[0];
            let ratio = 0.5 + 0.5 * difference;
            pair.stretch = Some(Stretch { ratio, inverse: 1.0 / ratio, difference });
            all += scalar::rate::<Slope, _>(&RadiusSlope, &(i, j, pair));
        }
        let slope = all.gradient().unwrap();
        assert!((slope[0] - 2.0).abs() < 1e-12 && slope[1].abs() < 1e-12, "{slope:?}");
    }
}
