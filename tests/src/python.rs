//! Scripts for the readers of others: VTK and h5py.

use crate::program::skipped;
use std::path::Path;
use std::process::Command;

/// Runs a script of `tests/python` with a folder as its argument and returns what it prints; `None`,
/// said on standard error, when Python lacks one of the `modules`.
///
/// # Panics
///
/// With what it prints when the script fails.
#[track_caller]
pub fn python_with(modules: &[&str], script: &str, folder: &Path) -> Option<String> {
    let import = format!("import {}", modules.join(", "));
    let found = Command::new("python3").args(["-c", &import]).output();
    if !found.is_ok_and(|output| output.status.success()) {
        skipped(script, &format!("`python3 -c \"{import}\"` fails (pip install vtk h5py)"));
        return None;
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/python").join(script);
    let output = Command::new("python3").arg(path).arg(folder).output().expect("python3 starts");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let (printed, message) = (text(&output.stdout), text(&output.stderr));
    assert!(output.status.success(), "{script}:\n{printed}\n{message}");
    Some(printed)
}
