//! Meshes in another unit than the rest of the scene, and solids that the fluid never meets.

use super::particles::Particles;
use super::report::MeshSummary;
use crate::scene::{ErrorKind, Scene, SceneError};
use sph_geometry::{Aabb, Shape, Solid};

/// A mesh so many times longer or shorter than everything else is taken for one in another unit.
const SUSPICIOUS: f64 = 30.0;

/// A mesh of so many spacings is beyond what can be filled with particles.
const LONGEST: f64 = 2e4;

/// A solid thinner than this part of the spacing has no material in any cell.
const THINNEST: f64 = 0.1;

fn longest<const D: usize>(bounds: &Aabb<D>) -> Option<f64> {
    bounds.is_finite().then(|| (0..D).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, f64::max))
}

/// What is odd about the size of a mesh, and the way out.
struct Odd<'a> {
    mesh: &'a MeshSummary,
    /// Its longest side, m.
    length: f64,
    /// Longest side of the nearest other shape in size, m.
    other: f64,
}

impl Odd<'_> {
    fn in_words(&self) -> (String, String) {
        let Self { mesh, length, other } = self;
        let what = format!(
            "the mesh {} of {} is {length} m long, from {:?} to {:?}, and other shapes of the scene are \
             {other} m",
            mesh.path, mesh.used_by, mesh.bounding_box[0], mesh.bounding_box[1]
        );
        let help = if length > other {
            "if it is drawn in millimetres, give it units = \"mm\", which is scale = 0.001"
        } else {
            "if it was scaled twice, leave out `units` and `scale`, or give another scale: \
             scale = 1000 makes metres of thousandths"
        };
        (what, help.into())
    }
}

/// Meshes much larger or smaller than every other shape.
fn odd<'a, const D: usize>(
    solids: &[Solid<D>],
    regions: &[Shape<D>],
    meshes: &'a [MeshSummary],
) -> Vec<Odd<'a>> {
    let shapes = solids.iter().map(|solid| &solid.shape).chain(regions);
    let sizes: Vec<f64> = shapes.filter_map(|shape| longest(&shape.bounding_box())).collect();
    let odd = |mesh: &'a MeshSummary| {
        let [min, max] = &mesh.bounding_box;
        let length = min.iter().zip(max).map(|(min, max)| max - min).fold(0.0, f64::max);
        // Its own shape has its own size.
        let apart = |size: f64| (size / length).max(length / size);
        let others = sizes.iter().filter(|size| apart(**size) > 1.5);
        let other = *others.min_by(|a, b| apart(**a).total_cmp(&apart(**b)))?;
        (apart(other) > SUSPICIOUS).then_some(Odd { mesh, length, other })
    };
    meshes.iter().filter_map(odd).collect()
}

/// Refuses meshes that are so large that their unit must be another one.
pub fn check<const D: usize>(
    scene: &Scene,
    solids: &[Solid<D>],
    regions: &[Shape<D>],
    meshes: &[MeshSummary],
) -> Result<(), SceneError> {
    let spacing = *scene.numerics.spacing;
    match odd(solids, regions, meshes).iter().find(|odd| odd.length > LONGEST * spacing) {
        Some(odd) if odd.length > odd.other => {
            let (what, help) = odd.in_words();
            Err(scene.error(place_of(scene, odd.mesh), ErrorKind::Invalid { what, help }))
        }
        _ => Ok(()),
    }
}

/// The same error, or a better one when a mesh has an odd size.
pub fn explain<const D: usize>(
    error: SceneError,
    scene: &Scene,
    solids: &[Solid<D>],
    regions: &[Shape<D>],
    meshes: &[MeshSummary],
) -> SceneError {
    match odd(solids, regions, meshes).first() {
        None => error,
        Some(odd) => {
            let (what, help) = odd.in_words();
            let what = format!("{what}; {error}");
            scene.error(place_of(scene, odd.mesh), ErrorKind::Invalid { what, help })
        }
    }
}

/// Refuses solids without particles for which there is no good reason.
pub fn without_particles<const D: usize>(
    scene: &Scene,
    solids: &[Solid<D>],
    regions: &[Shape<D>],
    meshes: &[MeshSummary],
    domain: &Aabb<D>,
    particles: &Particles<D>,
) -> Result<(), SceneError> {
    let spacing = *scene.numerics.spacing;
    for (index, solid) in solids.iter().enumerate() {
        if !particles.of_kind(1 + index as u16).is_empty() {
            continue;
        }
        let bounds = solid.shape.bounding_box();
        let name = &solid.name;
        let user = format!("solid {name}");
        let place = scene.solid.get(index).map_or(scene.numerics.spacing.place, |keys| keys.place);
        let refuse =
            |what: String, help: String| Err(scene.error(place, ErrorKind::Invalid { what, help }));
        let size = size_in_words(&bounds);
        if let Some(odd) = odd(solids, regions, meshes).iter().find(|odd| odd.mesh.used_by == user)
        {
            let (what, help) = odd.in_words();
            return refuse(format!("solid `{name}` has no particles: {what}"), help);
        }
        let both = bounds.intersection(domain);
        if (0..D).any(|k| both.min[k] > both.max[k]) {
            return refuse(
                format!(
                    "solid `{name}`, {size}, lies outside of the domain, {:?} to {:?}",
                    domain.min, domain.max
                ),
                "move it by `translate`, scale it (scale = 0.001 for millimetres), or enlarge [domain]"
                    .into(),
            );
        }
        let thinnest = (0..D).map(|k| bounds.max[k] - bounds.min[k]).fold(f64::INFINITY, f64::min);
        if thinnest < THINNEST * spacing {
            return refuse(
                format!("solid `{name}`, {size}, is lost between particles {spacing} m apart"),
                "make it thicker, give a smaller numerics.spacing, or scale it (scale = 1000 if it \
                 is drawn in thousandths of a metre)"
                    .into(),
            );
        }
    }
    Ok(())
}

fn size_in_words<const D: usize>(bounds: &Aabb<D>) -> String {
    format!("from {:?} to {:?}", bounds.min, bounds.max)
}

/// Where the scene gives the user of a mesh.
fn place_of(scene: &Scene, mesh: &MeshSummary) -> crate::scene::Place {
    let solid = scene.solid.iter().find(|solid| format!("solid {}", *solid.name) == mesh.used_by);
    match (solid, scene.fluid()) {
        (Some(solid), _) => solid.place,
        (None, Ok((_, fluid))) => fluid.regions.place,
        (None, Err(_)) => scene.numerics.spacing.place,
    }
}
