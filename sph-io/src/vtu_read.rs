//! Reads a `.vtu` snapshot back.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use vtkio::model::{Attribute, DataSet, Piece, UnstructuredGridPiece, Vtk};

use crate::{IoError, vtu_check};

/// The particles of a `.vtu` file, with all numbers as `f64`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    /// Positions in metres; z = 0 in two dimensions.
    pub positions: Vec<[f64; 3]>,
    /// What is known of the particles, in the order of the file.
    pub columns: Vec<SnapshotColumn>,
}

/// A quantity of all particles of a [`Snapshot`].
#[derive(Clone, Debug, PartialEq)]
pub struct SnapshotColumn {
    /// Its name.
    pub name: String,
    /// Numbers per particle: 3 for a vector.
    pub components: usize,
    /// The numbers, particle by particle.
    pub values: Vec<f64>,
}

impl Snapshot {
    /// The column of this name.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&SnapshotColumn> {
        self.columns.iter().find(|column| column.name == name)
    }

    /// One number per particle from the column of this name: the number itself, or the length of the
    /// vector.
    #[must_use]
    pub fn magnitudes(&self, name: &str) -> Option<Vec<f64>> {
        let column = self.column(name)?;
        if column.components == 1 {
            return Some(column.values.clone());
        }
        let length = |row: &[f64]| row.iter().map(|c| c * c).sum::<f64>().sqrt();
        Some(column.values.chunks_exact(column.components).map(length).collect())
    }
}

/// Reads a snapshot that [`write_vtu`](crate::write_vtu) wrote, or another program: an unstructured
/// grid in one or more pieces, whose points are the particles. Arrays that are not in every piece
/// are left out.
///
/// # Errors
///
/// [`IoError::Snapshot`] when the file is cut or of another kind.
///
/// # Examples
///
/// ```
/// use sph_io::{ParticleFrame, read_vtu, write_vtu};
///
/// # fn main() -> Result<(), sph_io::IoError> {
/// # let folder = tempfile::tempdir().unwrap();
/// let path = folder.path().join("a.vtu");
/// let frame = ParticleFrame::new(0.0, &[[0.5, 1.5]]).with("velocity", vec![[3.0_f32, 4.0]]);
/// write_vtu(&path, &frame)?;
/// let back = read_vtu(&path)?;
/// assert_eq!(back.positions, [[0.5, 1.5, 0.0]]);
/// assert_eq!(back.magnitudes("velocity").unwrap(), [5.0]);
/// # Ok(())
/// # }
/// ```
pub fn read_vtu(path: impl AsRef<Path>) -> Result<Snapshot, IoError> {
    let path = path.as_ref();
    read(path).map_err(|problem| IoError::Snapshot { path: path.to_path_buf(), problem })
}

fn read(path: &Path) -> Result<Snapshot, String> {
    let bytes = std::fs::read(path).map_err(|error| error.to_string())?;
    vtu_check::check(&bytes)?;
    // vtkio was made for whole files: on some damaged ones it panics.
    let parsed = catch_unwind(AssertUnwindSafe(|| pieces(path)));
    let mut whole: Option<Snapshot> = None;
    for piece in parsed.map_err(|_| "it is damaged")?? {
        let points: Vec<f64> = piece.points.cast_into().ok_or("its positions are no numbers")?;
        let (rows, rest) = points.as_chunks::<3>();
        if !rest.is_empty() {
            return Err("a position is cut".into());
        }
        let mut part = Snapshot { positions: rows.to_vec(), columns: Vec::new() };
        for attribute in piece.data.point {
            let Attribute::DataArray(array) = attribute else { continue };
            let components = array.num_comp();
            let Some(values) = array.data.cast_into::<f64>() else { continue };
            if values.len() != rows.len() * components {
                return Err(format!(
                    "{} points, but {} numbers in \"{}\"",
                    rows.len(),
                    values.len(),
                    array.name
                ));
            }
            part.columns.push(SnapshotColumn { name: array.name, components, values });
        }
        match &mut whole {
            None => whole = Some(part),
            Some(whole) => append(whole, &part),
        }
    }
    Ok(whole.unwrap_or_default())
}

/// The pieces of the grid in a file.
fn pieces(path: &Path) -> Result<Vec<UnstructuredGridPiece>, String> {
    let file = Vtk::import(path).map_err(|error| error.to_string())?;
    let DataSet::UnstructuredGrid { pieces, .. } = file.data else {
        return Err("it holds no unstructured grid".into());
    };
    let load = |piece: Piece<UnstructuredGridPiece>| {
        piece.into_loaded_piece_data(path.parent()).map_err(|error| error.to_string())
    };
    pieces.into_iter().map(load).collect()
}

/// Adds the particles of another piece.
fn append(whole: &mut Snapshot, part: &Snapshot) {
    whole.positions.extend_from_slice(&part.positions);
    whole.columns.retain_mut(|column| match part.column(&column.name) {
        Some(more) if more.components == column.components => {
            column.values.extend_from_slice(&more.values);
            true
        }
        _ => false,
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ParticleFrame, write_vtu};

    #[test]
    fn what_was_written_is_read_and_cut_files_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.vtu");
        let positions: Vec<[f64; 3]> = (0..500).map(|k| [f64::from(k), 0.5, -1.25]).collect();
        let ids: Vec<u64> = (0..500).collect();
        let frame = ParticleFrame::new(0.0, &positions)
            .with("id", &ids)
            .with("velocity", vec![[0.0_f32, 3.0, 4.0]; 500]);
        write_vtu(&path, &frame).unwrap();
        let back = read_vtu(&path).unwrap();
        assert_eq!(back.positions, positions);
        assert_eq!(back.magnitudes("id").unwrap()[499], 499.0);
        assert!(back.magnitudes("velocity").unwrap().iter().all(|speed| *speed == 5.0));
        assert!(back.column("density").is_none());
        let bytes = std::fs::read(&path).unwrap();
        for keep in [0, 20, bytes.len() / 3, bytes.len() / 2, bytes.len() - 40] {
            std::fs::write(&path, &bytes[..keep]).unwrap();
            let error = read_vtu(&path).unwrap_err().to_string();
            assert!(error.contains("a.vtu"), "{error}");
        }
    }

    #[test]
    fn an_empty_snapshot_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.vtu");
        write_vtu(&path, &ParticleFrame::<2>::new(0.0, &[])).unwrap();
        assert!(read_vtu(&path).unwrap().positions.is_empty());
    }

    #[test]
    fn pieces_are_put_together() {
        let column =
            |value| SnapshotColumn { name: "a".into(), components: 1, values: vec![value] };
        let mut whole = Snapshot { positions: vec![[0.0; 3]], columns: vec![column(1.0)] };
        let part = Snapshot { positions: vec![[1.0; 3]], columns: vec![column(2.0)] };
        append(&mut whole, &part);
        assert_eq!(whole.columns[0].values, [1.0, 2.0]);
        append(&mut whole, &Snapshot { positions: vec![[2.0; 3]], columns: Vec::new() });
        assert!(whole.columns.is_empty() && whole.positions.len() == 3);
    }
}
