//! What a run does besides stepping: until when, and what it writes.

use super::identity::Identity;
use super::notes::Notes;
use super::record::Record;
use super::reference::FieldReference;
use super::samples::Probe;
use super::snapshot_choice::SnapshotChoice;
use super::stop::Stop;
use std::path::PathBuf;

/// Outputs of a run.
#[derive(Debug, Clone)]
pub struct RunPlan<const D: usize> {
    /// Name of the scene; files are named after it.
    pub name: String,
    /// The scene as text, kept in checkpoints.
    pub scene_text: String,
    /// What a run that goes on from a checkpoint must share with it, and what it may change.
    pub identity: Identity,
    /// What was asked for.
    pub record: Record,
    /// Folder for all files.
    pub out: PathBuf,
    /// Time at which the run ends, s.
    pub end_time: f64,
    /// Seconds between snapshots.
    pub snapshots: Option<f64>,
    /// What snapshots hold.
    pub snapshot_choice: SnapshotChoice,
    /// Seconds between rows of the tables.
    pub samples: Option<f64>,
    /// Seconds between checkpoints.
    pub checkpoints: Option<f64>,
    /// Whether the tables have an energy budget.
    pub energy_budget: bool,
    /// Named probes.
    pub probes: Vec<(String, Probe<D>)>,
    /// Fields to compare the fluid with.
    pub reference: Option<FieldReference>,
    /// Whether to continue from the latest checkpoint in `out`.
    pub resume: bool,
    /// Whether a checkpoint must be possible in every step, at the price of a second copy of the
    /// fluid's state.
    pub keeps_state: bool,
    /// Whether somebody wants the run to end.
    pub stop: Stop,
    /// Remarks about the run. The first rank makes them.
    pub notes: Notes,
}
