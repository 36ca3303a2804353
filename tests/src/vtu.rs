//! Reads `.vtu` files strictly.

use std::path::Path;
use vtkio::Vtk;
use vtkio::model::{Attribute, DataSet};

/// An array of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// Its name.
    pub name: String,
    /// Numbers per point.
    pub components: usize,
    /// The numbers.
    pub values: Vec<f64>,
}

/// The points of a file and what is known at them.
#[derive(Debug, Clone, PartialEq)]
pub struct Vtu {
    /// Number of points.
    pub points: usize,
    /// Positions under the name `Points`, then the point arrays.
    pub arrays: Vec<Array>,
}

impl Vtu {
    /// The array of this name.
    ///
    /// # Panics
    ///
    /// When there is none.
    #[track_caller]
    pub fn array(&self, name: &str) -> &Array {
        let found = self.arrays.iter().find(|array| array.name == name);
        found.unwrap_or_else(|| panic!("there is no array \"{name}\""))
    }
}

/// Reads a file whose cells are its points.
///
/// # Panics
///
/// When it is cut, or holds other than what its head says.
#[track_caller]
pub fn read_vtu(path: &Path) -> Vtu {
    read(path).unwrap_or_else(|problem| panic!("{}: {problem}", path.display()))
}

fn read(path: &Path) -> Result<Vtu, String> {
    let file = Vtk::import(path).map_err(|error| error.to_string())?;
    let DataSet::UnstructuredGrid { pieces, .. } = file.data else {
        return Err("no unstructured grid".into());
    };
    let [piece] =
        <[_; 1]>::try_from(pieces).map_err(|pieces| format!("{} pieces", pieces.len()))?;
    let piece = piece.into_loaded_piece_data(None).map_err(|error| error.to_string())?;
    let points = piece.cells.types.len();
    let mut arrays = vec![Array {
        name: "Points".into(),
        components: 3,
        values: piece.points.cast_into().ok_or("positions that are no numbers")?,
    }];
    for attribute in &piece.data.point {
        let Attribute::DataArray(array) = attribute else {
            return Err("a point array of another kind".into());
        };
        arrays.push(Array {
            name: array.name.clone(),
            components: array.num_comp(),
            values: array.data.cast_into().ok_or("an array that holds no numbers")?,
        });
    }
    for Array { name, components, values } in &arrays {
        if values.len() != points * components {
            return Err(format!("{points} points, but {} numbers in {name}", values.len()));
        }
    }
    Ok(Vtu { points, arrays })
}

#[cfg(test)]
mod tests {
    use super::read;
    use sph_io::{ParticleFrame, write_vtu};

    #[test]
    fn whole_files_are_read_and_cut_ones_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.vtu");
        let positions = [[1.0, 2.0], [3.0, 4.5]];
        let frame = ParticleFrame::new(0.5, &positions)
            .with("id", vec![7_u64, 8])
            .with("pressure", vec![-1.5_f32, f32::NAN]);
        write_vtu(&path, &frame).unwrap();
        let vtu = read(&path).unwrap();
        assert_eq!(vtu.points, 2);
        assert_eq!(vtu.array("Points").values, [1.0, 2.0, 0.0, 3.0, 4.5, 0.0]);
        assert_eq!(vtu.array("id").values, [7.0, 8.0]);
        assert_eq!(vtu.array("pressure").values[0], -1.5);
        assert!(vtu.array("pressure").values[1].is_nan());
        let bytes = std::fs::read(&path).unwrap();
        for cut in [20, 60, bytes.len() / 2, bytes.len()] {
            std::fs::write(&path, &bytes[..bytes.len() - cut]).unwrap();
            assert!(read(&path).is_err(), "{cut} of {} bytes cut", bytes.len());
        }
    }
}
