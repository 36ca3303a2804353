//! HDF5 through the pure Rust library `hdf5-pure`. Its types stay in this file.

use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::ops::Range;
use std::path::Path;

use hdf5_pure::{AttrValue, DType, Dataset, FileBuilder, GroupBuilder};

use super::container::{CheckpointReader, CheckpointWriter, Shape};
use super::{Attribute, Attributes};
use crate::{Column, IoError, Scalar, Values};

/// Rows of a compressed chunk.
const CHUNK: u64 = 1 << 16;

/// Builds the file in memory, then streams it out.
pub(super) struct PureWriter {
    file: FileBuilder,
    /// Groups by path; a parent stands before its children.
    groups: Vec<(String, GroupBuilder)>,
}

impl PureWriter {
    pub(super) fn new() -> Self {
        Self { file: FileBuilder::new(), groups: Vec::new() }
    }

    fn group(&mut self, path: &str) -> &mut GroupBuilder {
        if let Some(i) = self.groups.iter().position(|(p, _)| p == path) {
            return &mut self.groups[i].1;
        }
        let (parent, name) = path.rsplit_once('/').unwrap_or(("", path));
        if !parent.is_empty() {
            self.group(parent);
        }
        let i = self.groups.len();
        self.groups.push((path.to_owned(), self.file.create_group(name)));
        &mut self.groups[i].1
    }
}

impl CheckpointWriter for PureWriter {
    fn attribute(&mut self, group: &str, name: &str, value: &Attribute) -> io::Result<()> {
        let value = match value {
            Attribute::F64(x) => AttrValue::F64(*x),
            Attribute::U64(n) => AttrValue::U64(*n),
            // VTK asks for texts of fixed length; Python makes plain strings of the others.
            Attribute::Text(text) if group.starts_with("VTKHDF") => {
                AttrValue::AsciiString(text.clone())
            }
            Attribute::Text(text) => AttrValue::VarLenString(text.clone()),
            Attribute::F64Array(x) => AttrValue::F64Array(x.clone()),
            Attribute::U64Array(n) => AttrValue::U64Array(n.clone()),
        };
        self.group(group).set_attr(name, value);
        Ok(())
    }

    fn dataset(
        &mut self,
        group: &str,
        name: &str,
        data: &Column<'_>,
        repetitive: bool,
    ) -> io::Result<()> {
        let rows = data.rows() as u64;
        let dataset = self.group(group).create_dataset(name);
        match data.values() {
            Values::F32(x) => dataset.with_f32_data(x),
            Values::F64(x) => dataset.with_f64_data(x),
            Values::U8(x) => dataset.with_u8_data(x),
            Values::U16(x) => dataset.with_u16_data(x),
            Values::U32(x) => dataset.with_u32_data(x),
            Values::U64(x) => dataset.with_u64_data(x),
            Values::I64(x) => dataset.with_i64_data(x),
        };
        match data.components() {
            1 => dataset.with_shape(&[rows]),
            n => dataset.with_shape(&[rows, n as u64]),
        };
        if repetitive && rows > 1 && data.components() == 1 {
            dataset.with_chunks(&[rows.min(CHUNK)]).with_shuffle().with_deflate(1);
        }
        Ok(())
    }

    fn finish(mut self, file: &mut BufWriter<File>) -> io::Result<()> {
        while let Some((path, group)) = self.groups.pop() {
            let finished = group.finish();
            match path.rsplit_once('/') {
                Some((parent, _)) => self.group(parent).add_group(finished),
                None => self.file.add_group(finished),
            }
        }
        self.file.finish_to(file).map_err(|error| match error {
            hdf5_pure::Error::Io(error) => error,
            other => io::Error::other(other),
        })
    }
}

/// Reads from the file on demand.
pub(super) struct PureReader(hdf5_pure::File);

impl PureReader {
    /// Opens a file and checks that it has its full length.
    pub(super) fn open(path: &Path) -> Result<Self, IoError> {
        let length = fs::metadata(path).map_err(IoError::read(path))?.len();
        let damaged = |problem: String| IoError::NotACheckpoint {
            path: path.to_path_buf(),
            problem: format!("{problem}; resume from an older checkpoint"),
        };
        let file = hdf5_pure::File::open_streaming(path).map_err(|error| match error {
            hdf5_pure::Error::Io(error) => IoError::read(path)(error),
            error => damaged(format!("it is not an HDF5 file, or its head is cut ({error})")),
        })?;
        let due = file.superblock().eof_address;
        if length < due {
            return Err(damaged(format!(
                "it is cut: {length} bytes of {due} are there, the disk may have been full"
            )));
        }
        Ok(Self(file))
    }

    fn dataset(&self, group: &str, name: &str) -> io::Result<Dataset> {
        self.0.group(group).and_then(|group| group.dataset(name)).map_err(io::Error::other)
    }
}

impl CheckpointReader for PureReader {
    fn attributes(&self, group: &str) -> io::Result<Attributes> {
        let found =
            self.0.group(group).and_then(|group| group.attrs()).map_err(io::Error::other)?;
        let mut attributes = Attributes::default();
        for (name, value) in found {
            let value = match value {
                AttrValue::F64(x) => Attribute::F64(x),
                AttrValue::U64(n) => Attribute::U64(n),
                AttrValue::F64Array(x) => Attribute::F64Array(x),
                AttrValue::U64Array(n) => Attribute::U64Array(n),
                other => match other.as_str() {
                    Some(text) => Attribute::Text(text.to_owned()),
                    None => continue,
                },
            };
            attributes.set(name, value);
        }
        Ok(attributes)
    }

    fn shape(&self, group: &str, name: &str) -> io::Result<Shape> {
        let dataset = self.dataset(group, name)?;
        let extent = dataset.shape().map_err(io::Error::other)?;
        let scalar = scalar(&dataset)?;
        match extent[..] {
            [rows] => Ok(Shape { scalar, rows, components: 1 }),
            [rows, components] => Ok(Shape { scalar, rows, components }),
            _ => Err(io::Error::other(format!("it has {} dimensions", extent.len()))),
        }
    }

    fn rows(&self, group: &str, name: &str, rows: Range<u64>) -> io::Result<Column<'static>> {
        let components = self.shape(group, name)?.components;
        let components = usize::try_from(components).map_err(io::Error::other)?;
        let dataset = self.dataset(group, name)?;
        let (start, count) = (rows.start, rows.end.saturating_sub(rows.start));
        macro_rules! numbers {
            ($read:ident) => {
                Column::from_numbers(
                    dataset.$read(start, count).map_err(io::Error::other)?,
                    components,
                )
            };
        }
        Ok(match scalar(&dataset)? {
            Scalar::F32 => numbers!(read_f32_rows),
            Scalar::F64 => numbers!(read_f64_rows),
            Scalar::U8 => numbers!(read_u8_rows),
            Scalar::U16 => numbers!(read_u16_rows),
            Scalar::U32 => numbers!(read_u32_rows),
            Scalar::U64 => numbers!(read_u64_rows),
            Scalar::I64 => numbers!(read_i64_rows),
        })
    }
}

fn scalar(dataset: &Dataset) -> io::Result<Scalar> {
    match dataset.dtype().map_err(io::Error::other)? {
        DType::F32 => Ok(Scalar::F32),
        DType::F64 => Ok(Scalar::F64),
        DType::U8 => Ok(Scalar::U8),
        DType::U16 => Ok(Scalar::U16),
        DType::U32 => Ok(Scalar::U32),
        DType::U64 => Ok(Scalar::U64),
        DType::I64 => Ok(Scalar::I64),
        other => Err(io::Error::other(format!("it holds {other} values"))),
    }
}
