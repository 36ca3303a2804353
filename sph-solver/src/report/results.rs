//! What a run has left in its folder, as far as it can be read.

use super::error::ReportError;
use crate::run::Record;
use serde_json::Value;
use sph_io::{PvdEntry, PvdIndex, Table, read_table};
use std::path::{Path, PathBuf};

/// The results of a run. A run that goes on, or was killed, has left a part of them.
#[derive(Debug)]
pub struct Results {
    /// The folder.
    pub folder: PathBuf,
    /// What the run is called beside others.
    pub label: String,
    /// What was asked for; default values when that is not known.
    pub record: Record,
    /// `summary.json`, or null when the run has not ended.
    pub summary: Value,
    /// Tables by the names of their files without `.csv`, in the order of the names.
    pub tables: Vec<(String, Table)>,
    /// Snapshots of the fluid over time.
    pub snapshots: Vec<PvdEntry>,
    /// Files of walls at rest.
    pub walls: Vec<String>,
    /// Walls that move, over time.
    pub moving: Vec<PvdEntry>,
    /// What could not be read, and why.
    pub problems: Vec<String>,
}

impl Results {
    /// Reads what is in a folder.
    pub fn read(folder: &Path) -> Result<Self, ReportError> {
        let failed = |source| ReportError::Folder { path: folder.into(), source };
        let mut names = Vec::new();
        for entry in std::fs::read_dir(folder).map_err(failed)? {
            names.extend(entry.map_err(failed)?.file_name().into_string());
        }
        names.sort();
        let has = |name: &str| names.iter().any(|known| known == name);
        let indices: Vec<&String> = names.iter().filter(|name| name.ends_with(".pvd")).collect();
        if !["run.json", "summary.json", "energies.csv"].into_iter().any(has) && indices.is_empty()
        {
            return Err(ReportError::NoRun { path: folder.into() });
        }
        let mut problems = Vec::new();
        let record = Record::read(folder).unwrap_or_else(|| {
            if has("run.json") {
                problems.push("run.json cannot be read: scene and command are not known".into());
            }
            Record::default()
        });
        let summary = if has("summary.json") {
            read_json(&folder.join("summary.json")).unwrap_or_else(|problem| {
                problems.push(format!("summary.json cannot be read: {problem}"));
                Value::Null
            })
        } else {
            problems.push(
                "There is no summary.json: the run goes on still, or did not reach its end. What \
                 it has written so far is shown."
                    .into(),
            );
            Value::Null
        };
        let mut tables = Vec::new();
        for name in names.iter().filter_map(|name| name.strip_suffix(".csv")) {
            if !is_table(name) {
                continue;
            }
            match read_table(folder.join(format!("{name}.csv"))) {
                Ok(table) => tables.push((name.to_owned(), table)),
                Err(error) => problems.push(format!("{error}; it is left out")),
            }
        }
        let (mut snapshots, mut walls, mut moving) = (Vec::new(), Vec::new(), Vec::new());
        // The series is named after the scene.
        let index = indices
            .iter()
            .find(|name| **name == &format!("{}.pvd", record.name))
            .or(indices.first());
        if let Some(name) = index {
            match PvdIndex::open(folder.join(name)) {
                Ok(index) => {
                    let entries = index.entries().iter().cloned();
                    let parts: Vec<PvdEntry>;
                    (snapshots, parts) = entries.partition(|one| one.part == 0);
                    let rests = |one: &PvdEntry| {
                        let same = parts.iter().filter(|other| other.file == one.file);
                        same.count() == snapshots.len()
                    };
                    let at_rest;
                    (at_rest, moving) = parts.iter().cloned().partition(rests);
                    walls = at_rest.into_iter().map(|one: PvdEntry| one.file).collect();
                    walls.sort();
                    walls.dedup();
                    snapshots.sort_by(|a, b| a.time.total_cmp(&b.time));
                }
                Err(error) => problems.push(format!("{error}; there are no pictures")),
            }
        }
        let label = folder
            .canonicalize()
            .ok()
            .and_then(|path| path.file_name().map(|name| name.to_string_lossy().into_owned()))
            .unwrap_or_else(|| folder.display().to_string());
        let folder = folder.into();
        Ok(Self { folder, label, record, summary, tables, snapshots, walls, moving, problems })
    }

    /// Name of the scene.
    pub fn name(&self) -> &str {
        let summary = self.summary["name"].as_str();
        summary.or(Some(&self.record.name)).filter(|name| !name.is_empty()).unwrap_or(&self.label)
    }

    /// A number of the summary, such as `/phases/density`.
    pub fn number(&self, pointer: &str) -> Option<f64> {
        self.summary.pointer(pointer).and_then(Value::as_f64)
    }

    /// The time of the last row of the energies, s.
    pub fn last_row(&self) -> Option<f64> {
        let (_, energies) = self.tables.iter().find(|(name, _)| name == "energies")?;
        energies.rows.last()?.first().copied()
    }

    /// Remarks about the run.
    pub fn notes(&self) -> Vec<&str> {
        self.summary["notes"].as_array().into_iter().flatten().filter_map(Value::as_str).collect()
    }

    /// Number of space dimensions, when it is known.
    pub fn dimension(&self) -> Option<usize> {
        let summary = self.summary["dimension"].as_u64().map(|dimension| dimension as usize);
        summary.or(Some(self.record.dimension)).filter(|dimension| [2, 3].contains(dimension))
    }
}

/// Gives runs whose folders have the same name different labels.
pub fn tell_apart(runs: &mut [Results]) {
    for index in 0..runs.len() {
        if runs.iter().filter(|run| run.label == runs[index].label).count() > 1 {
            let label = runs[index].label.clone();
            for (number, run) in runs.iter_mut().filter(|run| run.label == label).enumerate() {
                let path = run.folder.display().to_string();
                run.label = if path == label { format!("{label} ({})", number + 1) } else { path };
            }
        }
    }
}

fn read_json(path: &Path) -> Result<Value, String> {
    let text = std::fs::read_to_string(path).map_err(|error| error.to_string())?;
    serde_json::from_str(&text).map_err(|error| error.to_string())
}

/// Whether a table of this name is one of a run.
fn is_table(name: &str) -> bool {
    matches!(name, "energies" | "lost") || name.starts_with("probe-") || name.starts_with("solid-")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn what_is_half_written_is_named_and_the_rest_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        assert!(matches!(Results::read(path), Err(ReportError::NoRun { .. })));
        assert!(matches!(Results::read(&path.join("no")), Err(ReportError::Folder { .. })));
        fs::write(path.join("energies.csv"), "time [s],kinetic [J]\n0,1\n0.1,2\n0.2,").unwrap();
        fs::write(path.join("probe-P.csv"), "time [s],pressure [Pa]\n0,one\n").unwrap();
        fs::write(path.join("notes.csv"), "not a table").unwrap();
        fs::write(path.join("summary.json"), "{\"name\": ").unwrap();
        fs::write(path.join("a.pvd"), "<?xml version=\"1.0\"?>\n<VTKFile").unwrap();
        let results = Results::read(path).unwrap();
        assert_eq!(results.tables.len(), 1);
        assert_eq!(results.tables[0].1.rows.len(), 2);
        assert!(results.summary.is_null() && results.snapshots.is_empty());
        for file in ["summary.json", "probe-P.csv", "a.pvd"] {
            assert!(results.problems.iter().any(|p| p.contains(file)), "{file}: {results:?}");
        }
    }

    #[test]
    fn labels_differ() {
        let folder = tempfile::tempdir().unwrap();
        let mut runs: Vec<_> = ["a/out", "b/out", "c"]
            .iter()
            .map(|name| {
                let path = folder.path().join(name);
                fs::create_dir_all(&path).unwrap();
                fs::write(path.join("energies.csv"), "time [s]\n").unwrap();
                Results::read(&path).unwrap()
            })
            .collect();
        tell_apart(&mut runs);
        assert!(runs[0].label.ends_with("a/out") && runs[1].label.ends_with("b/out"));
        assert_eq!(runs[2].label, "c");
    }
}
