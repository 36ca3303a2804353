//! Shapes of a scene as geometry, meshes read and checked.

use super::report::MeshSummary;
use crate::scene::{self, At, ErrorKind, Place, Scene, SceneError, ShapeKeys, vector};
use sph_geometry::{MeshError, MeshReport, Shape, ShapeError, TriangleMesh, check};
use std::path::Path;

/// Makes shapes and remembers the meshes that they are made of.
pub struct Shapes<'a> {
    scene: &'a Scene,
    /// What the check report says of each mesh, in the order of use.
    pub meshes: Vec<MeshSummary>,
}

impl<'a> Shapes<'a> {
    pub fn new(scene: &'a Scene) -> Self {
        Self { scene, meshes: Vec::new() }
    }

    /// The only shape among `shapes`, for a solid or region that messages call `user`.
    pub fn only<const D: usize>(
        &mut self,
        user: &str,
        place: Place,
        shapes: &[scene::Shape<'_>],
    ) -> Result<Shape<D>, SceneError> {
        match shapes.first() {
            Some(shape) => self.make(user, shape),
            None => {
                let what = format!("{user} has no shape");
                let help = "give it a shape such as box or sphere".into();
                Err(self.scene.error(place, ErrorKind::Invalid { what, help }))
            }
        }
    }

    fn make<const D: usize>(
        &mut self,
        user: &str,
        shape: &scene::Shape<'_>,
    ) -> Result<Shape<D>, SceneError> {
        let made = match shape {
            scene::Shape::Box(keys) => Shape::cuboid(vector(&keys.min), vector(&keys.max)),
            scene::Shape::Sphere(keys) => Shape::sphere(vector(&keys.center), *keys.radius),
            scene::Shape::Cylinder(keys) => {
                Shape::cylinder(vector(&keys.from), vector(&keys.to), *keys.radius)
            }
            scene::Shape::Capsule(keys) => {
                Shape::capsule(vector(&keys.from), vector(&keys.to), *keys.radius)
            }
            scene::Shape::Plane(keys) => {
                Shape::half_space(vector(&keys.point), vector(&keys.normal))
            }
            scene::Shape::Polygon(points) => {
                let corners: Vec<[f64; D]> = points.iter().map(|point| vector(point)).collect();
                Shape::polygon(&corners)
            }
            scene::Shape::Mesh(path) => return self.mesh(user, path.place, path),
            scene::Shape::Union(shapes) => Shape::union(self.several(user, shapes)?),
            scene::Shape::Difference(shapes) => {
                let mut shapes = self.several(user, shapes)?;
                let others = shapes.split_off(1.min(shapes.len()));
                match shapes.pop() {
                    Some(first) => Ok(Shape::difference(first, others)),
                    None => Err(ShapeError::EmptyUnion),
                }
            }
        };
        made.map_err(|error| {
            let (what, help) = in_two(&error.to_string());
            self.scene.error(shape.place(), ErrorKind::Invalid { what, help })
        })
    }

    fn several<const D: usize>(
        &mut self,
        user: &str,
        shapes: &At<Vec<At<ShapeKeys>>>,
    ) -> Result<Vec<Shape<D>>, SceneError> {
        shapes.iter().map(|keys| self.only(user, keys.place, &keys.shapes())).collect()
    }

    fn mesh<const D: usize>(
        &mut self,
        user: &str,
        place: Place,
        path: &Path,
    ) -> Result<Shape<D>, SceneError> {
        let file = self.scene.resolve(path);
        let refuse = |reason: String, help: String| {
            self.scene.error(place, ErrorKind::Mesh { path: file.clone(), reason, help })
        };
        let refuse_mesh = |error: MeshError| match error {
            MeshError::Read { source, .. } => refuse(source.to_string(), missing_help(&file)),
            MeshError::Format { reason, .. } => {
                refuse(reason, "export the surface again as STL, OBJ or PLY".into())
            }
            other => {
                let (reason, help) = in_two(&other.to_string());
                refuse(reason, help)
            }
        };
        let mesh = TriangleMesh::read(&file).map_err(refuse_mesh)?;
        let report = check(&mesh).map_err(refuse_mesh)?;
        if let Some(error) = report.error() {
            return Err(refuse_mesh(error));
        }
        let shape = Shape::mesh(&mesh).map_err(|error| {
            let (reason, help) = in_two(&error.to_string());
            refuse(reason, help)
        })?;
        self.meshes.push(summary(user, &file, &report));
        Ok(shape)
    }
}

fn summary(user: &str, file: &Path, report: &MeshReport) -> MeshSummary {
    let mut defects = vec![match report.shells {
        1 => "closed".to_string(),
        shells => format!("closed, {shells} separate surfaces"),
    }];
    if report.is_inside_out() {
        defects.push("turned right side out".into());
    }
    if !report.degenerate_triangles.is_empty() {
        defects.push(format!("without area: {}", report.degenerate_triangles));
    }
    MeshSummary {
        used_by: user.into(),
        path: file.display().to_string(),
        triangles: report.triangles,
        bounding_box: [report.bounding_box.min.to_vec(), report.bounding_box.max.to_vec()],
        volume: report.volume.abs(),
        defects: defects.join(", "),
    }
}

/// Messages of geometry read "what is wrong; what to do".
fn in_two(message: &str) -> (String, String) {
    let (what, help) = message.split_once("; ").unwrap_or((message, ""));
    (what.into(), help.into())
}

/// Suggests the mesh in the same folder with the most similar name.
fn missing_help(file: &Path) -> String {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    let usual = "mesh paths are relative to the folder of the scene file";
    let Ok(entries) = std::fs::read_dir(folder) else {
        return format!("there is no folder {}; {usual}", folder.display());
    };
    let is_mesh = |name: &String| {
        let name = name.to_lowercase();
        [".stl", ".obj", ".ply"].iter().any(|end| name.ends_with(end))
    };
    let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let mut names: Vec<String> = names.filter(is_mesh).collect();
    names.sort();
    let wanted = file.file_name().unwrap_or_default().to_string_lossy();
    match scene::nearest(&wanted, names.iter().map(String::as_str)) {
        Some(near) => format!("did you mean `{near}`? {usual}"),
        None => usual.into(),
    }
}
