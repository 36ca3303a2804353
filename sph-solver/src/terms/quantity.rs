//! What a sweep reads and returns.

use super::{Pair, lanes};
use sph_kernels::{Lanes, Real};
use sph_neighbors::CLUSTER;
use std::ops::{AddAssign, SubAssign};

/// What a group of pairs contributes to the change of a particle. Groups add up.
pub trait Rate: Copy + Default + Send + Sync + AddAssign + SubAssign + 'static {}

impl Rate for DensityRate {}

impl<const D: usize> Rate for Acceleration<D> {}

/// What word 6 of the records holds while a sweep runs, what the coefficients of its terms multiply,
/// and what it returns.
pub trait Quantity: Copy + Send + Sync + 'static {
    /// Result per target.
    type Rate<const D: usize>: Rate;
    /// Sum over the pairs of a target, one target a lane.
    type Sum<const D: usize, L: Lanes>: Copy;

    /// Nothing added yet.
    fn zero<const D: usize, L: Lanes>() -> Self::Sum<D, L>;

    /// Adds one pair a lane.
    fn add<const D: usize, L: Lanes>(sum: &mut Self::Sum<D, L>, coefficient: L, pair: &Pair<D, L>);

    /// Adds s (v_i − v_j) F V of one pair a lane, see [`PairTerm::shear`](super::PairTerm::shear).
    #[inline(always)]
    fn add_shear<const D: usize, L: Lanes>(
        _: &mut Self::Sum<D, L>,
        _: L,
        _: &[L; D],
        _: &Pair<D, L>,
    ) {
    }

    /// The results of the targets in the first lanes, given their densities in kg/m³.
    fn rates<const D: usize, L: Lanes>(
        sum: &Self::Sum<D, L>,
        density: &[f64],
        rates: &mut [Self::Rate<D>],
    );
}

/// Records carry the density deviation ρ − ρ0 (kg/m³). A term gives c, with
/// `dρ_i/dt = ρ_i Σ_j c w`, where `w r_ij = ∇W_ij V_j` with r_ij in units. The sweep returns
/// [`DensityRate`].
#[derive(Debug, Clone, Copy)]
pub struct Deviation;

/// Records carry the pressure (Pa). A term gives c in Pa, with `dv_i/dt = (1/ρ_i) Σ_j c ∇W_ij V_j`.
/// The sweep returns accelerations, m/s².
#[derive(Debug, Clone, Copy)]
pub struct Pressure;

/// Records carry anything: only places count. A term gives c, and the sweep returns Σ_j c ∇W_ij V_j, 1/m.
#[derive(Debug, Clone, Copy)]
pub struct Crowding;

/// Records carry anything: only places and support radii count. A term gives c, and the sweep returns
/// Σ_j c ∇W_ij V_j with what it takes to make a gradient of it.
#[derive(Debug, Clone, Copy)]
pub struct Slope;

/// A sum of gradients and the moments of the neighbours that it is over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlopeSum<const D: usize> {
    /// Σ c ∇W V, 1/m.
    pub sum: [f64; D],
    /// Σ (x_j − x_i) ⊗ ∇W_ij V_j: 1 inside of the fluid.
    pub moments: [[f64; D]; D],
}

impl<const D: usize> SlopeSum<D> {
    /// The gradient, exact for fields that are linear; none where too few neighbours lie around.
    ///
    /// Source: Randles & Libersky (1996), Comput. Methods Appl. Mech. Eng. 139, eq. 27.
    pub fn gradient(&self) -> Option<[f64; D]> {
        // Gauss's elimination with the largest pivot of each column.
        let (mut m, mut g) = (self.moments, self.sum);
        for k in 0..D {
            let size = |row: &usize| m[*row][k].abs();
            let pivot = (k..D).max_by(|a, b| size(a).total_cmp(&size(b)))?;
            m.swap(k, pivot);
            g.swap(k, pivot);
            if m[k][k].abs() < SINGULAR {
                return None;
            }
            for row in k + 1..D {
                let factor = m[row][k] / m[k][k];
                (k..D).for_each(|l| m[row][l] -= factor * m[k][l]);
                g[row] -= factor * g[k];
            }
        }
        for k in (0..D).rev() {
            let known: f64 = (k + 1..D).map(|l| m[k][l] * g[l]).sum();
            g[k] = (g[k] - known) / m[k][k];
        }
        Some(g)
    }
}

/// Moments smaller than this are of neighbours that hardly spread along some direction.
const SINGULAR: f64 = 0.1;

impl<const D: usize> Rate for SlopeSum<D> {}

impl<const D: usize> Default for SlopeSum<D> {
    fn default() -> Self {
        Self { sum: [0.0; D], moments: [[0.0; D]; D] }
    }
}

impl<const D: usize> AddAssign for SlopeSum<D> {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        for k in 0..D {
            self.sum[k] += other.sum[k];
            (0..D).for_each(|l| self.moments[k][l] += other.moments[k][l]);
        }
    }
}

impl<const D: usize> SubAssign for SlopeSum<D> {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        for k in 0..D {
            self.sum[k] -= other.sum[k];
            (0..D).for_each(|l| self.moments[k][l] -= other.moments[k][l]);
        }
    }
}

/// A sum of gradients, 1/m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VectorSum<const D: usize>(pub [f64; D]);

impl<const D: usize> Rate for VectorSum<D> {}

impl<const D: usize> Default for VectorSum<D> {
    fn default() -> Self {
        Self([0.0; D])
    }
}

impl<const D: usize> AddAssign for VectorSum<D> {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        for (sum, part) in self.0.iter_mut().zip(other.0) {
            *sum += part;
        }
    }
}

/// What the density sweep tells of a particle.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct DensityRate {
    /// dρ/dt, kg/m³/s.
    pub rate: f64,
    /// How much of the support the fluid fills, −Σ r_ij·∇W_ij V_j/D: 1 inside, ½ at a flat surface.
    pub fluid: f64,
    /// How much of it walls fill, counted in the same way.
    pub wall: f64,
}

impl AddAssign for DensityRate {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        self.rate += other.rate;
        self.fluid += other.fluid;
        self.wall += other.wall;
    }
}

/// dv/dt of a particle, m/s².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Acceleration<const D: usize>(pub [f64; D]);

impl<const D: usize> AddAssign for Acceleration<D> {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        for (sum, part) in self.0.iter_mut().zip(other.0) {
            *sum += part;
        }
    }
}

impl<const D: usize> Default for Acceleration<D> {
    fn default() -> Self {
        Self([0.0; D])
    }
}

impl SubAssign for DensityRate {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        self.rate -= other.rate;
        self.fluid -= other.fluid;
        self.wall -= other.wall;
    }
}

impl<const D: usize> SubAssign for Acceleration<D> {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        for (sum, part) in self.0.iter_mut().zip(other.0) {
            *sum -= part;
        }
    }
}

impl<const D: usize> SubAssign for VectorSum<D> {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        for (sum, part) in self.0.iter_mut().zip(other.0) {
            *sum -= part;
        }
    }
}

impl Quantity for Deviation {
    type Rate<const D: usize> = DensityRate;
    /// Σ c w, and the shares of the support that fluid and walls fill.
    type Sum<const D: usize, L: Lanes> = [L; 3];

    #[inline(always)]
    fn zero<const D: usize, L: Lanes>() -> [L; 3] {
        [L::zero(); 3]
    }

    #[inline(always)]
    fn add<const D: usize, L: Lanes>(sum: &mut [L; 3], coefficient: L, pair: &Pair<D, L>) {
        sum[0] = coefficient.mul_add(pair.weight, sum[0]);
        let metres = pair.unit * lanes(-1.0 / D as f64);
        sum[1] = (pair.distance2 * metres).mul_add(pair.weight, sum[1]);
    }

    #[inline(always)]
    fn rates<const D: usize, L: Lanes>(sum: &[L; 3], density: &[f64], rates: &mut [DensityRate]) {
        let [flux, fluid, wall] = sum.map(numbers);
        for (l, (rate, density)) in rates.iter_mut().zip(density).enumerate() {
            *rate = DensityRate { rate: flux[l] * density, fluid: fluid[l], wall: wall[l] };
        }
    }
}

impl Quantity for Pressure {
    type Rate<const D: usize> = Acceleration<D>;
    type Sum<const D: usize, L: Lanes> = [L; D];

    #[inline(always)]
    fn zero<const D: usize, L: Lanes>() -> [L; D] {
        [L::zero(); D]
    }

    #[inline(always)]
    fn add<const D: usize, L: Lanes>(sum: &mut [L; D], coefficient: L, pair: &Pair<D, L>) {
        let factor = coefficient * pair.weight;
        for (sum, offset) in sum.iter_mut().zip(pair.offset) {
            *sum = factor.mul_add(offset, *sum);
        }
    }

    #[inline(always)]
    fn add_shear<const D: usize, L: Lanes>(
        sum: &mut [L; D],
        coefficient: L,
        velocity: &[L; D],
        pair: &Pair<D, L>,
    ) {
        // F V = w per unit of length.
        let factor = coefficient * (pair.weight * pair.per_unit);
        for (sum, velocity) in sum.iter_mut().zip(velocity) {
            *sum = factor.mul_add(*velocity, *sum);
        }
    }

    #[inline(always)]
    fn rates<const D: usize, L: Lanes>(
        sum: &[L; D],
        density: &[f64],
        rates: &mut [Acceleration<D>],
    ) {
        let sum = sum.map(numbers);
        for (l, (rate, density)) in rates.iter_mut().zip(density).enumerate() {
            *rate = Acceleration(std::array::from_fn(|k| sum[k][l] / density));
        }
    }
}

impl Quantity for Crowding {
    type Rate<const D: usize> = VectorSum<D>;
    type Sum<const D: usize, L: Lanes> = [L; D];

    #[inline(always)]
    fn zero<const D: usize, L: Lanes>() -> [L; D] {
        [L::zero(); D]
    }

    #[inline(always)]
    fn add<const D: usize, L: Lanes>(sum: &mut [L; D], coefficient: L, pair: &Pair<D, L>) {
        Pressure::add(sum, coefficient, pair);
    }

    #[inline(always)]
    fn rates<const D: usize, L: Lanes>(sum: &[L; D], _: &[f64], rates: &mut [VectorSum<D>]) {
        let sum = sum.map(numbers);
        for (l, rate) in rates.iter_mut().enumerate() {
            *rate = VectorSum(std::array::from_fn(|k| sum[k][l]));
        }
    }
}

impl Quantity for Slope {
    type Rate<const D: usize> = SlopeSum<D>;
    /// Σ c ∇W V, and the moments.
    type Sum<const D: usize, L: Lanes> = ([L; D], [[L; D]; D]);

    #[inline(always)]
    fn zero<const D: usize, L: Lanes>() -> ([L; D], [[L; D]; D]) {
        ([L::zero(); D], [[L::zero(); D]; D])
    }

    #[inline(always)]
    fn add<const D: usize, L: Lanes>(
        sum: &mut ([L; D], [[L; D]; D]),
        coefficient: L,
        pair: &Pair<D, L>,
    ) {
        Pressure::add(&mut sum.0, coefficient, pair);
        let weight = pair.weight * -pair.unit;
        for (k, row) in sum.1.iter_mut().enumerate() {
            let factor = weight * pair.offset[k];
            for (l, moment) in row.iter_mut().enumerate() {
                *moment = factor.mul_add(pair.offset[l], *moment);
            }
        }
    }

    #[inline(always)]
    fn rates<const D: usize, L: Lanes>(
        sum: &([L; D], [[L; D]; D]),
        _: &[f64],
        rates: &mut [SlopeSum<D>],
    ) {
        let (sum, moments) = (sum.0.map(numbers), sum.1.map(|row| row.map(numbers)));
        for (l, rate) in rates.iter_mut().enumerate() {
            *rate = SlopeSum {
                sum: std::array::from_fn(|k| sum[k][l]),
                moments: std::array::from_fn(|k| std::array::from_fn(|m| moments[k][m][l])),
            };
        }
    }
}

/// The numbers in the lanes, and zeros up to the size of a cluster.
#[inline(always)]
fn numbers<L: Lanes>(lanes: L) -> [f64; CLUSTER] {
    let mut all = [L::Scalar::from_f64(0.0); CLUSTER];
    lanes.store(&mut all);
    all.map(Real::to_f64)
}
