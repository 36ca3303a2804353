//! Columns of the tables of a run, before there is one.

use super::files::{energy_columns, solid_columns};
use super::launch::probe;
use crate::scene::Scene;

/// Names of the columns of `table` (energies, probe-NAME or solid-NAME), without the time. None when a
/// run of the scene has no such table.
pub fn of_table<const D: usize>(scene: &Scene, table: &str) -> Vec<&'static str> {
    let names = |columns: Vec<(&'static str, &'static str)>| {
        columns.into_iter().map(|(name, _)| name).collect()
    };
    if table == "energies" {
        return names(energy_columns(D, scene.output.energy_budget));
    }
    let named = |prefix: &str| table.strip_prefix(prefix);
    let of_name = |name: &str| scene.probe.iter().find(|probe| probe.name.as_str() == name);
    if let Some(one) = named("probe-").and_then(of_name) {
        return names(probe::<D>(one, *scene.numerics.spacing).columns());
    }
    let of_name = |name: &str| scene.solid.iter().find(|solid| solid.name.as_str() == name);
    match named("solid-").and_then(of_name) {
        Some(solid) => names(solid_columns(D, solid.moves())),
        None => Vec::new(),
    }
}
