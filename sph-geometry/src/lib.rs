//! Solids for particle methods: mesh import and checks, signed distances, particles of fluid
//! regions and walls.
//!
//! * [`TriangleMesh`]: surfaces from STL, OBJ and PLY files; [`check`] tells whether one is closed and
//!   consistently oriented, [`mass_properties`] what a body of that shape weighs.
//! * [`Shape`]: a set of points with a signed distance: primitives, meshes, polygons, unions and
//!   differences, in two and three dimensions.
//! * [`Solid`]: a shape with material on one side of its surface.
//! * [`Lattice`]: where particles are placed; [`fill_lattice`] fills a region with them.
//! * [`wall_particles`]: the particles of walls, one support radius deep and only near fluid;
//!   [`body_elements`]: those of a solid that moves.
//!
//! Lengths are in metres, directions are unit vectors, `D` is the dimension.
//!
//! The README shows it from the STL file to the particles.

#![forbid(unsafe_code)]

mod aabb;
mod body_elements;
mod boundary;
mod lattice;
mod mesh;
mod shape;
mod shape_mass;
mod solid;
mod vector;
mod wall_elements;

pub use aabb::Aabb;
pub use body_elements::body_elements;
pub use boundary::{Domain, WallParticles, free_cells, solid_at, wall_particles};
pub use lattice::{
    Lattice, LatticeError, LatticeRuns, NearSurface, fill_lattice, lattice_inside, near_surface,
};
pub use mesh::{
    Defects, MassProperties, MeshError, MeshFile, MeshFormat, MeshReport, TriangleMesh, check,
    mass_properties,
};
pub use shape::{Nearest, Shape, ShapeError, SignedDistance};
pub use shape_mass::shape_mass_properties;
pub use solid::{FluidSide, Solid, depth_in_solids};
pub use wall_elements::{WallElements, wall_elements};

/// Runs the programs of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
