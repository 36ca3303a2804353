//! `motion` and `body` of a `[[solid]]`: what makes it move.

use super::formula::TimedFormula;
use super::located::At;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Prescribed motion of a solid, whatever the fluid does: either constant (`velocity`, `spin`), or formulas
/// in t (`displacement`, `rotation`), or a `table`.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Motion {
    /// Constant velocity, m/s.
    pub velocity: Option<At<Vec<f64>>>,
    /// Constant angular velocity about `axis`, rad/s.
    pub spin: Option<At<f64>>,
    /// Displacement along the axes as formulas in t (s), m; zero is the place at t = 0.
    pub displacement: Option<At<Vec<At<TimedFormula>>>>,
    /// Angle about `axis` as a formula in t (s), rad; zero is the angle at t = 0.
    pub rotation: Option<At<TimedFormula>>,
    /// A CSV file, relative to the folder of the scene, with a line of titles: `time` (s), and any of `x`,
    /// `y`, `z` (displacement, m) and `angle` (about `axis`, rad).
    pub table: Option<At<PathBuf>>,
    /// The point that the solid turns about, m. The middle of its bounding box when absent.
    pub about: Option<At<Vec<f64>>>,
    /// The axis that it turns about; three dimensions only. z when absent.
    pub axis: Option<At<Vec<f64>>>,
}

/// A solid that the fluid moves.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// Density, kg/m³: mass, centre and inertia are those of the shape filled with it.
    pub density: Option<At<f64>>,
    /// Mass, kg (kg per metre of depth in two dimensions), instead of the density.
    pub mass: Option<At<f64>>,
    /// Centre of mass at the start, m. That of the shape when absent.
    pub center: Option<At<Vec<f64>>>,
    /// Inertia about the centre of mass, kg m²: one number in two dimensions, three about x, y and z or six
    /// (xx, yy, zz, xy, xz, yz) in three. That of the shape when absent.
    pub inertia: Option<At<Vec<f64>>>,
    /// Velocity at the start, m/s.
    pub velocity: Option<At<Vec<f64>>>,
    /// Angular velocity about `axis` at the start, rad/s.
    pub spin: Option<At<f64>>,
    /// The axis of the first `spin`; three dimensions only. z when absent.
    pub axis: Option<At<Vec<f64>>>,
    /// Degrees of freedom that are held.
    #[serde(default)]
    pub fixed: Vec<At<Degree>>,
    /// Springs, dampers and moorings to fixed points.
    #[serde(default)]
    pub springs: Vec<At<Spring>>,
    /// Share of the speed of approach with which it leaves a contact with another solid, 0 to 1.
    #[serde(default)]
    pub restitution: At<f64>,
    /// Coulomb's coefficient of friction in contacts with other solids.
    #[serde(default)]
    pub friction: At<f64>,
}

/// A degree of freedom.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Degree {
    /// Along x.
    X,
    /// Along y.
    Y,
    /// Along z.
    Z,
    /// About x.
    RotationX,
    /// About y.
    RotationY,
    /// About z.
    RotationZ,
}

impl Degree {
    /// Whether it is a rotation, and its axis.
    pub fn parts(self) -> (bool, usize) {
        match self {
            Self::X => (false, 0),
            Self::Y => (false, 1),
            Self::Z => (false, 2),
            Self::RotationX => (true, 0),
            Self::RotationY => (true, 1),
            Self::RotationZ => (true, 2),
        }
    }
}

/// A linear spring with a damper beside it, between a fixed point and a point of the body.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Spring {
    /// The fixed end, m.
    pub anchor: At<Vec<f64>>,
    /// The end on the body, where the body is at the start, m. The centre of mass when absent.
    pub attached: Option<At<Vec<f64>>>,
    /// Length without a force, m. That at the start when absent.
    pub length: Option<At<f64>>,
    /// Stiffness, N/m.
    pub stiffness: At<f64>,
    /// Damping, N s/m.
    #[serde(default)]
    pub damping: At<f64>,
    /// Whether it only pulls, as a rope does.
    #[serde(default)]
    pub rope: At<bool>,
}
