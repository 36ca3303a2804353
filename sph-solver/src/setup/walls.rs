//! Solids of a scene and the particles of their walls.

use super::constants::Constants;
use super::particles::Particles;
use super::shapes::Shapes;
use super::{LARGEST, MOST_PARTICLES, lattice_error, memory, too_many};
use crate::scene::{self, At, ErrorKind, Scene, SceneError};
use sph_geometry::{Aabb, Domain, FluidSide, Lattice, Solid, WallParticles, wall_particles};

/// More rows of lattice cells than this are not searched; a domain that large is a mistake.
const MOST_ROWS: f64 = 1e9;

/// The solids of the scene as geometry.
pub fn solids<const D: usize>(
    scene: &Scene,
    shapes: &mut Shapes<'_>,
) -> Result<Vec<Solid<D>>, SceneError> {
    let make = |solid: &At<scene::Solid>| {
        let user = format!("solid {}", *solid.name);
        let shape = shapes.only(&user, solid.place, &solid.shapes())?;
        // Only planes have no side; their material is the half space itself.
        let side = match solid.fluid_side.map(|side| *side) {
            Some(scene::FluidSide::Inside) => FluidSide::Inside,
            Some(scene::FluidSide::Outside) | None => FluidSide::Outside,
        };
        Ok(Solid::new(solid.name.as_str(), shape, side))
    };
    if let Some(surplus) = scene.solid.get(usize::from(u16::MAX)) {
        let kind = ErrorKind::Invalid {
            what: format!("the scene has {} solids", scene.solid.len()),
            help: "65535 is the most; join some by `union`".into(),
        };
        return Err(scene.error(surplus.place, kind));
    }
    scene.solid.iter().map(make).collect()
}

/// Adds the wall particles, solid by solid.
pub fn add_walls<const D: usize>(
    scene: &Scene,
    solids: &[Solid<D>],
    lattice: &Lattice<D>,
    constants: &Constants<D>,
    mass: f64,
    particles: &mut Particles<D>,
) -> Result<(), SceneError> {
    let bounds = Aabb::new(constants.domain.0, constants.domain.1);
    let walls = find_walls(scene, solids, lattice, &bounds, constants.support_radius)?;
    let total = particles.len() + walls.positions.len();
    if total as f64 > MOST_PARTICLES {
        return Err(too_many(scene, total as f64, LARGEST));
    }
    let needed = memory::to_set_up::<D>(walls.positions.len() as f64);
    if let Some(available) = memory::available().filter(|available| needed > *available) {
        let [needed, available] = [needed, available].map(memory::gibibytes);
        let why = format!("its walls need {needed}, and {available} are free here");
        return Err(too_many(scene, total as f64, &why));
    }
    // Solid by solid; within a solid in the order of the lattice.
    let mut order: Vec<usize> = (0..walls.positions.len()).collect();
    order.sort_by_key(|wall| walls.solids[*wall]);
    for wall in order {
        let kind = 1 + walls.solids[wall] as u16;
        particles.push(walls.positions[wall], [0.0; D], constants.density0, mass, kind);
    }
    Ok(())
}

/// The wall particles within `support` (m) of where fluid can be.
pub fn find_walls<const D: usize>(
    scene: &Scene,
    solids: &[Solid<D>],
    lattice: &Lattice<D>,
    bounds: &Aabb<D>,
    support: f64,
) -> Result<WallParticles<D>, SceneError> {
    if solids.is_empty() {
        return Ok(WallParticles::default());
    }
    let place = scene.domain.as_ref().map_or(scene.numerics.spacing.place, |domain| domain.place);
    let sides = (1..D).map(|axis| (bounds.max[axis] - bounds.min[axis]) / lattice.spacing());
    if sides.product::<f64>() > MOST_ROWS {
        let kind = ErrorKind::Invalid {
            what: format!(
                "the domain {:?} to {:?} is too large for a spacing of {} m",
                bounds.min,
                bounds.max,
                lattice.spacing()
            ),
            help: "give a smaller [domain] or a larger numerics.spacing".into(),
        };
        return Err(scene.error(place, kind));
    }
    wall_particles(solids, lattice, support, &Domain::new(*bounds))
        .map_err(|error| lattice_error(scene, place, &error))
}
