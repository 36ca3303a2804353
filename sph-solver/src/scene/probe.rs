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
    /// Where a point, patch or level probe is, m, or a point of the plane of a flow probe.
    pub at: Option<At<Vec<f64>>>,
    /// What a point or patch probe reads.
    pub fields: Option<At<Vec<Field>>>,
    /// Radius of a patch probe, m.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: Option<At<f64>>,
    /// Normal of a plane, of any length: of that of a flow probe, which counts flow along it as
    /// positive, or of that of a patch probe, which is a ball without.
    pub normal: Option<At<Vec<f64>>>,
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
    /// Means of fields over a disc or ball, as the face of a pressure sensor: needs `at`, `radius` and
    /// `fields`, and for a disc `normal`.
    Patch,
    /// The level of the water on the vertical line through a point, as a coordinate against gravity:
    /// needs `at` and a scene with gravity. Drops above the water do not count.
    Level,
    /// Volume per second through a plane: needs `at` and `normal`.
    Flow,
    /// The farthest fluid particle along an axis, as the front of a dam break: needs `axis`.
    Front,
}

impl ProbeKind {
    /// The word of scenes for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Point => "point",
            Self::Patch => "patch",
            Self::Level => "level",
            Self::Flow => "flow",
            Self::Front => "front",
        }
    }
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
