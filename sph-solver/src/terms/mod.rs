//! Pair terms: what one neighbour contributes to one particle.
//!
//! A term is one file: its equation and source in the docs, one function, its test. Terms compose
//! as tuples, `(Continuity, HydrostaticDiffusion { .. })`; `()` is the empty term and costs
//! nothing, because every sweep is compiled for exactly the tuple it is given.
//!
//! Notation: i is the target, j the source, `r_ij = x_i − x_j`, `∇W_ij = ∇_i W(r_ij)`,
//! `V = m/ρ`. A term adds to a [`Sum`]; the sweep multiplies nothing afterwards.

mod artificial_viscosity;
mod continuity;
mod density_diffusion;
mod pressure;
mod viscosity;
mod wall_pressure;

pub use artificial_viscosity::ArtificialViscosity;
pub use continuity::Continuity;
pub use density_diffusion::HydrostaticDiffusion;
pub use pressure::SymmetricPressure;
pub use viscosity::LaminarViscosity;
pub use wall_pressure::OneSidedRiemannWall;

use sph_kernels::{Lanes, Real};

/// What word 6 of the records holds while a sweep runs, and what the sweep returns.
pub trait Quantity: Copy + Send + Sync + 'static {
    /// Result per target.
    type Rate<const D: usize>: Copy + Default + Send + Sync;

    /// Turns the summed pair contributions into the result.
    fn rate<const D: usize>(density: f64, acceleration: [f64; D]) -> Self::Rate<D>;
}

/// Records carry the density deviation ρ − ρ0 (kg/m³); the sweep returns dρ/dt (kg/m³/s).
#[derive(Debug, Clone, Copy)]
pub struct Deviation;

/// Records carry the pressure (Pa); the sweep returns accelerations (m/s²).
#[derive(Debug, Clone, Copy)]
pub struct Pressure;

impl Quantity for Deviation {
    type Rate<const D: usize> = f64;

    #[inline(always)]
    fn rate<const D: usize>(density: f64, _: [f64; D]) -> f64 {
        density
    }
}

impl Quantity for Pressure {
    type Rate<const D: usize> = Acceleration<D>;

    #[inline(always)]
    fn rate<const D: usize>(_: f64, acceleration: [f64; D]) -> Acceleration<D> {
        Acceleration(acceleration)
    }
}

/// An acceleration, m/s².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Acceleration<const D: usize>(pub [f64; D]);

impl<const D: usize> Default for Acceleration<D> {
    fn default() -> Self {
        Self([0.0; D])
    }
}

/// The particle that a sweep computes, in every lane.
#[derive(Debug, Clone, Copy)]
pub struct Target<const D: usize, L> {
    /// Velocity, m/s.
    pub velocity: [L; D],
    /// Density deviation or pressure: see [`Quantity`].
    pub quantity: L,
    /// Density, kg/m³.
    pub density: L,
    /// 1 / density, m³/kg.
    pub inverse_density: L,
}

/// One neighbour a lane.
#[derive(Debug, Clone, Copy)]
pub struct Source<const D: usize, L> {
    /// Density deviation or pressure: see [`Quantity`].
    pub quantity: L,
    /// Velocity difference v_i − v_j, m/s.
    pub approach: [L; D],
}

/// Geometry of a pair, one neighbour a lane.
#[derive(Debug, Clone, Copy)]
pub struct Pair<const D: usize, L> {
    /// r_ij = x_i − x_j, m.
    pub offset: [L; D],
    /// |r_ij|², m².
    pub distance2: L,
    /// |r_ij|, m.
    pub distance: L,
    /// F V_j with ∇W_ij = F r_ij: the weighted slope that every gradient term shares, 1/m².
    pub slope_volume: L,
}

/// What the pairs add up to for one target.
#[derive(Debug, Clone, Copy)]
pub struct Sum<const D: usize, L> {
    /// dρ/dt, kg/m³/s.
    pub density: L,
    /// dv/dt, m/s².
    pub acceleration: [L; D],
}

impl<const D: usize, L: Lanes> Sum<D, L> {
    /// Nothing added yet.
    #[inline(always)]
    pub fn zero() -> Self {
        Self { density: L::zero(), acceleration: [L::zero(); D] }
    }

    /// Adds `factor · r_ij` to the acceleration.
    #[inline(always)]
    pub fn push(&mut self, factor: L, pair: &Pair<D, L>) {
        for (sum, offset) in self.acceleration.iter_mut().zip(pair.offset) {
            *sum = factor.mul_add(offset, *sum);
        }
    }
}

/// A contribution of pairs to a sweep whose records carry `Q`.
pub trait PairTerm<const D: usize, Q: Quantity>: Copy + Send + Sync {
    /// Whether the term adds nothing at all, so that its neighbours need not be visited.
    const EMPTY: bool = false;

    /// Adds the contribution of one neighbour a lane. Must vanish for `r_ij = 0`, `v_i = v_j` and
    /// equal quantities: lists are padded with the target itself.
    fn add<L: Lanes>(
        &self,
        i: &Target<D, L>,
        j: &Source<D, L>,
        pair: &Pair<D, L>,
        sum: &mut Sum<D, L>,
    );
}

impl<const D: usize, Q: Quantity> PairTerm<D, Q> for () {
    const EMPTY: bool = true;

    #[inline(always)]
    fn add<L: Lanes>(&self, _: &Target<D, L>, _: &Source<D, L>, _: &Pair<D, L>, _: &mut Sum<D, L>) {
    }
}

impl<const D: usize, Q: Quantity, A: PairTerm<D, Q>, B: PairTerm<D, Q>> PairTerm<D, Q> for (A, B) {
    const EMPTY: bool = A::EMPTY && B::EMPTY;

    #[inline(always)]
    fn add<L: Lanes>(
        &self,
        i: &Target<D, L>,
        j: &Source<D, L>,
        pair: &Pair<D, L>,
        sum: &mut Sum<D, L>,
    ) {
        self.0.add(i, j, pair, sum);
        self.1.add(i, j, pair, sum);
    }
}

/// Adds `strength/ρ_i · π_ij ∇W_ij V_j` with `π_ij = (v_j − v_i)·r_ji / (|r_ij|² + softening)`: the
/// form that artificial and physical viscosity share.
#[inline(always)]
pub(crate) fn push_viscous<const D: usize, L: Lanes>(
    strength: f64,
    softening: f64,
    i: &Target<D, L>,
    j: &Source<D, L>,
    pair: &Pair<D, L>,
    sum: &mut Sum<D, L>,
) {
    // (v_j − v_i)·r_ji = (v_i − v_j)·r_ij.
    let rate = dot(&j.approach, &pair.offset).div(pair.distance2 + lanes(softening));
    let factor = rate * pair.slope_volume * lanes(strength);
    sum.push(factor * i.inverse_density, pair);
}

/// A constant of a term in every lane.
#[inline(always)]
pub(crate) fn lanes<L: Lanes>(value: f64) -> L {
    L::splat(<L::Scalar as Real>::from_f64(value))
}

/// a · b over the components.
#[inline(always)]
pub(crate) fn dot<const D: usize, L: Lanes>(a: &[L; D], b: &[L; D]) -> L {
    let mut sum = a[0] * b[0];
    for k in 1..D {
        sum = a[k].mul_add(b[k], sum);
    }
    sum
}

#[cfg(test)]
pub(crate) mod scalar {
    //! One pair in plain numbers, for the tests of the terms.
    use super::*;

    /// Target and source with velocities `v_i`, `v_j` and quantities `q_i`, `q_j`; density 1000,
    /// volume `volume`, offset `r_ij`, slope F.
    pub fn pair(
        r_ij: [f64; 2],
        v: ([f64; 2], [f64; 2]),
        q: (f64, f64),
        volume: f64,
        slope: f64,
    ) -> (Target<2, f64>, Source<2, f64>, Pair<2, f64>) {
        let distance2 = r_ij[0] * r_ij[0] + r_ij[1] * r_ij[1];
        (
            Target { velocity: v.0, quantity: q.0, density: 1000.0, inverse_density: 1e-3 },
            Source { quantity: q.1, approach: [v.0[0] - v.1[0], v.0[1] - v.1[1]] },
            Pair {
                offset: r_ij,
                distance2,
                distance: distance2.sqrt(),
                slope_volume: slope * volume,
            },
        )
    }
}
