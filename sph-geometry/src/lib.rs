//! Solids for particle methods: mesh import and checks, signed distances, particles of fluid
//! regions and walls.
//!
//! * [`TriangleMesh`]: surfaces from STL, OBJ, PLY and VTK files; [`check`] tells whether one is closed
//!   and consistently oriented, [`repaired`] mends what is safe to mend, [`bodies`] tells which bodies
//!   and cavities its shells bound, [`mass_properties`] what they weigh.
//! * [`Shape`]: a set of points with a signed distance: primitives, meshes, polygons, unions and
//!   differences, in two and three dimensions.
//! * [`Solid`]: a shape with material on one side of its surface.
//! * [`Lattice`]: where particles are placed; [`fill_lattice`] fills a region with them.
//! * [`wall_elements`]: the material of walls cell by cell, one support radius deep and only near fluid;
//!   [`body_elements`]: those of a solid that moves; [`thin_wall_elements`] and
//!   [`thin_body_elements`]: those of solids thinner than the support.
//! * [`SpacingField`]: where particles are finer than elsewhere; [`CellTree`] divides space accordingly.
//!
//! Lengths are in metres, directions are unit vectors, `D` is the dimension.
//!
//! The README shows it from the mesh file to the particles.

#![forbid(unsafe_code)]

mod aabb;
mod affine;
mod body_elements;
mod boundary;
mod graded;
mod lattice;
mod mesh;
mod shape;
mod shape_mass;
mod solid;
mod surface_pieces;
mod thin_elements;
mod vector;
mod wall_elements;

pub use aabb::Aabb;
pub use affine::Affine;
pub use body_elements::body_elements;
pub use boundary::{Domain, WallParticles, free_cells, solid_at, wall_particles};
pub use graded::{
    Cell, CellTree, Refinement, SpacingField, graded_body_elements, graded_wall_elements,
};
pub use lattice::{
    Lattice, LatticeError, LatticeRuns, NearSurface, fill_lattice, lattice_inside, near_surface,
    near_surface_within,
};
pub use mesh::{
    Bodies, Defects, MassProperties, MeshError, MeshFile, MeshFormat, MeshReport, Repaired,
    Repairs, TriangleMesh, bodies, check, mass_properties, repaired,
};
pub use shape::{Nearest, Shape, ShapeError, SignedDistance};
pub use shape_mass::shape_mass_properties;
pub use solid::{FluidSide, Solid, depth_in_solids};
pub use thin_elements::{thin_body_elements, thin_wall_elements};
pub use wall_elements::{WallElements, wall_elements};

/// Runs the programs of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
