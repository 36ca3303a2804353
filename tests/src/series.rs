//! The `.pvd` index of the snapshots of a run.

use std::fs;
use std::path::Path;

/// A file of the index.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Time, s.
    pub time: f64,
    /// 0 for the fluid.
    pub part: u32,
    /// Name relative to the index.
    pub file: String,
}

/// Reads an index strictly.
///
/// # Panics
///
/// When it is not whole.
#[track_caller]
pub fn read_series(path: &Path) -> Vec<Entry> {
    let text = fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let body = text
        .split_once("<Collection>")
        .and_then(|(_, rest)| rest.split_once("</Collection>"))
        .filter(|(_, rest)| rest.trim() == "</VTKFile>");
    let (body, _) = body.unwrap_or_else(|| panic!("{} is not whole:\n{text}", path.display()));
    let elements = body.split('<').skip(1);
    elements
        .map(|element| {
            let value = |key| {
                attribute(element, key)
                    .unwrap_or_else(|| panic!("{}: no {key} in <{element}", path.display()))
            };
            assert!(element.starts_with("DataSet ") && element.trim().ends_with("/>"), "{element}");
            Entry {
                time: value("timestep").parse().expect("a time"),
                part: value("part").parse().expect("a part"),
                file: value("file").into(),
            }
        })
        .collect()
}

/// Value of an attribute of an XML element.
pub(crate) fn attribute<'a>(element: &'a str, key: &str) -> Option<&'a str> {
    let start = format!(" {key}=\"");
    let (_, rest) = element.split_once(&start)?;
    rest.split_once('"').map(|(value, _)| value)
}
