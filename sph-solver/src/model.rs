//! The numbers of a run that every rank and every pass shares.

use crate::eos::EquationOfState;
use crate::grading::Grading;
use crate::space::PairScale;
use crate::timestep::StepLimits;

/// Constants of a run in SI units; derived from the scene once and never changed.
#[derive(Debug, Clone, PartialEq)]
pub struct Model<const D: usize> {
    /// Initial particle distance, the largest where it varies, m.
    pub spacing: f64,
    /// Support radius R, the largest where it varies, m.
    pub support_radius: f64,
    /// How radii follow from masses; none where all are the same.
    pub grading: Option<Grading>,
    /// Width of the Verlet skin: lists hold pairs closer than R + skin, m.
    pub skin: f64,
    /// Gravity, m/s².
    pub gravity: [f64; D],
    /// Equation of state of the fluid.
    pub equation_of_state: EquationOfState,
    /// Limits of the time step.
    pub limits: StepLimits,
    /// Lower and upper corner of the box that particles may be in, m.
    pub domain: ([f64; D], [f64; D]),
    /// Lengths after which the axes repeat, from the lower corner of the domain on, m; none for an
    /// open axis.
    pub periods: [Option<f64>; D],
    /// Lowest pressure of the fluid, Pa: where it would cavitate. −∞ for one that never does.
    pub lowest_pressure: f64,
    /// Whether the fluid fills all the space that it can be in, so that it has no free surface.
    pub closed: bool,
    /// What happens to a particle outside of the domain.
    pub on_lost: OnLost,
    /// The solids by number.
    pub solids: Vec<SolidModel<D>>,
}

/// What the passes know of a solid besides its wall elements.
#[derive(Debug, Clone, PartialEq)]
pub struct SolidModel<const D: usize> {
    /// Name, for files.
    pub name: String,
    /// The point that moments are about, m.
    pub center: [f64; D],
    /// Whether the fluid slips along it.
    pub slips: bool,
    /// For a solid so thin that each of its sides is a wall of its own.
    pub thin: Option<ThinWall>,
}

/// A solid thinner than the support, each of whose sides is a wall of its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThinWall {
    /// How far below its surface fluid still belongs to that side, m: not beyond the middle.
    pub below: f64,
    /// Distance of its elements, m.
    pub spacing: f64,
}

/// What to do with a particle that leaves the domain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OnLost {
    /// End the run with an error.
    Stop,
    /// Take it out, count and report it.
    Remove,
}

/// A speed beyond this multiple of the sound speed is no longer weakly compressible flow.
const DIVERGED_MACH: f64 = 3.0;

impl<const D: usize> Model<D> {
    /// Scale of the pairs.
    pub fn scale(&self) -> PairScale<D> {
        PairScale { periods: self.periods, ..PairScale::new(self.support_radius) }
    }

    /// A solid by its number in the scene.
    pub fn solid(&self, number: u16) -> Option<&SolidModel<D>> {
        self.solids.get(usize::from(number))
    }

    /// What a thin solid of this number is.
    pub fn thin(&self, number: u16) -> Option<ThinWall> {
        self.solid(number).and_then(|solid| solid.thin)
    }

    /// Speed above which the run has diverged, m/s.
    pub fn speed_limit(&self) -> f64 {
        DIVERGED_MACH * self.limits.sound_speed
    }

    /// Support radius of a particle of this mass (kg), m.
    #[inline]
    pub fn radius_of(&self, mass: f64) -> f64 {
        match &self.grading {
            Some(grading) => self.support_radius * grading.ratio::<D>(mass),
            None => self.support_radius,
        }
    }

    /// Initial distance of particles of this mass (kg), m.
    #[inline]
    pub fn spacing_of(&self, mass: f64) -> f64 {
        match &self.grading {
            Some(grading) => self.spacing * grading.ratio::<D>(mass),
            None => self.spacing,
        }
    }

    /// Largest distance up to which lists and overlap zones reach, m.
    pub fn reach(&self) -> f64 {
        self.support_radius + self.skin
    }

    /// Pressure (Pa) at a density (kg/m³), not below the lowest one.
    #[inline]
    pub fn pressure(&self, density: f64) -> f64 {
        self.equation_of_state.pressure(density).max(self.lowest_pressure)
    }

    /// Elastic energy per mass at a density, J/kg: that of the equation of state, and beyond the density at
    /// which the fluid cavitates what its lowest pressure stores.
    pub fn elastic_energy(&self, density: f64) -> f64 {
        let eos = &self.equation_of_state;
        if eos.pressure(density) >= self.lowest_pressure {
            return eos.elastic_energy(density);
        }
        let torn = eos.density(self.lowest_pressure);
        eos.elastic_energy(torn) + self.lowest_pressure * (1.0 / torn - 1.0 / density)
    }

    /// Gravity along the open axes, which has a potential, and along the periodic ones, which drives, m/s².
    pub fn parts_of_gravity(&self) -> ([f64; D], [f64; D]) {
        let open = std::array::from_fn(|k| self.periods[k].map_or(self.gravity[k], |_| 0.0));
        (open, std::array::from_fn(|k| self.gravity[k] - open[k]))
    }

    /// Potential energy per mass at `x` (m), zero at the origin, J/kg.
    #[inline]
    pub fn potential_energy(&self, x: &[f64; D]) -> f64 {
        let open = self.parts_of_gravity().0;
        -(0..D).map(|k| open[k] * x[k]).sum::<f64>()
    }

    /// Whether a point is inside the domain. NaN is outside.
    pub fn contains(&self, x: &[f64; D]) -> bool {
        let (lower, upper) = &self.domain;
        (0..D).all(|k| match self.periods[k] {
            Some(_) => x[k].is_finite(),
            None => lower[k] <= x[k] && x[k] <= upper[k],
        })
    }
}
