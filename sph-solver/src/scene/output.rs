//! `[output]`: what is written how often.

use super::located::At;
use schemars::JsonSchema;
use serde::Deserialize;

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
    /// Seconds of simulated time between checkpoints, from which `sph run --resume` goes on. Absent:
    /// none.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub checkpoint_every: Option<At<f64>>,
}
