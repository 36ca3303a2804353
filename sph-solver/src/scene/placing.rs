//! Keys beside a shape that scale, rotate and translate it.

use super::located::At;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor};
use std::borrow::Cow;

/// How a shape is placed: read in its unit, scaled, rotated and translated, in this order.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Placing<'a> {
    /// Unit of length of a mesh.
    pub units: Option<&'a At<Units>>,
    /// Scale, from the origin.
    pub scale: Option<&'a At<Scale>>,
    /// Rotation about the origin.
    pub rotate: Option<&'a At<Rotation>>,
    /// Translation, m.
    pub translate: Option<&'a At<Vec<f64>>>,
    /// Thickness of a mesh as a sheet, m.
    pub thickness: Option<&'a At<f64>>,
    /// Whether the convex hull of a mesh is meant.
    pub convex_hull: Option<&'a At<bool>>,
}

/// A unit of length in which meshes are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Units {
    /// Metres.
    M,
    /// Centimetres.
    Cm,
    /// Millimetres.
    Mm,
    /// Inches of 25.4 mm.
    In,
    /// Feet of 304.8 mm.
    Ft,
}

impl Units {
    /// A length in metres, rounded once: 680 mm are 0.68 m.
    pub fn to_metres(self, length: f64) -> f64 {
        match self {
            Self::M => length,
            Self::Cm => length / 100.0,
            Self::Mm => length / 1000.0,
            Self::In => length * 25.4 / 1000.0,
            Self::Ft => length * 304.8 / 1000.0,
        }
    }
}

/// A scale: one factor, or one for each axis.
#[derive(Debug, Clone, PartialEq)]
pub enum Scale {
    /// The same along all axes.
    Uniform(f64),
    /// Axis by axis.
    Axes(Vec<f64>),
}

impl<'de> Deserialize<'de> for Scale {
    fn deserialize<R: Deserializer<'de>>(reader: R) -> Result<Self, R::Error> {
        reader.deserialize_any(ScaleVisitor)
    }
}

struct ScaleVisitor;

impl<'de> Visitor<'de> for ScaleVisitor {
    type Value = Scale;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a number, or an array with one for each axis")
    }

    fn visit_i64<E>(self, number: i64) -> Result<Scale, E> {
        Ok(Scale::Uniform(number as f64))
    }

    fn visit_f64<E>(self, number: f64) -> Result<Scale, E> {
        Ok(Scale::Uniform(number))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Scale, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(seq)).map(Scale::Axes)
    }
}

impl JsonSchema for Scale {
    fn schema_name() -> Cow<'static, str> {
        "Scale".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "a factor, or one for each axis",
            "anyOf": [{ "type": "number" }, { "type": "array", "items": { "type": "number" } }],
        })
    }
}

/// A rotation about the origin: in two dimensions an angle in degrees, anticlockwise; in three an axis
/// and an angle, anticlockwise seen against the axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Rotation {
    /// Direction of the axis, of any length.
    pub axis: Option<At<Vec<f64>>>,
    /// Angle, degrees.
    pub degrees: f64,
}

/// A rotation as a table.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct RotationKeys {
    /// Direction of the axis, of any length. Three dimensions only.
    axis: Option<At<Vec<f64>>>,
    /// Angle in degrees, anticlockwise seen against the axis.
    degrees: f64,
}

impl<'de> Deserialize<'de> for Rotation {
    fn deserialize<R: Deserializer<'de>>(reader: R) -> Result<Self, R::Error> {
        reader.deserialize_any(RotationVisitor)
    }
}

struct RotationVisitor;

impl<'de> Visitor<'de> for RotationVisitor {
    type Value = Rotation;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a table such as { axis = [0, 0, 1], degrees = 30 } (in 2-D just the degrees)")
    }

    fn visit_i64<E>(self, degrees: i64) -> Result<Rotation, E> {
        Ok(Rotation { axis: None, degrees: degrees as f64 })
    }

    fn visit_f64<E>(self, degrees: f64) -> Result<Rotation, E> {
        Ok(Rotation { axis: None, degrees })
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Rotation, A::Error> {
        let RotationKeys { axis, degrees } =
            RotationKeys::deserialize(MapAccessDeserializer::new(map))?;
        Ok(Rotation { axis, degrees })
    }
}

impl JsonSchema for Rotation {
    fn schema_name() -> Cow<'static, str> {
        "Rotation".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "an axis and degrees; in two dimensions degrees",
            "anyOf": [{ "type": "number" }, generator.subschema_for::<RotationKeys>()],
        })
    }
}
