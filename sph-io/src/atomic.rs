//! Files that are whole or absent.
//!
//! A file is written under a temporary name in the folder of the final one, brought to the disk,
//! and renamed. Renaming within a folder is one step of the file system, so a process killed at
//! any moment leaves the old file, the new file, or a temporary beside them, never half a file
//! under a final name.

use std::ffi::OsStr;
use std::fs::{self, File, TryLockError};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::IoError;

const SUFFIX: &str = ".tmp";
const BUFFER: usize = 1 << 20;

/// Writes a file through `fill`, whole or not at all.
///
/// When `fill` fails or the process dies, a file that was there before stays as it was.
///
/// # Errors
///
/// [`IoError::Write`] with the final path when `fill` or the operating system fails.
///
/// # Examples
///
/// ```
/// use std::io::Write;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("summary.json");
/// sph_io::write_atomically(&path, |file| writeln!(file, "{{\"steps\": 12}}"))?;
/// assert_eq!(std::fs::read_to_string(&path)?, "{\"steps\": 12}\n");
/// # Ok(())
/// # }
/// ```
pub fn write_atomically<T>(
    path: impl AsRef<Path>,
    fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<T>,
) -> Result<T, IoError> {
    let path = path.as_ref();
    replace(path, fill).map_err(IoError::write(path))
}

/// Writes a text file, whole or not at all; for summaries and reports.
///
/// # Errors
///
/// [`IoError::Write`] with the final path.
pub fn write_text_atomically(path: impl AsRef<Path>, text: &str) -> Result<(), IoError> {
    write_atomically(path, |file| file.write_all(text.as_bytes()))
}

/// Removes the temporaries that killed processes left in `folder`, and returns how many.
///
/// A temporary is locked while it is written, so files that another process is writing at this
/// moment are left alone.
///
/// # Errors
///
/// [`IoError::Read`] when the folder cannot be listed, [`IoError::Write`] when a temporary cannot
/// be removed.
pub fn remove_stale_temporaries(folder: impl AsRef<Path>) -> Result<usize, IoError> {
    let folder = folder.as_ref();
    let mut removed = 0;
    for entry in fs::read_dir(folder).map_err(IoError::read(folder))? {
        let path = entry.map_err(IoError::read(folder))?.path();
        if !path.file_name().is_some_and(is_temporary) {
            continue;
        }
        match File::open(&path).map(|file| file.try_lock()) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Ok(Err(TryLockError::WouldBlock)) => {}
            _ => {
                fs::remove_file(&path).map_err(IoError::write(&path))?;
                removed += 1;
            }
        }
    }
    Ok(removed)
}

fn replace<T>(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<T>,
) -> io::Result<T> {
    let temporary = Temporary(temporary_name(path)?);
    let file = File::create(&temporary.0)?;
    // A file system without locks still writes whole files; only the clean-up knows less.
    let _ = file.lock();
    let mut writer = BufWriter::with_capacity(BUFFER, file);
    let value = fill(&mut writer)?;
    let file = writer.into_inner().map_err(io::IntoInnerError::into_error)?;
    file.sync_all()?;
    fs::rename(&temporary.0, path)?;
    sync_folder(path);
    Ok(value)
}

/// Removes the temporary unless it has been renamed; also when `fill` panics.
struct Temporary(PathBuf);

impl Drop for Temporary {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

/// `.name.<process>-<count>.tmp`: hidden, and different for every writer on this machine.
fn temporary_name(path: &Path) -> io::Result<PathBuf> {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let name = path.file_name().ok_or_else(|| {
        io::Error::new(io::ErrorKind::InvalidInput, "the path does not name a file")
    })?;
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    let mut temporary = OsStr::new(".").to_os_string();
    temporary.push(name);
    temporary.push(format!(".{}-{count}{SUFFIX}", process::id()));
    Ok(path.with_file_name(temporary))
}

fn is_temporary(name: &OsStr) -> bool {
    let name = name.to_string_lossy();
    let Some(stem) = name.strip_prefix('.').and_then(|n| n.strip_suffix(SUFFIX)) else {
        return false;
    };
    let Some((_, writer)) = stem.rsplit_once('.') else { return false };
    let digits = |s: &str| !s.is_empty() && s.bytes().all(|b| b.is_ascii_digit());
    writer.split_once('-').is_some_and(|(process, count)| digits(process) && digits(count))
}

/// Brings the new name to the disk. Not every system can do this; the file is whole either way.
fn sync_folder(path: &Path) {
    #[cfg(unix)]
    {
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
        if let Ok(folder) = File::open(folder.unwrap_or(Path::new("."))) {
            let _ = folder.sync_all();
        }
    }
    #[cfg(not(unix))]
    let _ = path;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_no_temporary() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_text_atomically(&path, "old").unwrap();
        let error = write_atomically(&path, |file| {
            file.write_all(b"half")?;
            Err::<(), _>(io::Error::other("no more"))
        })
        .unwrap_err();
        assert!(error.to_string().contains("a.txt"), "{error}");
        assert!(error.to_string().contains("no more"), "{error}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_missing_folder_is_named_in_the_error() {
        let folder = tempfile::tempdir().unwrap();
        let error = write_text_atomically(folder.path().join("no/b.txt"), "x").unwrap_err();
        assert!(error.to_string().contains("create it first"), "{error}");
    }

    #[test]
    fn only_abandoned_temporaries_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("c.vtu");
        let abandoned = folder.path().join(".c.vtu.4711-0.tmp");
        fs::write(&abandoned, "half").unwrap();
        let foreign = folder.path().join(".notes.tmp");
        fs::write(&foreign, "mine").unwrap();
        write_atomically(&path, |file| {
            file.write_all(b"whole")?;
            assert_eq!(remove_stale_temporaries(folder.path()).unwrap(), 1);
            Ok(())
        })
        .unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "whole");
        assert!(!abandoned.exists());
        assert!(foreign.exists());
    }
}
