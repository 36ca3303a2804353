//! `run.json`: what was asked for, written when a run begins.

use crate::error::RunError;
use crate::scene::Scene;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// File name of the record.
pub const RECORD: &str = "run.json";

/// What a run was asked for: enough to repeat it, and to read its results before it has ended.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Record {
    /// Version of the program.
    pub version: String,
    /// Name of the scene and of its snapshots.
    pub name: String,
    /// Number of space dimensions.
    pub dimension: usize,
    /// Initial distance of the particles, m.
    pub spacing: f64,
    /// Gravity, m/s².
    pub gravity: Vec<f64>,
    /// Time at which the run is to end, s.
    pub end_time: f64,
    /// The scene file, as the command names it.
    pub scene_file: String,
    /// The `--set` arguments.
    pub overrides: Vec<String>,
    /// The commands that made the results: the first one, then those that resumed it.
    pub commands: Vec<String>,
    /// Text of the scene file.
    pub scene: String,
}

impl Record {
    /// The record of a scene that runs until `end_time` (s) upon `command`.
    pub fn new(scene: &Scene, end_time: f64, command: Option<&str>) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").into(),
            name: scene.name().into(),
            dimension: scene.dimension(),
            spacing: *scene.numerics.spacing,
            gravity: scene.gravity.as_ref().map_or_else(Vec::new, |gravity| gravity.value.clone()),
            end_time,
            scene_file: scene.file_name().into(),
            overrides: scene.overrides().map(Into::into).collect(),
            commands: command.map(Into::into).into_iter().collect(),
            scene: scene.text().into(),
        }
    }

    /// Reads the record of the run in `folder`, if there is one that can be read.
    pub fn read(folder: &Path) -> Option<Self> {
        let text = std::fs::read_to_string(folder.join(RECORD)).ok()?;
        serde_json::from_str(&text).ok()
    }

    /// Writes the record into `folder`. A run that goes on adds its command to those before.
    pub fn write(mut self, folder: &Path, goes_on: bool) -> Result<(), RunError> {
        if goes_on && let Some(before) = Self::read(folder) {
            self.commands.splice(0..0, before.commands);
        }
        let text = serde_json::to_string_pretty(&self).map_err(|error| {
            RunError::Ranks(format!("the record cannot be written as JSON: {error}"))
        })?;
        Ok(sph_io::write_text_atomically(folder.join(RECORD), &(text + "\n"))?)
    }
}

/// A command line that a POSIX shell reads as these words.
pub fn shell_line<S: AsRef<str>>(words: impl IntoIterator<Item = S>) -> String {
    let plain = |c: char| c.is_alphanumeric() || "_-./=,:+@%".contains(c);
    let quoted = words.into_iter().map(|word| {
        let word = word.as_ref();
        if !word.is_empty() && word.chars().all(plain) {
            word.to_owned()
        } else {
            format!("'{}'", word.replace('\'', r"'\''"))
        }
    });
    quoted.collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_with_meaning_to_a_shell_are_quoted() {
        let words = ["sph", "run", "a b.toml", "--set", "gravity=[0, -1]", "it's", ""];
        assert_eq!(shell_line(words), r"sph run 'a b.toml' --set 'gravity=[0, -1]' 'it'\''s' ''");
    }

    #[test]
    fn a_run_that_goes_on_keeps_the_commands_before() {
        let folder = tempfile::tempdir().unwrap();
        let record = |command: &str| Record { commands: vec![command.into()], ..Record::default() };
        record("one").write(folder.path(), false).unwrap();
        record("two").write(folder.path(), true).unwrap();
        assert_eq!(Record::read(folder.path()).unwrap().commands, ["one", "two"]);
        record("three").write(folder.path(), false).unwrap();
        assert_eq!(Record::read(folder.path()).unwrap().commands, ["three"]);
    }
}
