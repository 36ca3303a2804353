//! A series of snapshots: numbered `.vtu` files and their `.pvd` index.

use std::path::{Path, PathBuf};

use crate::atomic::remove_stale_temporaries;
use crate::{IoError, ParticleFrame, PvdIndex, write_vtu};

/// Writes numbered snapshots `NAME-000000.vtu`, … beside an index `NAME.pvd`.
///
/// The index names a file only after it is whole, so a viewer may watch a run, and a killed run
/// leaves a series that opens.
///
/// # Examples
///
/// ```
/// use sph_io::{ParticleFrame, SnapshotSeries};
///
/// # fn main() -> Result<(), sph_io::IoError> {
/// # let folder = tempfile::tempdir().unwrap();
/// let walls = [[0.0, 0.0], [0.1, 0.0]];
/// let mut fluid = [[0.05, 0.1]];
/// let mut series = SnapshotSeries::create(folder.path(), "tank")?;
/// series.fixed_part("walls", &ParticleFrame::new(0.0, &walls))?;
/// for step in 0..3 {
///     fluid[0][1] += 0.01;
///     series.write(&ParticleFrame::new(0.1 * f64::from(step), &fluid))?;
/// }
/// assert_eq!(series.index().entries().len(), 6);
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct SnapshotSeries {
    folder: PathBuf,
    name: String,
    fixed: Vec<String>,
    next: u64,
    index: PvdIndex,
}

impl SnapshotSeries {
    /// Starts a series in an existing folder, in place of one of the same name.
    ///
    /// # Errors
    ///
    /// [`IoError`] when the name is no file name or the folder cannot be written.
    pub fn create(folder: impl Into<PathBuf>, name: &str) -> Result<Self, IoError> {
        crate::column::check_name(name)?;
        let folder = folder.into();
        remove_stale_temporaries(&folder)?;
        let index = PvdIndex::create(index_path(&folder, name))?;
        Ok(Self { folder, name: name.to_owned(), fixed: Vec::new(), next: 0, index })
    }

    /// Continues a series from `time` in seconds: later snapshots leave the index, their files
    /// are written again.
    ///
    /// Parts that were fixed are taken over from the index; naming them again is allowed. A series
    /// that does not exist yet is started.
    ///
    /// # Errors
    ///
    /// [`IoError`] when the index is damaged or the folder cannot be written.
    pub fn resume(folder: impl Into<PathBuf>, name: &str, time: f64) -> Result<Self, IoError> {
        crate::column::check_name(name)?;
        let folder = folder.into();
        remove_stale_temporaries(&folder)?;
        let index = PvdIndex::resume(index_path(&folder, name), time)?;
        let next = index
            .entries()
            .iter()
            .filter(|entry| entry.part == 0)
            .filter_map(|entry| number_of(name, &entry.file))
            .max()
            .map_or(0, |last| last + 1);
        let mut fixed = Vec::new();
        let numbered = |file: &str| {
            let stem = file.strip_suffix(".vtu").unwrap_or(file);
            stem.rsplit_once('-').is_some_and(|(part, _)| number_of(part, file).is_some())
        };
        for entry in index.entries().iter().filter(|entry| entry.part > 0) {
            if !numbered(&entry.file) && !fixed.contains(&entry.file) {
                fixed.push(entry.file.clone());
            }
        }
        Ok(Self { folder, name: name.to_owned(), fixed, next, index })
    }

    /// Writes a part that does not change once, as `NAME-PART.vtu`; every later snapshot names it.
    ///
    /// # Errors
    ///
    /// [`IoError`] as [`write_vtu`].
    pub fn fixed_part<const D: usize>(
        &mut self,
        part: &str,
        frame: &ParticleFrame<'_, D>,
    ) -> Result<(), IoError> {
        crate::column::check_name(part)?;
        let file = format!("{}-{part}.vtu", self.name);
        if number_of(&self.name, &file).is_some() {
            return Err(IoError::Name {
                name: part.to_owned(),
                problem: "it looks like the number of a snapshot",
            });
        }
        write_vtu(self.folder.join(&file), frame)?;
        if !self.fixed.contains(&file) {
            self.fixed.push(file);
        }
        Ok(())
    }

    /// Writes the next snapshot, then adds it to the index. Returns its path.
    ///
    /// # Errors
    ///
    /// [`IoError`] as [`write_vtu`].
    pub fn write<const D: usize>(
        &mut self,
        frame: &ParticleFrame<'_, D>,
    ) -> Result<PathBuf, IoError> {
        self.write_parts(frame, &[])
    }

    /// Writes the next snapshot in parts: `frame`, and each of `parts` as `NAME-PART-000000.vtu`. Returns
    /// the path of the first.
    ///
    /// # Errors
    ///
    /// [`IoError`] as [`write_vtu`].
    pub fn write_parts<const D: usize>(
        &mut self,
        frame: &ParticleFrame<'_, D>,
        parts: &[(&str, &ParticleFrame<'_, D>)],
    ) -> Result<PathBuf, IoError> {
        let file = format!("{}-{:06}.vtu", self.name, self.next);
        let path = self.folder.join(&file);
        write_vtu(&path, frame)?;
        let mut files = vec![file];
        for (part, frame) in parts {
            crate::column::check_name(part)?;
            let file = format!("{}-{part}-{:06}.vtu", self.name, self.next);
            write_vtu(self.folder.join(&file), frame)?;
            files.push(file);
        }
        files.extend(self.fixed.iter().cloned());
        self.index.add(frame.time(), &files)?;
        self.next += 1;
        Ok(path)
    }

    /// Number of the next snapshot, counted from 0.
    #[must_use]
    pub fn next_number(&self) -> u64 {
        self.next
    }

    /// The index as it is on the disk.
    #[must_use]
    pub fn index(&self) -> &PvdIndex {
        &self.index
    }
}

fn index_path(folder: &Path, name: &str) -> PathBuf {
    folder.join(format!("{name}.pvd"))
}

fn number_of(name: &str, file: &str) -> Option<u64> {
    let digits = file.strip_prefix(name)?.strip_prefix('-')?.strip_suffix(".vtu")?;
    digits.bytes().all(|b| b.is_ascii_digit()).then(|| digits.parse().ok())?
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_resumed_series_goes_on_where_it_was_cut() {
        let folder = tempfile::tempdir().unwrap();
        let positions = [[0.0, 1.0]];
        let frame = |time| ParticleFrame::new(time, &positions);
        let mut series = SnapshotSeries::create(folder.path(), "s").unwrap();
        series.fixed_part("walls", &frame(0.0)).unwrap();
        for time in [0.0, 1.0, 2.0, 3.0] {
            series.write_parts(&frame(time), &[("body", &frame(time))]).unwrap();
        }
        let mut series = SnapshotSeries::resume(folder.path(), "s", 1.5).unwrap();
        assert_eq!(series.next_number(), 2);
        series.write(&frame(2.5)).unwrap();
        let shown: Vec<_> =
            series.index().entries().iter().map(|e| (e.time, e.part, e.file.as_str())).collect();
        assert_eq!(
            shown,
            [
                (0.0, 0, "s-000000.vtu"),
                (0.0, 1, "s-body-000000.vtu"),
                (0.0, 2, "s-walls.vtu"),
                (1.0, 0, "s-000001.vtu"),
                (1.0, 1, "s-body-000001.vtu"),
                (1.0, 2, "s-walls.vtu"),
                (2.5, 0, "s-000002.vtu"),
                (2.5, 1, "s-walls.vtu"),
            ]
        );
        assert!(series.fixed_part("12", &frame(0.0)).is_err());
        assert!(SnapshotSeries::create(folder.path(), "../s").is_err());
    }
}
