//! Where each part of a state lies in the file, whatever library writes it.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufWriter};
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::container::{CheckpointReader, CheckpointWriter, Shape};
use super::pure::{PureReader, PureWriter};
use super::{Attribute, Attributes, Checkpoint};
use crate::atomic::write_atomically;
use crate::column::{Column, check_name};
use crate::frame::{Rows, padded};
use crate::vtu::VTK_VERTEX;
use crate::{IoError, Scalar};

/// Version of the layout that this crate writes and reads.
pub const FORMAT_VERSION: u64 = 1;

const VTK: &str = "VTKHDF";
const POINT_DATA: &str = "VTKHDF/PointData";
const FIELD_DATA: &str = "VTKHDF/FieldData";
const PRIVATE: &str = "sph";
const ID: &str = "id";

/// Attributes of the private group that the layout itself uses.
const RESERVED: [&str; 7] =
    ["format_version", "dimension", "particles", "time", "step", "columns", "components"];

/// Version of VTKHDF: the first one that has unstructured grids, which every reader knows.
const VTKHDF_VERSION: [u64; 2] = [1, 0];

/// Writes a state, whole or not at all.
///
/// # Errors
///
/// [`IoError`] when names or lengths do not fit or the file cannot be written.
pub fn write_checkpoint<const D: usize>(
    path: impl AsRef<Path>,
    state: &Checkpoint<'_, D>,
) -> Result<(), IoError> {
    state.check()?;
    for (name, value) in &state.attributes {
        check_name(name)?;
        if RESERVED.contains(&name.as_str()) {
            return Err(IoError::Name { name: name.clone(), problem: "the layout uses it itself" });
        }
        if matches!(value, Attribute::Text(text) if text.contains('\0')) {
            return Err(IoError::Name { name: name.clone(), problem: "its text holds a NUL" });
        }
    }
    if state.columns().any(|(name, _)| name == ID) {
        return Err(IoError::Name { name: ID.to_owned(), problem: "the ids are stored under it" });
    }
    write_atomically(path, |file| put(PureWriter::new(), state, file))
}

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
    reader: PureReader,
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
        let file = Self { path, reader, info, components };
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
            self.reader.rows(group, name, rows.clone()).map_err(|error| {
                damaged(&self.path, &format!("/{group}/{name} cannot be read: {error}"))
            })
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

/// Puts a state into a container.
fn put<const D: usize>(
    mut out: impl CheckpointWriter,
    state: &Checkpoint<'_, D>,
    file: &mut BufWriter<File>,
) -> io::Result<()> {
    let n = state.len() as u64;
    out.attribute(VTK, "Version", &Attribute::U64Array(VTKHDF_VERSION.to_vec()))?;
    out.attribute(VTK, "Type", &Attribute::Text("UnstructuredGrid".to_owned()))?;
    let count = Column::from(vec![n as i64]);
    for name in ["NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"] {
        out.dataset(VTK, name, &count, false)?;
    }
    let positions = Column::from(&state.positions[..]);
    out.dataset(VTK, "Points", &padded_column(&positions), false)?;
    out.dataset(VTK, "Connectivity", &Column::from((0..n as i64).collect::<Vec<_>>()), true)?;
    out.dataset(VTK, "Offsets", &Column::from((0..=n as i64).collect::<Vec<_>>()), true)?;
    out.dataset(VTK, "Types", &Column::from(vec![VTK_VERTEX; state.len()]), true)?;
    out.dataset(POINT_DATA, ID, &Column::from(&state.ids[..]), false)?;
    for (name, column) in &state.columns {
        out.dataset(POINT_DATA, name, &padded_column(column), false)?;
    }
    out.dataset(FIELD_DATA, "TimeValue", &Column::from(vec![state.time]), false)?;

    let names: Vec<&str> = state.columns().map(|(name, _)| name).collect();
    let components = state.columns().map(|(_, c)| c.components() as u64).collect();
    let own: [(&str, Attribute); RESERVED.len()] = [
        ("format_version", FORMAT_VERSION.into()),
        ("dimension", (D as u64).into()),
        ("particles", n.into()),
        ("time", state.time.into()),
        ("step", state.step.into()),
        ("columns", names.join("\n").into()),
        ("components", Attribute::U64Array(components)),
    ];
    for (name, value) in &own {
        out.attribute(PRIVATE, name, value)?;
    }
    for (name, value) in &state.attributes {
        out.attribute(PRIVATE, name, value)?;
    }
    out.finish(file)
}

/// The column with rows as VTK wants them; borrowed when they are so already.
fn padded_column<'c>(column: &'c Column<'_>) -> Cow<'c, Column<'c>> {
    if padded(column.components()) == column.components() {
        return Cow::Borrowed(column);
    }
    let rows = Rows::new(column.values(), column.components());
    let mut bytes = Vec::with_capacity(column.rows() * rows.row_in_file());
    let done: Result<(), std::convert::Infallible> = rows.for_each_piece(None, |piece| {
        bytes.extend_from_slice(piece);
        Ok(())
    });
    let Ok(()) = done;
    Cow::Owned(Column::from_bytes(rows.scalar, &bytes, rows.components))
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
