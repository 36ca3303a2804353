//! The state of a run in memory.

use std::borrow::Cow;

use super::{Attribute, Attributes};
use crate::IoError;
use crate::column::{Column, Element, check_columns, find};

/// The whole state of a run: positions, ids, named columns and named attributes.
///
/// The arrays may be borrowed, so that writing copies nothing that the file library does not
/// copy itself. What has been read owns its arrays.
///
/// # Examples
///
/// ```
/// use sph_io::{Checkpoint, read_checkpoint, write_checkpoint};
///
/// # fn main() -> Result<(), sph_io::IoError> {
/// # let folder = tempfile::tempdir().unwrap();
/// let ids = [7_u64, 3];
/// let positions = [[0.0, 0.5], [1.0, 0.5]];
/// let density = [1000.0, 1000.5];
/// let path = folder.path().join(sph_io::checkpoint_name(120));
/// let state = Checkpoint::new(0.25, 120, &ids[..], &positions[..])
///     .with("density", &density[..])
///     .with_attribute("dt", 1e-4)
///     .with_attribute("scene", "dimension = 2\n");
/// write_checkpoint(&path, &state)?;
///
/// let back = read_checkpoint::<2>(&path)?;
/// assert_eq!(back, state);
/// assert_eq!(back.column::<f64>("density")?, density);
/// assert_eq!(back.attributes.f64("dt")?, 1e-4);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint<'a, const D: usize> {
    /// Time in seconds.
    pub time: f64,
    /// Number of steps done.
    pub step: u64,
    /// Global id of each particle.
    pub ids: Cow<'a, [u64]>,
    /// Position of each particle in metres.
    pub positions: Cow<'a, [[f64; D]]>,
    /// Parameters, counters and texts.
    pub attributes: Attributes,
    pub(super) columns: Vec<(String, Column<'a>)>,
}

impl<'a, const D: usize> Checkpoint<'a, D> {
    /// A state of positions and ids alone.
    #[must_use]
    pub fn new(
        time: f64,
        step: u64,
        ids: impl Into<Cow<'a, [u64]>>,
        positions: impl Into<Cow<'a, [[f64; D]]>>,
    ) -> Self {
        Self {
            time,
            step,
            ids: ids.into(),
            positions: positions.into(),
            attributes: Attributes::default(),
            columns: Vec::new(),
        }
    }

    /// Adds a column, one row per particle. Names and lengths are checked when the state is
    /// written.
    #[must_use]
    pub fn with(mut self, name: impl Into<String>, column: impl Into<Column<'a>>) -> Self {
        self.columns.push((name.into(), column.into()));
        self
    }

    /// Sets an attribute.
    #[must_use]
    pub fn with_attribute(mut self, name: impl Into<String>, value: impl Into<Attribute>) -> Self {
        self.attributes.set(name, value);
        self
    }

    /// Number of particles.
    #[must_use]
    pub fn len(&self) -> usize {
        self.ids.len()
    }

    /// True when there is no particle.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }

    /// The column called `name`, as rows of type `T`.
    ///
    /// # Errors
    ///
    /// [`IoError::MissingColumn`], [`IoError::ColumnType`].
    pub fn column<T: Element>(&self, name: &str) -> Result<&[T], IoError> {
        find(&self.columns, name)
    }

    /// Names and columns in the order in which they were added.
    pub fn columns(&self) -> impl Iterator<Item = (&str, &Column<'a>)> {
        self.columns.iter().map(|(name, column)| (name.as_str(), column))
    }

    pub(super) fn check(&self) -> Result<(), IoError> {
        check_columns(&self.columns, self.len())?;
        if self.positions.len() != self.len() {
            return Err(IoError::ColumnLength {
                name: "position".to_owned(),
                found: self.positions.len(),
                expected: self.len(),
            });
        }
        Ok(())
    }
}
