//! How a run of a study ended, as it is kept between studies.

use super::error::StudyError;
use super::identity;
use super::plan::Case;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// How a run ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "outcome")]
pub enum Outcome {
    /// At its end time.
    Finished,
    /// With an error: most often, the flow blew up.
    Diverged {
        /// What the run said.
        message: String,
    },
    /// At the limit of wall-clock time that the study allows.
    OutOfTime,
}

/// A run that is over.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// All that determines the result, a line each.
    pub settings: String,
    /// How it ended.
    #[serde(flatten)]
    pub outcome: Outcome,
}

/// Where the record of a run lies.
fn path(study: &Path, case: &Case) -> PathBuf {
    study.join("runs").join(format!("{}.json", case.name))
}

impl Record {
    /// The record of a run of the same settings, if it is over.
    ///
    /// # Errors
    ///
    /// A record of other settings, which `overwrite` forgets.
    pub fn find(study: &Path, case: &Case, overwrite: bool) -> Result<Option<Self>, StudyError> {
        let path = path(study, case);
        if overwrite {
            return match std::fs::remove_file(&path) {
                Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
                    Err(StudyError::System { path, source })
                }
                _ => Ok(None),
            };
        }
        let Ok(text) = std::fs::read_to_string(&path) else { return Ok(None) };
        // A file that is no record is none.
        let Ok(record) = serde_json::from_str::<Self>(&text) else { return Ok(None) };
        if record.settings != case.identity {
            let difference = identity::difference(&case.identity, &record.settings);
            return Err(StudyError::OtherSettings { path, difference });
        }
        Ok(Some(record))
    }

    /// Keeps how a run ended.
    pub fn keep(study: &Path, case: &Case, outcome: Outcome) -> Result<(), StudyError> {
        let record = Self { settings: case.identity.clone(), outcome };
        let text = serde_json::to_string_pretty(&record).unwrap_or_default() + "\n";
        Ok(sph_io::write_text_atomically(path(study, case), &text)?)
    }
}
