//! The folder of a run: one run at a time, and no results overwritten by accident.

use super::record::{RECORD, Record};
use crate::error::RunError;
use sph_io::PvdIndex;
use std::fs::{self, File, TryLockError};
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};

/// What is to happen with results that lie in the folder already.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Existing {
    /// They are kept: the run is refused.
    #[default]
    Refuse,
    /// The run goes on from their last checkpoint.
    Resume,
    /// They are removed.
    Overwrite,
}

/// The folder of a run, locked for as long as this value lives. The system takes the lock away when
/// the process dies.
#[derive(Debug)]
pub struct RunFolder {
    path: PathBuf,
    /// Open for the sake of its lock.
    _lock: File,
    /// Whether the file system has locks at all.
    locks: bool,
}

/// Locked while a run writes into the folder.
const LOCK: &str = ".sph.lock";

impl RunFolder {
    /// Refuses what [`claim`](Self::claim) would refuse, as far as that is seen without touching
    /// anything: before the set-up of a large scene, which takes a while.
    pub fn look(path: &Path, existing: Existing) -> Result<(), RunError> {
        match existing {
            Existing::Refuse => refuse_results(path),
            Existing::Resume if !path.is_dir() => {
                Err(RunError::NothingToResume { path: path.into() })
            }
            Existing::Resume | Existing::Overwrite => Ok(()),
        }
    }

    /// Makes the folder, locks it, and deals with what lies in it.
    pub fn claim(path: &Path, existing: Existing) -> Result<Self, RunError> {
        Self::look(path, existing)?;
        let failed = |source| RunError::Folder { path: path.into(), source };
        fs::create_dir_all(path).map_err(failed)?;
        let lock = path.join(LOCK);
        let folder = loop {
            let file = File::options().create(true).append(true).open(&lock).map_err(failed)?;
            let locks = match file.try_lock() {
                Ok(()) => true,
                Err(TryLockError::WouldBlock) => {
                    return Err(RunError::FolderInUse { path: path.into() });
                }
                Err(TryLockError::Error(_)) => false,
            };
            // A run that ended in this very moment took the name of the locked file away.
            if !locks || is_at(&file, &lock) {
                break Self { path: path.into(), _lock: file, locks };
            }
        };
        match existing {
            Existing::Refuse => refuse_results(path)?,
            Existing::Resume => (),
            Existing::Overwrite => {
                for file in files_of_runs(path).map_err(failed)? {
                    fs::remove_file(&file)
                        .map_err(|source| RunError::Folder { path: file.clone(), source })?;
                }
                sph_io::remove_stale_temporaries(path)?;
            }
        }
        Ok(folder)
    }

    /// What the user should know about this folder.
    pub fn note(&self) -> Option<String> {
        let folder = self.path.display();
        (!self.locks).then(|| {
            format!(
                "the file system of {folder} has no locks: make sure that no other run writes there"
            )
        })
    }
}

impl Drop for RunFolder {
    fn drop(&mut self) {
        // While the lock is still held. A file that cannot be removed does no harm.
        if cfg!(unix) {
            let _ = fs::remove_file(self.path.join(LOCK));
        }
    }
}

/// Whether an open file is the one that the path names.
fn is_at(file: &File, path: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        match (file.metadata(), fs::metadata(path)) {
            (Ok(open), Ok(named)) => (open.dev(), open.ino()) == (named.dev(), named.ino()),
            _ => false,
        }
    }
    #[cfg(not(unix))]
    {
        let _ = (file, path);
        true
    }
}

fn refuse_results(path: &Path) -> Result<(), RunError> {
    if !path.is_dir() {
        return Ok(());
    }
    let files =
        files_of_runs(path).map_err(|source| RunError::Folder { path: path.into(), source })?;
    let Some(first) = files.first() else { return Ok(()) };
    let name = |path: &Path| path.file_name().map(|name| name.to_string_lossy().into_owned());
    Err(RunError::ResultsThere {
        path: path.into(),
        example: name(first).unwrap_or_default(),
        count: files.len(),
        resumable: files.iter().any(|file| name(file).is_some_and(|name| is_checkpoint(&name))),
    })
}

/// Files that runs have left in a folder, the summary first: what a run names itself, tables that
/// begin with a time, and series of snapshots whose index names nothing else.
fn files_of_runs(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if entry.file_type()?.is_file() {
            names.extend(entry.file_name().into_string());
        }
    }
    let series: Vec<&str> = names
        .iter()
        .filter_map(|name| name.strip_suffix(".pvd"))
        .filter(|series| is_series(folder, series))
        .collect();
    let of_a_run = |name: &String| {
        name == "summary.json"
            || (name == RECORD && Record::read(folder).is_some())
            || is_checkpoint(name)
            || is_table(folder, name)
            || name.strip_suffix(".pvd").is_some_and(|stem| series.contains(&stem))
            || series.iter().any(|series| is_snapshot(series, name))
    };
    let mut found: Vec<&String> = names.iter().filter(|name| of_a_run(name)).collect();
    found.sort_by_key(|name| (*name != "summary.json", !is_checkpoint(name), *name));
    Ok(found.into_iter().map(|name| folder.join(name)).collect())
}

fn is_number(text: &str) -> bool {
    text.len() >= 6 && text.bytes().all(|byte| byte.is_ascii_digit())
}

fn is_checkpoint(name: &str) -> bool {
    let number = name.strip_prefix("checkpoint-").and_then(|name| name.strip_suffix(".vtkhdf"));
    number.is_some_and(is_number)
}

fn is_table(folder: &Path, name: &str) -> bool {
    let Some(stem) = name.strip_suffix(".csv") else { return false };
    if !matches!(stem, "energies" | "lost")
        && !stem.starts_with("probe-")
        && !stem.starts_with("solid-")
        && !stem.starts_with("energies-until-")
    {
        return false;
    }
    let mut head = String::new();
    let read = File::open(folder.join(name))
        .and_then(|file| BufReader::new(io::Read::take(file, 64)).read_line(&mut head));
    read.is_ok() && head.starts_with("time [s]")
}

/// A snapshot or the fixed walls of a series.
fn is_snapshot(series: &str, name: &str) -> bool {
    let rest = name.strip_prefix(series).and_then(|rest| rest.strip_prefix('-'));
    let part = rest.and_then(|rest| rest.strip_suffix(".vtu"));
    part.is_some_and(|part| part == "walls" || is_number(part))
}

fn is_series(folder: &Path, series: &str) -> bool {
    PvdIndex::open(folder.join(format!("{series}.pvd")))
        .is_ok_and(|index| index.entries().iter().all(|entry| is_snapshot(series, &entry.file)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder with the files of a run and with files that only look alike.
    fn folder() -> (tempfile::TempDir, Vec<&'static str>, Vec<&'static str>) {
        let folder = tempfile::tempdir().unwrap();
        let mine = vec![
            "summary.json",
            "checkpoint-000012.vtkhdf",
            "energies.csv",
            "lost.csv",
            "probe-P1.csv",
            "a.pvd",
            "a-000000.vtu",
            "a-1000000.vtu",
            "a-walls.vtu",
        ];
        let foreign = vec![
            "scene.toml",
            "notes.csv",
            "probe-places.csv",
            "checkpoint-old.vtkhdf",
            "b-000000.vtu",
            "a-mesh.vtu",
            "mine.pvd",
            "mine-000000.vtu",
        ];
        for name in mine.iter().chain(&foreign) {
            fs::write(folder.path().join(name), "x").unwrap();
        }
        for name in ["energies", "lost", "probe-P1"] {
            fs::write(folder.path().join(format!("{name}.csv")), "time [s],x [m]\n").unwrap();
        }
        let index = |name: &str, file: &str| {
            let mut index = PvdIndex::create(folder.path().join(name)).unwrap();
            index.add(0.0, &[file]).unwrap();
        };
        index("a.pvd", "a-000000.vtu");
        index("mine.pvd", "picture.vtu");
        fs::create_dir(folder.path().join("a-000007.vtu")).unwrap();
        (folder, mine, foreign)
    }

    #[test]
    fn overwriting_removes_the_files_of_runs_and_nothing_else() {
        let (folder, mine, foreign) = folder();
        let error = RunFolder::claim(folder.path(), Existing::Refuse).unwrap_err();
        let RunError::ResultsThere { count, resumable: true, .. } = error else {
            panic!("{error}");
        };
        assert_eq!(count, mine.len());
        drop(RunFolder::claim(folder.path(), Existing::Overwrite).unwrap());
        for name in mine {
            assert!(!folder.path().join(name).exists(), "{name} is still there");
        }
        for name in foreign {
            assert!(folder.path().join(name).exists(), "{name} is gone");
        }
        assert!(!folder.path().join(LOCK).exists());
        RunFolder::claim(folder.path(), Existing::Refuse).unwrap();
    }

    #[test]
    fn one_run_at_a_time() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("new");
        assert!(matches!(
            RunFolder::claim(&out, Existing::Resume),
            Err(RunError::NothingToResume { .. })
        ));
        assert!(!out.exists());
        for existing in [Existing::Refuse, Existing::Resume, Existing::Overwrite] {
            let first = RunFolder::claim(&out, Existing::Refuse).unwrap();
            let second = RunFolder::claim(&out, existing);
            assert!(matches!(second, Err(RunError::FolderInUse { .. })), "{second:?}");
            drop(first);
        }
    }
}
