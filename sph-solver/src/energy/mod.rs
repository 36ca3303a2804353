//! The energy budget: what each term of the scheme takes from the energy of the fluid.
//!
//! The energy of the fluid is kinetic, potential and elastic. Every term changes it in a known way: a force
//! by its work in the half kicks of a step, a change of density by p dρ/ρ² per mass. Both are booked as
//! they happen, to a *sink*, for each particle in each step: nothing is interpolated between rows. What the
//! pressure of the fluid does and what the continuity equation does then remain; the two are an exchange
//! between kinetic and elastic energy and cancel but for the error of the time integration. So the
//! *residual*, the energy now and all that sinks took less the energy at the start, is the energy that the
//! run has gained or lost without a reason: how far it may be believed.
//!
//! Everything is added up in whole quanta, so that order does not matter: the same bits on any number of
//! ranks and threads, and after a resume.

mod kicks;

pub use kicks::Kicks;

use crate::loads::whole;
use crate::model::Model;
use crate::scheme::Scheme;

/// Where energy of the fluid goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sink {
    /// Artificial viscosity.
    ArtificialViscosity,
    /// Physical viscosity inside the fluid.
    Viscosity,
    /// Diffusion of the density.
    DensityDiffusion,
    /// Pressure of walls, seen from the wall: what the fluid does to the mirrored fluid in it.
    WallPressure,
    /// Dissipation of what moves along the normal of a wall.
    WallDamping,
    /// Friction along walls, seen from the wall.
    WallFriction,
    /// Work on solids that move. Negative for a solid that drives the fluid.
    Solids,
    /// Work against gravity along a periodic axis, where it has no potential. Negative where it drives the
    /// fluid.
    Driving,
    /// Particles that are shifted up or down.
    Shifting,
    /// Tension in particles that tear off, which is let go.
    Spray,
    /// Particles that have left the domain.
    Lost,
}

/// Number of sinks.
pub const SINKS: usize = 11;

impl Sink {
    /// All of them in the order of [`Quanta`].
    pub const ALL: [Self; SINKS] = [
        Self::ArtificialViscosity,
        Self::Viscosity,
        Self::DensityDiffusion,
        Self::WallPressure,
        Self::WallDamping,
        Self::WallFriction,
        Self::Solids,
        Self::Driving,
        Self::Shifting,
        Self::Spray,
        Self::Lost,
    ];

    /// Name of its column in `energies.csv`.
    pub fn column(self) -> &'static str {
        match self {
            Self::ArtificialViscosity => "to_artificial_viscosity",
            Self::Viscosity => "to_viscosity",
            Self::DensityDiffusion => "to_density_diffusion",
            Self::WallPressure => "to_wall_pressure",
            Self::WallDamping => "to_wall_damping",
            Self::WallFriction => "to_wall_friction",
            Self::Solids => "to_solids",
            Self::Driving => "to_driving",
            Self::Shifting => "to_shifting",
            Self::Spray => "to_spray",
            Self::Lost => "to_lost_particles",
        }
    }
}

/// Energies that sinks took, in whole quanta.
pub type Quanta = [i128; SINKS];

/// Size of the quantum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnergyScale {
    /// Joules per quantum.
    pub joules: f64,
}

impl EnergyScale {
    /// A quantum is 2⁻⁵⁶ of the energy that a particle has at the speed of sound, twice. In one step a
    /// particle may give a hundred times that much.
    pub fn of_model<const D: usize>(model: &Model<D>) -> Self {
        let mass = model.equation_of_state.density0() * model.spacing.powi(D as i32);
        Self { joules: 2.0_f64.powi(-56) * mass * model.limits.sound_speed.powi(2) }
    }

    /// Energies in J.
    pub fn in_joules(&self, quanta: &Quanta) -> [f64; SINKS] {
        quanta.map(|number| number as f64 * self.joules)
    }
}

/// What sinks took in a step.
#[derive(Debug, Clone, PartialEq)]
pub struct Taken {
    /// Up to the full step: the change of density and the closing kicks.
    pub before: Quanta,
    /// After it: the opening kicks and the drift.
    pub after: Quanta,
    scale: EnergyScale,
}

impl Taken {
    /// Nothing yet.
    pub fn new(scale: EnergyScale) -> Self {
        Self { before: [0; SINKS], after: [0; SINKS], scale }
    }

    /// Books energies (J) to a sink, before and after the full step.
    #[inline]
    pub fn add(&mut self, sink: Sink, [before, after]: [f64; 2]) {
        self.before[sink as usize] += whole(before / self.scale.joules);
        self.after[sink as usize] += whole(after / self.scale.joules);
    }

    /// Books what other particles lost.
    pub fn join(&mut self, other: &Self) {
        for (sum, part) in self.before.iter_mut().zip(other.before) {
            *sum += part;
        }
        for (sum, part) in self.after.iter_mut().zip(other.after) {
            *sum += part;
        }
    }
}

/// The books of a run; nothing when its scheme keeps none.
pub fn open_books<const D: usize, S>(model: &Model<D>, scheme: &Scheme<D, S>) -> Option<Taken> {
    scheme.accounts.as_ref().map(|_| Taken::new(EnergyScale::of_model(model)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sinks_are_in_the_order_of_their_numbers() {
        for (place, sink) in Sink::ALL.into_iter().enumerate() {
            assert_eq!(sink as usize, place);
        }
    }

    #[test]
    fn order_does_not_matter() {
        let scale = EnergyScale { joules: 1e-15 };
        let book = |energies: &[f64]| {
            let mut taken = Taken::new(scale);
            energies.iter().for_each(|e| taken.add(Sink::Viscosity, [*e, -*e]));
            taken
        };
        let (a, b) = ([0.1, 3.7e-9, -20.0], [5e-3, 1.0 / 3.0]);
        let mut parts = book(&b);
        parts.join(&book(&a));
        assert_eq!(parts, book(&[0.1, 1.0 / 3.0, 3.7e-9, 5e-3, -20.0]));
        let sum = scale.in_joules(&parts.before)[Sink::Viscosity as usize];
        assert!((sum - (0.1 + 3.7e-9 - 20.0 + 5e-3 + 1.0 / 3.0)).abs() < 1e-13);
    }
}
