//! Checks of `[[refine]]`.

use super::shapes;
use super::values::Values;
use crate::scene::error::{ErrorKind, SceneError};
use crate::scene::suggest::nearest;

/// How many times finer particles may be.
const FACTORS: [u32; 4] = [2, 4, 8, 16];

/// The most that spacings of neighbours may differ by. Beyond it, sums over neighbours of different sizes
/// are too wrong for water to stay at rest.
const LARGEST_GROWTH: f64 = 1.1;

pub fn check(values: &Values<'_>) -> Result<(), SceneError> {
    let scene = values.scene;
    for (index, refine) in scene.refine.iter().enumerate() {
        let path = format!("refine.{index}");
        if !FACTORS.contains(&refine.factor) {
            return Err(values.out_of_range(
                refine.factor.place,
                &format!("{path}.factor"),
                "2, 4, 8 or 16",
                *refine.factor,
                "cells are halved once, twice, three or four times; several [[refine]] may lie in \
                 each other",
            ));
        }
        if let Some(within) = &refine.within {
            values.not_negative(&format!("{path}.within"), within, "a distance in metres")?;
        }
        if let Some(growth) = &refine.growth {
            let help = "1.05 suits most scenes: the spacing doubles within 20 particles";
            let key = format!("{path}.growth");
            values.within(&key, growth, 1.01..=LARGEST_GROWTH, "between 1.01 and 1.1", help)?;
        }
        let shapes = refine.shapes();
        match (&refine.solid, shapes.first()) {
            (None, _) => {
                shapes::one_of(values, &path, refine.place, &shapes, &refine.placing())?;
            }
            (Some(solid), Some(shape)) => {
                return Err(values.invalid(
                    shape.place(),
                    format!("`{path}` has a shape and names solid `{}`", **solid),
                    "give one of the two, or a [[refine]] for each",
                ));
            }
            (Some(name), None) => {
                let names: Vec<&str> =
                    scene.solid.iter().map(|solid| solid.name.as_str()).collect();
                if !names.contains(&name.as_str()) {
                    let help = match nearest(name, names.iter().copied()) {
                        Some(near) => format!("did you mean `{near}`?"),
                        None => "name one of the solids of the scene".into(),
                    };
                    let what = format!("`{path}.solid` names `{}`, which is no solid", **name);
                    return Err(scene.error(name.place, ErrorKind::Invalid { what, help }));
                }
            }
        }
    }
    let mut jitter = scene.fluid.values().filter_map(|fluid| fluid.jitter.as_ref());
    match jitter.find(|jitter| ***jitter > 0.0) {
        Some(jitter) if !scene.refine.is_empty() => Err(values.invalid(
            jitter.place,
            "`jitter` shifts particles by parts of one spacing, and [[refine]] makes several"
                .into(),
            "remove one of them: particles of a refined scene are not on a lattice anyway",
        )),
        _ => Ok(()),
    }
}
