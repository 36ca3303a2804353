//! Fills a mesh with particles: reads a file (STL, OBJ, PLY, VTK), repairs what is safe to repair, says what it
//! is, and writes the particles as CSV.
//!
//! `cargo run --release -p sph-geometry --example fill_mesh -- SPACING [FILE] > particles.csv`
//!
//! Without a file it takes a box with a hole through it.

use sph_geometry::{
    Lattice, MeshFile, Shape, TriangleMesh, fill_lattice, mass_properties, repaired,
};
use std::io::{BufWriter, Write};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let spacing: f64 = arguments.next().map_or(Ok(0.05), |text| text.parse())?;
    let shape = match arguments.next() {
        Some(file) => {
            let file = MeshFile::read(file)?;
            eprintln!("{:?} with {} triangles", file.format, file.mesh.triangles.len());
            let mended = repaired(&file.mesh)?;
            for repair in mended.repairs.in_words() {
                eprintln!("repaired: {repair}");
            }
            let mass = mass_properties(&mended.mesh, 1000.0)?;
            eprintln!("{:.6} kg of water, centre of mass at {:.4?}", mass.mass, mass.center);
            Shape::<3>::mesh(&mended.mesh)?
        }
        None => {
            let block = Shape::mesh(&TriangleMesh::cuboid([0.0; 3], [1.0, 0.6, 0.4]))?;
            let hole = Shape::cylinder([0.5, -0.1, 0.2], [0.5, 0.7, 0.2], 0.12)?;
            Shape::difference(block, vec![hole])
        }
    };
    let particles = fill_lattice(&shape, &Lattice::new([0.0; 3], spacing)?)?;
    let volume = particles.len() as f64 * spacing.powi(3);
    eprintln!("{} particles, {volume:.6} m³", particles.len());

    let mut out = BufWriter::new(std::io::stdout());
    writeln!(out, "x [m],y [m],z [m]")?;
    for [x, y, z] in particles {
        writeln!(out, "{x},{y},{z}")?;
    }
    out.flush()?;
    Ok(())
}
