//! The seam between the layout of a checkpoint and the library that puts it into HDF5.

use std::fs::File;
use std::io::{self, BufWriter};
use std::ops::Range;

use super::{Attribute, Attributes};
use crate::{Column, Scalar};

/// Type and extent of a dataset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shape {
    /// Machine type of the numbers.
    pub scalar: Scalar,
    /// Rows.
    pub rows: u64,
    /// Numbers per row; 1 is a dataset of one dimension.
    pub components: u64,
}

/// Puts groups, attributes and datasets into a file.
///
/// Groups are paths without a leading `/`; they come into being when something is put into them.
pub(super) trait CheckpointWriter {
    /// Adds an attribute to a group.
    ///
    /// # Errors
    ///
    /// When the library cannot hold the value.
    fn attribute(&mut self, group: &str, name: &str, value: &Attribute) -> io::Result<()>;

    /// Adds a dataset to a group. `repetitive` says that the numbers compress to almost nothing.
    ///
    /// # Errors
    ///
    /// When the library cannot hold the data.
    fn dataset(
        &mut self,
        group: &str,
        name: &str,
        data: &Column<'_>,
        repetitive: bool,
    ) -> io::Result<()>;

    /// Brings everything to the file.
    ///
    /// # Errors
    ///
    /// When the library or the operating system refuses.
    fn finish(self, file: &mut BufWriter<File>) -> io::Result<()>;
}

/// Takes attributes and datasets out of a file.
pub(super) trait CheckpointReader {
    /// The attributes of a group that have one of our types.
    ///
    /// # Errors
    ///
    /// When the group is absent or damaged.
    fn attributes(&self, group: &str) -> io::Result<Attributes>;

    /// Type and extent of a dataset.
    ///
    /// # Errors
    ///
    /// When the dataset is absent, damaged or of a type that no column has.
    fn shape(&self, group: &str, name: &str) -> io::Result<Shape>;

    /// Some rows of a dataset.
    ///
    /// # Errors
    ///
    /// When the dataset is absent or damaged.
    fn rows(&self, group: &str, name: &str, rows: Range<u64>) -> io::Result<Column<'static>>;
}
