//! Sets of lattice points, stored as runs along x.

use super::{CellBox, Lattice};

/// A set of lattice points. Memory grows with its surface, not with its volume.
#[derive(Debug, Clone)]
pub struct LatticeRuns<const D: usize> {
    lattice: Lattice<D>,
    cells: CellBox<D>,
    /// Where the runs of each row start; one entry more than rows.
    starts: Vec<usize>,
    /// First index and end of each run.
    runs: Vec<[i64; 2]>,
}

impl<const D: usize> LatticeRuns<D> {
    /// The points where `distance` is negative. It may change by at most the distance between two
    /// points, as a signed distance does, so that points far from its zeros are skipped.
    pub(crate) fn trace(
        lattice: Lattice<D>,
        cells: CellBox<D>,
        distance: impl Fn(&[f64; D]) -> f64,
    ) -> Self {
        let rows = cells.rows();
        let mut starts = Vec::with_capacity(rows + 1);
        let mut runs: Vec<[i64; 2]> = Vec::new();
        starts.push(0);
        for row in 0..rows {
            let mut index = cells.row_start(row);
            let mut open: Option<i64> = None;
            while index[0] < cells.end[0] {
                let value = distance(&lattice.point(&index));
                match (value < 0.0, open) {
                    (true, None) => open = Some(index[0]),
                    (false, Some(start)) => {
                        runs.push([start, index[0]]);
                        open = None;
                    }
                    _ => {}
                }
                // Up to this far away everything is on the same side. The small part keeps points
                // that lie on the surface but for rounding from being skipped.
                let same = (value.abs() / lattice.spacing - 1e-6).ceil();
                index[0] = index[0].saturating_add((same as i64).max(1));
            }
            if let Some(start) = open {
                runs.push([start, cells.end[0]]);
            }
            starts.push(runs.len());
        }
        Self { lattice, cells, starts, runs }
    }

    /// The lattice.
    pub fn lattice(&self) -> &Lattice<D> {
        &self.lattice
    }

    /// Number of points.
    pub fn count(&self) -> u64 {
        self.runs.iter().map(|[start, end]| end.abs_diff(*start)).sum()
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.runs.is_empty()
    }

    /// Indices of the points in ascending order, x fastest.
    pub fn indices(&self) -> impl Iterator<Item = [i64; D]> + '_ {
        (0..self.cells.rows()).flat_map(move |row| {
            let start = self.cells.row_start(row);
            self.row_runs(row).iter().flat_map(move |&[first, end]| {
                (first..end).map(move |x| {
                    let mut index = start;
                    index[0] = x;
                    index
                })
            })
        })
    }

    /// The points in ascending order of their indices, x fastest.
    pub fn points(&self) -> impl Iterator<Item = [f64; D]> + '_ {
        self.indices().map(|index| self.lattice.point(&index))
    }

    /// Whether the point with an index is in the set.
    pub fn contains(&self, index: &[i64; D]) -> bool {
        self.meets(index, index[0], index[0])
    }

    fn row_runs(&self, row: usize) -> &[[i64; 2]] {
        &self.runs[self.starts[row]..self.starts[row + 1]]
    }

    /// Whether the row of `index` has a point from `first` to `last`.
    fn meets(&self, index: &[i64; D], first: i64, last: i64) -> bool {
        let Some(row) = self.cells.row(index) else { return false };
        let runs = self.row_runs(row);
        let next = runs.partition_point(|run| run[1] <= first);
        runs.get(next).is_some_and(|run| run[0] <= last)
    }

    /// Whether a cell of the set lies closer to a lattice point than a reach. Along periodic axes
    /// the cells of the set repeat.
    pub(crate) fn is_near(&self, index: &[i64; D], reach: &Reach<D>) -> bool {
        reach.rows.iter().any(|(offset, width)| {
            let row = std::array::from_fn(|k| self.wrapped(k, index[k] + offset[k], reach));
            let (first, last) = (row[0] - width, row[0] + width);
            let length = self.cells.len(0);
            self.meets(&row, first, last)
                || reach.periodic[0]
                    && (self.meets(&row, first + length, last + length)
                        || self.meets(&row, first - length, last - length))
        })
    }

    fn wrapped(&self, axis: usize, index: i64, reach: &Reach<D>) -> i64 {
        if !reach.periodic[axis] {
            return index;
        }
        let first = self.cells.first[axis];
        first + (index - first).rem_euclid(self.cells.len(axis))
    }
}

/// Which cells come closer to the middle of a cell than a distance.
pub(crate) struct Reach<const D: usize> {
    /// Offset of a row along x, and how many cells of it to either side; nearest rows first.
    rows: Vec<([i64; D], i64)>,
    periodic: [bool; D],
}

impl<const D: usize> Reach<D> {
    /// `distance` in units of the spacing.
    pub fn new(distance: f64, periodic: [bool; D]) -> Self {
        // Distance from the middle of one cell to the nearest side of another along an axis.
        let gap = |cells: i64| (cells.unsigned_abs() as f64 - 0.5).max(0.0);
        let most = distance.ceil() as i64 + 1;
        let side = 2 * most + 1;
        let mut rows: Vec<([i64; D], i64)> = Vec::new();
        for row in 0..side.pow(D as u32 - 1) {
            let mut offset = [0; D];
            let mut rest = row;
            for o in offset.iter_mut().skip(1) {
                *o = rest % side - most;
                rest /= side;
            }
            let across: f64 = offset.iter().map(|&o| gap(o) * gap(o)).sum();
            let along = distance * distance - across;
            if along > 0.0 {
                // The greatest whole number below √along + ½.
                let width = (along.sqrt() + 0.5).ceil() as i64 - 1;
                rows.push((offset, width));
            }
        }
        rows.sort_by_key(|(offset, width)| (-width, *offset));
        Self { rows, periodic }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Shape;
    use proptest::prelude::*;

    const CELLS: CellBox<3> = CellBox { first: [-3, -4, -5], end: [9, 8, 7] };

    fn lattice() -> Lattice<3> {
        Lattice::new([0.05, -0.02, 0.01], 0.1).unwrap()
    }

    fn all() -> impl Iterator<Item = [i64; 3]> {
        (-5..7).flat_map(|z| (-4..8).flat_map(move |y| (-3..9).map(move |x| [x, y, z])))
    }

    proptest! {
        #[test]
        fn skipping_finds_the_same_points(
            center in prop::array::uniform3(-0.5..1.0),
            radius in 0.01..0.8,
            hole in 0.01..0.8,
        ) {
            let shape = Shape::difference(
                Shape::sphere(center, radius).unwrap(),
                vec![Shape::sphere([0.3; 3], hole).unwrap()],
            );
            let runs = LatticeRuns::trace(lattice(), CELLS, |x| shape.signed_distance(x));
            let inside = |index: &[i64; 3]| shape.contains(&lattice().point(index));
            let brute: Vec<[i64; 3]> = all().filter(inside).collect();
            prop_assert_eq!(runs.indices().collect::<Vec<_>>(), brute.clone());
            prop_assert_eq!(runs.count(), brute.len() as u64);
            prop_assert_eq!(runs.is_empty(), brute.is_empty());
            for index in all() {
                prop_assert_eq!(runs.contains(&index), inside(&index));
            }
        }

        #[test]
        fn near_cells_agree_with_brute_force(
            members in prop::collection::btree_set((0..12i64, 0..12i64, 0..12i64), 1..6),
            distance in 0.3..4.0,
            periodic in prop::array::uniform3(any::<bool>()),
        ) {
            let members: Vec<[i64; 3]> =
                members.into_iter().map(|(x, y, z)| [x - 3, y - 4, z - 5]).collect();
            let runs = LatticeRuns::trace(lattice(), CELLS, |x| {
                let same = |m: &[i64; 3]| crate::vector::distance(x, &lattice().point(m)) < 1e-9;
                if members.iter().any(same) { -1e-9 } else { 1e-9 }
            });
            prop_assert_eq!(runs.count(), members.len() as u64);
            let reach = Reach::new(distance, periodic);
            for index in all() {
                let near = members.iter().any(|m| {
                    let sum: f64 = (0..3)
                        .map(|k| {
                            let d = (m[k] - index[k]).abs();
                            let d = if periodic[k] { d.min(12 - d) } else { d };
                            (d as f64 - 0.5).max(0.0).powi(2)
                        })
                        .sum();
                    sum < distance * distance
                });
                prop_assert_eq!(runs.is_near(&index, &reach), near, "{:?}", index);
            }
        }
    }
}
