//! `[[probe]]`: numbers written down while the run goes on.

use super::located::At;
use schemars::JsonSchema;
use serde::Deserialize;

/// Something measured in the interval `output.energies`, written to `probe-NAME.csv`.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Probe {
    /// Name of the probe and of its file.
    pub name: At<String>,
    /// What kind of probe it is.
    #[serde(default)]
    pub kind: ProbeKind,
    /// Where a point probe is, m.
    pub at: Option<At<Vec<f64>>>,
    /// What a point probe reads.
    pub fields: Option<At<Vec<Field>>>,
    /// Along which axis a front probe looks for the farthest fluid.
    pub axis: Option<At<Axis>>,
}

/// Kinds of probes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ProbeKind {
    /// Fields of the fluid at a fixed point: needs `at` and `fields`.
    #[default]
    Point,
    /// The farthest fluid particle along an axis, as the front of a dam break: needs `axis`.
    Front,
}

/// Fields of the fluid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Field {
    /// Pressure, Pa.
    Pressure,
    /// Velocity, m/s.
    Velocity,
    /// Density, kg/m³.
    Density,
}

/// Coordinate axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Axis {
    /// The first axis.
    X,
    /// The second axis, upwards in two dimensions.
    Y,
    /// The third axis, upwards in three dimensions.
    Z,
}

impl Axis {
    /// 0, 1 or 2.
    pub fn index(self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
            Self::Z => 2,
        }
    }
}
