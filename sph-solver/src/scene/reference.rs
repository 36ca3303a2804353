//! `[reference]`: what is known about the flow; `[study]`: what a study of the scene varies.

use super::formula::TimedFormula;
use super::located::At;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// What is known about the flow: exactly one of `velocity`, `pressure`, `formula`, `file`, `finest`.
/// `sph study` measures errors by it; with a field, `sph run` writes them to `reference.csv`.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Reference {
    /// Exact velocity, m/s, compared over all fluid particles: one formula in x, y, z, t per component.
    pub velocity: Option<At<Vec<At<TimedFormula>>>>,
    /// Exact pressure, Pa, compared over all fluid particles: a formula in x, y, z, t.
    pub pressure: Option<At<TimedFormula>>,
    /// What is compared when a velocity is given. Absent: the velocity as a vector.
    pub compare: Option<At<Compare>>,
    /// Exact value of the `column` of a `table`: a formula in t (s) and start, its first value.
    pub formula: Option<At<TimedFormula>>,
    /// A CSV file with values of the `column` of a `table` over time, relative to the folder of the
    /// scene. Lines that begin with # are remarks, the first other line names the columns.
    pub file: Option<At<PathBuf>>,
    /// Names of the columns of `file`: time and value. The first two when absent.
    pub file_columns: Option<At<Vec<At<String>>>>,
    /// Seconds per unit of the time column of `file`.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub time_unit: Option<At<f64>>,
    /// SI units per unit of the value column of `file`.
    pub value_unit: Option<At<f64>>,
    /// True: the `column` of the `table` in the run with the smallest spacing of the study is the
    /// reference (self-convergence).
    pub finest: Option<At<bool>>,
    /// Table of the run, without .csv: energies, probe-NAME or solid-NAME.
    pub table: Option<At<String>>,
    /// Column of the table.
    pub column: Option<At<String>>,
    /// How differences become one number.
    #[serde(default)]
    pub norm: At<Norm>,
    /// What errors are divided by, in the unit of what is compared. When absent, the same norm of the
    /// reference.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub scale: Option<At<f64>>,
    /// Earliest time that counts, s. For fields it is the end of the run when absent, for columns its
    /// beginning.
    #[schemars(extend("minimum" = 0))]
    pub from: Option<At<f64>>,
    /// Latest time that counts, s. The end of the run when absent.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub until: Option<At<f64>>,
    /// The error that is good enough.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub bar: Option<At<f64>>,
    /// What the error is, for tables.
    pub title: Option<At<String>>,
    /// What is to be said of the result, for tables: such as why it misses its bar.
    pub remark: Option<At<String>>,
}

/// What is compared of a velocity.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Compare {
    /// The vector.
    #[default]
    Velocity,
    /// Its length.
    Speed,
}

/// How differences become one number.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Norm {
    /// Mean of magnitudes.
    L1,
    /// Root of the mean square.
    #[default]
    L2,
    /// Largest magnitude.
    Max,
    /// Magnitude of the mean: what oscillates cancels. For columns only.
    Mean,
    /// Magnitude of the last difference. For columns only.
    Last,
}

impl Norm {
    /// The word of scenes for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::L1 => "l1",
            Self::L2 => "l2",
            Self::Max => "max",
            Self::Mean => "mean",
            Self::Last => "last",
        }
    }
}

/// What a study of the scene varies, unless the command line says otherwise.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StudyKeys {
    /// Keys with their values, such as "numerics.spacing=0.04,0.02,0.01". Every combination is run.
    #[serde(default)]
    pub over: Vec<At<String>>,
    /// Seeds of the jitter of the fluid; the rest is run with each of them.
    #[serde(default)]
    pub seeds: Vec<At<u64>>,
}
