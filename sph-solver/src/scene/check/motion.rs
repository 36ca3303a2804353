//! Checks of what makes solids move.

use super::formula_of_time;
use super::values::Values;
use crate::scene::error::SceneError;
use crate::scene::located::At;
use crate::scene::motion::{Body, Motion};
use crate::scene::shape::Shape;
use crate::scene::solid::Solid;

pub fn check(values: &Values<'_>, index: usize, solid: &At<Solid>) -> Result<(), SceneError> {
    if !solid.moves() {
        return Ok(());
    }
    if let (Some(_), Some(body)) = (&solid.motion, &solid.body) {
        return Err(values.invalid(
            body.place,
            format!("solid `{}` has both a `motion` and a `body`", *solid.name),
            "a prescribed motion leaves nothing for the fluid to move: remove one of them",
        ));
    }
    if let [Shape::Plane(plane)] = solid.shapes()[..] {
        return Err(values.invalid(
            plane.place,
            format!("solid `{}` moves, but a plane has no end", *solid.name),
            "make it a box",
        ));
    }
    if let Some(motion) = &solid.motion {
        self::motion(values, &format!("solid.{index}.motion"), motion)?;
    }
    if let Some(body) = &solid.body {
        self::body(values, &format!("solid.{index}.body"), body)?;
    }
    Ok(())
}

fn motion(values: &Values<'_>, path: &str, motion: &At<Motion>) -> Result<(), SceneError> {
    let ways = [
        motion.velocity.is_some() || motion.spin.is_some(),
        motion.displacement.is_some() || motion.rotation.is_some(),
        motion.table.is_some(),
    ];
    if ways.into_iter().filter(|way| *way).count() != 1 {
        return Err(values.invalid(
            motion.place,
            format!("`{path}` must say in one way how the solid moves"),
            "give velocity and spin, or displacement and rotation as formulas in t, or a table",
        ));
    }
    for (key, vector) in [("velocity", &motion.velocity), ("about", &motion.about)] {
        if let Some(vector) = vector {
            values.components(&format!("{path}.{key}"), vector)?;
        }
    }
    if let Some(displacement) = &motion.displacement {
        let key = format!("{path}.displacement");
        values.length(&key, displacement.place, displacement.len())?;
        for component in displacement.iter() {
            formula_of_time(values, component, component.place)?;
        }
    }
    if let Some(rotation) = &motion.rotation {
        formula_of_time(values, rotation, rotation.place)?;
    }
    axis(values, path, motion.axis.as_ref())
}

fn body(values: &Values<'_>, path: &str, body: &At<Body>) -> Result<(), SceneError> {
    match (&body.density, &body.mass) {
        (Some(density), None) => values.positive(
            &format!("{path}.density"),
            density,
            "in kg/m³; wood has about 500, ice 920, steel 7850",
        )?,
        (None, Some(mass)) => values.positive(
            &format!("{path}.mass"),
            mass,
            "in kg (kg per metre of depth in two dimensions)",
        )?,
        (given, _) => {
            let count = if given.is_some() { "both" } else { "neither" };
            return Err(values.invalid(
                body.place,
                format!("`{path}` has {count} of `density` and `mass`"),
                "give one of them",
            ));
        }
    }
    for (key, vector) in [("center", &body.center), ("velocity", &body.velocity)] {
        if let Some(vector) = vector {
            values.components(&format!("{path}.{key}"), vector)?;
        }
    }
    if let Some(inertia) = &body.inertia {
        let dimension = values.scene.dimension();
        let fits =
            if dimension == 2 { inertia.len() == 1 } else { [3, 6].contains(&inertia.len()) };
        if !fits {
            return Err(values.invalid(
                inertia.place,
                format!("`{path}.inertia` has {} numbers", inertia.len()),
                if dimension == 2 {
                    "give one in two dimensions, that about z"
                } else {
                    "give three, those about x, y and z, or six: xx, yy, zz, xy, xz, yz"
                },
            ));
        }
        if !is_positive(inertia) {
            return Err(values.invalid(
                inertia.place,
                format!("`{path}.inertia` is that of no body"),
                "the inertia about every axis is positive",
            ));
        }
    }
    axis(values, path, body.axis.as_ref())?;
    values.within(
        &format!("{path}.restitution"),
        &body.restitution,
        0.0..=1.0,
        "between 0 and 1",
        "0 for a body that stays where it falls, 1 for one that loses nothing",
    )?;
    values.not_negative(&format!("{path}.friction"), &body.friction, "0.3 suits many surfaces")?;
    for (index, spring) in body.springs.iter().enumerate() {
        let path = format!("{path}.springs.{index}");
        values.components(&format!("{path}.anchor"), &spring.anchor)?;
        if let Some(attached) = &spring.attached {
            values.components(&format!("{path}.attached"), attached)?;
        }
        if let Some(length) = &spring.length {
            values.not_negative(&format!("{path}.length"), length, "in metres")?;
        }
        values.not_negative(&format!("{path}.stiffness"), &spring.stiffness, "in N/m")?;
        values.not_negative(&format!("{path}.damping"), &spring.damping, "in N s/m")?;
    }
    if values.scene.dimension() == 2
        && let Some(degree) = body.fixed.iter().find(|degree| {
            let (turns, axis) = degree.parts();
            turns != (axis == 2)
        })
    {
        return Err(values.invalid(
            degree.place,
            format!("`{path}.fixed`: a body in two dimensions has no such degree of freedom"),
            "those that can be held are \"x\", \"y\" and \"rotation-z\"",
        ));
    }
    Ok(())
}

/// Whether an inertia tensor is positive definite, by its leading minors (Sylvester).
fn is_positive(inertia: &[f64]) -> bool {
    let at = |k: usize| inertia.get(k).copied().unwrap_or(0.0);
    if inertia.len() == 1 {
        return at(0) > 0.0;
    }
    let [xx, yy, zz, xy, xz, yz] = std::array::from_fn(at);
    let two = xx * yy - xy * xy;
    let three = zz * two - yz * (xx * yz - xy * xz) + xz * (xy * yz - yy * xz);
    xx > 0.0 && two > 0.0 && three > 0.0
}

fn axis(values: &Values<'_>, path: &str, axis: Option<&At<Vec<f64>>>) -> Result<(), SceneError> {
    let Some(axis) = axis else { return Ok(()) };
    if values.scene.dimension() == 2 {
        return Err(values.invalid(
            axis.place,
            format!("`{path}.axis` has no meaning in two dimensions"),
            "remove it: everything turns in the plane",
        ));
    }
    values.components(&format!("{path}.axis"), axis)?;
    if axis.iter().all(|component| *component == 0.0) {
        let what = format!("`{path}.axis` has no direction");
        return Err(values.invalid(axis.place, what, "for example axis = [0, 0, 1]"));
    }
    Ok(())
}
