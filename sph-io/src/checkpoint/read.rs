//! From a file to a state.

use std::ops::Range;
use std::path::{Path, PathBuf};

use super::container::{CheckpointReader, Shape};
use super::pure::PureReader;
use super::schema::{FORMAT_VERSION, ID, POINT_DATA, PRIVATE, VTK};
use super::{Attributes, Checkpoint};
use crate::column::Column;
use crate::column::padded;
use crate::{IoError, Scalar};

/// Reads a whole state.
///
/// # Errors
///
/// As [`CheckpointFile::open`] and [`CheckpointFile::read`].
pub fn read_checkpoint<const D: usize>(
    path: impl AsRef<Path>,
) -> Result<Checkpoint<'static, D>, IoError> {
    CheckpointFile::open(path)?.read()
}

/// What a checkpoint says of itself.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct CheckpointInfo {
    /// Number of space dimensions.
    pub dimension: usize,
    /// Number of particles.
    pub particles: u64,
    /// Time in seconds.
    pub time: f64,
    /// Number of steps done.
    pub step: u64,
    /// Names of the columns, without ids and positions.
    pub columns: Vec<String>,
    /// The caller's attributes.
    pub attributes: Attributes,
}

/// An open checkpoint: its head has been read and its datasets are known to be there in full.
pub struct CheckpointFile {
    path: PathBuf,
    reader: Box<dyn CheckpointReader + Send + Sync>,
    info: CheckpointInfo,
    components: Vec<u64>,
}

impl CheckpointFile {
    /// Opens a checkpoint and checks that it is whole, without reading the particles.
    ///
    /// # Errors
    ///
    /// [`IoError::Read`] when there is no such file; [`IoError::NotACheckpoint`] when it is cut,
    /// damaged or something else; [`IoError::FormatVersion`].
    pub fn open(path: impl AsRef<Path>) -> Result<Self, IoError> {
        let path = path.as_ref().to_path_buf();
        let reader = PureReader::open(&path)?;
        let mut attributes = reader
            .attributes(PRIVATE)
            .map_err(|_| damaged(&path, "it holds no group /sph, so another program wrote it"))?;
        let version = take(&path, &mut attributes, "format_version", Attributes::u64)?;
        if version != FORMAT_VERSION {
            return Err(IoError::FormatVersion { path, found: version, supported: FORMAT_VERSION });
        }
        let dimension = take(&path, &mut attributes, "dimension", Attributes::u64)?;
        let names = take(&path, &mut attributes, "columns", |a, n| a.text(n).map(str::to_owned))?;
        let components =
            take(&path, &mut attributes, "components", |a, n| a.u64_array(n).map(<[u64]>::to_vec))?;
        let info = CheckpointInfo {
            dimension: usize::try_from(dimension).unwrap_or(usize::MAX),
            particles: take(&path, &mut attributes, "particles", Attributes::u64)?,
            time: take(&path, &mut attributes, "time", Attributes::f64)?,
            step: take(&path, &mut attributes, "step", Attributes::u64)?,
            columns: names.lines().map(str::to_owned).collect(),
            attributes,
        };
        let file = Self { path, reader: Box::new(reader), info, components };
        file.check_datasets()?;
        Ok(file)
    }

    /// What the checkpoint says of itself.
    #[must_use]
    pub fn info(&self) -> &CheckpointInfo {
        &self.info
    }

    /// Where it lies.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Reads the whole state.
    ///
    /// # Errors
    ///
    /// [`IoError::Dimension`] when it has another number of dimensions,
    /// [`IoError::NotACheckpoint`] when it is damaged.
    pub fn read<const D: usize>(&self) -> Result<Checkpoint<'static, D>, IoError> {
        self.read_rows(0..self.info.particles)
    }

    /// Reads the particles in rows `rows` of the file, for a process that takes a share.
    ///
    /// Rows past the end are left out.
    ///
    /// # Errors
    ///
    /// As [`CheckpointFile::read`].
    pub fn read_rows<const D: usize>(
        &self,
        rows: Range<u64>,
    ) -> Result<Checkpoint<'static, D>, IoError> {
        if self.info.dimension != D {
            return Err(IoError::Dimension {
                path: self.path.clone(),
                found: self.info.dimension,
                expected: D,
            });
        }
        let end = rows.end.min(self.info.particles);
        let rows = rows.start.min(end)..end;
        let get = |group: &str, name: &str| {
            let column = self.reader.rows(group, name, rows.clone()).map_err(|error| {
                damaged(&self.path, &format!("/{group}/{name} cannot be read: {error}"))
            })?;
            if column.rows() as u64 == rows.end - rows.start {
                Ok(column)
            } else {
                Err(damaged(&self.path, &format!("/{group}/{name} is shorter than it says")))
            }
        };
        let positions = unpadded(get(VTK, "Points")?, D as u64);
        let ids = get(POINT_DATA, ID)?;
        // The types were checked when the file was opened.
        let positions = positions.view::<[f64; D]>().unwrap_or_default().to_vec();
        let ids = ids.view::<u64>().unwrap_or_default().to_vec();
        let mut state = Checkpoint::new(self.info.time, self.info.step, ids, positions);
        state.attributes = self.info.attributes.clone();
        for (name, &components) in self.info.columns.iter().zip(&self.components) {
            state.columns.push((name.clone(), unpadded(get(POINT_DATA, name)?, components)));
        }
        Ok(state)
    }

    /// Every dataset is there, of the right extent and type.
    fn check_datasets(&self) -> Result<(), IoError> {
        let info = &self.info;
        if self.components.len() != info.columns.len() {
            return Err(damaged(&self.path, "its list of columns is not consistent"));
        }
        let points = Some(Scalar::F64);
        let fixed = [(VTK, "Points", points, 3), (POINT_DATA, ID, Some(Scalar::U64), 1)];
        let columns = info.columns.iter().zip(&self.components).map(|(name, &c)| {
            (POINT_DATA, name.as_str(), None, padded(usize::try_from(c).unwrap_or(0)) as u64)
        });
        for (group, name, scalar, components) in fixed.into_iter().chain(columns) {
            let found = self.reader.shape(group, name).map_err(|error| {
                damaged(&self.path, &format!("the dataset /{group}/{name} is missing: {error}"))
            })?;
            let scalar = scalar.unwrap_or(found.scalar);
            let expected = Shape { scalar, rows: info.particles, components };
            if found != expected {
                return Err(damaged(
                    &self.path,
                    &format!("/{group}/{name} is {found:?} where {expected:?} is due"),
                ));
            }
        }
        Ok(())
    }
}

impl std::fmt::Debug for CheckpointFile {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("CheckpointFile").field("path", &self.path).finish_non_exhaustive()
    }
}

/// The leading components of each row.
fn unpadded(column: Column<'static>, components: u64) -> Column<'static> {
    let components = usize::try_from(components).unwrap_or(1).max(1);
    if column.components() <= components {
        return column;
    }
    let scalar = column.values().scalar();
    let row = column.components() * scalar.size();
    let keep = components * scalar.size();
    let bytes: Vec<u8> =
        column.values().bytes().chunks_exact(row).flat_map(|r| &r[..keep]).copied().collect();
    Column::from_bytes(scalar, &bytes, components)
}

fn take<T>(
    path: &Path,
    attributes: &mut Attributes,
    name: &str,
    get: impl FnOnce(&Attributes, &str) -> Result<T, IoError>,
) -> Result<T, IoError> {
    let value =
        get(attributes, name).map_err(|error| damaged(path, &format!("in /sph {error}")))?;
    attributes.remove(name);
    Ok(value)
}

fn damaged(path: &Path, problem: &str) -> IoError {
    IoError::NotACheckpoint {
        path: path.to_path_buf(),
        problem: format!("{problem}; resume from an older checkpoint"),
    }
}
