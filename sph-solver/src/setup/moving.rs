//! Solids of a scene that move.

use super::lattice_error;
use super::thickness::Thin;
use crate::bodies::{Body, Course, Free, Guide, Path, Rigid, Row, Spring, in_space};
use crate::csv_file;
use crate::scene::{self, At, Degree, ErrorKind, Motion, Place, Scene, SceneError, TimedFormula};
use crate::walls::WallElements;
use nalgebra::{Matrix3, Unit, Vector3};
use sph_geometry::{
    Aabb, Lattice, LatticeError, Solid, body_elements, shape_mass_properties, thin_body_elements,
};

/// Moments at which the speed of a prescribed motion is looked at.
const SAMPLES: usize = 1000;

/// Whether each solid of a scene moves.
pub fn moves(scene: &Scene) -> Vec<bool> {
    scene.solid.iter().map(|solid| solid.moves()).collect()
}

/// The solids that rest, and all others left out.
pub fn at_rest<const D: usize>(scene: &Scene, solids: &[Solid<D>]) -> Vec<Solid<D>> {
    let moves = moves(scene);
    solids.iter().zip(moves).filter(|(_, moves)| !moves).map(|(solid, _)| solid.clone()).collect()
}

/// The solids that move, without elements.
pub fn bodies<const D: usize>(
    scene: &Scene,
    solids: &[Solid<D>],
) -> Result<Vec<Body<D>>, SceneError> {
    let mut bodies = Vec::new();
    for (number, (keys, shape)) in scene.solid.iter().zip(solids).enumerate() {
        let (guide, start) = match (&keys.motion, &keys.body) {
            (Some(motion), _) => prescribed(scene, keys, motion, shape)?,
            (None, Some(body)) => free(scene, keys, body, shape)?,
            (None, None) => continue,
        };
        let elements = WallElements::default();
        bodies.push(Body { solid: number as u16, guide, start, shape: shape.clone(), elements });
    }
    Ok(bodies)
}

/// The wall elements of a solid that moves, which may be among the `thin` ones.
///
/// # Errors
///
/// As [`body_elements`].
pub fn elements<const D: usize>(
    body: &Body<D>,
    thin: &[Option<Thin<D>>],
    lattice: &Lattice<D>,
    support: f64,
) -> Result<sph_geometry::WallElements<D>, LatticeError> {
    let make = match thin[usize::from(body.solid)] {
        Some(_) => thin_body_elements,
        None => body_elements,
    };
    make(&body.shape, lattice, support)
}

/// Gives a solid that moves its wall elements, whose ids count from 0.
pub fn add_elements<const D: usize>(
    scene: &Scene,
    body: &mut Body<D>,
    elements: Result<sph_geometry::WallElements<D>, LatticeError>,
) -> Result<(), SceneError> {
    let place = scene.solid[usize::from(body.solid)].place;
    let elements = elements.map_err(|error| lattice_error(scene, place, &error))?;
    if elements.positions.is_empty() {
        let kind = ErrorKind::Invalid {
            what: format!("solid `{}` moves, but has no wall particles", body.shape.name),
            help: "it is much smaller than the spacing: use a smaller numerics.spacing, or check \
                   its size"
                .into(),
        };
        return Err(scene.error(place, kind));
    }
    body.elements = WallElements::of_body(&elements, body.solid, 0);
    Ok(())
}

/// The largest speed (m/s) that bodies bring along: at the start, or on a prescribed course until the end
/// of the run.
pub fn largest_speed<const D: usize>(scene: &Scene, bodies: &[Body<D>]) -> f64 {
    let of = |body: &Body<D>| {
        let radius = corner(&body.shape.shape.bounding_box(), &body.start.position);
        let speed = |rigid: &Rigid| rigid.velocity.norm() + rigid.spin.norm() * radius;
        let Guide::Course(course) = &body.guide else { return speed(&body.start) };
        let step = *scene.end_time / SAMPLES as f64;
        let at = |k: usize| speed(&course.step(k as f64 * step, step));
        (0..SAMPLES).map(at).fold(0.0, f64::max)
    };
    bodies.iter().map(of).fold(0.0, f64::max)
}

/// Distance of the farthest corner of a box from a point, m.
fn corner<const D: usize>(bounds: &Aabb<D>, from: &Vector3<f64>) -> f64 {
    let side = |k: usize| (bounds.max[k] - from[k]).abs().max((bounds.min[k] - from[k]).abs());
    (0..D).map(|k| side(k) * side(k)).sum::<f64>().sqrt()
}

fn prescribed<const D: usize>(
    scene: &Scene,
    keys: &scene::Solid,
    motion: &At<Motion>,
    solid: &Solid<D>,
) -> Result<(Guide, Rigid), SceneError> {
    let bounds = solid.shape.bounding_box();
    let middle = std::array::from_fn(|k| 0.5 * (bounds.min[k] + bounds.max[k]));
    let about = motion.about.as_ref().or(keys.moments_about.as_ref());
    let about: [f64; D] = about.map_or(middle, |point| scene::vector(point));
    let path = match (&motion.table, &motion.displacement, &motion.rotation) {
        (Some(table), _, _) => Path::Table(rows(scene, table)?),
        (None, None, None) => Path::Steady {
            velocity: vector(motion.velocity.as_ref()),
            spin: motion.spin.as_deref().copied().unwrap_or(0.0),
        },
        (None, displacement, rotation) => {
            let component = |k: usize| {
                let formula = displacement.as_ref().and_then(|all| all.get(k));
                formula.map_or_else(TimedFormula::default, |formula| formula.value.clone())
            };
            Path::Formulas {
                displacement: Box::new(std::array::from_fn(component)),
                angle: rotation
                    .as_ref()
                    .map_or_else(TimedFormula::default, |angle| angle.value.clone()),
            }
        }
    };
    let course = Course { about: in_space(&about), axis: axis(motion.axis.as_ref()), path };
    // The velocity at the start is that of a first short step.
    let first = course.step(0.0, *scene.end_time / SAMPLES as f64);
    let start = Rigid { velocity: first.velocity, spin: first.spin, ..course.at(0.0) };
    if !(start.to_array().iter().all(|number| number.is_finite())) {
        let kind = ErrorKind::Invalid {
            what: format!("the motion of solid `{}` is not defined at t = 0", solid.name),
            help: "its formulas must give numbers at all times".into(),
        };
        return Err(scene.error(motion.place, kind));
    }
    Ok((Guide::Course(course), start))
}

fn free<const D: usize>(
    scene: &Scene,
    keys: &scene::Solid,
    body: &At<scene::Body>,
    solid: &Solid<D>,
) -> Result<(Guide, Rigid), SceneError> {
    let refuse = |place: Place, what: String, help: &str| {
        scene.error(place, ErrorKind::Invalid { what, help: help.into() })
    };
    if keys.fluid_side.as_deref() == Some(&scene::FluidSide::Inside) && body.mass.is_none() {
        return Err(refuse(
            body.place,
            format!("solid `{}` has the fluid inside: its material has no end", solid.name),
            "give its `mass`, `center` and `inertia`",
        ));
    }
    let filled = shape_mass_properties(&solid.shape, 1.0);
    let mass = match (&body.density, &body.mass) {
        (Some(density), _) => **density * filled.volume,
        (None, mass) => mass.as_deref().copied().unwrap_or(0.0),
    };
    if !(mass > 0.0 && filled.volume > 0.0) {
        let what = format!("solid `{}` encloses no volume", solid.name);
        return Err(refuse(body.place, what, "a body needs a mass"));
    }
    let center = body.center.as_ref().map_or(filled.center, |center| vector(Some(center)));
    let inertia = match body.inertia.as_deref().map(Vec::as_slice) {
        Some([zz]) => Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, *zz)),
        Some([xx, yy, zz]) => Matrix3::from_diagonal(&Vector3::new(*xx, *yy, *zz)),
        Some([xx, yy, zz, xy, xz, yz]) => Matrix3::new(*xx, *xy, *xz, *xy, *yy, *yz, *xz, *yz, *zz),
        _ => {
            // About another point than the middle of the shape: Steiner.
            let d = center - filled.center;
            let shift = Matrix3::identity() * d.norm_squared() - d * d.transpose();
            filled.inertia * (mass / filled.mass) + shift * mass
        }
    };
    let mut start = Rigid::at(center);
    start.velocity = vector(body.velocity.as_ref());
    start.spin =
        axis(body.axis.as_ref()).into_inner() * body.spin.as_deref().copied().unwrap_or(0.0);
    let free = |turn: bool| {
        let held = |axis: usize| {
            body.fixed.iter().any(|degree: &At<Degree>| degree.parts() == (turn, axis))
        };
        std::array::from_fn(|axis| (D == 3 || turn == (axis == 2)) && !held(axis))
    };
    let (moves, turns) = (free(false), free(true));
    for k in 0..3 {
        if !moves[k] {
            start.velocity[k] = 0.0;
        }
        if !turns[k] {
            start.spin[k] = 0.0;
        }
    }
    let spring = |keys: &At<scene::Spring>| {
        let anchor = vector(Some(&keys.anchor));
        let end = keys.attached.as_ref().map_or(center, |end| vector(Some(end)));
        Spring {
            anchor,
            arm: end - center,
            length: keys.length.as_deref().copied().unwrap_or((anchor - end).norm()),
            stiffness: *keys.stiffness,
            damping: *keys.damping,
            slack: *keys.rope,
        }
    };
    let free = Free {
        mass,
        inertia,
        moves,
        turns,
        springs: body.springs.iter().map(spring).collect(),
        restitution: *body.restitution,
        friction: *body.friction,
    };
    Ok((Guide::Free(free), start))
}

fn vector(numbers: Option<&At<Vec<f64>>>) -> Vector3<f64> {
    Vector3::from_fn(|k, _| numbers.and_then(|all| all.get(k)).copied().unwrap_or(0.0))
}

fn axis(numbers: Option<&At<Vec<f64>>>) -> Unit<Vector3<f64>> {
    let axis = numbers.map_or_else(Vector3::z, |_| vector(numbers));
    Unit::try_new(axis, 0.0).unwrap_or_else(Vector3::z_axis)
}

/// The rows of a table of motion.
fn rows(scene: &Scene, path: &At<std::path::PathBuf>) -> Result<Vec<Row>, SceneError> {
    let file = scene.resolve(path);
    let refuse = |what: String| {
        let kind = ErrorKind::Invalid {
            what: format!("{}: {what}", file.display()),
            help:
                "a table of motion has a line of titles, `time` and any of `x`, `y`, `z` (m) and \
                   `angle` (rad), and rows of numbers whose times increase"
                    .into(),
        };
        scene.error(path.place, kind)
    };
    // The time, then each of the others that there is, by its place among these.
    const KNOWN: [&str; 4] = ["x", "y", "z", "angle"];
    let mut known = Vec::new();
    let pick = |names: &[&str]| {
        let place = |name: &str| names.iter().position(|other| *other == name);
        let time = place("time").ok_or("there is no column `time`")?;
        let strange = names.iter().find(|name| **name != "time" && !KNOWN.contains(name));
        if let Some(other) = strange {
            return Err(format!("there is a column `{other}`"));
        }
        let mut places = vec![time];
        for (axis, name) in KNOWN.iter().enumerate() {
            if let Some(place) = place(name) {
                known.push(axis);
                places.push(place);
            }
        }
        Ok(places)
    };
    let table = csv_file::rows(&file, pick).map_err(refuse)?;
    let mut rows: Vec<Row> = Vec::new();
    for (line, numbers) in &table {
        let (time, rest) = (numbers[0], &numbers[1..]);
        if rows.last().is_some_and(|before| time <= before.time) {
            return Err(refuse(format!(
                "{}: the time of row {line} is not later than before",
                file.display()
            )));
        }
        let mut place = [0.0; 4];
        known.iter().zip(rest).for_each(|(axis, number)| place[*axis] = *number);
        rows.push(Row { time, place });
    }
    if rows.is_empty() {
        return Err(refuse(format!("{}: there are no rows", file.display())));
    }
    Ok(rows)
}
