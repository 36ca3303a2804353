//! The checkpoints of a run in their folder: names by step, the newest, and the old ones.

use std::fs;
use std::ops::RangeBounds;
use std::path::{Path, PathBuf};

use super::{CheckpointFile, CheckpointInfo};
use crate::IoError;

const PREFIX: &str = "checkpoint-";
const SUFFIX: &str = ".vtkhdf";

/// File name of the checkpoint of a step: `checkpoint-000123.vtkhdf`.
#[must_use]
pub fn checkpoint_name(step: u64) -> String {
    format!("{PREFIX}{step:06}{SUFFIX}")
}

/// The newest whole checkpoint of a folder.
#[derive(Debug)]
#[non_exhaustive]
pub struct LatestCheckpoint {
    /// Where it lies.
    pub path: PathBuf,
    /// What it says of itself.
    pub info: CheckpointInfo,
    /// Newer ones that cannot be used, with the reason; worth a warning.
    pub skipped: Vec<IoError>,
}

/// Finds the newest whole checkpoint in a folder; `None` when there is no checkpoint.
///
/// # Errors
///
/// [`IoError::Read`] when the folder cannot be listed; the reason of the newest one when there
/// are checkpoints but none can be used.
pub fn latest_checkpoint(folder: impl AsRef<Path>) -> Result<Option<LatestCheckpoint>, IoError> {
    let mut skipped = Vec::new();
    for (_, path) in list(folder.as_ref())?.into_iter().rev() {
        match CheckpointFile::open(&path) {
            Ok(file) => {
                return Ok(Some(LatestCheckpoint { path, info: file.info().clone(), skipped }));
            }
            Err(error) => skipped.push(error),
        }
    }
    match skipped.into_iter().next() {
        Some(newest) => Err(newest),
        None => Ok(None),
    }
}

/// Removes all but the `keep` newest checkpoints of a folder, and returns how many.
///
/// The newest one always stays.
///
/// # Errors
///
/// [`IoError::Read`] when the folder cannot be listed, [`IoError::Write`] when a file cannot be
/// removed.
pub fn prune_checkpoints(folder: impl AsRef<Path>, keep: usize) -> Result<usize, IoError> {
    let files = list(folder.as_ref())?;
    let old = files.len().saturating_sub(keep.max(1));
    remove(&files[..old])
}

/// Removes the checkpoints of some steps: `..` before a run starts anew, `step + 1..` when it
/// goes on from an earlier step. Returns how many.
///
/// # Errors
///
/// As [`prune_checkpoints`].
pub fn remove_checkpoints(
    folder: impl AsRef<Path>,
    steps: impl RangeBounds<u64>,
) -> Result<usize, IoError> {
    let mut files = list(folder.as_ref())?;
    files.retain(|(step, _)| steps.contains(step));
    remove(&files)
}

fn remove(files: &[(u64, PathBuf)]) -> Result<usize, IoError> {
    for (_, path) in files {
        fs::remove_file(path).map_err(IoError::write(path))?;
    }
    Ok(files.len())
}

/// Steps and paths, oldest first.
fn list(folder: &Path) -> Result<Vec<(u64, PathBuf)>, IoError> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).map_err(IoError::read(folder))? {
        let path = entry.map_err(IoError::read(folder))?.path();
        let step = path.file_name().and_then(|name| {
            let digits = name.to_str()?.strip_prefix(PREFIX)?.strip_suffix(SUFFIX)?;
            digits.bytes().all(|b| b.is_ascii_digit()).then(|| digits.parse().ok())?
        });
        files.extend(step.map(|step| (step, path)));
    }
    files.sort_unstable();
    Ok(files)
}
