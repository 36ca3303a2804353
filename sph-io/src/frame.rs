//! The particles of one moment, borrowed from whoever holds them.

use crate::IoError;
use crate::column::{Column, check_columns};

/// How the arrays of a snapshot are packed. VTK reads all of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Compression {
    /// Fast.
    #[default]
    Lz4,
    /// Smaller, above all where numbers count up, and slower to write.
    Zlib,
}

/// Positions and named columns of the particles at one time.
///
/// Nothing is copied: the frame borrows the caller's arrays until it is written.
///
/// # Examples
///
/// ```
/// use sph_io::ParticleFrame;
///
/// let positions = [[0.0, 0.5], [1.0, 0.5]];
/// let pressure = [9.81_f32, 4.9];
/// let ids = [0_u64, 1];
/// let frame = ParticleFrame::new(0.25, &positions)
///     .with("pressure", &pressure[..])
///     .with("id", &ids[..]);
/// assert_eq!(frame.len(), 2);
/// ```
#[derive(Clone, Debug)]
pub struct ParticleFrame<'a, const D: usize> {
    pub(crate) time: f64,
    pub(crate) positions: &'a [[f64; D]],
    pub(crate) columns: Vec<(String, Column<'a>)>,
    pub(crate) selection: Option<&'a [u32]>,
    pub(crate) single_positions: bool,
    pub(crate) compression: Compression,
}

impl<'a, const D: usize> ParticleFrame<'a, D> {
    /// A frame of positions in metres at `time` in seconds.
    #[must_use]
    pub fn new(time: f64, positions: &'a [[f64; D]]) -> Self {
        Self {
            time,
            positions,
            columns: Vec::new(),
            selection: None,
            single_positions: false,
            compression: Compression::default(),
        }
    }

    /// Adds a column, one row per particle. Names and lengths are checked when the frame is
    /// written.
    #[must_use]
    pub fn with(mut self, name: impl Into<String>, column: impl Into<Column<'a>>) -> Self {
        self.columns.push((name.into(), column.into()));
        self
    }

    /// Writes only these particles, in this order: fluid without walls, or sorted by id.
    #[must_use]
    pub fn select(mut self, selection: &'a [u32]) -> Self {
        self.selection = Some(selection);
        self
    }

    /// Writes positions in single precision: half the room, seven digits.
    #[must_use]
    pub fn with_single_positions(mut self) -> Self {
        self.single_positions = true;
        self
    }

    /// Packs the arrays of a snapshot in this way.
    #[must_use]
    pub fn compressed(mut self, compression: Compression) -> Self {
        self.compression = compression;
        self
    }

    /// Number of particles that will be written.
    #[must_use]
    pub fn len(&self) -> usize {
        self.selection.map_or(self.positions.len(), <[u32]>::len)
    }

    /// True when no particle will be written.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Time in seconds.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    pub(crate) fn check(&self) -> Result<(), IoError> {
        check_columns(&self.columns, self.positions.len())?;
        let particles = self.positions.len();
        let out_of_range =
            self.selection.and_then(|s| s.iter().find(|&&i| i as usize >= particles));
        match out_of_range {
            Some(&index) => Err(IoError::Selection { index, particles }),
            None => Ok(()),
        }
    }
}
