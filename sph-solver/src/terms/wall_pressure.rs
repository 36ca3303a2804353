use super::{Pair, PairTerm, Pressure, Source, Target, difference, dot, lanes};
use sph_kernels::Lanes;

/// Pressure of a wall by a one-sided Riemann problem for every pair of fluid particle i and wall
/// particle w, no extrapolation sum needed:
/// dv_i/dt = −(1/ρ_i) Σ_w 2 p*_iw ∇W_iw V_w with
/// 2 p* = max(0, 2 p_i + ρ_i g·(x_w − x_i)) + 2 ρ_i u min(6 u, c0), u = max(0, (v_i − v_w)·e_iw).
///
/// The wall state is the mirrored one of Zhang, Hu & Adams (2017), J. Comput. Phys. 335, eq. 22–24
/// (hydrostatic pressure, reversed normal velocity) and the dissipation their low-dissipation
/// limiter, eq. 17 with η = 3. The part without dissipation is not allowed to pull: a wall never
/// sucks fluid, as in the free-surface walls of Adami, Hu & Adams (2012). Add
/// [`LaminarViscosity`](super::LaminarViscosity) for a no-slip wall.
///
/// The speed is that along each pair, not along the normal of the wall, so what flows along a wall
/// approaches the wall particles ahead of it and is dragged: Taylor–Green vortices that touch the
/// walls of a box 40 spacings wide lose speed 1.9 times as fast as they should. With a
/// `sound_speed` of 0 the dissipation, and with it the drag, is gone.
#[derive(Debug, Clone, Copy)]
pub struct OneSidedRiemannWall<const D: usize> {
    /// Gravity less the acceleration of the wall, m/s².
    pub gravity: [f64; D],
    /// c0, m/s.
    pub sound_speed: f64,
}

impl<const D: usize> PairTerm<D, Pressure> for OneSidedRiemannWall<D> {
    #[inline(always)]
    fn coefficient<L: Lanes>(&self, i: &Target<D, L>, j: &Source<D, L>, pair: &Pair<D, L>) -> L {
        // g·(x_w − x_i) = −g·r_iw, and e_iw = −r_iw / |r_iw|.
        let weight: [L; D] = self.gravity.map(|g| lanes::<L>(g) * pair.unit * i.density);
        let hydrostatic = dot(&weight, &pair.offset);
        let pressures = (i.quantity + i.quantity - hydrostatic).max(L::zero());
        let approach = -dot(&difference(&i.velocity, &j.velocity), &pair.offset);
        // The floor keeps 0/0 of coincident particles finite; it is far below any real distance.
        let speed = approach.max(L::zero()).div(pair.distance.max(lanes(1e-20)));
        let limited = (speed * lanes(6.0)).min(lanes(self.sound_speed));
        let dissipation = (speed + speed) * i.density * limited;
        -pressures - dissipation
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::scalar;

    const WALL: OneSidedRiemannWall<2> =
        OneSidedRiemannWall { gravity: [0.0, -9.81], sound_speed: 20.0 };

    /// Fluid 0.1 m above a wall particle.
    fn upward(pressure: f64, velocity: f64) -> f64 {
        let v = ([0.0, velocity], [0.0; 2]);
        let pair = scalar::pair([0.0, 0.1], v, (pressure, 0.0), 0.01, -50.0);
        scalar::rate::<Pressure, _>(&WALL, &pair).0[1]
    }

    #[test]
    fn hydrostatic_pressure_is_mirrored() {
        let expected = (2.0 * 500.0 + 1000.0 * 9.81 * 0.1) * 50.0 * 0.01 * 0.1 / 1000.0;
        assert!((upward(500.0, 0.0) - expected).abs() < 1e-12);
    }

    #[test]
    fn a_wall_never_sucks() {
        assert_eq!(upward(-1e5, 0.0), 0.0);
    }

    #[test]
    fn an_approach_is_stopped_harder_than_a_departure() {
        assert!(upward(0.0, -1.0) > upward(0.0, 0.0));
        assert_eq!(upward(0.0, 1.0), upward(0.0, 0.0));
    }

    #[test]
    fn coincident_particles_do_not_push() {
        let pair = scalar::pair([0.0; 2], ([1.0; 2], [0.0; 2]), (7.0, 7.0), 0.01, -50.0);
        assert_eq!(scalar::rate::<Pressure, _>(&WALL, &pair).0, [0.0; 2]);
    }
}
