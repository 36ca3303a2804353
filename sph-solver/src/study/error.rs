//! Why a study fails.

use crate::scene::SceneError;
use sph_io::IoError;
use std::path::PathBuf;

/// Why a study fails as a whole. A run that fails is a row of the study.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// The scene is wrong, or one of the values that it is run with.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A study needs something that was not asked for.
    #[error("{what}; {help}")]
    Request {
        /// What is wrong.
        what: String,
        /// What to do.
        help: String,
    },
    /// The folder holds runs of other settings.
    #[error(
        "{} is a run with other settings:\n{difference}\nchoose another folder with --out, or use \
         --overwrite",
        path.display()
    )]
    OtherSettings {
        /// The record of the run.
        path: PathBuf,
        /// Lines that differ.
        difference: String,
    },
    /// A run that cannot be.
    #[error("the run {name} was refused: {message}; leave its values out of --over")]
    Refused {
        /// Name of the run.
        name: String,
        /// What it said.
        message: String,
    },
    /// A run that failed for another reason than its flow.
    #[error(
        "the run {name} failed: {message}; the same command goes on with the runs that are missing"
    )]
    Failed {
        /// Name of the run.
        name: String,
        /// What it said.
        message: String,
    },
    /// A run that was ended from outside.
    #[error("the run {name} was killed; the same command goes on with the runs that are missing")]
    Killed {
        /// Name of the run.
        name: String,
    },
    /// A file of the study.
    #[error(transparent)]
    File(#[from] IoError),
    /// A folder or file that the system refuses.
    #[error("{}: {source}", path.display())]
    System {
        /// What.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A run cannot be started at all.
    #[error("cannot start {}: {source}", program.display())]
    Start {
        /// The program.
        program: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// Asked to end.
    #[error("ended by a signal; the same command goes on with the runs that are missing")]
    Stopped,
}
