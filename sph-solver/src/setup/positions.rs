//! Positions without the rest of the state, for reports on fields of many particles.

use super::{Geometry, domain, fill, moving, nothing, overlap, thickness, walls};
use crate::scene::{Scene, SceneError};

/// Memory that reports on positions take per particle at their peak, bytes.
pub const BYTES_PER_POSITION: f64 = 130.0;

/// The positions that a run begins with, in the order of the ids.
#[derive(Debug, Clone, PartialEq)]
pub struct Positions<const D: usize> {
    /// Of the fluid, then of the walls, m.
    pub position: Vec<[f64; D]>,
    /// How many of them are fluid.
    pub fluid: usize,
}

impl<const D: usize> Positions<D> {
    /// Fills the shapes of a scene.
    ///
    /// # Errors
    ///
    /// Like [`Setup::new`](super::Setup::new) for all that concerns places.
    pub fn new(scene: &Scene, geometry: &Geometry<D>) -> Result<Self, SceneError> {
        let (name, fluid) = scene.fluid()?;
        let Geometry { solids, regions, lattice, .. } = geometry;
        let (mut position, mut ends) = fill(scene, fluid, regions, lattice)?;
        overlap::give_way(scene, name, fluid, solids, &mut position, &mut ends)?;
        if position.is_empty() {
            return Err(nothing(scene, fluid));
        }
        domain::check(scene, fluid, &geometry.domain, &position)?;
        let support = Geometry::<D>::support(scene);
        let domain = &geometry.domain;
        let thin = thickness::thin_solids(scene, solids, lattice, domain, support);
        let walls = walls::find_walls(scene, solids, &thin, lattice, domain, support)?;
        let fluid = position.len();
        position.extend_from_slice(&walls.positions);
        for mut body in moving::bodies(scene, solids)? {
            let elements = moving::elements(&body, &thin, lattice, support);
            moving::add_elements(scene, &mut body, elements)?;
            position.extend_from_slice(&body.elements.position);
        }
        Ok(Self { position, fluid })
    }
}
