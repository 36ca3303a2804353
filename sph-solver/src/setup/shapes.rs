//! Shapes of a scene as geometry, meshes read and checked.

use super::placed;
use super::report::MeshSummary;
use super::volume;
use crate::scene::{self, At, ErrorKind, Place, Placing, Scene, SceneError, ShapeKeys, vector};
use sph_geometry::{
    Bodies, MeshError, MeshFile, Shape, ShapeError, TriangleMesh, bodies, check, repaired,
};
use std::path::Path;

/// Makes shapes and remembers the meshes that they are made of.
pub struct Shapes<'a> {
    scene: &'a Scene,
    /// What the check report says of each mesh, in the order of use.
    pub meshes: Vec<MeshSummary>,
    /// What deserves a look about them.
    pub notes: Vec<String>,
}

impl<'a> Shapes<'a> {
    pub fn new(scene: &'a Scene) -> Self {
        Self { scene, meshes: Vec::new(), notes: Vec::new() }
    }

    /// The only shape among `shapes`, for a solid or region that messages call `user`.
    pub fn only<const D: usize>(
        &mut self,
        user: &str,
        place: Place,
        shapes: &[scene::Shape<'_>],
        placing: &Placing<'_>,
    ) -> Result<Shape<D>, SceneError> {
        match shapes.first() {
            Some(scene::Shape::Mesh(path)) => self.mesh(user, path.place, path, placing),
            Some(shape) => {
                let made = self.make(user, shape)?;
                made.moved(&placed::map(placing)).map_err(|error| {
                    let place = placing.scale.map_or(shape.place(), |scale| scale.place);
                    let (what, help) = in_two(&error.to_string());
                    self.scene.error(place, ErrorKind::Invalid { what, help })
                })
            }
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
            scene::Shape::Mesh(path) => {
                return self.mesh(user, path.place, path, &Placing::default());
            }
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
        shapes
            .iter()
            .map(|keys| self.only(user, keys.place, &keys.shapes(), &keys.placing()))
            .collect()
    }

    fn mesh<const D: usize>(
        &mut self,
        user: &str,
        place: Place,
        path: &Path,
        placing: &Placing<'_>,
    ) -> Result<Shape<D>, SceneError> {
        let file = self.scene.resolve(path);
        let refuse = |reason: String, help: String| {
            self.scene.error(place, ErrorKind::Mesh { path: file.clone(), reason, help })
        };
        let refuse_mesh = |error: MeshError| match error {
            MeshError::Read { source, .. } => refuse(source.to_string(), missing_help(&file)),
            MeshError::Format { reason, .. } => {
                refuse(reason, "export the surface again as STL, OBJ, PLY or VTK".into())
            }
            other => {
                let (reason, help) = in_two(&other.to_string());
                refuse(reason, help)
            }
        };
        let read = MeshFile::read(&file).map_err(refuse_mesh)?;
        let resolution = resolution(&read, placing);
        let raw = placed::mesh(read.mesh, placing);
        let mut found = Found { triangles: raw.triangles.len(), ..Found::default() };
        let made = if let Some(thickness) = placing.thickness {
            found.words.push(format!("a sheet of {} m", **thickness));
            Shape::sheet(&raw, **thickness).map(|shape| (raw, shape))
        } else if placing.convex_hull.is_some_and(|hull| **hull) {
            found.words.push("its convex hull".into());
            raw.convex_hull().map_err(ShapeError::Mesh).and_then(|hull| {
                let shape = Shape::mesh(&hull)?;
                Ok((hull, shape))
            })
        } else {
            closed(raw, &mut found)
        };
        let (mesh, shape) = made.map_err(|error| match error {
            ShapeError::Mesh(error) => refuse_mesh(error),
            other => {
                let (reason, help) = in_two(&other.to_string());
                refuse(reason, help)
            }
        })?;
        let spacing = *self.scene.numerics.spacing;
        if resolution > COARSE * spacing {
            found.notes.push(format!(
                "the numbers of the file are {resolution:.2e} m apart, more than a hundredth of the \
                 spacing: move the geometry near to the origin before it is exported, or export it \
                 as text"
            ));
        }
        let path = file.display();
        self.notes.extend(found.notes.iter().map(|note| format!("mesh {path} of {user}: {note}")));
        let bounds = mesh.bounding_box();
        self.meshes.push(MeshSummary {
            used_by: user.into(),
            path: path.to_string(),
            triangles: found.triangles,
            bounding_box: [bounds.min.to_vec(), bounds.max.to_vec()],
            volume: found
                .volume
                .unwrap_or_else(|| volume::of_regions(std::slice::from_ref(&shape), &[])),
            defects: found.words.join(", "),
        });
        Ok(shape)
    }
}

/// Numbers farther apart than this part of the spacing make walls that are not smooth.
const COARSE: f64 = 0.01;

/// What is said of a mesh.
#[derive(Default)]
struct Found {
    triangles: usize,
    /// m³, where it is known exactly.
    volume: Option<f64>,
    words: Vec<String>,
    notes: Vec<String>,
}

/// The bodies that a mesh bounds, and the mended mesh.
fn closed<const D: usize>(
    raw: TriangleMesh,
    found: &mut Found,
) -> Result<(TriangleMesh, Shape<D>), ShapeError> {
    let mended = repaired(&raw)?;
    drop(raw);
    let report = check(&mended.mesh)?;
    if let Some(error) = report.error() {
        return Err(error.into());
    }
    let bodies = bodies(&mended.mesh)?;
    let shape = Shape::bodies(&bodies)?;
    found.volume = (!bodies.may_overlap()).then_some(bodies.volume);
    found.words.push(nesting(&bodies));
    found.words.extend(mended.repairs.in_words());
    found.notes.extend(mended.repairs.in_words());
    if !report.degenerate_triangles.is_empty() {
        found.words.push(format!("without area: {}", report.degenerate_triangles));
    }
    if bodies.idle > 0 {
        found.notes.push(format!(
            "{} of its surfaces bound nothing: they are flat, or lie inside of a body and face as it \
             does. A surface around a cavity has to face the other way",
            bodies.idle
        ));
    }
    Ok((mended.mesh, shape))
}

/// Shells and their nesting in words.
fn nesting(bodies: &Bodies) -> String {
    let mut words = vec!["closed".to_string()];
    if bodies.shells > 1 {
        words.push(format!("{} separate surfaces", bodies.shells));
        words.push(match bodies.bodies {
            1 => "one body".into(),
            count => format!("{count} bodies"),
        });
        if bodies.cavities > 0 {
            words.push(format!("{} around cavities", bodies.cavities));
        }
        if bodies.idle > 0 {
            words.push(format!("{} inside of material without effect", bodies.idle));
        }
        if bodies.may_overlap() {
            words.push("united where they overlap".into());
        }
    }
    match bodies.turned {
        0 => {}
        all if all == bodies.shells => words.push("turned right side out".into()),
        some => words.push(format!("{some} turned right side out")),
    }
    words.join(", ")
}

/// Distance of neighbouring numbers of the file, m.
fn resolution(file: &MeshFile, placing: &Placing<'_>) -> f64 {
    let factor = placing.units.map_or(1.0, |units| units.to_metres(1.0));
    let map = placed::map::<3>(placing);
    file.resolution * factor * map.determinant().abs().cbrt()
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
        [".stl", ".obj", ".ply", ".vtk", ".vtp", ".vtu"].iter().any(|end| name.ends_with(end))
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
