//! Shapes of regions and solids: primitives, meshes and their combinations.

use super::located::At;
use schemars::JsonSchema;
use serde::Deserialize;
use std::path::PathBuf;

/// Declares a struct with one optional key per shape beside its own keys, of which a scene gives
/// exactly one. (serde cannot both flatten a struct and refuse unknown keys.)
macro_rules! with_shape_keys {
    ($(#[$attribute:meta])* $name:ident {
        $($(#[$field_attribute:meta])* $field:ident: $type:ty,)*
    }) => {
        $(#[$attribute])*
        #[derive(Debug, Clone, PartialEq, serde::Deserialize, schemars::JsonSchema)]
        #[serde(deny_unknown_fields)]
        pub struct $name {
            $($(#[$field_attribute])* pub $field: $type,)*
            /// An axis-parallel box (a rectangle in two dimensions).
            pub r#box: Option<At<$crate::scene::shape::BoxKeys>>,
            /// A ball (a disc in two dimensions).
            pub sphere: Option<At<$crate::scene::shape::SphereKeys>>,
            /// A cylinder with flat ends (a turned rectangle in two dimensions).
            pub cylinder: Option<At<$crate::scene::shape::AxisKeys>>,
            /// A cylinder with round ends (a stadium in two dimensions).
            pub capsule: Option<At<$crate::scene::shape::AxisKeys>>,
            /// The half space behind a plane (behind a line in two dimensions).
            pub plane: Option<At<$crate::scene::shape::PlaneKeys>>,
            /// Corners of a simple polygon in either direction; two dimensions only.
            pub polygon: Option<At<Vec<At<Vec<f64>>>>>,
            /// A closed surface in an STL, OBJ, PLY or VTK file, relative to the folder of the scene; three
            /// dimensions only. Several bodies in it are united; one inside another that faces the other way is a cavity.
            pub mesh: Option<At<std::path::PathBuf>>,
            /// Everything that is in any of these shapes.
            pub union: Option<At<Vec<At<$crate::scene::shape::ShapeKeys>>>>,
            /// What is in the first of these shapes and in none of the others.
            pub difference: Option<At<Vec<At<$crate::scene::shape::ShapeKeys>>>>,
            /// Unit of length of the mesh; metres when absent.
            pub units: Option<At<$crate::scene::placing::Units>>,
            /// Scales the shape from the origin, before anything else: a number or one for each axis.
            /// Different ones suit boxes, planes, polygons and meshes only.
            pub scale: Option<At<$crate::scene::placing::Scale>>,
            /// Rotates the shape about the origin, after `scale`: { axis = [0, 0, 1], degrees = 30 }, in two
            /// dimensions just the degrees.
            pub rotate: Option<At<$crate::scene::placing::Rotation>>,
            /// Moves the shape by so much, m, after `scale` and `rotate`.
            pub translate: Option<At<Vec<f64>>>,
            /// Takes the mesh as a sheet of this thickness, m, with material on both sides of its surface,
            /// which may have holes.
            pub thickness: Option<At<f64>>,
            /// Takes the convex hull of the mesh instead of the mesh, which may then have holes.
            pub convex_hull: Option<At<bool>>,
        }

        impl $name {
            /// How the shape is placed.
            pub fn placing(&self) -> $crate::scene::placing::Placing<'_> {
                $crate::scene::placing::Placing {
                    units: self.units.as_ref(),
                    scale: self.scale.as_ref(),
                    rotate: self.rotate.as_ref(),
                    translate: self.translate.as_ref(),
                    thickness: self.thickness.as_ref(),
                    convex_hull: self.convex_hull.as_ref(),
                }
            }

            /// The shapes given, of which there should be exactly one.
            pub fn shapes(&self) -> Vec<$crate::scene::shape::Shape<'_>> {
                use $crate::scene::shape::Shape;
                [
                    self.r#box.as_ref().map(Shape::Box),
                    self.sphere.as_ref().map(Shape::Sphere),
                    self.cylinder.as_ref().map(Shape::Cylinder),
                    self.capsule.as_ref().map(Shape::Capsule),
                    self.plane.as_ref().map(Shape::Plane),
                    self.polygon.as_ref().map(Shape::Polygon),
                    self.mesh.as_ref().map(Shape::Mesh),
                    self.union.as_ref().map(Shape::Union),
                    self.difference.as_ref().map(Shape::Difference),
                ]
                .into_iter()
                .flatten()
                .collect()
            }
        }
    };
}
pub(super) use with_shape_keys;

with_shape_keys! {
    /// A shape inside a union or difference: exactly one of these keys.
    ShapeKeys {}
}

/// A shape that a scene names.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape<'a> {
    /// An axis-parallel box.
    Box(&'a At<BoxKeys>),
    /// A ball.
    Sphere(&'a At<SphereKeys>),
    /// A cylinder with flat ends.
    Cylinder(&'a At<AxisKeys>),
    /// A cylinder with round ends.
    Capsule(&'a At<AxisKeys>),
    /// A half space.
    Plane(&'a At<PlaneKeys>),
    /// A polygon.
    Polygon(&'a At<Vec<At<Vec<f64>>>>),
    /// A mesh.
    Mesh(&'a At<PathBuf>),
    /// All of several shapes.
    Union(&'a At<Vec<At<ShapeKeys>>>),
    /// The first shape without the others.
    Difference(&'a At<Vec<At<ShapeKeys>>>),
}

impl Shape<'_> {
    /// The key of the shape in scenes.
    pub fn key(&self) -> &'static str {
        match self {
            Self::Box(_) => "box",
            Self::Sphere(_) => "sphere",
            Self::Cylinder(_) => "cylinder",
            Self::Capsule(_) => "capsule",
            Self::Plane(_) => "plane",
            Self::Polygon(_) => "polygon",
            Self::Mesh(_) => "mesh",
            Self::Union(_) => "union",
            Self::Difference(_) => "difference",
        }
    }

    /// Where the shape was written.
    pub fn place(&self) -> super::Place {
        match self {
            Self::Box(keys) => keys.place,
            Self::Sphere(keys) => keys.place,
            Self::Cylinder(keys) | Self::Capsule(keys) => keys.place,
            Self::Plane(keys) => keys.place,
            Self::Polygon(points) => points.place,
            Self::Mesh(path) => path.place,
            Self::Union(shapes) | Self::Difference(shapes) => shapes.place,
        }
    }
}

/// An axis-parallel box.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxKeys {
    /// Lowest corner, m.
    pub min: At<Vec<f64>>,
    /// Highest corner, m.
    pub max: At<Vec<f64>>,
}

/// A ball.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SphereKeys {
    /// Centre, m.
    pub center: At<Vec<f64>>,
    /// Radius, m.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: At<f64>,
}

/// A segment with a radius.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AxisKeys {
    /// One end of the axis, m.
    pub from: At<Vec<f64>>,
    /// The other end of the axis, m.
    pub to: At<Vec<f64>>,
    /// Radius, m.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: At<f64>,
}

/// A half space.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaneKeys {
    /// A point of the plane, m.
    pub point: At<Vec<f64>>,
    /// Direction out of the half space, of any length.
    pub normal: At<Vec<f64>>,
}
