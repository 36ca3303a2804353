use super::{BesideWall, Pressure, Target, WallPair, WallTerm, dot, lanes};
use sph_kernels::Lanes;

/// Friction of a wall at rest that does not let the fluid slip:
/// dv_i/dt += (2 μ/ρ_i) Σ_w (v_i − v_iw)_t F_iw V_w, ∇W_iw = F_iw r_iw, with the velocity of the wall
/// element continued linearly from the fluid through zero at the surface:
/// v_i − v_iw = (v_i + d_i Ω × n) (d_i + d_w)/d_i, d_i the distance of the particle from the surface, d_w
/// the depth of the element. v_i is the velocity in the frame of a wall that spins with Ω; what spins with
/// it feels nothing together with the fluid behind. Only the part along the wall acts; the pressure of the wall takes care of the other.
///
/// Source: Morris, Fox & Zhu (1997), J. Comput. Phys. 136, eq. 22–24, whose wall velocities these are.
#[derive(Debug, Clone, Copy)]
pub struct NoSlip {
    /// Dynamic viscosity μ, Pa s.
    pub dynamic_viscosity: f64,
    /// The fluid is taken to be at least so far from the surface, m: a particle pressed into a wall
    /// shall not meet infinite friction.
    pub smallest_distance: f64,
}

impl<const D: usize> WallTerm<D, Pressure> for NoSlip {
    type Total<L: Lanes> = [L; D];

    #[inline(always)]
    fn zero<L: Lanes>() -> [L; D] {
        [L::zero(); D]
    }

    #[inline(always)]
    fn add<L: Lanes>(
        &self,
        i: &Target<D, L>,
        beside: &BesideWall<D, L>,
        pair: &WallPair<D, L>,
        sum: &mut [L; D],
    ) {
        let below = dot(&pair.offset, &pair.normal) * pair.unit;
        let distance = (below - pair.depth).max(pair.stretched(lanes(self.smallest_distance)));
        let stretch = (distance + pair.depth).div(distance);
        // F V = w per unit of length.
        let factor =
            lanes::<L>(2.0 * self.dynamic_viscosity) * pair.weight * pair.per_unit * stretch;
        let along = dot(&i.velocity, &pair.normal);
        for (k, sum) in sum.iter_mut().enumerate() {
            let (a, b) = ((k + 1) % 3, (k + 2) % 3);
            let normal = |k: usize| if k < D { pair.normal[k] } else { L::zero() };
            let spinning = beside.spin[a] * normal(b) - beside.spin[b] * normal(a);
            let tangential = distance.mul_add(spinning, i.velocity[k] - along * pair.normal[k]);
            *sum = factor.mul_add(tangential, *sum);
        }
    }

    #[inline(always)]
    fn finish<L: Lanes>(&self, _: &Target<D, L>, _: &BesideWall<D, L>, total: &[L; D]) -> [L; D] {
        *total
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::{Acceleration, scalar};
    use sph_kernels::{Kernel, WendlandC2};

    /// Fluid sums of a shear flow u = y above a wall at y = 0 and the wall's friction cancel: the
    /// Laplacian of a linear profile is zero.
    #[test]
    fn a_linear_profile_feels_no_force() {
        let (dp, radius) = (0.01, 0.03);
        let norm = WendlandC2::norm(2) / f64::powi(radius, 4);
        let term = NoSlip { dynamic_viscosity: 1.0, smallest_distance: 0.1 * dp };
        let y = 0.5 * dp;
        let (mut fluid, mut wall) = (0.0, 0.0);
        for a in -4..=4 {
            for b in -4..=4 {
                let (dx, yj) = (f64::from(a) * dp, y + f64::from(b) * dp);
                let q = dx.hypot(yj - y) / radius;
                if q >= 1.0 || (a, b) == (0, 0) {
                    continue;
                }
                let slope = norm * WendlandC2::slope(q);
                if yj > 0.0 {
                    fluid += 2.0 * (y - yj) * slope * dp * dp / 1000.0;
                } else {
                    let (r, state) = ([-dx, y - yj], ([y, 0.0], 0.0));
                    let pair = scalar::wall(r, [0.0, 1.0], -yj, state, dp * dp, slope);
                    let Acceleration(rate) =
                        scalar::wall_rate::<Pressure, _>(&term, &pair, [0.0; 2], 0.0);
                    assert_eq!(rate[1], 0.0);
                    wall += rate[0];
                }
            }
        }
        assert!(wall < 0.0 && (fluid + wall).abs() < 1e-12 * wall.abs(), "{fluid} {wall}");
    }
}
