//! What can be wrong with a shape, and the way out.

use crate::mesh::MeshError;
use thiserror::Error;

/// Why a shape does not exist.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// A number that is not finite.
    #[error("the {what} of a {shape} is {value:?}; all numbers must be finite")]
    NotFinite {
        /// The shape.
        shape: &'static str,
        /// Which of its properties.
        what: &'static str,
        /// The value.
        value: Vec<f64>,
    },
    /// A box without volume.
    #[error("a box goes from {min} to {max} along {axis}; max must be greater than min")]
    EmptyBox {
        /// The axis.
        axis: char,
        /// Lowest coordinate, m.
        min: f64,
        /// Highest coordinate, m.
        max: f64,
    },
    /// A radius that is not positive.
    #[error("the radius of a {shape} is {radius}; give a positive length in metres")]
    Radius {
        /// The shape.
        shape: &'static str,
        /// The radius, m.
        radius: f64,
    },
    /// Both ends of an axis are the same point.
    #[error("both ends of a {shape} are at {point:?}; move one end, or use a sphere")]
    NoLength {
        /// The shape.
        shape: &'static str,
        /// The point, m.
        point: Vec<f64>,
    },
    /// A normal of length zero.
    #[error("the normal of a half space has no direction; for example, use [0, 0, 1]")]
    NoDirection,
    /// Too few corners.
    #[error("a polygon has {count} different corners; it needs three or more")]
    FewCorners {
        /// Number of corners.
        count: usize,
    },
    /// Edges that meet.
    #[error(
        "the edges of a polygon after corners {first} and {second} meet near {place:?}; reorder \
         the corners, or combine several polygons by union and difference"
    )]
    Crossing {
        /// Corner (counted from 0) where one edge starts.
        first: usize,
        /// Corner where the other edge starts.
        second: usize,
        /// Where, m.
        place: [f64; 2],
    },
    /// A polygon without area.
    #[error("all corners of a polygon are on one line; move one corner off it")]
    NoArea,
    /// Different scales along different axes, for a shape that would be no such shape any more.
    #[error(
        "a {shape} cannot be scaled differently along different axes; give one number as the scale, \
         or use a mesh or a polygon"
    )]
    Stretched {
        /// The shape.
        shape: &'static str,
    },
    /// A scale of zero.
    #[error("a shape scaled to nothing; give a scale that is a finite number and not 0")]
    Flattened,
    /// A thickness that is not positive.
    #[error("the thickness of a sheet is {thickness}; give a positive length in metres")]
    Thickness {
        /// The thickness, m.
        thickness: f64,
    },
    /// A combination of nothing.
    #[error("a union of no shapes; give one or more")]
    EmptyUnion,
    /// A shape in the wrong number of dimensions.
    #[error(
        "a {shape} exists in {needed} dimensions only, not in {found}; use a polygon in two \
         dimensions and a mesh in three"
    )]
    Dimension {
        /// The shape.
        shape: &'static str,
        /// Dimensions that it needs.
        needed: usize,
        /// Dimensions asked for.
        found: usize,
    },
    /// A mesh that bounds nothing.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

pub(super) fn finite(
    shape: &'static str,
    what: &'static str,
    value: &[f64],
) -> Result<(), ShapeError> {
    if value.iter().all(|x| x.is_finite()) {
        Ok(())
    } else {
        Err(ShapeError::NotFinite { shape, what, value: value.to_vec() })
    }
}

pub(super) fn positive_radius(shape: &'static str, radius: f64) -> Result<(), ShapeError> {
    finite(shape, "radius", &[radius])?;
    if radius > 0.0 { Ok(()) } else { Err(ShapeError::Radius { shape, radius }) }
}
