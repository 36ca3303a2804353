//! The sums of the solver for one scene, written out without its terms: inviscid δ-SPH in three
//! dimensions with the kernel Wendland C2, no walls.
//!
//! What composition costs is the difference between these loops and the solver's sweep with the
//! same terms: see the program `composition`.

use crate::SweepCase;
use sph_kernels::{Lanes, Real, Vectorized};
use sph_neighbors::{CLUSTER, ClusterList};
use sph_solver::records::Record;
use sph_solver::terms::{Acceleration, DensityRate};

/// Particles per entry into vector code, as in the solver.
const GRAIN: usize = 256;

/// dρ/dt = ρ_i Σ (v_i − v_j)·∇W V + 2 δ h c0 Σ Ψ F V, and the share of the support that is filled.
pub fn density_rates<S: Real>(
    case: &SweepCase<S>,
    strength: f64,
    gradient: [f64; 3],
) -> Vec<DensityRate> {
    let mut rates = vec![DensityRate::default(); case.len()];
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
    list: &'a ClusterList,
    unit: f64,
    radius: f64,
    strength: f64,
    gradient: [f64; 3],
    rates: &'a mut [DensityRate],
}

struct Force<'a, S> {
    first: usize,
    records: &'a [Record<S>],
    density: &'a [f64],
    list: &'a ClusterList,
    unit: f64,
    radius: f64,
    rates: &'a mut [Acceleration<3>],
}

#[inline(always)]
fn lanes<L: Lanes>(x: f64) -> L {
    L::splat(L::Scalar::from_f64(x))
}

/// Targets of a cluster, from the first on: their records and up to eight numbers made from their
/// densities. Lanes without a target repeat the last one.
#[inline(always)]
fn cluster<L: Lanes>(
    records: &[Record<L::Scalar>],
    density: &[f64],
    first: usize,
) -> ([L; 8], [L::Scalar; CLUSTER]) {
    let count = density.len();
    let index: [u32; CLUSTER] = std::array::from_fn(|l| (first + l.min(count - 1)) as u32);
    let inverse = std::array::from_fn(|l| L::Scalar::from_f64(1.0 / density[l.min(count - 1)]));
    (L::gather(records, &index), inverse)
}

#[inline(always)]
fn numbers<L: Lanes>(lanes: L) -> [f64; CLUSTER] {
    let mut all = [L::Scalar::from_f64(0.0); CLUSTER];
    lanes.store(&mut all);
    all.map(Real::to_f64)
}

impl<S: Real> Vectorized for Density<'_, S> {
    type Scalar = S;
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes<Scalar = S>>(self) {
        let (unit, per_unit): (L, L) = (lanes(self.unit), lanes(1.0 / self.unit));
        let metres = unit * lanes(-1.0 / 3.0);
        let to_q: L = lanes(self.unit / self.radius);
        let one: L = lanes(1.0);
        let [gx, gy, gz] = self.gradient.map(lanes::<L>);
        let (records, list) = (self.records, self.list);
        let end = self.first + self.rates.len();
        for (number, targets) in list.clusters().within(self.first..end) {
            for start in targets.clone().step_by(L::LANES) {
                let own = start - self.first..targets.end.min(start + L::LANES) - self.first;
                let (words, inverse) = cluster::<L>(records, &self.density[own.clone()], start);
                let [x, y, z, u, v, w, deviation, _] = words;
                let strength = lanes::<L>(-2.0 * self.strength) * L::load(&inverse);
                let u = strength.mul_add(gx, u);
                let v = strength.mul_add(gy, v);
                let w = strength.mul_add(gz, w);
                let strength = strength * per_unit;
                let (mut sum, mut filled) = (L::zero(), L::zero());
                for &j in list.sources(number) {
                    let [xj, yj, zj, uj, vj, wj, deviation_j, weight] =
                        records[j as usize].map(L::splat);
                    let dx = L::coordinate_difference(x, xj);
                    let dy = L::coordinate_difference(y, yj);
                    let dz = L::coordinate_difference(z, zj);
                    let distance2 = dz.mul_add(dz, dy.mul_add(dy, dx * dx));
                    let m = (one - distance2.sqrt() * to_q).max(L::zero());
                    let slope = m * m * m * weight;
                    let flux = (w - wj).mul_add(dz, (v - vj).mul_add(dy, (u - uj) * dx));
                    let coefficient = strength.mul_add(deviation_j - deviation, flux);
                    sum = coefficient.mul_add(slope, sum);
                    filled = (distance2 * metres).mul_add(slope, filled);
                }
                let (sum, filled) = (numbers(sum), numbers(filled));
                let rates = self.rates[own.clone()].iter_mut().zip(&self.density[own]);
                for (l, (rate, density)) in rates.enumerate() {
                    *rate = DensityRate { rate: sum[l] * density, fluid: filled[l], wall: 0.0 };
                }
            }
        }
    }
}

impl<S: Real> Vectorized for Force<'_, S> {
    type Scalar = S;
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes<Scalar = S>>(self) {
        let to_q: L = lanes(self.unit / self.radius);
        let one: L = lanes(1.0);
        let (records, list) = (self.records, self.list);
        let end = self.first + self.rates.len();
        for (number, targets) in list.clusters().within(self.first..end) {
            for start in targets.clone().step_by(L::LANES) {
                let own = start - self.first..targets.end.min(start + L::LANES) - self.first;
                let (words, _) = cluster::<L>(records, &self.density[own.clone()], start);
                let [x, y, z, _, _, _, pressure, _] = words;
                let (mut ax, mut ay, mut az) = (L::zero(), L::zero(), L::zero());
                for &j in list.sources(number) {
                    let [xj, yj, zj, _, _, _, pressure_j, weight] =
                        records[j as usize].map(L::splat);
                    let dx = L::coordinate_difference(x, xj);
                    let dy = L::coordinate_difference(y, yj);
                    let dz = L::coordinate_difference(z, zj);
                    let distance2 = dz.mul_add(dz, dy.mul_add(dy, dx * dx));
                    let m = (one - distance2.sqrt() * to_q).max(L::zero());
                    let factor = (-pressure - pressure_j) * (m * m * m * weight);
                    ax = factor.mul_add(dx, ax);
                    ay = factor.mul_add(dy, ay);
                    az = factor.mul_add(dz, az);
                }
                let sums = [ax, ay, az].map(numbers);
                let rates = self.rates[own.clone()].iter_mut().zip(&self.density[own]);
                for (l, (rate, density)) in rates.enumerate() {
                    *rate = Acceleration([0, 1, 2].map(|k| sums[k][l] / density));
                }
            }
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
        let (strength, gradient) = (terms.strength, terms.hydrostatic_gradient);
        assert_eq!(density_rates(&case, strength, gradient), case.density_rates(terms));
        assert_eq!(accelerations(&case), case.accelerations(inviscid_force_terms()));
    }

    #[test]
    fn the_solver_computes_the_same_bits() {
        same_bits::<f32>();
        same_bits::<f64>();
    }
}
