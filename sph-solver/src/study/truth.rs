//! What the runs of a study are compared with.

use super::error::StudyError;
use crate::csv_file::{self, Series};
use crate::run::columns;
use crate::scene::{Compare, ErrorKind, Reference, Scene, TimedFormula};

/// What is known of the flow, ready to be compared with.
#[derive(Debug, Clone, PartialEq)]
pub enum Truth {
    /// A field: the runs themselves have written their errors, in this column of `reference.csv`.
    Field(String),
    /// A formula in time.
    Formula(TimedFormula),
    /// Values over time.
    Values(Series),
    /// The run with the smallest spacing.
    Finest,
}

impl Truth {
    /// The reference of a scene.
    ///
    /// # Errors
    ///
    /// A file that cannot be used, or a column that no run writes; both with their place in the scene.
    pub fn of(scene: &Scene, reference: &Reference) -> Result<Self, StudyError> {
        if reference.velocity.is_some() || reference.pressure.is_some() {
            return Ok(Self::Field(field_column(reference)));
        }
        check_column(scene, reference)?;
        if let Some(formula) = &reference.formula {
            return Ok(Self::Formula(formula.value.clone()));
        }
        let Some(file) = &reference.file else { return Ok(Self::Finest) };
        let names = reference.file_columns.as_ref().and_then(|names| match &names.value[..] {
            [time, value] => Some([time.as_str(), value.as_str()]),
            _ => None,
        });
        let unit = |unit: Option<&crate::scene::At<f64>>| unit.map_or(1.0, |unit| **unit);
        let units = [unit(reference.time_unit.as_ref()), unit(reference.value_unit.as_ref())];
        let read = csv_file::read(&scene.resolve(file), names, units);
        Ok(Self::Values(read.map_err(|what| {
            let help =
                "a CSV file: remarks begin with #, then names of columns, then numbers".into();
            scene.error(file.place, ErrorKind::Invalid { what, help })
        })?))
    }
}

fn field_column(reference: &Reference) -> String {
    let quantity = match (&reference.pressure, reference.compare.as_deref()) {
        (Some(_), _) => "pressure",
        (None, Some(Compare::Speed)) => "speed",
        (None, _) => "velocity",
    };
    format!("{quantity}_{}", reference.norm.name())
}

fn check_column(scene: &Scene, reference: &Reference) -> Result<(), StudyError> {
    let (Some(table), Some(column)) = (&reference.table, &reference.column) else { return Ok(()) };
    let valid = match scene.dimension() {
        2 => columns::of_table::<2>(scene, table),
        _ => columns::of_table::<3>(scene, table),
    };
    if valid.contains(&column.as_str()) {
        return Ok(());
    }
    let kind = ErrorKind::UnknownChoice {
        key: "reference.column".into(),
        found: column.value.clone(),
        valid: valid.iter().map(ToString::to_string).collect(),
    };
    Err(scene.error(column.place, kind).into())
}
