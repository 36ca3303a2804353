//! The meshes shipped with the scenes are those of the generator, to the last byte.

#[path = "../examples/make_scene_meshes.rs"]
mod make_scene_meshes;

use sph_geometry::{TriangleMesh, check};

#[test]
fn shipped_meshes_are_those_of_the_generator() {
    for (name, mesh) in make_scene_meshes::meshes() {
        let path = format!("{}/../scenes/{name}", env!("CARGO_MANIFEST_DIR"));
        let shipped = std::fs::read(&path).unwrap();
        assert_eq!(
            shipped,
            mesh.to_stl().unwrap(),
            "run `cargo run -p sph-geometry --example make_scene_meshes`"
        );
        let read = TriangleMesh::read(&path).unwrap();
        assert_eq!(read.bounding_box(), mesh.bounding_box());
        assert!(check(&read).unwrap().error().is_none());
    }
}
