//! `[fluid.NAME]`: what flows and where it is at the start.

use super::formula::Formula;
use super::located::At;
use super::shape::with_shape_keys;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::{Deserializer, IntoDeserializer, Visitor};
use std::borrow::Cow;

/// A fluid.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Fluid {
    /// Density at pressure 0, kg/m³.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub density: At<f64>,
    /// Dynamic viscosity, Pa s. Absent or 0: inviscid, and the term costs nothing.
    #[schemars(extend("minimum" = 0))]
    pub viscosity: Option<At<f64>>,
    /// Lowest pressure of the fluid, Pa, at most 0: there it cavitates instead of being pulled any
    /// further. Without it, fluid that is away from its free surface holds any tension, also at walls.
    #[schemars(extend("maximum" = 0))]
    pub cavitation_pressure: Option<At<f64>>,
    /// Where the fluid is at the start. A point in several regions belongs to the first of them.
    #[schemars(extend("minItems" = 1))]
    pub regions: At<Vec<At<Region>>>,
    /// Largest random shift of the initial positions along each axis, divided by the spacing: so that
    /// results do not hang on a perfect lattice. 0 when absent. For scenes without walls.
    #[schemars(extend("minimum" = 0, "maximum" = 0.4))]
    pub jitter: Option<At<f64>>,
    /// Number that chooses the random shifts. 1 when absent.
    pub seed: Option<At<u64>>,
    /// Initial velocity, m/s: one formula in x, y, z per component. At rest when absent.
    pub velocity: Option<At<Vec<At<Formula>>>>,
    /// Initial pressure, Pa: a formula in x, y, z, or "hydrostatic" for the weight of the fluid
    /// between a particle and the surface of its body of water, the highest place (against gravity) of
    /// the fluid that is connected with it. 0 when absent.
    #[serde(default)]
    pub pressure: At<Pressure>,
}

with_shape_keys! {
    /// A region full of fluid: exactly one shape, and initial fields of its own where they differ.
    Region {
        /// Initial velocity in this region, m/s, instead of the fluid's.
        velocity: Option<At<Vec<At<Formula>>>>,
        /// Initial pressure in this region, Pa, instead of the fluid's.
        pressure: Option<At<Pressure>>,
    }
}

/// An initial pressure.
#[derive(Debug, Clone, PartialEq)]
pub enum Pressure {
    /// ρ0 g times the depth below the surface of the connected body of fluid.
    Hydrostatic,
    /// A formula, Pa.
    Formula(Formula),
}

impl Default for Pressure {
    fn default() -> Self {
        Self::Formula(Formula::default())
    }
}

impl<'de> Deserialize<'de> for Pressure {
    fn deserialize<R: Deserializer<'de>>(reader: R) -> Result<Self, R::Error> {
        reader.deserialize_any(PressureVisitor)
    }
}

struct PressureVisitor;

impl Visitor<'_> for PressureVisitor {
    type Value = Pressure;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("\"hydrostatic\", a formula in quotes or a number")
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Pressure, E> {
        match text.trim() {
            "hydrostatic" => Ok(Pressure::Hydrostatic),
            formula => Ok(Pressure::Formula(Formula::new(formula))),
        }
    }

    fn visit_i64<E: serde::de::Error>(self, number: i64) -> Result<Pressure, E> {
        Formula::deserialize(number.into_deserializer()).map(Pressure::Formula)
    }

    fn visit_f64<E: serde::de::Error>(self, number: f64) -> Result<Pressure, E> {
        Formula::deserialize(number.into_deserializer()).map(Pressure::Formula)
    }
}

impl JsonSchema for Pressure {
    fn schema_name() -> Cow<'static, str> {
        "Pressure".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "\"hydrostatic\" or a formula for the pressure in Pa",
            "anyOf": [{ "const": "hydrostatic" }, generator.subschema_for::<Formula>()],
        })
    }
}
