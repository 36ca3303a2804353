//! Equations of state: pressure from density and back.

/// Pressure of a weakly compressible fluid as a function of its density deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EquationOfState {
    /// p = c0² (ρ − ρ0).
    Linear {
        /// Reference density ρ0, kg/m³.
        density0: f64,
        /// Sound speed c0 at the reference density, m/s.
        sound_speed: f64,
    },
    /// p = ρ0 c0²/γ ((ρ/ρ0)^γ − 1). Source: Tait; Monaghan (1994), J. Comput. Phys. 110, eq. 3.3.
    Tait {
        /// Reference density ρ0, kg/m³.
        density0: f64,
        /// Sound speed c0 at the reference density, m/s.
        sound_speed: f64,
        /// Exponent γ, 7 for water.
        gamma: f64,
    },
}

impl EquationOfState {
    /// Reference density ρ0, kg/m³.
    pub fn density0(&self) -> f64 {
        match *self {
            Self::Linear { density0, .. } | Self::Tait { density0, .. } => density0,
        }
    }

    /// Pressure (Pa) at a density (kg/m³).
    #[inline]
    pub fn pressure(&self, density: f64) -> f64 {
        match *self {
            Self::Linear { density0, sound_speed } => {
                sound_speed * sound_speed * (density - density0)
            }
            Self::Tait { density0, sound_speed, gamma } => {
                let stiffness = density0 * sound_speed * sound_speed / gamma;
                let ratio = density / density0;
                // The usual exponent without the library's general power, which costs ten times
                // as much.
                #[expect(clippy::float_cmp, reason = "the exponent is a constant of the scene")]
                let power = if gamma == 7.0 {
                    let cube = ratio * ratio * ratio;
                    cube * cube * ratio
                } else {
                    ratio.powf(gamma)
                };
                stiffness * (power - 1.0)
            }
        }
    }

    /// Density (kg/m³) at a pressure (Pa).
    pub fn density(&self, pressure: f64) -> f64 {
        match *self {
            Self::Linear { density0, sound_speed } => {
                density0 + pressure / (sound_speed * sound_speed)
            }
            Self::Tait { density0, sound_speed, gamma } => {
                let stiffness = density0 * sound_speed * sound_speed / gamma;
                density0 * (1.0 + pressure / stiffness).powf(1.0 / gamma)
            }
        }
    }

    /// Elastic energy per mass (J/kg) at a density, zero at ρ0: ∫ p/ρ² dρ, what the continuity equation
    /// stores while the density changes from ρ0 to this one.
    ///
    /// c0² (ln x + 1/x − 1) with x = ρ/ρ0 for the linear equation,
    /// (c0²/γ) ((x^(γ−1) − 1)/(γ − 1) + 1/x − 1) for that of Tait.
    pub fn elastic_energy(&self, density: f64) -> f64 {
        match *self {
            Self::Linear { density0, sound_speed } => {
                let deviation = (density - density0) / density0;
                sound_speed * sound_speed * (deviation.ln_1p() - deviation / (1.0 + deviation))
            }
            Self::Tait { density0, sound_speed, gamma } => {
                let deviation = (density - density0) / density0;
                let power = ((gamma - 1.0) * deviation.ln_1p()).exp_m1() / (gamma - 1.0);
                sound_speed * sound_speed / gamma * (power - deviation / (1.0 + deviation))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_equations_invert_and_agree_for_small_deviations() {
        let linear = EquationOfState::Linear { density0: 1000.0, sound_speed: 30.0 };
        let tait = EquationOfState::Tait { density0: 1000.0, sound_speed: 30.0, gamma: 7.0 };
        for eos in [linear, tait] {
            assert_eq!(eos.pressure(1000.0), 0.0);
            assert!((eos.density(eos.pressure(1013.0)) - 1013.0).abs() < 1e-9);
        }
        let ratio = tait.pressure(1001.0) / linear.pressure(1001.0);
        assert!((ratio - 1.003).abs() < 1e-4, "{ratio}");
    }

    #[test]
    fn seventh_power_is_the_general_power() {
        let pressure = |gamma| {
            EquationOfState::Tait { density0: 1000.0, sound_speed: 30.0, gamma }.pressure(1020.0)
        };
        assert!((pressure(7.0) / pressure(7.0 + 1e-12) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn elastic_energy_is_the_work_of_the_pressure() {
        let (density0, sound_speed) = (1000.0, 30.0);
        let linear = EquationOfState::Linear { density0, sound_speed };
        let tait = EquationOfState::Tait { density0, sound_speed, gamma: 7.0 };
        for eos in [linear, tait] {
            for end in [970.0, 1000.01, 1030.0] {
                let steps = 1000;
                let width = (end - density0) / f64::from(steps);
                let middle = |k: i32| density0 + (f64::from(k) + 0.5) * width;
                let power = |density: f64| eos.pressure(density) / (density * density);
                let work: f64 = (0..steps).map(|k| power(middle(k)) * width).sum();
                assert!((eos.elastic_energy(end) / work - 1.0).abs() < 1e-5, "{end}");
            }
            assert_eq!(eos.elastic_energy(density0), 0.0);
        }
    }
}
