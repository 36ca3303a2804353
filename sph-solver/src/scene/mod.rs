//! Scene files: TOML in SI units, read into a typed [`Scene`].
//!
//! [`Scene::read`] parses the text, applies `--set key.path=value` arguments, refuses unknown keys,
//! wrong types and values out of range, and remembers where everything was written, so that every
//! [`SceneError`] (also one found much later, when particles are made) shows the line at fault.
//!
//! The keys are declared once, by the structs here: their serde attributes read them, their doc
//! comments describe them, and [`json_schema`] turns both into the schema that editors use.

mod check;
mod document;
mod domain;
mod error;
mod fluid;
pub mod formula;
mod located;
mod manual;
mod motion;
mod numerics;
mod output;
mod overrides;
mod paths;
mod placing;
mod probe;
mod reader;
mod reference;
mod refine;
mod root;
mod schema;
mod shape;
mod solid;
mod suggest;
mod template;
#[cfg(test)]
mod tests;

pub use document::{Place, Source, Sources};
pub use domain::Domain;
pub use error::{ErrorKind, SceneError};
pub use fluid::{Fluid, Pressure, Region};
pub use formula::{Formula, TimedFormula};
pub use located::At;
pub use manual::manual;
pub use motion::{Body, Degree, Motion, Spring};
pub use numerics::{Equation, Kernel, Numerics, OnLost, Precision, Scheme, SoundSpeed};
pub use output::{Output, SnapshotCompression, SnapshotField, SnapshotPositions};
pub use placing::{Placing, Rotation, Scale, Units};
pub use probe::{Axis, Field, Probe, ProbeKind};
pub use reference::{Compare, Norm, Reference, StudyKeys};
pub use refine::Refine;
pub use root::Scene;
pub(crate) use root::vector;
pub use schema::json_schema;
pub use shape::{AxisKeys, BoxKeys, PlaneKeys, Shape, ShapeKeys, SphereKeys};
pub use solid::{FluidSide, Solid, WallFriction};
pub(crate) use suggest::nearest;
pub use template::Template;
