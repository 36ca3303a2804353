//! What a run does besides stepping: until when, and what it writes.

use super::samples::Probe;
use std::path::PathBuf;

/// Outputs of a run.
#[derive(Debug, Clone)]
pub struct RunPlan<const D: usize> {
    /// Name of the scene; files are named after it.
    pub name: String,
    /// The scene as text, kept in checkpoints.
    pub scene_text: String,
    /// Everything that determines the bits of the result. A run continues only a checkpoint with
    /// the same.
    pub fingerprint: String,
    /// Folder for all files.
    pub out: PathBuf,
    /// Time at which the run ends, s.
    pub end_time: f64,
    /// Seconds between snapshots.
    pub snapshots: Option<f64>,
    /// Seconds between rows of the tables.
    pub samples: Option<f64>,
    /// Seconds between checkpoints.
    pub checkpoints: Option<f64>,
    /// Named probes.
    pub probes: Vec<(String, Probe<D>)>,
    /// Whether to continue from the latest checkpoint in `out`.
    pub resume: bool,
}
