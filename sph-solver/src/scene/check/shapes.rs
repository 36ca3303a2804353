//! Checks of shapes: exactly one per table, the right number of components, sizes that exist.

use super::values::Values;
use crate::scene::document::Place;
use crate::scene::error::SceneError;
use crate::scene::located::At;
use crate::scene::placing::{Placing, Rotation, Scale};
use crate::scene::shape::{AxisKeys, Shape, ShapeKeys};
use crate::scene::solid::{FluidSide, Solid};

const KEYS: &str = "box, sphere, cylinder, capsule, plane, polygon, mesh, union, difference";

pub fn solid(values: &Values<'_>, index: usize, solid: &At<Solid>) -> Result<(), SceneError> {
    let path = format!("solid.{index}");
    let shapes = solid.shapes();
    one_of(values, &path, solid.place, &shapes, &solid.placing())?;
    if let (Some(thickness), Some(FluidSide::Inside)) =
        (&solid.thickness, solid.fluid_side.map(|side| *side))
    {
        return Err(values.invalid(
            thickness.place,
            format!("solid `{}` is a sheet, with the fluid inside", *solid.name),
            "give fluid_side = \"outside\": the fluid is on both sides of a sheet, the material in it",
        ));
    }
    let plane = matches!(shapes[..], [Shape::Plane(_)]);
    match &solid.fluid_side {
        None if !plane => Err(values.invalid(
            solid.place,
            format!("solid `{}` lacks the key `fluid_side`", *solid.name),
            "add fluid_side = \"inside\" for a tank or \"outside\" for an obstacle",
        )),
        Some(side) if plane => Err(values.invalid(
            side.place,
            format!("solid `{}` is a plane and has no fluid_side", *solid.name),
            "remove the key: the fluid is on the side that the normal points to",
        )),
        _ => Ok(()),
    }
}

/// Exactly one shape, and that one in order.
pub fn one_of(
    values: &Values<'_>,
    path: &str,
    place: Place,
    shapes: &[Shape<'_>],
    placing: &Placing<'_>,
) -> Result<(), SceneError> {
    match shapes {
        [] => Err(values.invalid(
            place,
            format!("`{path}` has no shape"),
            &format!("give exactly one of {KEYS}"),
        )),
        [one] => {
            shape(values, path, one)?;
            placed(values, path, one, placing)
        }
        [first, second, ..] => Err(values.invalid(
            second.place(),
            format!("`{path}` has two shapes: {} and {}", first.key(), second.key()),
            "give exactly one, or combine several with union = [{ … }, { … }]",
        )),
    }
}

fn shape(values: &Values<'_>, path: &str, shape: &Shape<'_>) -> Result<(), SceneError> {
    let path = format!("{path}.{}", shape.key());
    dimension(values, shape)?;
    match shape {
        Shape::Box(keys) => values.corners(&path, &keys.min, &keys.max),
        Shape::Sphere(keys) => {
            values.components(&format!("{path}.center"), &keys.center)?;
            values.positive(&format!("{path}.radius"), &keys.radius, "in metres")
        }
        Shape::Cylinder(keys) | Shape::Capsule(keys) => axis(values, &path, keys),
        Shape::Plane(keys) => {
            values.components(&format!("{path}.point"), &keys.point)?;
            values.components(&format!("{path}.normal"), &keys.normal)?;
            if keys.normal.iter().all(|n| *n == 0.0) {
                let what = format!("`{path}.normal` has no direction");
                return Err(values.invalid(keys.normal.place, what, "for example [0, 1]"));
            }
            Ok(())
        }
        Shape::Polygon(points) => {
            if points.len() < 3 {
                let what = format!("`{path}` has {} corners", points.len());
                return Err(values.invalid(points.place, what, "a polygon has 3 or more"));
            }
            let check = |(index, point)| values.components(&format!("{path}.{index}"), point);
            points.iter().enumerate().try_for_each(check)
        }
        Shape::Mesh(_) => Ok(()),
        Shape::Union(shapes) => several(values, &path, shapes, 1),
        Shape::Difference(shapes) => several(values, &path, shapes, 2),
    }
}

/// Keys that scale, rotate and translate.
fn placed(
    values: &Values<'_>,
    path: &str,
    shape: &Shape<'_>,
    placing: &Placing<'_>,
) -> Result<(), SceneError> {
    let Placing { units, scale, rotate, translate, thickness, convex_hull } = placing;
    let only_for_meshes = [
        units.map(|key| ("units", key.place)),
        thickness.map(|key| ("thickness", key.place)),
        convex_hull.map(|key| ("convex_hull", key.place)),
    ];
    if let Some((key, place)) = only_for_meshes.into_iter().flatten().next()
        && !matches!(shape, Shape::Mesh(_))
    {
        let what = format!("`{path}.{key}` belongs to a mesh, and this is a {}", shape.key());
        return Err(values.invalid(place, what, "remove the key; `scale` suits every shape"));
    }
    if let (Some(thickness), Some(At { value: true, .. })) = (thickness, convex_hull) {
        let what = format!("`{path}` cannot have a thickness and be a convex hull");
        return Err(values.invalid(thickness.place, what, "remove one of the keys"));
    }
    if let Some(thickness) = thickness {
        values.positive(&format!("{path}.thickness"), thickness, "in metres")?;
    }
    if let Some(scale) = scale {
        let zero = match &scale.value {
            Scale::Uniform(factor) => *factor == 0.0,
            Scale::Axes(factors) => {
                values.length(&format!("{path}.scale"), scale.place, factors.len())?;
                factors.contains(&0.0)
            }
        };
        if zero {
            let what = format!("`{path}.scale` is 0");
            return Err(values.invalid(scale.place, what, "for example 0.001 for millimetres"));
        }
    }
    if let Some(rotate) = rotate {
        rotation(values, &format!("{path}.rotate"), rotate)?;
    }
    match translate {
        Some(translate) => values.components(&format!("{path}.translate"), translate),
        None => Ok(()),
    }
}

fn rotation(values: &Values<'_>, path: &str, rotate: &At<Rotation>) -> Result<(), SceneError> {
    match (values.scene.dimension(), &rotate.axis) {
        (2, None) => Ok(()),
        (2, Some(axis)) => Err(values.invalid(
            axis.place,
            format!("`{path}.axis` has no meaning in two dimensions"),
            "give the degrees alone: rotate = 30",
        )),
        (_, None) => Err(values.invalid(
            rotate.place,
            format!("`{path}` needs an axis in three dimensions"),
            "for example rotate = { axis = [0, 0, 1], degrees = 30 }",
        )),
        (_, Some(axis)) => {
            values.components(&format!("{path}.axis"), axis)?;
            if axis.iter().all(|x| *x == 0.0) {
                let what = format!("`{path}.axis` has no direction");
                return Err(values.invalid(axis.place, what, "for example [0, 0, 1]"));
            }
            Ok(())
        }
    }
}

fn axis(values: &Values<'_>, path: &str, keys: &AxisKeys) -> Result<(), SceneError> {
    values.components(&format!("{path}.from"), &keys.from)?;
    values.components(&format!("{path}.to"), &keys.to)?;
    values.positive(&format!("{path}.radius"), &keys.radius, "in metres")?;
    if *keys.from == *keys.to {
        let what = format!("`{path}` has no length: from and to are the same point");
        return Err(values.invalid(keys.to.place, what, "move one end, or use a sphere"));
    }
    Ok(())
}

fn several(
    values: &Values<'_>,
    path: &str,
    shapes: &At<Vec<At<ShapeKeys>>>,
    least: usize,
) -> Result<(), SceneError> {
    if shapes.len() < least {
        let what = format!("`{path}` has {} shapes, but needs {least} or more", shapes.len());
        return Err(values.invalid(
            shapes.place,
            what,
            "for example [{ box = … }, { sphere = … }]",
        ));
    }
    for (index, keys) in shapes.iter().enumerate() {
        one_of(values, &format!("{path}.{index}"), keys.place, &keys.shapes(), &keys.placing())?;
    }
    Ok(())
}

fn dimension(values: &Values<'_>, shape: &Shape<'_>) -> Result<(), SceneError> {
    let (needed, instead) = match shape {
        Shape::Mesh(_) => (3, "in two dimensions, use a polygon"),
        Shape::Polygon(_) => (2, "in three dimensions, use a mesh"),
        _ => return Ok(()),
    };
    let dimension = values.scene.dimension();
    if dimension == needed {
        return Ok(());
    }
    let what = format!(
        "a {} exists in {needed} dimensions only, but the scene has dimension = {dimension}",
        shape.key()
    );
    Err(values.invalid(shape.place(), what, instead))
}
