//! Times signed distances, lattice filling and wall particles on this machine.
//!
//! `cargo run --release -p sph-geometry --example timings`

use sph_geometry::{
    Aabb, Domain, FluidSide, Lattice, Shape, Solid, TriangleMesh, bodies, fill_lattice,
    near_surface, repaired, wall_elements, wall_particles,
};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let tank = TriangleMesh::cuboid([0.0; 3], [1.6, 0.68, 0.6]);
    let meshes = [
        ("box", tank.clone()),
        ("sphere", TriangleMesh::sphere([0.8, 0.34, 0.3], 0.25, 3)),
        ("sphere", TriangleMesh::sphere([0.8, 0.34, 0.3], 0.25, 5)),
    ];
    // A lattice of about a million points around the tank.
    let lattice = Lattice::new([0.0; 3], 0.01)?;
    let around = Shape::cuboid([-0.1; 3], [1.7, 0.78, 0.6])?;
    let points = fill_lattice(&around, &lattice)?;
    for (name, mesh) in meshes {
        let triangles = mesh.triangles.len();
        let shape = time(&format!("build {name} of {triangles} triangles"), || Shape::mesh(&mesh))?;
        let sum = time(&format!("  {} signed distances, each point", points.len()), || {
            points.iter().map(|x| shape.signed_distance(x)).sum::<f64>()
        });
        assert!(sum.is_finite());
        let near = time("  those within 0.03 m on the same lattice", || {
            near_surface(&shape, &lattice, 0.03)
        })?;
        println!("  … {} points", near.len());
        let inside = time("  lattice points inside", || fill_lattice(&shape, &lattice))?;
        println!("  … {} points", inside.len());
    }

    million()?;

    let obstacle = TriangleMesh::cuboid([0.9, 0.28, 0.0], [1.02, 0.4, 0.44]);
    let solids = [
        Solid::new("tank", Shape::mesh(&tank)?, FluidSide::Inside),
        Solid::new("obstacle", Shape::mesh(&obstacle)?, FluidSide::Outside),
    ];
    let domain = Domain::new(solids[0].shape.bounding_box());
    for spacing in [0.02, 0.01, 0.005, 0.0025] {
        let lattice = Lattice::new([0.0; 3], spacing)?;
        let walls = time(&format!("walls of tank and obstacle, spacing {spacing} m"), || {
            wall_particles(&solids, &lattice, 3.0 * spacing, &domain)
        })?;
        println!("  … {} particles", walls.positions.len());
        let column = Shape::cuboid([0.0; 3], [0.4, 0.68, 0.3])?;
        let fluid = time("  fluid column", || fill_lattice(&column, &lattice))?;
        println!("  … {} particles", fluid.len());
    }
    Ok(())
}

/// Import, repair and sampling of a mesh of 1.3 million triangles.
fn million() -> Result<(), Box<dyn std::error::Error>> {
    let mut hull = TriangleMesh::sphere([0.8, 0.5, 0.3], 0.25, 8);
    // Waves, so that the surface is no more convex than a real one.
    for x in &mut hull.vertices {
        x[2] += 0.01 * (40.0 * x[0]).sin() * (40.0 * x[1]).cos();
    }
    let bytes = hull.to_stl()?;
    let read =
        time("read binary STL of 1.3 million triangles", || TriangleMesh::from_bytes(&bytes))?;
    let mended = time("  repair", || repaired(&read))?;
    let found = time("  find bodies", || bodies(&mended.mesh))?;
    let shape = time("  build the shape", || Shape::bodies(&found))?;
    let solids = [
        Solid::new("tank", Shape::cuboid([0.0; 3], [1.6, 1.0, 0.6])?, FluidSide::Inside),
        Solid::new("hull", shape, FluidSide::Outside),
    ];
    let domain = Domain::new(Aabb::new([0.0; 3], [1.6, 1.0, 0.6]));
    for spacing in [0.02, 0.01, 0.005] {
        let lattice = Lattice::new([0.0; 3], spacing)?;
        let walls = time(&format!("  wall elements, spacing {spacing} m"), || {
            wall_elements(&solids, &lattice, 3.0 * spacing, &domain)
        })?;
        println!("  … {} elements", walls.positions.len());
        let inside = time("  lattice points inside", || fill_lattice(&solids[1].shape, &lattice))?;
        println!("  … {} points", inside.len());
    }
    Ok(())
}

fn time<T>(what: &str, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    println!("{what:60} {:8.3} s", start.elapsed().as_secs_f64());
    result
}
