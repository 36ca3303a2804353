//! `[output]`: what is written how often.

use super::domain::Domain;
use super::located::At;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What is written how often. Steps are never shortened to meet a time.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Output {
    /// Seconds of simulated time between snapshots of all particles. Absent: none.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub snapshots: Option<At<f64>>,
    /// Seconds of simulated time between rows of `energies.csv` and of the probe tables. Absent: only
    /// the last state.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub energies: Option<At<f64>>,
    /// Whether `energies.csv` also tells where energy went: what each term of the scheme took since the
    /// start, and the residual that no term explains. Costs further sums, the results stay the same bits.
    #[serde(default)]
    pub energy_budget: bool,
    /// Seconds of simulated time between checkpoints, from which `sph run --resume` goes on. Absent:
    /// none.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub checkpoint_every: Option<At<f64>>,
    /// What snapshots hold of each particle beside its position. Absent: everything. `sph report`
    /// draws velocity and pressure.
    pub fields: Option<At<Vec<SnapshotField>>>,
    /// Snapshots hold only what is in this box at their time.
    pub region: Option<At<Domain>>,
    /// Snapshots hold only the fluid particles whose id is a multiple of this.
    #[schemars(extend("minimum" = 1))]
    pub every_nth: Option<At<usize>>,
    /// Precision of the positions in snapshots. All else has single precision there anyway.
    #[serde(default)]
    pub positions: SnapshotPositions,
    /// How snapshots are packed.
    #[serde(default)]
    pub compression: SnapshotCompression,
}

/// Quantities of snapshots.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SnapshotField {
    /// Velocity, m/s.
    Velocity,
    /// Pressure, Pa.
    Pressure,
    /// Density, kg/m³.
    Density,
    /// 0 for the fluid, 1 + k for solid k of the scene.
    Kind,
    /// The number by which a particle is known all through a run.
    Id,
}

impl SnapshotField {
    /// All of them.
    pub const ALL: [Self; 5] =
        [Self::Velocity, Self::Pressure, Self::Density, Self::Kind, Self::Id];
}

/// Precision of positions in snapshots.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SnapshotPositions {
    /// 15 digits.
    #[default]
    F64,
    /// 7 digits in half the room: for pictures.
    F32,
}

/// How snapshots are packed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SnapshotCompression {
    /// Fast.
    #[default]
    Lz4,
    /// Smaller, and slower to write.
    Zlib,
}
