//! The figures of a run: its error, and what it cost.

use super::norms;
use super::outcome::Outcome;
use super::plan::{Case, Plan};
use super::truth::Truth;
use crate::csv_file::{Series, between};
use crate::scene::{Norm, Reference};
use serde_json::Value;
use sph_io::read_table;
use std::path::Path;

/// What a run of a study gave.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// How it ended.
    pub outcome: Outcome,
    /// Its error; absent for a run that did not reach its end, and for the finest run of a study that is
    /// its own reference.
    pub error: Option<f64>,
    /// Why there is no error, or what else is to be said.
    pub remark: Option<String>,
    /// CPU seconds of all threads in the steps.
    pub core_seconds: Option<f64>,
    /// Fluid particles.
    pub particles: Option<u64>,
    /// Steps.
    pub steps: Option<u64>,
}

/// Figures of all runs of a plan, in its order.
pub fn figures(
    plan: &Plan,
    study: &Path,
    reference: &Reference,
    truth: &Truth,
    outcomes: &[Outcome],
) -> Vec<Figure> {
    let runs = plan.cases.iter().zip(outcomes);
    runs.map(|(case, outcome)| {
        let summary = summary(&case.folder(study));
        let number = |path: &[&str]| {
            path.iter().try_fold(&summary, |value, key| value.get(key)).and_then(Value::as_f64)
        };
        let mut figure = Figure {
            outcome: outcome.clone(),
            error: None,
            remark: None,
            core_seconds: number(&["core_seconds"]),
            particles: number(&["particles", "fluid"]).map(|count| count as u64),
            steps: number(&["steps"]).map(|count| count as u64),
        };
        match outcome {
            Outcome::Finished => match error_of(plan, study, reference, truth, case, outcomes) {
                Ok(error) => figure.error = error,
                Err(reason) => figure.remark = Some(reason),
            },
            Outcome::Diverged { message } => figure.remark = Some(message.clone()),
            Outcome::OutOfTime => figure.remark = Some("it took too long (--max-wall)".into()),
        }
        figure
    })
    .collect()
}

fn summary(folder: &Path) -> Value {
    let text = std::fs::read_to_string(folder.join("summary.json")).unwrap_or_default();
    serde_json::from_str(&text).unwrap_or(Value::Null)
}

/// The error of a finished run; none for the run that is the reference of the others.
fn error_of(
    plan: &Plan,
    study: &Path,
    reference: &Reference,
    truth: &Truth,
    case: &Case,
    outcomes: &[Outcome],
) -> Result<Option<f64>, String> {
    let folder = case.folder(study);
    let (table, column) = match truth {
        Truth::Field(column) => ("reference", column.as_str()),
        _ => (
            reference.table.as_ref().map_or("", |table| table.as_str()),
            reference.column.as_ref().map_or("", |column| column.as_str()),
        ),
    };
    let series = read(&folder, table, column)?;
    let from = reference.from.map(|from| *from);
    let until = reference.until.map_or(f64::INFINITY, |until| *until);
    let error = match truth {
        Truth::Field(_) => field_error(&series, from, until),
        _ => {
            let start = series.first().map_or(f64::NAN, |(_, value)| *value);
            let finest = match truth {
                Truth::Finest => match finest_of(plan, case, outcomes) {
                    Some(finest) if finest.name == case.name => return Ok(None),
                    Some(finest) => read(&finest.folder(study), table, column)?,
                    None => Vec::new(),
                },
                _ => Vec::new(),
            };
            let known = |time: f64| match truth {
                Truth::Formula(formula) => Some(formula.of_column(time, start)),
                Truth::Values(values) => between(values, time),
                _ => between(&finest, time),
            };
            let begin = from.unwrap_or(f64::NEG_INFINITY);
            let window = series.iter().filter(|(time, _)| (begin..=until).contains(time));
            let pairs = window.filter_map(|&(time, value)| Some((value, known(time)?)));
            let pairs: Vec<(f64, f64)> = pairs.collect();
            // A run stops a step after the last time of its reference.
            if *reference.norm == Norm::Last
                && matches!(truth, Truth::Values(_))
                && pairs.is_empty()
            {
                return Err("the reference ends before the run".into());
            }
            norms::error(&pairs, *reference.norm, reference.scale.map(|scale| *scale))
        }
    };
    if error.is_finite() {
        Ok(Some(error))
    } else {
        Err(format!("the error cannot be measured: {column} of {table}.csv gives {error}"))
    }
}

/// The error that the run has written: its last one, or the mean over the window.
fn field_error(series: &Series, from: Option<f64>, until: f64) -> f64 {
    let mut within = series.iter().filter(|(time, _)| *time <= until);
    let Some(from) = from else {
        return within.next_back().map_or(f64::NAN, |(_, error)| *error);
    };
    let errors: Vec<f64> =
        within.filter(|(time, _)| *time >= from).map(|(_, error)| *error).collect();
    errors.iter().sum::<f64>() / errors.len() as f64
}

/// The finished run with the smallest spacing among those that differ from a case in nothing else but
/// the seed, of which it has the same if it can.
fn finest_of<'a>(plan: &'a Plan, case: &Case, outcomes: &[Outcome]) -> Option<&'a Case> {
    let alike = plan.cases.iter().zip(outcomes).filter(|(other, outcome)| {
        **outcome == Outcome::Finished && other.settings == case.settings
    });
    alike.map(|(other, _)| other).min_by(|a, b| {
        let other_seed = |one: &Case| one.seed != case.seed;
        a.spacing.total_cmp(&b.spacing).then(other_seed(a).cmp(&other_seed(b)))
    })
}

/// Times and values of a column, without empty cells.
fn read(folder: &Path, table: &str, column: &str) -> Result<Series, String> {
    let path = folder.join(format!("{table}.csv"));
    let table = read_table(&path).map_err(|error| error.to_string())?;
    let values =
        table.column(column).ok_or_else(|| format!("{} has no column {column}", path.display()))?;
    let times = table.rows.iter().map(|row| row[0]);
    Ok(times.zip(values).filter(|(_, value)| !value.is_nan()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_field_counts_at_the_end_or_over_a_window() {
        let series = vec![(0.0, 1.0), (1.0, 2.0), (2.0, 4.0), (3.0, 8.0)];
        assert_eq!(field_error(&series, None, f64::INFINITY), 8.0);
        assert_eq!(field_error(&series, None, 2.5), 4.0);
        assert_eq!(field_error(&series, Some(1.0), 2.0), 3.0);
        assert!(field_error(&series, Some(9.0), 9.0).is_nan());
    }
}
