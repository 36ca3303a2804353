//! `[[solid]]`: walls, at rest or moving.

use super::located::At;
use super::motion::{Body, Motion};
use super::shape::with_shape_keys;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

with_shape_keys! {
    /// A solid: exactly one shape. It rests unless it has a `motion` or is a `body`.
    Solid {
        /// Name of the solid.
        name: At<String>,
        /// On which side of the surface the fluid is: "inside" for a tank, "outside" for an obstacle.
        /// Needed for every shape but `plane`, which keeps the fluid on the side of its normal.
        fluid_side: Option<At<FluidSide>>,
        /// Whether the fluid slips along the wall: "slip" or "no-slip". When absent, an inviscid fluid
        /// slips and a fluid with a viscosity does not.
        wall_friction: Option<At<WallFriction>>,
        /// The point that the moments of the load on this solid are about, m. The middle of its
        /// bounding box when absent; the origin along axes where that has no end. For a solid that
        /// moves it is the point that the solid turns about or its centre of mass, and goes with it.
        moments_about: Option<At<Vec<f64>>>,
        /// How the solid moves, whatever the fluid does.
        motion: Option<At<Motion>>,
        /// What the solid weighs and what holds it, when the fluid moves it.
        body: Option<At<Body>>,
    }
}

impl Solid {
    /// Whether it does not rest.
    pub fn moves(&self) -> bool {
        self.motion.is_some() || self.body.is_some()
    }
}

/// What a wall does to fluid that moves along it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum WallFriction {
    /// Nothing: only the velocity into the wall is felt.
    Slip,
    /// The fluid at the wall moves with it. Needs a fluid with a viscosity.
    NoSlip,
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
