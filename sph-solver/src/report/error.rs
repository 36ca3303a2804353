//! Why there is no report.

use std::path::PathBuf;

/// An error of a report, in the user's terms.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The folder does not exist or cannot be read.
    #[error("cannot read the folder {}: {source}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// Nothing in the folder is of a run.
    #[error(
        "{} holds no results of a run: none of run.json, summary.json, energies.csv and NAME.pvd is \
         there. Give the folder that `sph run` names at its end", path.display()
    )]
    NoRun {
        /// The folder.
        path: PathBuf,
    },
    /// No folder was given.
    #[error("name at least one folder with results of `sph run`")]
    NoFolder,
    /// The texts of the runs alone are too long for a page.
    #[error("the page has {bytes} bytes even without pictures: compare fewer runs at a time")]
    TooLong {
        /// Bytes of the page.
        bytes: usize,
    },
}
