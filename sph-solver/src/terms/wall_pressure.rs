use super::{Pressure, Target, WallPair, WallTerm, dot, lanes};
use sph_kernels::Lanes;

/// Pressure of a wall at rest by a one-sided Riemann problem along its normal n:
/// dv_i/dt = −(1/ρ_i) Σ_w 2 p*_iw (n·∇W_iw) n V_w with
/// 2 p* = max(0, 2 p_i + ρ_i g·(x_w − x_i)) + 2 ρ_i u min(6 u, c0), u = max(0, −n·v_i).
///
/// The wall state is the mirrored one of Zhang, Hu & Adams (2017), J. Comput. Phys. 335, eq. 22–24
/// (hydrostatic pressure, reversed normal velocity) and the dissipation their low-dissipation
/// limiter, eq. 17 with η = 3. Both the force and the velocity that it sees lie along the normal, so a
/// wall takes no momentum from what flows along it.
#[derive(Debug, Clone, Copy)]
pub struct WallPressure<const D: usize> {
    /// Gravity, m/s².
    pub gravity: [f64; D],
    /// c0, m/s. With 0 there is no dissipation.
    pub sound_speed: f64,
}

impl<const D: usize> WallTerm<D, Pressure> for WallPressure<D> {
    #[inline(always)]
    fn add<L: Lanes>(&self, i: &Target<D, L>, pair: &WallPair<D, L>, sum: &mut [L; D]) {
        // g·(x_w − x_i) = −g·r_iw.
        let weight: [L; D] = self.gravity.map(|g| lanes::<L>(g) * pair.unit * i.density);
        let hydrostatic = dot(&weight, &pair.offset);
        let pressures = (i.quantity + i.quantity - hydrostatic).max(L::zero());
        let speed = (-dot(&i.velocity, &pair.normal)).max(L::zero());
        let limited = (speed * lanes(6.0)).min(lanes(self.sound_speed));
        let dissipation = (speed + speed) * i.density * limited;
        let factor = (-pressures - dissipation) * (pair.weight * pair.height);
        for (sum, n) in sum.iter_mut().zip(pair.normal) {
            *sum = factor.mul_add(n, *sum);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::scalar;

    const WALL: WallPressure<2> = WallPressure { gravity: [0.0, -9.81], sound_speed: 20.0 };

    /// Fluid 0.1 m above a wall particle.
    fn push(pressure: f64, velocity: [f64; 2]) -> [f64; 2] {
        let state = (velocity, pressure);
        let pair = scalar::wall([0.04, 0.1], [0.0, 1.0], 0.05, state, 0.01, -50.0);
        scalar::wall_rate::<Pressure, _>(&WALL, &pair).0
    }

    #[test]
    fn hydrostatic_pressure_is_mirrored() {
        let expected = (2.0 * 500.0 + 1000.0 * 9.81 * 0.1) * 50.0 * 0.01 * 0.1 / 1000.0;
        assert!((push(500.0, [0.0; 2])[1] - expected).abs() < 1e-12);
    }

    #[test]
    fn a_slide_is_not_felt() {
        assert_eq!(push(500.0, [3.0, 0.0]), push(500.0, [0.0; 2]));
        assert_eq!(push(500.0, [3.0, -1.0])[0], 0.0);
    }

    #[test]
    fn an_approach_is_stopped_harder_than_a_departure() {
        assert!(push(0.0, [0.0, -1.0])[1] > push(0.0, [0.0; 2])[1]);
        assert_eq!(push(0.0, [0.0, 1.0]), push(0.0, [0.0; 2]));
    }

    #[test]
    fn coincident_particles_do_not_push() {
        let pair = scalar::wall([0.0; 2], [0.0, 1.0], 0.05, ([1.0; 2], 7.0), 0.01, -50.0);
        assert_eq!(scalar::wall_rate::<Pressure, _>(&WALL, &pair).0, [0.0; 2]);
    }
}
