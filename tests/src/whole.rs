//! Checks over all files of a folder: nothing half-written, nothing that is no number.

use crate::series::read_series;
use crate::table::read_table;
use crate::vtu::read_vtu;
use std::fs;
use std::path::{Path, PathBuf};

/// Asserts that every file under a final name is whole. Temporaries, hidden and ending in `.tmp`, and
/// the hidden lock of a killed run may be there. A folder that does not exist holds nothing half-written.
///
/// # Panics
///
/// With the file that is not whole, or that no run writes.
#[track_caller]
pub fn assert_whole(folder: &Path, dimension: usize) {
    visit(folder, dimension, |_, _| {});
}

/// Asserts that every file is whole and every number in it finite.
///
/// # Panics
///
/// With the first file and number that is not.
#[track_caller]
pub fn assert_finite(folder: &Path, dimension: usize) {
    visit(folder, dimension, |path, number| {
        assert!(number.is_finite(), "{} holds {number}", path.display());
    });
}

fn visit(folder: &Path, dimension: usize, see: impl Fn(&Path, f64)) {
    for path in files(folder) {
        let name = path.file_name().and_then(|name| name.to_str()).expect("a file name");
        if name.starts_with('.') {
            assert!(
                name.ends_with(".tmp") || name == ".sph.lock",
                "{} is no name of a run",
                path.display()
            );
            continue;
        }
        match path.extension().and_then(|extension| extension.to_str()) {
            Some("vtu") => {
                for array in &read_vtu(&path).arrays {
                    array.values.iter().for_each(|&number| see(&path, number));
                }
            }
            Some("pvd") => {
                for entry in read_series(&path) {
                    assert!(folder.join(&entry.file).is_file(), "{entry:?} names no file");
                    see(&path, entry.time);
                }
            }
            Some("csv") => {
                let table = read_table(&path);
                let filled = table.rows.iter().flatten().filter(|number| !number.is_nan());
                filled.for_each(|&number| see(&path, number));
            }
            Some("json") => {
                let text = fs::read_to_string(&path).expect("a readable file");
                let value = serde_json::from_str::<serde_json::Value>(&text);
                assert!(value.is_ok(), "{}: {value:?}", path.display());
            }
            Some("vtkhdf") if dimension == 2 => checkpoint::<2>(&path, &see),
            Some("vtkhdf") => checkpoint::<3>(&path, &see),
            _ => panic!("no run writes {}", path.display()),
        }
    }
}

fn checkpoint<const D: usize>(path: &Path, see: &impl Fn(&Path, f64)) {
    let state = sph_io::read_checkpoint::<D>(path);
    let state = state.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    state.positions.iter().flatten().for_each(|&number| see(path, number));
    let velocity = state.column::<[f64; D]>("velocity");
    let velocity = velocity.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    velocity.iter().flatten().for_each(|&number| see(path, number));
    see(path, state.time);
}

/// Files of a folder by name; none when it does not exist.
pub(crate) fn files(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    paths
}
