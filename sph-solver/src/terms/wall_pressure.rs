use super::{BesideWall, Pressure, Target, WallPair, WallPush, WallTerm, dot, lanes};
use sph_kernels::Lanes;

/// Pressure of a wall at rest by a one-sided Riemann problem along its normal n:
/// dv_i/dt = −(1/ρ_i) Σ_w 2 p*_iw ∇W_iw V_w, the sum as [`WallPush`] leaves it, with
/// 2 p* = max(2 p_low, 2 p_i − ρ_i G·r_iw) + 2 ρ_i u min(6 |u|, c0), u = −n·v_i.
///
/// G = ∇p/ρ is the pressure gradient that the fluid felt lately, gravity less acceleration by Euler's
/// equation, so that a wall carries the water that rests on it and neither carries nor drags the water
/// that runs down along it. The mirrored state is that of Zhang, Hu & Adams (2017), J. Comput. Phys.
/// 335, eq. 22–24, and the dissipation their low-dissipation limiter, eq. 17 with η = 3, on the way in and on the way out: on the way in alone it leaves twice
/// the noise in the pressure of a dam break. Velocity and
/// dissipation lie along the normal, so a plane takes no momentum from what flows along it. Near a free
/// surface p_low is 0 and a wall never sucks, as in Adami, Hu & Adams (2012); elsewhere it is the
/// pressure at which the fluid cavitates.
///
/// At a thin solid pressure and dissipation are 1 + max(0, 1 − z/(dp/2))² times as large, z the height of the
/// particle over its surface: there is little way in which to stop it.
#[derive(Debug, Clone, Copy)]
pub struct WallPressure {
    /// c0, m/s. With 0 there is no dissipation.
    pub sound_speed: f64,
}

impl<const D: usize> WallTerm<D, Pressure> for WallPressure {
    type Total<L: Lanes> = WallPush<D, L>;

    #[inline(always)]
    fn zero<L: Lanes>() -> WallPush<D, L> {
        WallPush::zero()
    }

    #[inline(always)]
    fn add<L: Lanes>(
        &self,
        i: &Target<D, L>,
        beside: &BesideWall<D, L>,
        pair: &WallPair<D, L>,
        total: &mut WallPush<D, L>,
    ) {
        let gradient = beside.pressure_gradient.map(|g| g * (i.density * pair.unit));
        let change = -dot(&gradient, &pair.offset);
        let (mirrored, lowest) = (i.quantity + i.quantity, beside.lowest_pressure);
        let pressures = (mirrored + change).max(lowest + lowest);
        let speed = -dot(&i.velocity, &pair.normal);
        let limited = (speed.max(-speed) * lanes(6.0)).min(lanes(self.sound_speed));
        let dissipation = (speed + speed) * i.density * limited;
        // What has come too close to a thin wall is kept from passing through it.
        let (even, damping) = match pair.squeezed {
            None => (change - pressures, dissipation),
            Some(squeezed) => {
                let more = squeezed * pressures.max(L::zero());
                (change - pressures - more, squeezed.mul_add(dissipation, dissipation))
            }
        };
        total.add(even, -change, pair);
        total.damp(-damping, pair);
    }

    #[inline(always)]
    fn finish<L: Lanes>(
        &self,
        _: &Target<D, L>,
        beside: &BesideWall<D, L>,
        total: &WallPush<D, L>,
    ) -> [L; D] {
        total.felt(beside.flatness)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::scalar;

    const WALL: WallPressure = WallPressure { sound_speed: 20.0 };

    /// Fluid 0.1 m above a wall particle.
    fn push(pressure: f64, velocity: [f64; 2], gradient: [f64; 2], lowest: f64) -> [f64; 2] {
        let state = (velocity, pressure);
        let pair = scalar::wall([0.04, 0.1], [0.0, 1.0], 0.05, state, 0.01, -50.0);
        scalar::wall_rate::<Pressure, _>(&WALL, &pair, gradient, lowest).0
    }

    #[test]
    fn pressure_is_continued_with_its_gradient() {
        let expected = (2.0 * 500.0 + 1000.0 * 9.81 * 0.1) * 50.0 * 0.01 * 0.1 / 1000.0;
        assert!((push(500.0, [0.0; 2], [0.0, -9.81], 0.0)[1] - expected).abs() < 1e-12);
    }

    #[test]
    fn a_slide_is_not_felt() {
        let still = push(500.0, [0.0; 2], [0.0; 2], 0.0);
        assert_eq!(push(500.0, [3.0, 0.0], [0.0; 2], 0.0), still);
        assert!(push(500.0, [3.0, -1.0], [0.0; 2], 0.0)[0].abs() < 1e-14);
    }

    #[test]
    fn motion_along_the_normal_is_damped_both_ways() {
        let at = |v: f64| push(0.0, [0.0, v], [0.0; 2], 0.0)[1];
        assert!(at(-1.0) > 0.0);
        assert_eq!(at(1.0), -at(-1.0));
        // Quadratic as long as it is slow.
        assert!((at(-2.0) / at(-1.0) - 4.0).abs() < 1e-12);
    }

    #[test]
    fn suction_ends_at_the_lowest_pressure() {
        let at = |lowest| push(-1e5, [0.0; 2], [0.0; 2], lowest)[1];
        assert_eq!(at(0.0), 0.0);
        let factor = 2.0 * 50.0 * 0.01 * 0.1 / 1000.0;
        assert!((at(-3e4) + 3e4 * factor).abs() < 1e-9);
        assert!((at(-1e9) + 1e5 * factor).abs() < 1e-9);
    }

    #[test]
    fn a_thin_wall_pushes_harder_on_what_is_too_close() {
        let push = |squeezed| {
            let state = ([0.0, -1.0], 500.0);
            let (i, pair) = scalar::wall([0.04, 0.1], [0.0, 1.0], 0.05, state, 0.01, -50.0);
            let pair = (i, WallPair { squeezed, ..pair });
            scalar::wall_rate::<Pressure, _>(&WALL, &pair, [0.0; 2], 0.0).0[1]
        };
        assert_eq!(push(Some(0.0)), push(None));
        assert!((push(Some(1.0)) / push(None) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn coincident_particles_do_not_push() {
        let pair = scalar::wall([0.0; 2], [0.0, 1.0], 0.05, ([1.0; 2], 7.0), 0.01, -50.0);
        assert_eq!(scalar::wall_rate::<Pressure, _>(&WALL, &pair, [0.0; 2], 0.0).0, [0.0; 2]);
    }
}
