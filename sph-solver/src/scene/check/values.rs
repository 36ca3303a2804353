//! Checks of single values.

use crate::scene::document::Place;
use crate::scene::error::{ErrorKind, SceneError};
use crate::scene::located::At;
use crate::scene::root::Scene;
use std::fmt::Display;
use std::ops::RangeInclusive;

/// Checks values of a scene.
pub struct Values<'a> {
    pub scene: &'a Scene,
}

impl Values<'_> {
    pub fn out_of_range(
        &self,
        place: Place,
        key: &str,
        range: &'static str,
        found: impl Display,
        help: &str,
    ) -> SceneError {
        let kind = ErrorKind::OutOfRange {
            key: key.into(),
            range,
            found: found.to_string(),
            help: help.into(),
        };
        self.scene.error(place, kind)
    }

    pub fn invalid(&self, place: Place, what: String, help: &str) -> SceneError {
        self.scene.error(place, ErrorKind::Invalid { what, help: help.into() })
    }

    pub fn positive(&self, key: &str, value: &At<f64>, help: &str) -> Result<(), SceneError> {
        if **value > 0.0 {
            return Ok(());
        }
        Err(self.out_of_range(value.place, key, "positive", **value, help))
    }

    pub fn not_negative(&self, key: &str, value: &At<f64>, help: &str) -> Result<(), SceneError> {
        if **value >= 0.0 {
            return Ok(());
        }
        Err(self.out_of_range(value.place, key, "0 or more", **value, help))
    }

    pub fn within(
        &self,
        key: &str,
        value: &At<f64>,
        allowed: RangeInclusive<f64>,
        range: &'static str,
        help: &str,
    ) -> Result<(), SceneError> {
        if allowed.contains(&**value) {
            return Ok(());
        }
        Err(self.out_of_range(value.place, key, range, **value, help))
    }

    /// One number per dimension.
    pub fn length(&self, key: &str, place: Place, found: usize) -> Result<(), SceneError> {
        let dimension = self.scene.dimension();
        if found == dimension {
            return Ok(());
        }
        Err(self.scene.error(place, ErrorKind::Components { key: key.into(), found, dimension }))
    }

    pub fn components(&self, key: &str, vector: &At<Vec<f64>>) -> Result<(), SceneError> {
        self.length(key, vector.place, vector.len())
    }

    /// Two opposite corners of a box.
    pub fn corners(
        &self,
        key: &str,
        min: &At<Vec<f64>>,
        max: &At<Vec<f64>>,
    ) -> Result<(), SceneError> {
        self.components(&format!("{key}.min"), min)?;
        self.components(&format!("{key}.max"), max)?;
        for (axis, (low, high)) in min.iter().zip(max.iter()).enumerate() {
            if low >= high {
                let axis = ["x", "y", "z"][axis];
                let what = format!("`{key}` is empty along {axis}: min is {low}, max is {high}");
                return Err(self.invalid(max.place, what, "every max must be larger than its min"));
            }
        }
        Ok(())
    }

    /// A name that can be part of a file name everywhere.
    pub fn file_name(&self, key: &str, name: &At<String>) -> Result<(), SceneError> {
        let fits = |c: char| c.is_alphanumeric() || "-_. +".contains(c);
        if !name.trim().is_empty() && !name.starts_with('.') && name.chars().all(fits) {
            return Ok(());
        }
        let what = format!("`{key}` cannot be {:?}: files are named after it", **name);
        Err(self.invalid(name.place, what, "use letters, digits, - and _"))
    }

    /// Any name at all.
    pub fn name(&self, key: &str, name: &At<String>) -> Result<(), SceneError> {
        if !name.trim().is_empty() {
            return Ok(());
        }
        Err(self.invalid(name.place, format!("`{key}` is empty"), "give it a name of its own"))
    }

    /// Adds a name to those seen.
    pub fn unique(
        &self,
        what: &str,
        name: &At<String>,
        seen: &mut Vec<String>,
    ) -> Result<(), SceneError> {
        if seen.contains(name) {
            let message = format!("there are two {what}s with the name `{}`", **name);
            return Err(self.invalid(name.place, message, "give each a name of its own"));
        }
        seen.push(name.value.clone());
        Ok(())
    }
}
