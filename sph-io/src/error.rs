//! What can go wrong with a file, in words that say what to do next.

use std::io;
use std::path::{Path, PathBuf};

/// An error of this crate: which file, what is wrong with it, and the way out.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IoError {
    /// The operating system or an encoder refused to write.
    #[error("cannot write {}: {source}{}", path.display(), write_hint(path, source))]
    Write {
        /// The file under its final name.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The operating system refused to read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A column has another number of rows than there are particles.
    #[error(
        "column \"{name}\" has {found} rows but there are {expected} particles: pass one row per particle"
    )]
    ColumnLength {
        /// Name of the column.
        name: String,
        /// Its number of rows.
        found: usize,
        /// The number of particles.
        expected: usize,
    },
    /// A name that the file formats cannot carry.
    #[error("the name \"{name}\" cannot be used: {problem}")]
    Name {
        /// The name.
        name: String,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// An index into the particles is out of range.
    #[error("the selection names particle {index} but there are {particles} particles")]
    Selection {
        /// The index.
        index: u32,
        /// The number of particles.
        particles: usize,
    },
    /// A text index or table is not in the form that this crate writes.
    #[error("{}, line {line}: {problem}", path.display())]
    Text {
        /// The file.
        path: PathBuf,
        /// Line, counted from 1.
        line: usize,
        /// What is wrong and what to do.
        problem: String,
    },
    /// A snapshot is cut, or no unstructured grid.
    #[error("cannot read the snapshot {}: {problem}", path.display())]
    Snapshot {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        problem: String,
    },
    /// A row of a table has the wrong number of values.
    #[error("a row of {} has {found} values, its header names {expected}", path.display())]
    RowLength {
        /// The table.
        path: PathBuf,
        /// Values given.
        found: usize,
        /// Values expected.
        expected: usize,
    },
    /// The file is not an HDF5 file, or its inside cannot be followed.
    #[error("{} is not a whole checkpoint: {problem}", path.display())]
    NotACheckpoint {
        /// The file.
        path: PathBuf,
        /// What is wrong and what to do.
        problem: String,
    },
    /// The checkpoint was written in another version of the layout.
    #[error(
        "{} has checkpoint format {found}, this program reads format {supported}: \
         restart with the program version that wrote it, or start the run anew", path.display()
    )]
    FormatVersion {
        /// The file.
        path: PathBuf,
        /// Version in the file.
        found: u64,
        /// Version that this crate reads.
        supported: u64,
    },
    /// The checkpoint holds another number of space dimensions.
    #[error(
        "{} holds a {found}-dimensional state, {expected} dimensions were asked for: \
         resume with the scene that wrote it", path.display()
    )]
    Dimension {
        /// The file.
        path: PathBuf,
        /// Dimensions in the file.
        found: usize,
        /// Dimensions asked for.
        expected: usize,
    },
    /// A column that the caller needs is absent.
    #[error("there is no column \"{name}\" (present: {present})")]
    MissingColumn {
        /// Name asked for.
        name: String,
        /// The names that exist.
        present: String,
    },
    /// A column exists with another element type.
    #[error("column \"{name}\" holds {found} values, {expected} values were asked for")]
    ColumnType {
        /// Name of the column.
        name: String,
        /// Its type.
        found: String,
        /// The type asked for.
        expected: String,
    },
    /// An attribute that the caller needs is absent or has another type.
    #[error("there is no attribute \"{name}\" of type {expected} (present: {present})")]
    MissingAttribute {
        /// Name asked for.
        name: String,
        /// Type asked for.
        expected: &'static str,
        /// The names that exist.
        present: String,
    },
}

impl IoError {
    pub(crate) fn write(path: &Path) -> impl FnOnce(io::Error) -> Self + '_ {
        move |source| Self::Write { path: path.to_path_buf(), source }
    }

    pub(crate) fn read(path: &Path) -> impl FnOnce(io::Error) -> Self + '_ {
        move |source| Self::Read { path: path.to_path_buf(), source }
    }
}

fn write_hint(path: &Path, source: &io::Error) -> &'static str {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
    match source.kind() {
        io::ErrorKind::NotFound if folder.is_some_and(|p| !p.exists()) => {
            " (its folder does not exist: create it first)"
        }
        io::ErrorKind::StorageFull => " (free some space; files written before are whole)",
        _ => "",
    }
}
