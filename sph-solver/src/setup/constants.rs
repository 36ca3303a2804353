//! The numbers of a run, all derived from the scene.

use crate::eos::EquationOfState;
use crate::grading::Grading;
use crate::lio::Extremes;
use crate::scene::{ErrorKind, Numerics, OnLost, Scene, SceneError, SoundSpeed};
use crate::stability::largest_courant;
use crate::terms::strengthened;
use crate::timestep::StepLimits;
use serde::Serialize;

/// Constants of a run, SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Constants<const D: usize> {
    /// Initial particle distance, the largest where it varies, m.
    pub spacing: f64,
    /// Smoothing length h, the largest where it varies, m.
    pub smoothing_length: f64,
    /// Support radius R of the kernel, the largest where it varies, m.
    pub support_radius: f64,
    /// How radii follow from masses; none where all are the same.
    pub grading: Option<Grading>,
    /// Verlet skin: neighbour lists reach this far beyond the support radius, m.
    pub skin: f64,
    /// Reference density ρ0 of the fluid, kg/m³.
    pub density0: f64,
    /// Sound speed c0, m/s.
    pub sound_speed: f64,
    /// Pressure as a function of density, of ρ0 and c0.
    pub equation_of_state: EquationOfState,
    /// Gravity, m/s².
    pub gravity: [f64; D],
    /// Courant number that the scene asks for.
    pub cfl: f64,
    /// Artificial viscosity α; 0 for none.
    pub artificial_viscosity: f64,
    /// Density diffusion δ; 0 for none.
    pub density_diffusion: f64,
    /// Dynamic viscosity μ of the fluid, Pa s, if it has one.
    pub viscosity: Option<f64>,
    /// Whether the fluid fills all the space that it can be in.
    pub closed: bool,
    /// Lowest pressure of the fluid, Pa, if it cavitates.
    pub cavitation_pressure: Option<f64>,
    /// Lowest and highest corner of the box that particles may be in, m.
    pub domain: ([f64; D], [f64; D]),
    /// Lengths after which the axes repeat, m; none for an open axis.
    pub periods: [Option<f64>; D],
    /// What to do with a particle outside of the domain.
    pub on_lost: OnLost,
}

impl<const D: usize> Constants<D> {
    /// The Courant number of the steps: that of the scene, or the largest that its density diffusion and
    /// viscosity bear.
    pub fn courant(&self) -> f64 {
        // Where spacings grow, viscosity is stronger.
        let strengthened = self.grading.map_or(1.0, |_| strengthened(TYPICAL_GROWTH));
        let viscosity = self.artificial_viscosity * strengthened;
        self.cfl.min(largest_courant(self.density_diffusion, viscosity))
    }

    /// A length that goes with the spacing, given for the largest: for the smallest.
    pub fn finest(&self, length: f64) -> f64 {
        self.grading.map_or(length, |grading| length * grading.smallest())
    }

    /// Limits of the time step.
    pub fn step_limits(&self) -> StepLimits {
        StepLimits {
            cfl: self.courant(),
            smoothing_length: self.finest(self.smoothing_length),
            sound_speed: self.sound_speed,
            kinematic_viscosity: self.viscosity.unwrap_or(0.0) / self.density0,
        }
    }
}

/// Spacing over that of the next particle where spacings grow.
const TYPICAL_GROWTH: f64 = 1.05;

/// What limits the time step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum StepLimit {
    /// Sound and flow speed: cfl · h/(c0 + |v|).
    Sound,
    /// Accelerations: 0.25 √(h/|a|).
    Forces,
    /// Viscosity: 0.125 h²/ν.
    Viscosity,
}

/// The time step (s) of a flow of this `speed` (m/s) under gravity alone, and what limits it. Impacts
/// make it shorter for a while.
pub fn time_step<const D: usize>(constants: &Constants<D>, speed: f64) -> (f64, StepLimit) {
    let acceleration2 = constants.gravity.iter().map(|g| g * g).sum();
    let flow = Extremes { speed2: speed * speed, acceleration2, ..Extremes::NONE };
    let limits = constants.step_limits();
    let step = limits.step(flow);
    let sound = StepLimits { kinematic_viscosity: 0.0, ..limits };
    // Each limit left out in turn: the one without which the step would be longer is at work.
    let limit = if sound.step(flow) > step {
        StepLimit::Viscosity
    } else if sound.step(Extremes { acceleration2: 0.0, ..flow }) > step {
        StepLimit::Forces
    } else {
        StepLimit::Sound
    };
    (step, limit)
}

/// The sound speed is this many times the expected flow speed, so that the density varies by about
/// 1/100 (Monaghan 1994, J. Comput. Phys. 110: density varies with the square of the Mach number).
const INVERSE_MACH: f64 = 10.0;

/// The speed (m/s) that a scene is expected to reach: the larger of the highest initial speed and
/// 2 √(g H), the speed of a dam-break front (Ritter 1892), H the `height` of the fluid along gravity.
pub fn expected_speed<const D: usize>(gravity: &[f64; D], height: f64, initial: f64) -> f64 {
    let gravity = gravity.iter().map(|g| g * g).sum::<f64>().sqrt();
    initial.max(2.0 * (gravity * height).sqrt())
}

/// c0 (m/s) of a scene: what it says, or ten times the expected speed.
pub fn sound_speed(
    scene: &Scene,
    numerics: &Numerics,
    expected_speed: f64,
) -> Result<f64, SceneError> {
    match *numerics.sound_speed {
        SoundSpeed::Given(speed) => Ok(speed),
        SoundSpeed::Auto if expected_speed > 0.0 => Ok(INVERSE_MACH * expected_speed),
        SoundSpeed::Auto => Err(scene.error(
            numerics.sound_speed.place,
            ErrorKind::Invalid {
                what:
                    "a sound speed cannot be derived: the scene has no gravity and its fluid is at \
                       rest"
                        .into(),
                help: "set numerics.sound_speed in m/s, about ten times the largest flow speed"
                    .into(),
            },
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn constants() -> Constants<2> {
        Constants {
            spacing: 0.02,
            smoothing_length: 0.03,
            support_radius: 0.06,
            grading: None,
            skin: 0.006,
            density0: 1000.0,
            sound_speed: 30.0,
            equation_of_state: EquationOfState::Linear { density0: 1000.0, sound_speed: 30.0 },
            gravity: [0.0, -9.81],
            cfl: 1.0,
            artificial_viscosity: 0.02,
            density_diffusion: 0.1,
            viscosity: None,
            closed: false,
            cavitation_pressure: None,
            domain: ([0.0; 2], [1.0; 2]),
            periods: [None; 2],
            on_lost: OnLost::Stop,
        }
    }

    #[test]
    fn names_what_limits_the_step() {
        let (step, limit) = time_step(&constants(), 0.0);
        assert_eq!((step, limit), (0.03 / 30.0, StepLimit::Sound));
        let heavy = Constants { gravity: [0.0, -1e4], ..constants() };
        assert_eq!(time_step(&heavy, 0.0), (0.25 * (0.03f64 / 1e4).sqrt(), StepLimit::Forces));
        let smooth = Constants { density_diffusion: 0.5, ..constants() };
        assert_eq!(time_step(&smooth, 0.0), (0.4 * 0.03 / 30.0, StepLimit::Sound));
        let syrup = Constants { viscosity: Some(1e3), ..constants() };
        assert_eq!(time_step(&syrup, 0.0), (0.125 * 0.03 * 0.03, StepLimit::Viscosity));
    }

    #[test]
    fn a_dam_break_front_sets_the_speed() {
        let gravity = [0.0, -9.81];
        assert!((expected_speed(&gravity, 2.0, 0.0) - 2.0 * (9.81f64 * 2.0).sqrt()).abs() < 1e-12);
        assert_eq!(expected_speed(&gravity, 2.0, 50.0), 50.0);
    }
}
