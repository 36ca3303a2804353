//! One `.vtu` file: an unstructured grid whose cells are the particles, one vertex each.
//!
//! `vtkio` encodes the arrays: VTK XML format, packed with LZ4, as base64. That takes less time and
//! half the room of base64 alone.

use std::io::{self, Write};
use std::path::Path;

use vtkio::IOBuffer;
use vtkio::model::{
    Attribute, Attributes, ByteOrder, CellType, Cells, DataArray, ElementType,
    UnstructuredGridPiece, Version, VertexNumbers, Vtk,
};
use vtkio::xml::{Compressor, se};

use crate::atomic::write_atomically;
use crate::column::{Column, Values};
use crate::{Compression, IoError, ParticleFrame};

/// Writes the particles of one moment as a `.vtu` file, whole or not at all.
///
/// `D` is 2 or 3; two-dimensional positions and vectors are written with z = 0. The time is stored
/// as the field `TimeValue`. The file is built in memory before it goes to the disk.
///
/// # Errors
///
/// [`IoError`] when a column does not fit the particles or the file cannot be written.
pub fn write_vtu<const D: usize>(
    path: impl AsRef<Path>,
    frame: &ParticleFrame<'_, D>,
) -> Result<(), IoError> {
    const { assert!(D == 2 || D == 3, "VTK knows points in the plane and in space") }
    frame.check()?;
    write_atomically(path, |file| {
        if u32::try_from(frame.len()).is_err() {
            return Err(io::Error::other("a .vtu file holds at most 2^32 - 1 particles"));
        }
        let text = encode(frame).map_err(|error| io::Error::other(error.to_string()))?;
        // What vtkio leaves out, in front of and inside its only piece: the time, and the counts
        // when they are zero.
        let (head, piece) = text
            .split_once("<Piece")
            .ok_or_else(|| io::Error::other("the encoder wrote no grid"))?;
        let mut own = format!(
            "<FieldData><DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" \
             format=\"ascii\">{:e}</DataArray></FieldData><Piece",
            frame.time
        );
        if frame.is_empty() {
            own.push_str(" NumberOfPoints=\"0\" NumberOfCells=\"0\"");
        }
        for part in ["<?xml version=\"1.0\"?>\n", head, &own, piece, "\n"] {
            file.write_all(part.as_bytes())?;
        }
        Ok(())
    })
}

/// The file as `vtkio` writes it.
///
/// It is built as a text because the writer of `vtkio` goes on when the disk is full.
fn encode<const D: usize>(frame: &ParticleFrame<'_, D>) -> Result<String, vtkio::xml::Error> {
    let n = frame.len() as u64;
    let point: Vec<DataArray> = frame
        .columns
        .iter()
        .map(|(name, column)| array(name, column.in_space(frame.selection)))
        .collect();
    let positions = Column::from(frame.positions);
    let points = match array("Points", positions.in_space(frame.selection)).data {
        IOBuffer::F64(x) if frame.single_positions => {
            IOBuffer::F32(x.into_iter().map(|x| x as f32).collect())
        }
        points => points,
    };

    let cell_verts =
        VertexNumbers::XML { connectivity: (0..n).collect(), offsets: (1..=n).collect() };
    let cells = Cells { cell_verts, types: vec![CellType::Vertex; frame.len()] };
    let point = point.into_iter().map(Attribute::DataArray).collect();
    let data = Attributes { point, cell: Vec::new() };
    let grid = Vtk {
        version: Version::new_xml(1, 0),
        title: String::new(),
        byte_order: ByteOrder::LittleEndian,
        data: UnstructuredGridPiece { points, cells, data }.into(),
        file_path: None,
    };
    let compressor = match frame.compression {
        Compression::Lz4 => Compressor::LZ4,
        Compression::Zlib => Compressor::ZLib,
    };
    // LZ4 has no levels, and higher ones of zlib find no more; 0 would turn it off.
    Ok(se::to_string(&grid.try_into_xml_format(compressor, 1)?)?)
}

/// A column as `vtkio` takes it: owned.
fn array(name: &str, column: Column<'_>) -> DataArray {
    let elem = ElementType::Generic(column.components() as u32);
    let data = match column.into_values() {
        Values::F32(v) => IOBuffer::F32(v.into_owned()),
        Values::F64(v) => IOBuffer::F64(v.into_owned()),
        Values::U8(v) => IOBuffer::U8(v.into_owned()),
        Values::U16(v) => IOBuffer::U16(v.into_owned()),
        Values::U32(v) => IOBuffer::U32(v.into_owned()),
        Values::U64(v) => IOBuffer::U64(v.into_owned()),
        Values::I64(v) => IOBuffer::I64(v.into_owned()),
    };
    DataArray { name: name.to_owned(), elem, data }
}

#[cfg(test)]
mod tests {
    use vtkio::model::DataSet;

    use super::*;

    #[test]
    fn names_that_xml_cannot_carry_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.vtu");
        for name in ["", "a\nb", "a\0", "\u{fffe}", "a\u{ffff}", "a/b"] {
            let frame = ParticleFrame::new(0.0, &[[0.0, 1.0]]).with(name, vec![1.0_f32]);
            let error = write_vtu(&path, &frame).unwrap_err();
            assert!(matches!(error, IoError::Name { .. }), "{error}");
            assert!(!path.exists(), "{name:?}");
        }
    }

    #[test]
    fn the_selected_rows_arrive_in_space_and_the_name_escaped() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.vtu");
        let positions = [[0.0, 1.0], [2.0, 3.0], [4.0, 5.0]];
        let name = "<Piece \"&'> ";
        let frame = ParticleFrame::new(0.5, &positions)
            .with(name, vec![[1_u16, 2], [3, 4], [5, 6]])
            .select(&[2, 0]);
        write_vtu(&path, &frame).unwrap();
        let DataSet::UnstructuredGrid { mut pieces, .. } = Vtk::import(&path).unwrap().data else {
            panic!("no grid")
        };
        let piece = pieces.remove(0).into_loaded_piece_data(None).unwrap();
        assert_eq!(piece.points, IOBuffer::F64(vec![4.0, 5.0, 0.0, 0.0, 1.0, 0.0]));
        let [Attribute::DataArray(column)] = &piece.data.point[..] else {
            panic!("not one column")
        };
        assert_eq!(column.name, name);
        assert_eq!(column.elem, ElementType::Generic(3));
        assert_eq!(column.data, IOBuffer::U16(vec![5, 6, 0, 1, 2, 0]));
    }
}
