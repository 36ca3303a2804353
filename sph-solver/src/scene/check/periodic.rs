//! `periodic`: axes along which the domain repeats.

use super::values::Values;
use crate::scene::error::SceneError;

/// Checks that the axes exist, are named once, and have a domain to repeat.
pub fn check(values: &Values<'_>) -> Result<(), SceneError> {
    let scene = values.scene;
    for (index, axis) in scene.periodic.iter().enumerate() {
        let name = ["x", "y", "z"][axis.index()];
        if axis.index() >= scene.dimension() {
            let what = format!("there is no axis {name} in {} dimensions", scene.dimension());
            return Err(values.invalid(axis.place, what, "leave it out"));
        }
        if scene.periodic[..index].iter().any(|earlier| earlier.value == axis.value) {
            let what = format!("the axis {name} is named twice");
            return Err(values.invalid(axis.place, what, "name it once"));
        }
    }
    if !scene.periodic.is_empty() && scene.domain.is_none() {
        return Err(values.invalid(
            scene.periodic.place,
            "a periodic scene needs a domain that repeats".into(),
            "add a table [domain] with min and max, a whole number of spacings apart along the \
             periodic axes",
        ));
    }
    Ok(())
}
