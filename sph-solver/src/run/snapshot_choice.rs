//! What goes into snapshots.

use crate::scene::{Output, SnapshotCompression, SnapshotField, SnapshotPositions};
use sph_io::{Compression, ParticleFrame};

/// Which particles snapshots hold, and what of them.
#[derive(Debug, Clone, PartialEq)]
pub struct SnapshotChoice {
    fields: Vec<SnapshotField>,
    region: Option<(Vec<f64>, Vec<f64>)>,
    every: u64,
    single: bool,
    compression: Compression,
}

impl SnapshotChoice {
    /// As the scene has it.
    pub fn new(output: &Output) -> Self {
        let fields = output.fields.as_deref().cloned();
        let region = output.region.as_ref();
        Self {
            fields: fields.unwrap_or_else(|| SnapshotField::ALL.to_vec()),
            region: region.map(|one| (one.min.value.clone(), one.max.value.clone())),
            every: output.every_nth.as_deref().copied().unwrap_or(1).max(1) as u64,
            single: output.positions == SnapshotPositions::F32,
            compression: match output.compression {
                SnapshotCompression::Lz4 => Compression::Lz4,
                SnapshotCompression::Zlib => Compression::Zlib,
            },
        }
    }

    /// Whether snapshots have a quantity.
    pub fn has(&self, field: SnapshotField) -> bool {
        self.fields.contains(&field)
    }

    /// The rows of these particles that snapshots hold, or `None` for all of them. Those of walls hold
    /// every one in the region.
    pub fn rows<const D: usize>(&self, ids: Option<&[u64]>, at: &[[f64; D]]) -> Option<Vec<u32>> {
        let every = ids.filter(|_| self.every > 1);
        if every.is_none() && self.region.is_none() {
            return None;
        }
        let chosen = |row: &usize| {
            let by_id = every.is_none_or(|ids| ids[*row].is_multiple_of(self.every));
            let inside = self.region.as_ref().is_none_or(|(min, max)| {
                (0..D).all(|axis| (min[axis]..=max[axis]).contains(&at[*row][axis]))
            });
            by_id && inside
        };
        Some((0..at.len()).filter(chosen).map(|row| row as u32).collect())
    }

    /// The frame as the choice wants it packed.
    pub fn packed<'a, const D: usize>(&self, frame: ParticleFrame<'a, D>) -> ParticleFrame<'a, D> {
        let frame = frame.compressed(self.compression);
        if self.single { frame.with_single_positions() } else { frame }
    }

    /// About the bytes of a particle in a snapshot in so many dimensions, from measured flows, whose
    /// numbers hardly repeat: base64 makes 4 bytes of 3, and the cells of the grid and the ids are
    /// counts, which pack well.
    pub fn bytes_per_particle(&self, dimension: usize) -> f64 {
        // A number of 4 bytes, one of 8, and a count.
        let (single, double, count) = match self.compression {
            Compression::Zlib => (4.9, 10.2, 2.1),
            _ => (5.4, 10.8, 3.9),
        };
        let dimensions = dimension as f64;
        let fields = self.fields.iter().map(|field| match field {
            SnapshotField::Velocity => dimensions * single,
            SnapshotField::Pressure | SnapshotField::Density => single,
            SnapshotField::Kind => 0.0,
            SnapshotField::Id => count,
        });
        let position = dimensions * if self.single { single } else { double };
        position + 2.0 * count + fields.sum::<f64>()
    }

    /// The share of the fluid that snapshots hold, at most: how much of it is in a region is not known.
    pub fn share(&self) -> f64 {
        1.0 / self.every as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn choice(region: Option<(Vec<f64>, Vec<f64>)>, every: u64) -> SnapshotChoice {
        SnapshotChoice { region, every, ..SnapshotChoice::new(&Output::default()) }
    }

    #[test]
    fn rows_are_chosen_by_id_and_place() {
        let (ids, at) = ([4, 5, 6, 9], [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]]);
        let rows = |choice: SnapshotChoice| choice.rows(Some(&ids), &at);
        assert_eq!(rows(choice(None, 1)), None);
        assert_eq!(rows(choice(None, 3)), Some(vec![2, 3]));
        let region = Some((vec![0.5, -1.0], vec![2.5, 1.0]));
        assert_eq!(rows(choice(region.clone(), 1)), Some(vec![1, 2]));
        assert_eq!(rows(choice(region.clone(), 3)), Some(vec![2]));
        assert_eq!(choice(region, 3).rows(None, &at), Some(vec![1, 2]));
        assert_eq!(choice(None, 3).rows(None, &at), None);
    }
}
