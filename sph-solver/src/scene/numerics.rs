//! `[numerics]`: resolution, scheme and its constants.

use super::located::At;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Deserialize, Deserializer, Visitor};
use serde::{Serialize, Serializer};
use std::borrow::Cow;

/// Resolution, scheme and its constants.
#[derive(Debug, Clone, PartialEq, serde::Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Numerics {
    /// Initial particle distance, m.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub spacing: At<f64>,
    /// Discretisation of the flow equations.
    #[serde(default)]
    pub scheme: Scheme,
    /// Smoothing kernel.
    #[serde(default)]
    pub kernel: Kernel,
    /// Support radius of the kernel divided by the spacing. 3 is the value point in three dimensions
    /// (about 92 neighbours); 4 is for accuracy runs.
    #[schemars(extend("minimum" = 2, "maximum" = 6))]
    #[serde(default = "default_support")]
    pub support: At<f64>,
    /// Courant number: the time step is cfl · h/(c0 + |v|) at most. Where the density diffusion and the
    /// artificial viscosity do not bear it, 1.2 with the usual ones, it is made smaller, and a note says
    /// so. At most 1.7.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1.7))]
    #[serde(default = "default_cfl")]
    pub cfl: At<f64>,
    /// Precision of the pair arithmetic. Positions and time integration are always double.
    #[serde(default)]
    pub precision: Precision,
    /// Sound speed c0, m/s, or "auto": 10 times the larger of the highest initial speed and
    /// 2 √(g H), H the extent of the fluid along gravity (a dam-break front runs at up to 2 √(g H)).
    #[serde(default)]
    pub sound_speed: At<SoundSpeed>,
    /// Artificial viscosity α: the viscous term has the strength α h c0. 0 leaves the term out. When
    /// absent, 0.02 for an inviscid fluid; a fluid with a physical viscosity has no artificial one.
    #[schemars(extend("minimum" = 0, "maximum" = 1))]
    pub artificial_viscosity: Option<At<f64>>,
    /// Density diffusion δ of the δ-SPH scheme: the term has the strength δ h c0. 0 makes it vanish.
    #[schemars(extend("minimum" = 0, "maximum" = 1))]
    #[serde(default = "default_density_diffusion")]
    pub density_diffusion: At<f64>,
    /// Pressure as a function of density.
    #[serde(default)]
    pub equation_of_state: Equation,
    /// Verlet skin divided by the support radius: neighbour lists reach this much farther, so that
    /// they last several steps. Changes cost, not results beyond rounding.
    #[schemars(extend("minimum" = 0, "maximum" = 1))]
    #[serde(default = "default_skin")]
    pub skin: At<f64>,
    /// What to do with a particle that leaves the domain.
    #[serde(default)]
    pub on_lost: OnLost,
}

fn default_support() -> At<f64> {
    At::default_of(3.0)
}

fn default_cfl() -> At<f64> {
    At::default_of(1.0)
}

fn default_density_diffusion() -> At<f64> {
    At::default_of(0.1)
}

fn default_skin() -> At<f64> {
    At::default_of(0.15)
}

/// Discretisation of the flow equations.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Scheme {
    /// Weakly compressible with density diffusion (δ-SPH: Antuono et al. 2010, Marrone et al. 2011).
    #[default]
    Delta,
    /// The same with particles that are away from a free surface shifted to where there are too few of
    /// them (δ⁺-SPH: Sun et al. 2017, 2019): keeps closed viscous flows even, at the price of one
    /// more sweep.
    DeltaPlus,
    /// One of these by what the scene holds, with an artificial viscosity to suit unless one is given: a
    /// closed flow is shifted, a fluid that rests under gravity is damped a little, one that collapses or hits is
    /// not. `sph check` and `summary.json` say which, and why.
    Auto,
}

/// Smoothing kernel.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Kernel {
    /// Wendland's C2 kernel, support radius 2 h.
    #[default]
    WendlandC2,
}

/// Precision of the pair arithmetic.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Precision {
    /// 32 bits on exact coordinate differences: twice as fast, equal to double within 0.1 %.
    #[default]
    Mixed,
    /// 64 bits.
    Double,
}

/// Pressure as a function of density.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Equation {
    /// p = c0² (ρ − ρ0).
    #[default]
    Linear,
    /// p = ρ0 c0²/7 ((ρ/ρ0)⁷ − 1).
    Tait,
}

/// What to do with a particle that leaves the domain.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum OnLost {
    /// End the run with an error that names it.
    #[default]
    Stop,
    /// Take it out, count it and go on.
    Remove,
}

/// A sound speed or the word "auto".
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum SoundSpeed {
    /// Derived from the initial state.
    #[default]
    Auto,
    /// In m/s.
    Given(f64),
}

impl<'de> Deserialize<'de> for SoundSpeed {
    fn deserialize<R: Deserializer<'de>>(reader: R) -> Result<Self, R::Error> {
        reader.deserialize_any(SoundSpeedVisitor)
    }
}

struct SoundSpeedVisitor;

impl Visitor<'_> for SoundSpeedVisitor {
    type Value = SoundSpeed;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("\"auto\" or a number in m/s")
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<SoundSpeed, E> {
        match text {
            "auto" => Ok(SoundSpeed::Auto),
            other => Err(E::invalid_value(serde::de::Unexpected::Str(other), &self)),
        }
    }

    fn visit_i64<E: serde::de::Error>(self, number: i64) -> Result<SoundSpeed, E> {
        Ok(SoundSpeed::Given(number as f64))
    }

    fn visit_f64<E: serde::de::Error>(self, number: f64) -> Result<SoundSpeed, E> {
        Ok(SoundSpeed::Given(number))
    }
}

impl Serialize for SoundSpeed {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Auto => serializer.serialize_str("auto"),
            Self::Given(speed) => serializer.serialize_f64(*speed),
        }
    }
}

impl JsonSchema for SoundSpeed {
    fn schema_name() -> Cow<'static, str> {
        "SoundSpeed".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "A sound speed in m/s or \"auto\"",
            "anyOf": [{ "type": "number", "exclusiveMinimum": 0 }, { "const": "auto" }],
        })
    }
}
