//! Pair terms: what one neighbour contributes to one particle.
//!
//! A term is one file: its equation and source in the docs, one function, its test. Terms compose
//! as tuples, `(SymmetricPressure, ArtificialViscosity { .. })`; `()` is the empty term and costs
//! nothing, because every sweep is compiled for exactly the tuple it is given.
//!
//! Notation: i is the target, j the source, `r_ij = x_i − x_j`, `∇W_ij = ∇_i W(r_ij)`,
//! `V = m/ρ`. Every sum over pairs here is one of gradients, so a term gives only the *coefficient*
//! in front of `∇W_ij V_j`; the sweep adds up the coefficients of a pair, multiplies once, and
//! divides by what all pairs of a target share (see [`Quantity`]) once per target.
//!
//! Walls are another kind of neighbour: they know their normal n, and what a frictionless wall does
//! lies along it, so a [`WallTerm`] has a sum of its own, see [`WallPush`].

mod artificial_viscosity;
mod at_rest;
mod continuity;
mod delta_continuity;
mod pressure;
mod quantity;
mod radius_slope;
mod shifting;
mod viscosity;
mod wall_continuity;
mod wall_friction;
mod wall_normals;
mod wall_pressure;
mod wall_push;

pub use artificial_viscosity::{ArtificialViscosity, strengthened};
pub use at_rest::AtRest;
pub use continuity::Continuity;
pub use delta_continuity::DeltaContinuity;
pub use pressure::SymmetricPressure;
pub use quantity::{
    Acceleration, Crowding, DensityRate, Deviation, Pressure, Quantity, Rate, Slope, SlopeSum,
    VectorSum,
};
pub use radius_slope::RadiusSlope;
pub use shifting::{MOST, Shifting, shift};
pub use viscosity::LaminarViscosity;
pub use wall_continuity::WallContinuity;
pub use wall_friction::NoSlip;
pub use wall_normals::{WallNormals, flatness};
pub use wall_pressure::WallPressure;
pub use wall_push::WallPush;

use sph_kernels::{Lanes, Real};

/// The particle that a sweep computes, one a lane.
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

/// One neighbour, the same in every lane.
#[derive(Debug, Clone, Copy)]
pub struct Source<const D: usize, L> {
    /// Density deviation or pressure: see [`Quantity`].
    pub quantity: L,
    /// Velocity, m/s.
    pub velocity: [L; D],
}

/// Geometry of a pair. Lengths are in units of the records, which saves three multiplications a
/// pair; what a term does with `unit` is computed once per cluster.
#[derive(Debug, Clone, Copy)]
pub struct Pair<const D: usize, L> {
    /// r_ij = x_i − x_j, units.
    pub offset: [L; D],
    /// |r_ij|², units².
    pub distance2: L,
    /// |r_ij|, units.
    pub distance: L,
    /// w with ∇W_ij V_j = w r_ij, r_ij in units, 1/m: the factor that every gradient term shares.
    pub weight: L,
    /// Metres per unit.
    pub unit: L,
    /// Units per metre.
    pub per_unit: L,
    /// How the support radius of the pair differs from the largest; none where all are the same.
    pub stretch: Option<Stretch<L>>,
}

/// The support radius of a pair where radii vary from particle to particle.
#[derive(Debug, Clone, Copy)]
pub struct Stretch<L> {
    /// R_ij over the largest radius.
    pub ratio: L,
    /// The largest radius over R_ij.
    pub inverse: L,
    /// R_j − R_i over the largest radius.
    pub difference: L,
}

/// The support radius of a target beside a wall where radii vary from particle to particle.
#[derive(Debug, Clone, Copy)]
pub struct WallStretch<const D: usize, L> {
    /// R_iw over the largest radius.
    pub ratio: L,
    /// The largest radius over R_iw.
    pub inverse: L,
    /// −½ ∇R_i/R_i, 1/m: how far the push of a wall leans per metre of height, see [`RadiusSlope`].
    pub lean: [L; D],
}

impl<const D: usize, L: Lanes> Pair<D, L> {
    /// A quantity that grows with the smoothing length, given for the largest.
    #[inline(always)]
    pub fn stretched(&self, x: L) -> L {
        self.stretch.map_or(x, |stretch| x * stretch.ratio)
    }
}

/// What a wall term knows of the target besides [`Target`].
#[derive(Debug, Clone, Copy)]
pub struct BesideWall<const D: usize, L> {
    /// ∇p/ρ, the pressure gradient in the fluid over its density, m/s².
    pub pressure_gradient: [L; D],
    /// Lowest pressure that the wall may have towards the target, Pa.
    pub lowest_pressure: L,
    /// 1 where all the walls around the target are of one plane, 0 where solids make a corner.
    pub flatness: L,
    /// Angular velocity of the wall, rad/s. Velocities of targets are those in the frame of the wall.
    pub spin: [L; 3],
}

/// Geometry of a pair of a target and an element of a wall, lengths in units of the records unless
/// said otherwise.
#[derive(Debug, Clone, Copy)]
pub struct WallPair<const D: usize, L> {
    /// r_iw = x_i − x_w, units.
    pub offset: [L; D],
    /// |r_iw|², units².
    pub distance2: L,
    /// n, unit vector out of the wall into the fluid.
    pub normal: [L; D],
    /// Depth of the element below the surface of the wall, m.
    pub depth: L,
    /// w with ∇W_iw V_w = w r_iw, as in [`Pair`].
    pub weight: L,
    /// How much harder than by its share the wall of a thin solid pushes: max(0, 1 − z/(dp/2))², z the height
    /// of the target above its surface. Nothing for other walls.
    pub squeezed: Option<L>,
    /// Metres per unit.
    pub unit: L,
    /// Units per metre.
    pub per_unit: L,
    /// How the support radius of the target differs from the largest; none where all are the same.
    pub stretch: Option<WallStretch<D, L>>,
}

impl<const D: usize, L: Lanes> WallPair<D, L> {
    /// A quantity that grows with the smoothing length, given for the largest.
    #[inline(always)]
    pub fn stretched(&self, x: L) -> L {
        self.stretch.map_or(x, |stretch| x * stretch.ratio)
    }
}

/// A contribution of the elements of a wall to a sweep whose targets carry `Q`.
pub trait WallTerm<const D: usize, Q: Quantity>: Copy + Send + Sync {
    /// What is summed over the elements.
    type Total<L: Lanes>: Copy;

    /// Nothing added yet.
    fn zero<L: Lanes>() -> Self::Total<L>;

    /// Adds one pair a lane. Must be finite for every pair, also for `r_iw = 0` and for pairs beyond
    /// the support.
    fn add<L: Lanes>(
        &self,
        i: &Target<D, L>,
        beside: &BesideWall<D, L>,
        pair: &WallPair<D, L>,
        total: &mut Self::Total<L>,
    );

    /// What the total means for the target, see [`Quantity`].
    fn finish<L: Lanes>(
        &self,
        i: &Target<D, L>,
        beside: &BesideWall<D, L>,
        total: &Self::Total<L>,
    ) -> Q::Sum<D, L>;
}

/// A contribution of pairs to a sweep whose records carry `Q`.
pub trait PairTerm<const D: usize, Q: Quantity>: Copy + Send + Sync {
    /// Whether the term adds nothing at all, so that its neighbours need not be visited.
    const EMPTY: bool = false;

    /// Whether the term has a part along r_ij, which [`coefficient`](Self::coefficient) gives.
    const CENTRAL: bool = true;

    /// Whether the term has a part along v_i − v_j, which [`shear`](Self::shear) gives.
    const SHEARS: bool = false;

    /// The coefficient s of (v_i − v_j) F_ij V_j, ∇W_ij = F_ij r_ij, in place of c ∇W_ij V_j. Only
    /// accelerations have such a part.
    fn shear<L: Lanes>(&self, _: &Target<D, L>, _: &Source<D, L>, _: &Pair<D, L>) -> L {
        L::zero()
    }

    /// The coefficient of one pair a lane, see [`Quantity`] for what it is the coefficient of.
    ///
    /// Must be finite for every pair, also for `r_ij = 0` and for pairs beyond the support; a
    /// particle is its own neighbour, with `r_ij = 0`, `v_i = v_j` and equal quantities, and must not
    /// contribute.
    fn coefficient<L: Lanes>(&self, i: &Target<D, L>, j: &Source<D, L>, pair: &Pair<D, L>) -> L;
}

impl<const D: usize, Q: Quantity> PairTerm<D, Q> for () {
    const EMPTY: bool = true;
    const CENTRAL: bool = false;

    #[inline(always)]
    fn coefficient<L: Lanes>(&self, _: &Target<D, L>, _: &Source<D, L>, _: &Pair<D, L>) -> L {
        L::zero()
    }
}

impl<const D: usize, Q: Quantity, A: PairTerm<D, Q>, B: PairTerm<D, Q>> PairTerm<D, Q> for (A, B) {
    const EMPTY: bool = A::EMPTY && B::EMPTY;
    const CENTRAL: bool = A::CENTRAL || B::CENTRAL;
    const SHEARS: bool = A::SHEARS || B::SHEARS;

    #[inline(always)]
    fn coefficient<L: Lanes>(&self, i: &Target<D, L>, j: &Source<D, L>, pair: &Pair<D, L>) -> L {
        // Adding a zero would be an instruction: it changes the sign of −0.
        if !B::CENTRAL {
            self.0.coefficient(i, j, pair)
        } else if !A::CENTRAL {
            self.1.coefficient(i, j, pair)
        } else {
            self.0.coefficient(i, j, pair) + self.1.coefficient(i, j, pair)
        }
    }

    #[inline(always)]
    fn shear<L: Lanes>(&self, i: &Target<D, L>, j: &Source<D, L>, pair: &Pair<D, L>) -> L {
        if !B::SHEARS {
            self.0.shear(i, j, pair)
        } else if !A::SHEARS {
            self.1.shear(i, j, pair)
        } else {
            self.0.shear(i, j, pair) + self.1.shear(i, j, pair)
        }
    }
}

/// `strength π_ij` with `π_ij = (v_j − v_i)·r_ji / (|r_ij|² + softening)`: the form of artificial
/// viscosity. `strength` in Pa s and `softening` in m² for the largest smoothing length.
#[inline(always)]
pub(crate) fn viscous<const D: usize, L: Lanes>(
    strength: f64,
    softening: f64,
    i: &Target<D, L>,
    j: &Source<D, L>,
    pair: &Pair<D, L>,
) -> L {
    let strength = pair.stretched(lanes::<L>(strength) * pair.per_unit);
    let softening = lanes::<L>(softening) * (pair.per_unit * pair.per_unit);
    let softening = pair.stretched(pair.stretched(softening));
    // (v_j − v_i)·r_ji = (v_i − v_j)·r_ij.
    let rate = dot(&difference(&i.velocity, &j.velocity), &pair.offset);
    rate.div(pair.distance2 + softening) * strength
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

/// a − b.
#[inline(always)]
pub(crate) fn difference<const D: usize, L: Lanes>(a: &[L; D], b: &[L; D]) -> [L; D] {
    std::array::from_fn(|k| a[k] - b[k])
}

#[cfg(test)]
pub(crate) mod scalar {
    //! One pair in plain numbers, for the tests of the terms.
    use super::*;

    /// Metres per unit of these pairs.
    const UNIT: f64 = 0.25;

    /// Target and source with velocities `v_i`, `v_j` and quantities `q_i`, `q_j`; density 1000,
    /// volume `volume`, offset `r_ij`, slope F with ∇W_ij = F r_ij.
    pub fn pair(
        r_ij: [f64; 2],
        v: ([f64; 2], [f64; 2]),
        q: (f64, f64),
        volume: f64,
        slope: f64,
    ) -> (Target<2, f64>, Source<2, f64>, Pair<2, f64>) {
        let offset = r_ij.map(|x| x / UNIT);
        let distance2 = offset[0] * offset[0] + offset[1] * offset[1];
        (
            Target { velocity: v.0, quantity: q.0, density: 1000.0, inverse_density: 1e-3 },
            Source { quantity: q.1, velocity: v.1 },
            Pair {
                offset,
                distance2,
                distance: distance2.sqrt(),
                weight: slope * volume * UNIT,
                unit: UNIT,
                per_unit: 1.0 / UNIT,
                stretch: None,
            },
        )
    }

    /// Target and an element of a wall with normal `normal`, `depth` below its surface; otherwise as
    /// [`pair`].
    pub fn wall(
        r_iw: [f64; 2],
        normal: [f64; 2],
        depth: f64,
        (velocity, quantity): ([f64; 2], f64),
        volume: f64,
        slope: f64,
    ) -> (Target<2, f64>, WallPair<2, f64>) {
        let (i, _, pair) = pair(r_iw, (velocity, [0.0; 2]), (quantity, 0.0), volume, slope);
        let Pair { offset, distance2, weight, unit, per_unit, .. } = pair;
        let (squeezed, stretch) = (None, None);
        let pair = WallPair {
            offset,
            distance2,
            normal,
            depth,
            weight,
            squeezed,
            unit,
            per_unit,
            stretch,
        };
        (i, pair)
    }

    /// What a wall term adds to the rate of the target, where ∇p/ρ is `gradient`.
    pub fn wall_rate<Q: Quantity, T: WallTerm<2, Q>>(
        term: &T,
        (i, pair): &(Target<2, f64>, WallPair<2, f64>),
        pressure_gradient: [f64; 2],
        lowest_pressure: f64,
    ) -> Q::Rate<2> {
        let mut total = T::zero();
        let (flatness, spin) = (1.0, [0.0; 3]);
        let beside = BesideWall { pressure_gradient, lowest_pressure, flatness, spin };
        term.add(i, &beside, pair, &mut total);
        let sum = term.finish(i, &beside, &total);
        let mut rates = [Q::Rate::default()];
        Q::rates(&sum, &[i.density], &mut rates);
        rates[0]
    }

    /// What a term adds to the rate of the target.
    pub fn rate<Q: Quantity, T: PairTerm<2, Q>>(
        term: &T,
        (i, j, pair): &(Target<2, f64>, Source<2, f64>, Pair<2, f64>),
    ) -> Q::Rate<2> {
        let mut sum = Q::zero();
        if T::CENTRAL {
            Q::add(&mut sum, term.coefficient(i, j, pair), pair);
        }
        if T::SHEARS {
            let velocity = difference(&i.velocity, &j.velocity);
            Q::add_shear(&mut sum, term.shear(i, j, pair), &velocity, pair);
        }
        let mut rates = [Q::Rate::default()];
        Q::rates(&sum, &[i.density], &mut rates);
        rates[0]
    }
}
