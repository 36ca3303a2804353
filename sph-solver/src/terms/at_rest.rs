use super::{Deviation, Pair, PairTerm, Source, Target};
use sph_kernels::Lanes;

/// A term of the density as it would be if nothing moved: of [`DeltaContinuity`](super::DeltaContinuity)
/// its diffusion is left, which an energy budget asks for by itself.
#[derive(Debug, Clone, Copy)]
pub struct AtRest<T>(pub T);

impl<const D: usize, T: PairTerm<D, Deviation>> PairTerm<D, Deviation> for AtRest<T> {
    #[inline(always)]
    fn coefficient<L: Lanes>(&self, i: &Target<D, L>, j: &Source<D, L>, pair: &Pair<D, L>) -> L {
        let rest = [L::zero(); D];
        self.0.coefficient(&Target { velocity: rest, ..*i }, &Source { velocity: rest, ..*j }, pair)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::{Continuity, DeltaContinuity, scalar};

    #[test]
    fn rest_and_motion_make_the_whole_term() {
        let delta = DeltaContinuity { strength: 0.1, hydrostatic_gradient: [0.0, -20.0] };
        let velocities = ([2.0, 0.3], [-1.0, 0.5]);
        let pair = scalar::pair([-0.1, 0.04], velocities, (3.0, 5.0), 0.01, -50.0);
        let rate = |rate: crate::terms::DensityRate| rate.rate;
        let whole = rate(scalar::rate::<Deviation, _>(&delta, &pair));
        let diffusion = rate(scalar::rate::<Deviation, _>(&AtRest(delta), &pair));
        let motion = rate(scalar::rate::<Deviation, _>(&Continuity, &pair));
        assert!((diffusion + motion - whole).abs() < 1e-12 * whole.abs() && diffusion != 0.0);
        assert_eq!(rate(scalar::rate::<Deviation, _>(&AtRest(Continuity), &pair)), 0.0);
    }
}
