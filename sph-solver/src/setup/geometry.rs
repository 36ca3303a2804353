//! Where fluid and walls are, before there are particles.

use super::report::MeshSummary;
use super::shapes::Shapes;
use super::{domain, fluid_box, graded, lattice_error, regions, sizes, walls};
use crate::scene::{ErrorKind, Scene, SceneError};
use sph_geometry::{Aabb, Lattice, Shape, Solid, SpacingField};

/// The shapes of a scene and the lattice on which its particles lie.
#[derive(Debug, Clone)]
pub struct Geometry<const D: usize> {
    /// The solids.
    pub solids: Vec<Solid<D>>,
    /// The regions of fluid; a point in several belongs to the first.
    pub regions: Vec<Shape<D>>,
    /// The box around them, m.
    pub fluid_box: Aabb<D>,
    /// The lattice of fluid and walls.
    pub lattice: Lattice<D>,
    /// The box that particles may be in, m.
    pub domain: Aabb<D>,
    /// The spacing at every place; none where it is the same everywhere.
    pub spacing: Option<SpacingField<D>>,
    pub(super) meshes: Vec<MeshSummary>,
    /// What deserves a look about the meshes.
    pub(super) notes: Vec<String>,
}

impl<const D: usize> Geometry<D> {
    /// Reads the shapes of a scene and the meshes that it names. With `bytes` per particle, scenes
    /// whose particles do not fit into this machine are refused.
    ///
    /// # Errors
    ///
    /// When the scene has another dimension, a shape cannot be made, or a region has no end.
    pub fn read(scene: &Scene, bytes: Option<f64>) -> Result<Self, SceneError> {
        if scene.dimension() != D {
            let dimension = scene.dimension();
            let kind = ErrorKind::Components { key: "dimension".into(), found: D, dimension };
            return Err(scene.error(scene.dimension.place, kind));
        }
        let (fluid_name, fluid) = scene.fluid()?;
        let numerics = &scene.numerics;
        let mut shapes = Shapes::new(scene);
        let solids = walls::solids(scene, &mut shapes)?;
        let regions = regions(fluid_name, fluid, &mut shapes)?;
        sizes::check(scene, &solids, &regions, &shapes.meshes)?;
        let fluid_box = fluid_box(scene, fluid, &regions, bytes)
            .map_err(|error| sizes::explain(error, scene, &solids, &regions, &shapes.meshes))?;
        let lattice = Lattice::new(regions[0].bounding_box().min, *numerics.spacing)
            .map_err(|error| lattice_error(scene, numerics.spacing.place, &error))?;
        let support = *numerics.spacing * *numerics.support;
        let domain = domain::domain(scene, &solids, &fluid_box, support);
        let spacing = graded::spacing_field(scene, &solids, &domain, &mut shapes)?;
        let Shapes { meshes, notes, .. } = shapes;
        Ok(Self { solids, regions, fluid_box, lattice, domain, spacing, meshes, notes })
    }

    /// Support radius of a scene, m.
    pub fn support(scene: &Scene) -> f64 {
        *scene.numerics.spacing * *scene.numerics.support
    }

    /// Distance up to which lists and overlap zones reach: support radius and skin, m.
    pub fn reach(scene: &Scene) -> f64 {
        let support = Self::support(scene);
        support + *scene.numerics.skin * support
    }
}
