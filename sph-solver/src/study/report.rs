//! All that a study has found, and its files.

use super::curve::{Curve, curves};
use super::error::StudyError;
use super::measure::Figure;
use super::outcome::Outcome;
use super::plan::Plan;
use super::plot::work_precision;
use crate::scene::{Compare, Reference};
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;

/// A run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Name of its folder.
    pub name: String,
    /// Values that are varied, besides spacing and seed.
    pub settings: Vec<(String, String)>,
    /// Initial particle distance, m.
    pub spacing: f64,
    /// Seed of the jitter.
    pub seed: Option<u64>,
    /// How it ended.
    #[serde(flatten)]
    pub outcome: Outcome,
    /// Error.
    pub error: Option<f64>,
    /// CPU seconds of all threads in the steps.
    pub core_seconds: Option<f64>,
    /// Fluid particles.
    pub particles: Option<u64>,
    /// Steps.
    pub steps: Option<u64>,
    /// Why there is no error.
    pub remark: Option<String>,
}

/// A study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Name of the scene.
    pub scene: String,
    /// What the error is.
    pub title: String,
    /// The error that is good enough.
    pub bar: Option<f64>,
    /// What the scene says about its result.
    pub remark: Option<String>,
    /// Version of the program.
    pub version: &'static str,
    /// Runs.
    pub rows: Vec<Row>,
    /// Runs put together.
    pub curves: Vec<Curve>,
}

/// Errors whose cost is told when nobody asks for others.
const TARGETS: [f64; 3] = [0.05, 0.02, 0.01];

impl Report {
    /// Puts the figures of a plan together; `targets` are errors whose cost is told.
    pub fn new(plan: &Plan, reference: &Reference, figures: &[Figure], targets: &[f64]) -> Self {
        let bar = reference.bar.map(|bar| *bar);
        let targets: Vec<f64> = match (targets, bar) {
            ([], Some(bar)) => vec![bar],
            ([], None) => TARGETS.to_vec(),
            (targets, _) => targets.to_vec(),
        };
        let rows = plan.cases.iter().zip(figures).map(|(case, figure)| Row {
            name: case.name.clone(),
            settings: case.settings.clone(),
            spacing: case.spacing,
            seed: case.seed,
            outcome: figure.outcome.clone(),
            error: figure.error,
            core_seconds: figure.core_seconds,
            particles: figure.particles,
            steps: figure.steps,
            remark: figure.remark.clone(),
        });
        Self {
            scene: plan.scene.name().to_owned(),
            title: title(reference),
            bar,
            remark: reference.remark.as_ref().map(|remark| remark.value.clone()),
            version: env!("CARGO_PKG_VERSION"),
            rows: rows.collect(),
            curves: curves(&plan.cases, figures, &targets),
        }
    }

    /// `study.csv`: a row per run.
    pub fn csv(&self) -> String {
        let keys: Vec<&str> = self
            .rows
            .first()
            .map_or(vec![], |row| row.settings.iter().map(|(key, _)| key.as_str()).collect());
        let mut text = "run".to_owned();
        keys.iter().for_each(|key| text += &format!(",{key}"));
        text += ",spacing [m],seed,outcome,error [1],core_seconds [s],particles,steps\n";
        for row in &self.rows {
            let outcome = match row.outcome {
                Outcome::Finished => "finished",
                Outcome::Diverged { .. } => "diverged",
                Outcome::OutOfTime => "out-of-time",
            };
            let mut cells = vec![quoted(&row.name)];
            cells.extend(row.settings.iter().map(|(_, value)| quoted(value)));
            cells.extend([
                row.spacing.to_string(),
                cell(row.seed),
                outcome.to_owned(),
                cell(row.error),
                cell(row.core_seconds),
                cell(row.particles),
                cell(row.steps),
            ]);
            let _ = writeln!(text, "{}", cells.join(","));
        }
        text
    }
}

/// Writes `study.csv`, `study.json` and `work-precision.svg` into the folder of a study.
///
/// # Errors
///
/// Files that cannot be written.
pub fn write(report: &Report, study: &Path) -> Result<(), StudyError> {
    let json = serde_json::to_string_pretty(report).unwrap_or_default() + "\n";
    sph_io::write_text_atomically(study.join("study.csv"), &report.csv())?;
    sph_io::write_text_atomically(study.join("study.json"), &json)?;
    sph_io::write_text_atomically(study.join("work-precision.svg"), &work_precision(report))?;
    Ok(())
}

/// What the error of a reference is, in words.
fn title(reference: &Reference) -> String {
    if let Some(title) = &reference.title {
        return title.value.clone();
    }
    let norm = reference.norm.name();
    match (&reference.pressure, &reference.column, &reference.table) {
        (Some(_), ..) => format!("{norm} error of the pressure"),
        (None, Some(column), Some(table)) => {
            format!("{norm} error of {} of {}", **column, **table)
        }
        _ => match reference.compare.as_deref() {
            Some(Compare::Speed) => format!("{norm} error of the speed"),
            _ => format!("{norm} error of the velocity"),
        },
    }
}

fn cell<T: ToString>(value: Option<T>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

fn quoted(text: &str) -> String {
    if text.contains([',', '"']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.into()
    }
}
