//! `[domain]`: the box that particles may be in.

use super::located::At;
use schemars::JsonSchema;
use serde::Deserialize;

/// The box that particles may be in. A particle outside of it is lost. Derived from the fluid and the
/// solids when absent.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Domain {
    /// Lowest corner, m.
    pub min: At<Vec<f64>>,
    /// Highest corner, m.
    pub max: At<Vec<f64>>,
}
