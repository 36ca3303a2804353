//! Cells that match the spacing: a tree over the cells of the coarsest lattice.

use super::SpacingField;
use crate::aabb::Aabb;
use crate::lattice::{CellBox, Lattice, LatticeError};
use crate::solid::{Solid, depth_in_solids};

/// A cell of the tree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell<const D: usize> {
    /// How often the coarsest cell was halved.
    pub level: u32,
    /// Middle, m.
    pub center: [f64; D],
    /// Edge, m.
    pub edge: f64,
    /// Spacing of the particles at the middle, m: at least the edge, less than twice that.
    pub spacing: f64,
}

/// The cells of a lattice, each halved along all axes until its edge is no longer than the spacing at
/// its middle. Where the spacing is constant over some distance, and a half, a quarter … of the
/// coarsest, cells are a lattice of that spacing.
#[derive(Debug, Clone)]
pub struct CellTree<'a, const D: usize> {
    /// Lattices of all levels, the coarsest first.
    lattices: Vec<Lattice<D>>,
    field: &'a SpacingField<D>,
    /// Solids in which cells may be larger with depth, and the support radius in spacings.
    solids: Option<(&'a [Solid<D>], f64)>,
}

/// Edges may exceed spacings by this share: rounding must not halve a cell.
const SLACK: f64 = 1e-9;

impl<'a, const D: usize> CellTree<'a, D> {
    /// The tree over a lattice, whose spacing is the coarsest of the field.
    ///
    /// # Errors
    ///
    /// When a lattice of the finest spacing cannot be.
    pub fn new(lattice: &Lattice<D>, field: &'a SpacingField<D>) -> Result<Self, LatticeError> {
        let mut lattices = vec![*lattice];
        let mut spacing = lattice.spacing();
        while spacing > field.finest() * (1.0 + SLACK) {
            spacing *= 0.5;
            lattices.push(Lattice::new(lattice.origin(), spacing)?);
        }
        Ok(Self { lattices, field, solids: None })
    }

    /// The same for the walls of these solids: at a depth that only particles of a larger spacing see, with
    /// a support radius of `supports` spacings, cells have that spacing.
    #[must_use]
    pub fn of_walls(&self, solids: &'a [Solid<D>], supports: f64) -> Self {
        Self { solids: Some((solids, supports)), ..self.clone() }
    }

    /// Lattices of all levels, the coarsest first.
    pub fn lattices(&self) -> &[Lattice<D>] {
        &self.lattices
    }

    /// The field.
    pub fn field(&self) -> &SpacingField<D> {
        self.field
    }

    /// Calls `visit` with every cell in a box of cells of the coarsest lattice, those that are close
    /// together mostly one after the other.
    ///
    /// # Errors
    ///
    /// When the box is too large to be visited.
    pub fn for_each(
        &self,
        bounds: &Aabb<D>,
        mut visit: impl FnMut(Cell<D>),
    ) -> Result<(), LatticeError> {
        let lattice = &self.lattices[0];
        let cells: CellBox<D> = lattice.cells("region", bounds)?;
        for row in 0..cells.rows() {
            let mut index = cells.row_start(row);
            for i in cells.first[0]..cells.end[0] {
                index[0] = i;
                self.split(0, &index, &mut visit);
            }
        }
        Ok(())
    }

    fn split(&self, level: usize, index: &[i64; D], visit: &mut impl FnMut(Cell<D>)) {
        if let Some(cell) = self.leaf(level, index) {
            visit(cell);
            return;
        }
        for child in 0..1 << D {
            let of_child = std::array::from_fn(|k| 2 * index[k] + (child >> k & 1));
            self.split(level + 1, &of_child, visit);
        }
    }

    /// The cell with an index, if it is not divided any further.
    fn leaf(&self, level: usize, index: &[i64; D]) -> Option<Cell<D>> {
        let lattice = &self.lattices[level];
        let (center, edge) = (lattice.point(index), lattice.spacing());
        let mut spacing = self.field.at(&center);
        if let Some((solids, supports)) = self.solids.filter(|_| edge > spacing) {
            let seen_by = depth_in_solids(solids, &center) / supports;
            spacing = spacing.max(seen_by.min(self.field.coarsest()));
        }
        let whole = edge <= spacing * (1.0 + SLACK) || level + 1 == self.lattices.len();
        whole.then_some(Cell { level: level as u32, center, edge, spacing: spacing.max(edge) })
    }

    /// The cell that holds a point.
    pub fn cell_at(&self, x: &[f64; D]) -> Cell<D> {
        let mut level = 0;
        loop {
            let lattice = &self.lattices[level];
            let along =
                |k: usize| ((x[k] - lattice.origin()[k]) / lattice.spacing()).floor() as i64;
            if let Some(cell) = self.leaf(level, &std::array::from_fn(along)) {
                return cell;
            }
            level += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graded::Refinement;
    use crate::shape::Shape;

    #[test]
    fn cells_fill_space_once_and_match_the_spacing() {
        let target = Shape::sphere([0.3, 0.2], 0.1).unwrap();
        let one = Refinement { target, spacing: 0.0125, within: 0.05, growth: 1.1 };
        let field = SpacingField::new(0.1, vec![one], [None; 2]);
        let lattice = Lattice::new([0.0; 2], 0.1).unwrap();
        let tree = CellTree::new(&lattice, &field).unwrap();
        assert_eq!(tree.lattices().len(), 4);
        let (mut area, mut levels) = (0.0, [0; 4]);
        let bounds = Aabb::new([0.0; 2], [3.0; 2]);
        tree.for_each(&bounds, |cell| {
            assert!(cell.edge <= cell.spacing * 1.001 && cell.spacing < 2.0 * cell.edge * 1.2);
            assert_eq!(tree.cell_at(&cell.center), cell);
            if bounds.contains(&cell.center) {
                area += cell.edge * cell.edge;
                levels[cell.level as usize] += 1;
            }
        })
        .unwrap();
        assert!((area - 9.0).abs() < 1e-12, "{area}");
        assert!(levels.iter().all(|count| *count > 10), "{levels:?}");
    }

    #[test]
    fn without_refinement_it_is_the_lattice() {
        let field = SpacingField::new(0.1, vec![], [None; 3]);
        let lattice = Lattice::new([0.0; 3], 0.1).unwrap();
        let tree = CellTree::new(&lattice, &field).unwrap();
        let cell = tree.cell_at(&[0.17, 0.05, -0.01]);
        assert_eq!((cell.level, cell.center), (0, lattice.point(&[1, 0, -1])));
    }
}
