//! The sums of the solver for one scene, written out without its terms: inviscid δ-SPH in three
//! dimensions with the kernel Wendland C2, no walls.
//!
//! What composition costs is the difference between these loops and the solver's sweep with the
//! same terms: see the program `composition`.

use crate::SweepCase;
use sph_kernels::{Lanes, Real, Vectorized};
use sph_neighbors::NeighborList;
use sph_solver::records::Record;
use sph_solver::terms::Acceleration;
use std::f64::consts::PI;

/// Particles per entry into vector code, as in the solver.
const GRAIN: usize = 256;

/// Norm of Wendland C2 in three dimensions.
const NORM: f64 = 21.0 / (2.0 * PI);

/// dρ/dt = ρ_i Σ (v_i − v_j)·∇W V + 2 δ h c0 Σ Ψ F V.
pub fn density_rates<S: Real>(case: &SweepCase<S>, strength: f64, gradient: [f64; 3]) -> Vec<f64> {
    let mut rates = vec![0.0; case.len()];
    for (k, rates) in rates.chunks_mut(GRAIN).enumerate() {
        let first = k * GRAIN;
        S::dispatch(Density {
            first,
            records: &case.deviation,
            density: &case.density[first..],
            list: &case.list,
            unit: case.scale.unit,
            radius: case.scale.support_radius,
            strength,
            gradient,
            rates,
        });
    }
    rates
}

/// dv/dt = −1/ρ_i Σ (p_i + p_j) ∇W V.
pub fn accelerations<S: Real>(case: &SweepCase<S>) -> Vec<Acceleration<3>> {
    let mut rates = vec![Acceleration::default(); case.len()];
    for (k, rates) in rates.chunks_mut(GRAIN).enumerate() {
        let first = k * GRAIN;
        S::dispatch(Force {
            first,
            records: &case.pressure,
            density: &case.density[first..],
            list: &case.list,
            unit: case.scale.unit,
            radius: case.scale.support_radius,
            rates,
        });
    }
    rates
}

struct Density<'a, S> {
    first: usize,
    records: &'a [Record<S>],
    density: &'a [f64],
    list: &'a NeighborList,
    unit: f64,
    radius: f64,
    strength: f64,
    gradient: [f64; 3],
    rates: &'a mut [f64],
}

struct Force<'a, S> {
    first: usize,
    records: &'a [Record<S>],
    density: &'a [f64],
    list: &'a NeighborList,
    unit: f64,
    radius: f64,
    rates: &'a mut [Acceleration<3>],
}

#[inline(always)]
fn lanes<L: Lanes>(x: f64) -> L {
    L::splat(L::Scalar::from_f64(x))
}

impl<S: Real> Vectorized for Density<'_, S> {
    type Scalar = S;
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes<Scalar = S>>(self) {
        let unit: L = lanes(self.unit);
        let inverse_radius: L = lanes(1.0 / self.radius);
        let norm: L = lanes(NORM / (self.radius * self.radius));
        let one: L = lanes(1.0);
        let strength: L = lanes(-2.0 * self.strength);
        let [gx, gy, gz] = self.gradient.map(lanes::<L>);
        for ((t, rate), &density) in (self.first..).zip(self.rates).zip(self.density) {
            let [x, y, z, u, v, w, deviation, _] = self.records[t].map(L::splat);
            let density: L = lanes(density);
            let mut sum = L::zero();
            for index in self.list.of(t).chunks_exact(L::LANES) {
                let [xj, yj, zj, uj, vj, wj, deviation_j, volume] = L::gather(self.records, index);
                let dx = L::coordinate_difference(x, xj) * unit;
                let dy = L::coordinate_difference(y, yj) * unit;
                let dz = L::coordinate_difference(z, zj) * unit;
                let distance2 = dz.mul_add(dz, dy.mul_add(dy, dx * dx));
                let m = (one - distance2.sqrt() * inverse_radius).max(L::zero());
                let slope = m * m * (m * lanes(-20.0)) * norm * volume;
                let approach = (w - wj).mul_add(dz, (v - vj).mul_add(dy, (u - uj) * dx));
                sum = density.mul_add(approach * slope, sum);
                let psi = (deviation_j - deviation) + gz.mul_add(dz, gy.mul_add(dy, gx * dx));
                sum = strength.mul_add(psi * slope, sum);
            }
            *rate = sum.sum().to_f64();
        }
    }
}

impl<S: Real> Vectorized for Force<'_, S> {
    type Scalar = S;
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes<Scalar = S>>(self) {
        let unit: L = lanes(self.unit);
        let inverse_radius: L = lanes(1.0 / self.radius);
        let norm: L = lanes(NORM / (self.radius * self.radius));
        let one: L = lanes(1.0);
        for ((t, rate), &density) in (self.first..).zip(self.rates).zip(self.density) {
            let [x, y, z, _, _, _, pressure, _] = self.records[t].map(L::splat);
            let inverse_density: L = lanes(1.0 / density);
            let (mut ax, mut ay, mut az) = (L::zero(), L::zero(), L::zero());
            for index in self.list.of(t).chunks_exact(L::LANES) {
                let [xj, yj, zj, _, _, _, pressure_j, volume] = L::gather(self.records, index);
                let dx = L::coordinate_difference(x, xj) * unit;
                let dy = L::coordinate_difference(y, yj) * unit;
                let dz = L::coordinate_difference(z, zj) * unit;
                let distance2 = dz.mul_add(dz, dy.mul_add(dy, dx * dx));
                let m = (one - distance2.sqrt() * inverse_radius).max(L::zero());
                let slope = m * m * (m * lanes(-20.0)) * norm * volume;
                let factor = -((pressure + pressure_j) * slope * inverse_density);
                ax = factor.mul_add(dx, ax);
                ay = factor.mul_add(dy, ay);
                az = factor.mul_add(dz, az);
            }
            *rate = Acceleration([ax, ay, az].map(|a| a.sum().to_f64()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{density_terms, inviscid_force_terms};

    /// The same operations in the same order: not a bit differs, so the counts are comparable.
    fn same_bits<S: Real>() {
        let case = SweepCase::<S>::new(1000, 2.63, 0.1);
        let terms = density_terms(case.scale.support_radius);
        let (strength, gradient) = (terms.1.strength, terms.1.hydrostatic_gradient);
        assert_eq!(density_rates(&case, strength, gradient), case.density_rates(terms));
        assert_eq!(accelerations(&case), case.accelerations(inviscid_force_terms()));
    }

    #[test]
    fn the_solver_computes_the_same_bits() {
        same_bits::<f32>();
        same_bits::<f64>();
    }
}
