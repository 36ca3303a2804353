//! From a state to a file.

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;

use super::container::CheckpointWriter;
use super::pure::PureWriter;
use super::schema::{
    FIELD_DATA, FORMAT_VERSION, ID, POINT_DATA, PRIVATE, RESERVED, VTK, VTKHDF_VERSION,
};
use super::{Attribute, Checkpoint};
use crate::IoError;
use crate::atomic::write_atomically;
use crate::column::{Column, check_name};

/// VTK's number for a cell that is a single point.
const VTK_VERTEX: u8 = 1;

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
    out.dataset(VTK, "Points", &positions.in_space(None), false)?;
    out.dataset(VTK, "Connectivity", &Column::from((0..n as i64).collect::<Vec<_>>()), true)?;
    out.dataset(VTK, "Offsets", &Column::from((0..=n as i64).collect::<Vec<_>>()), true)?;
    out.dataset(VTK, "Types", &Column::from(vec![VTK_VERTEX; state.len()]), true)?;
    out.dataset(POINT_DATA, ID, &Column::from(&state.ids[..]), false)?;
    for (name, column) in &state.columns {
        out.dataset(POINT_DATA, name, &column.in_space(None), false)?;
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
