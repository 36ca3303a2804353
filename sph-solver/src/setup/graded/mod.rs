//! Fluid of different spacings: from the `[[refine]]` of a scene to positions and volumes.
//!
//! Cells that match the spacing ([`sph_geometry::CellTree`]) fill the regions. Where the spacing is constant
//! they hold a particle each, and that is a lattice. In between there are too many of them: so many are
//! kept as the spacing asks for ([`seeds`]), and these are packed until sums over neighbours are even
//! ([`packing`]).

mod packing;
mod seeds;

use super::shapes::Shapes;
use super::{Geometry, lattice_error};
use crate::bodies::Body;
use crate::scene::{Scene, SceneError};
use sph_geometry::{
    Aabb, CellTree, Domain, FluidSide, LatticeError, Refinement, Shape, Solid, SpacingField,
    WallElements, graded_body_elements, graded_wall_elements,
};

/// The spacing at every place; none for a scene that refines nothing.
///
/// # Errors
///
/// When a shape to refine around cannot be made.
pub fn spacing_field<const D: usize>(
    scene: &Scene,
    solids: &[Solid<D>],
    domain: &Aabb<D>,
    shapes: &mut Shapes<'_>,
) -> Result<Option<SpacingField<D>>, SceneError> {
    if scene.refine.is_empty() {
        return Ok(None);
    }
    let coarsest = *scene.numerics.spacing;
    let mut all = Vec::new();
    for (index, keys) in scene.refine.iter().enumerate() {
        let named = keys.solid.as_ref().and_then(|name| solids.iter().find(|s| s.name == **name));
        let target = match named {
            Some(solid) => Shape::custom(solid.clone()),
            None => {
                let user = format!("refinement {index}");
                shapes.only(&user, keys.place, &keys.shapes(), &keys.placing())?
            }
        };
        let spacing = coarsest / f64::from(*keys.factor);
        all.push(Refinement { target, spacing, within: keys.within(), growth: keys.growth() });
    }
    let length = |k: usize| domain.max[k] - domain.min[k];
    let periodic = scene.periodic_axes::<D>();
    let periods = std::array::from_fn(|k| periodic[k].then(|| length(k)));
    Ok(Some(SpacingField::new(coarsest, all, periods)))
}

/// Fluid of different spacings.
#[derive(Debug)]
pub struct GradedFluid<const D: usize> {
    /// Positions, m.
    pub position: Vec<[f64; D]>,
    /// Volumes, m^D.
    pub volume: Vec<f64>,
    /// Where the regions end in them.
    pub ends: Vec<usize>,
}

/// Thins out and packs the cells in `position`, of which regions end at `ends`.
///
/// # Errors
///
/// When there are too many cells.
pub fn pack<const D: usize>(
    scene: &Scene,
    geometry: &Geometry<D>,
    field: &SpacingField<D>,
    position: &[[f64; D]],
    ends: &[usize],
) -> Result<GradedFluid<D>, SceneError> {
    let tree = tree(scene, geometry, field)?;
    let seeds = seeds::thinned(&tree, position, ends);
    let place = scene.numerics.spacing.place;
    let supports = *scene.numerics.support;
    // What is not fluid: everything outside of the regions, and solids in them.
    let outside = Shape::union(geometry.regions.clone()).map(|fluid| {
        let mut all = vec![Solid::new("outside", fluid, FluidSide::Inside)];
        all.extend_from_slice(&geometry.solids);
        all
    });
    let around = match outside {
        Ok(outside) => {
            let margin = 2.0 * supports * field.coarsest();
            let mut bounds = geometry.fluid_box.inflated(margin);
            let periodic = scene.periodic_axes();
            for k in (0..D).filter(|&k| periodic[k]) {
                (bounds.min[k], bounds.max[k]) = (geometry.domain.min[k], geometry.domain.max[k]);
            }
            graded_wall_elements(&outside, &tree, supports, &Domain { bounds, periodic })
                .map_err(|error| lattice_error(scene, place, &error))?
        }
        Err(_) => WallElements::default(),
    };
    packing::packed(scene, geometry, field, seeds, &around)
}

/// The middles of the cells in the regions, region by region, and where the regions end.
///
/// # Errors
///
/// When there are too many cells.
pub fn cells<const D: usize>(
    scene: &Scene,
    geometry: &Geometry<D>,
    field: &SpacingField<D>,
) -> Result<(Vec<[f64; D]>, Vec<usize>), SceneError> {
    let tree = tree(scene, geometry, field)?;
    let (mut position, mut ends) = (Vec::new(), Vec::new());
    for (index, region) in geometry.regions.iter().enumerate() {
        let earlier = &geometry.regions[..index];
        tree.for_each(&region.bounding_box(), |cell| {
            // Points on the surface of a region are not in it, so that later regions may have them.
            let margin = 1e-6 * cell.edge;
            let inside = |shape: &Shape<D>| shape.signed_distance(&cell.center) + margin < 0.0;
            if inside(region) && !earlier.iter().any(inside) {
                position.push(cell.center);
            }
        })
        .map_err(|error| lattice_error(scene, scene.numerics.spacing.place, &error))?;
        ends.push(position.len());
    }
    Ok((position, ends))
}

/// The cells of a scene.
///
/// # Errors
///
/// When the finest spacing is too small for a lattice.
pub fn tree<'a, const D: usize>(
    scene: &Scene,
    geometry: &Geometry<D>,
    field: &'a SpacingField<D>,
) -> Result<CellTree<'a, D>, SceneError> {
    CellTree::new(&geometry.lattice, field)
        .map_err(|error| lattice_error(scene, scene.numerics.spacing.place, &error))
}

/// The wall elements of a solid that moves, in cells as fine as the finest particles near it at the
/// start.
///
/// # Errors
///
/// When the finest spacing is too small for a lattice.
pub fn body_elements<const D: usize>(
    scene: &Scene,
    geometry: &Geometry<D>,
    field: &SpacingField<D>,
    body: &Body<D>,
) -> Result<WallElements<D>, LatticeError> {
    let near = field.least_in(&body.shape.shape.bounding_box());
    let halvings = (field.coarsest() / near * (1.0 - 1e-9)).log2().ceil().max(0.0);
    let spacing = field.coarsest() * 0.5_f64.powf(halvings);
    graded_body_elements(&body.shape, &geometry.lattice, spacing, *scene.numerics.support)
}
