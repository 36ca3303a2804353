//! `[[solid]]`: walls that do not move.

use super::located::At;
use super::shape::with_shape_keys;
use schemars::JsonSchema;
use serde::Deserialize;

with_shape_keys! {
    /// A solid that does not move: exactly one shape.
    Solid {
        /// Name of the solid.
        name: At<String>,
        /// On which side of the surface the fluid is: "inside" for a tank, "outside" for an obstacle.
        /// Needed for every shape but `plane`, which keeps the fluid on the side of its normal.
        fluid_side: Option<At<FluidSide>>,
    }
}

/// A side of a closed surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FluidSide {
    /// The fluid is inside: the shape is hollow, as a tank is.
    Inside,
    /// The fluid is outside: the shape is filled, as an obstacle is.
    Outside,
}
