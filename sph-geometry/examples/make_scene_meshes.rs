//! Writes the meshes of the scenes: a tank and a building for the dam break in three dimensions.
//!
//! `cargo run -p sph-geometry --example make_scene_meshes` writes them to the folder `scenes` of
//! the workspace, or to the folder given as an argument. All faces lie on multiples of 0.02 m, the
//! spacing of the scene.

use sph_geometry::{MeshError, TriangleMesh};
use std::path::PathBuf;

/// Every mesh with the name of its file.
pub fn meshes() -> [(&'static str, TriangleMesh); 2] {
    [
        ("dam-break-tank.stl", TriangleMesh::cuboid([0.0; 3], [1.6, 0.68, 0.6])),
        ("dam-break-obstacle.stl", TriangleMesh::cuboid([0.9, 0.28, 0.0], [1.02, 0.4, 0.44])),
    ]
}

#[allow(dead_code)] // The test of the shipped files uses this file as a module.
fn main() -> Result<(), MeshError> {
    let scenes = || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes"));
    let folder = std::env::args_os().nth(1).map_or_else(scenes, PathBuf::from);
    for (name, mesh) in meshes() {
        mesh.write_stl(folder.join(name))?;
        println!("{}", folder.join(name).display());
    }
    Ok(())
}
