//! The folder that a run leaves.

use crate::run::Run;
use crate::running::Outcome;
use crate::series::{Entry, read_series};
use crate::table::{Table, read_table};
use crate::whole::files;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Results of a run in a scratch folder, removed with this value.
#[derive(Debug)]
pub struct Results {
    folder: TempDir,
}

impl Results {
    /// No results yet; the folder of the results does not exist, only its parent.
    ///
    /// # Panics
    ///
    /// When the system has no place for scratch folders.
    #[allow(clippy::new_without_default, reason = "it makes a folder")]
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().expect("a scratch folder") }
    }

    /// Results of a run that succeeds.
    ///
    /// # Panics
    ///
    /// With the message of the program when it fails.
    #[track_caller]
    pub fn of(run: Run) -> Self {
        let results = Self::new();
        results.add(run);
        results
    }

    /// Runs once more into the same folder and asserts success.
    ///
    /// # Panics
    ///
    /// With the message of the program when it fails.
    #[track_caller]
    pub fn add(&self, run: Run) -> Outcome {
        run.out(self.path()).succeed()
    }

    /// A copy of these results.
    ///
    /// # Panics
    ///
    /// When it cannot be made.
    pub fn copy(&self) -> Self {
        let copy = Self::new();
        copy_folder(&self.path(), &copy.path());
        copy
    }

    /// The folder.
    pub fn path(&self) -> PathBuf {
        self.folder.path().join("results")
    }

    /// `summary.json`.
    ///
    /// # Panics
    ///
    /// When it is not there or no JSON.
    #[track_caller]
    pub fn summary(&self) -> Value {
        let path = self.path().join("summary.json");
        let text = fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error} in\n{text}"))
    }

    /// `state_digest` of the summary.
    ///
    /// # Panics
    ///
    /// When it is missing.
    #[track_caller]
    pub fn digest(&self) -> String {
        let summary = self.summary();
        let digest = summary["state_digest"].as_str();
        digest.unwrap_or_else(|| panic!("no state_digest in {summary:#}")).into()
    }

    /// The table `NAME.csv`.
    ///
    /// # Panics
    ///
    /// When it is not whole.
    #[track_caller]
    pub fn table(&self, name: &str) -> Table {
        read_table(&self.path().join(format!("{name}.csv")))
    }

    /// The files whose names end in `ending`, in the order of their names.
    pub fn files(&self, ending: &str) -> Vec<PathBuf> {
        let ends = |path: &PathBuf| path.to_string_lossy().ends_with(ending);
        files(&self.path()).into_iter().filter(ends).collect()
    }

    /// The entries of the only `.pvd` index.
    ///
    /// # Panics
    ///
    /// When there is not exactly one, or it is not whole.
    #[track_caller]
    pub fn series(&self) -> Vec<Entry> {
        let indices = self.files(".pvd");
        assert_eq!(indices.len(), 1, "{indices:?}");
        read_series(&indices[0])
    }

    /// Names and bytes of all files.
    ///
    /// # Panics
    ///
    /// When one cannot be read.
    pub fn contents(&self) -> Vec<(PathBuf, Vec<u8>)> {
        let read = |path: PathBuf| fs::read(&path).map(|bytes| (path, bytes));
        files(&self.path()).into_iter().map(read).collect::<Result<_, _>>().expect("readable files")
    }
}

/// Copies the files of a folder; a folder that does not exist is copied as none.
///
/// # Panics
///
/// When the copy cannot be made.
pub fn copy_folder(from: &Path, to: &Path) {
    if !from.exists() {
        return;
    }
    fs::create_dir_all(to).expect("a new folder");
    for path in files(from) {
        let name = path.file_name().expect("a file name");
        fs::copy(&path, to.join(name)).expect("a copy");
    }
}
