//! Checks of `[reference]`.

use super::values::Values;
use crate::scene::document::Place;
use crate::scene::error::{ErrorKind, SceneError};
use crate::scene::formula::{FormulaError, TimedFormula};
use crate::scene::located::At;
use crate::scene::reference::{Norm, Reference};

/// Exactly one source of truth, and all that it needs.
pub fn check(values: &Values<'_>, reference: &At<Reference>) -> Result<(), SceneError> {
    let sources = [
        ("velocity", reference.velocity.as_ref().map(|value| value.place)),
        ("pressure", reference.pressure.as_ref().map(|value| value.place)),
        ("formula", reference.formula.as_ref().map(|value| value.place)),
        ("file", reference.file.as_ref().map(|value| value.place)),
        ("finest", reference.finest.as_ref().filter(|yes| ***yes).map(|value| value.place)),
    ];
    let given: Vec<(&str, Place)> =
        sources.into_iter().filter_map(|(key, place)| Some((key, place?))).collect();
    match given[..] {
        [] => {
            let what = "the reference does not say what is known of the flow".into();
            let help = "give one of velocity, pressure (formulas in x, y, z, t), formula (in t), \
                        file (a CSV) or finest = true";
            return Err(values.invalid(reference.place, what, help));
        }
        [_] => (),
        [(first, _), (second, place), ..] => {
            let what = format!("the reference has two truths: `{first}` and `{second}`");
            return Err(values.invalid(place, what, "keep one of them"));
        }
    }
    if reference.velocity.is_some() || reference.pressure.is_some() {
        field(values, reference)?;
    } else {
        column(values, reference)?;
    }
    numbers(values, reference)
}

fn field(values: &Values<'_>, reference: &At<Reference>) -> Result<(), SceneError> {
    let dimension = values.scene.dimension();
    if let Some(velocity) = &reference.velocity {
        values.length("reference.velocity", velocity.place, velocity.len())?;
        for component in velocity.iter() {
            formula(values, component, TimedFormula::check_field(component, dimension))?;
        }
    }
    if let Some(pressure) = &reference.pressure {
        formula(values, pressure, TimedFormula::check_field(pressure, dimension))?;
        if let Some(compare) = &reference.compare {
            let what = "`reference.compare` is for a reference with a velocity".into();
            return Err(values.invalid(compare.place, what, "remove the key"));
        }
    }
    if matches!(*reference.norm, Norm::Mean | Norm::Last) {
        let what = format!("the norm {} is for columns of tables", reference.norm.name());
        return Err(values.invalid(reference.norm.place, what, "use l1, l2 or max"));
    }
    let not_for = [
        ("table", reference.table.as_ref().map(|value| value.place)),
        ("column", reference.column.as_ref().map(|value| value.place)),
        ("file_columns", reference.file_columns.as_ref().map(|value| value.place)),
        ("time_unit", reference.time_unit.as_ref().map(|value| value.place)),
        ("value_unit", reference.value_unit.as_ref().map(|value| value.place)),
    ];
    refuse(values, &not_for, "a field over the particles is compared, which has no")
}

fn column(values: &Values<'_>, reference: &At<Reference>) -> Result<(), SceneError> {
    let Some(table) = &reference.table else {
        let what = "the reference lacks the key `table`".into();
        let help = "the table of the run that is compared: energies, probe-NAME or solid-NAME";
        return Err(values.invalid(reference.place, what, help));
    };
    if reference.column.is_none() {
        let what = "the reference lacks the key `column`".into();
        return Err(values.invalid(reference.place, what, "for example column = \"kinetic\""));
    }
    known_table(values, table)?;
    if let Some(exact) = &reference.formula {
        formula(values, exact, exact.check_column())?;
    }
    if let Some(columns) = reference.file_columns.as_ref().filter(|columns| columns.len() != 2) {
        let what = format!("`reference.file_columns` has {} names", columns.len());
        return Err(values.invalid(columns.place, what, "give two: time and value"));
    }
    if values.scene.output.energies.is_none() && *reference.norm != Norm::Last {
        let what = "the tables of this scene have one row only".into();
        let help = "set output.energies, the seconds between two rows, or norm = \"last\"";
        return Err(values.invalid(table.place, what, help));
    }
    refuse(
        values,
        &[("compare", reference.compare.as_ref().map(|value| value.place))],
        "a column of a table is compared, which has no",
    )
}

/// Refuses a table that no run of the scene writes.
fn known_table(values: &Values<'_>, table: &At<String>) -> Result<(), SceneError> {
    let scene = values.scene;
    let probes = scene.probe.iter().map(|probe| format!("probe-{}", *probe.name));
    let solids = scene.solid.iter().map(|solid| format!("solid-{}", *solid.name));
    let valid: Vec<String> =
        std::iter::once("energies".to_owned()).chain(probes).chain(solids).collect();
    if valid.contains(table) {
        return Ok(());
    }
    let kind = ErrorKind::UnknownChoice {
        key: "reference.table".into(),
        found: table.value.clone(),
        valid,
    };
    Err(scene.error(table.place, kind))
}

fn numbers(values: &Values<'_>, reference: &At<Reference>) -> Result<(), SceneError> {
    for (key, number, help) in [
        ("time_unit", &reference.time_unit, "seconds per unit of the time column"),
        ("scale", &reference.scale, "errors are divided by it"),
        ("bar", &reference.bar, "the error that is good enough"),
        ("until", &reference.until, "in seconds"),
    ] {
        if let Some(number) = number {
            values.positive(&format!("reference.{key}"), number, help)?;
        }
    }
    if let Some(from) = &reference.from {
        values.not_negative("reference.from", from, "in seconds")?;
        let end = reference.until.map_or(*values.scene.end_time, |until| *until);
        if **from > end {
            let what = format!("`reference.from` is {}, after the last time {end}", **from);
            return Err(values.invalid(from.place, what, "the window would be empty"));
        }
    }
    Ok(())
}

fn refuse(
    values: &Values<'_>,
    keys: &[(&str, Option<Place>)],
    why: &str,
) -> Result<(), SceneError> {
    match keys.iter().find_map(|(key, place)| Some((key, (*place)?))) {
        Some((key, place)) => {
            Err(values.invalid(place, format!("{why} `{key}`"), "remove the key"))
        }
        None => Ok(()),
    }
}

fn formula(
    values: &Values<'_>,
    formula: &At<TimedFormula>,
    checked: Result<(), FormulaError>,
) -> Result<(), SceneError> {
    checked.map_err(|error| {
        let kind = ErrorKind::Formula {
            formula: formula.text().into(),
            reason: error.reason,
            help: error.help,
        };
        values.scene.error(formula.place, kind)
    })
}
