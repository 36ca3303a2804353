//! The box that particles may be in.

use crate::scene::{ErrorKind, Fluid, Scene, SceneError, vector};
use sph_geometry::{Aabb, FluidSide, Solid};

/// The domain of a scene: its `[domain]`, or else
///
/// * with a solid that has the fluid inside: the box around such solids and the fluid, grown by two
///   support radii, so that a particle is lost when it has crossed the whole layer of wall particles;
/// * without one: the box around the fluid and the finite solids, grown by its longest side on each
///   side, which gives the fluid some room to fall and spread. Scenes like that had better say.
pub fn domain<const D: usize>(
    scene: &Scene,
    solids: &[Solid<D>],
    fluid: &Aabb<D>,
    support_radius: f64,
) -> Aabb<D> {
    if let Some(domain) = &scene.domain {
        return Aabb::new(vector(&domain.min), vector(&domain.max));
    }
    let around = |side: Option<FluidSide>| {
        let chosen = solids.iter().filter(|solid| side.is_none_or(|side| solid.fluid_side == side));
        let boxes = chosen.map(|solid| solid.shape.bounding_box());
        boxes.filter(Aabb::is_finite).fold(*fluid, |all, one| all.union(&one))
    };
    if solids.iter().any(|solid| solid.fluid_side == FluidSide::Inside) {
        around(Some(FluidSide::Inside)).inflated(2.0 * support_radius)
    } else {
        let all = around(None);
        let longest = (0..D).map(|axis| all.max[axis] - all.min[axis]).fold(0.0, f64::max);
        all.inflated(longest.max(2.0 * support_radius))
    }
}

/// Refuses fluid outside of the domain.
pub fn check<const D: usize>(
    scene: &Scene,
    fluid: &Fluid,
    domain: &Aabb<D>,
    position: &[[f64; D]],
) -> Result<(), SceneError> {
    let outside = |x: &&[f64; D]| !domain.contains(x);
    let Some(first) = position.iter().find(outside) else { return Ok(()) };
    let count = position.iter().filter(outside).count();
    let what = format!(
        "{count} particles of the fluid would be outside of the domain, the first at {first:?}"
    );
    let help = "enlarge [domain] or shrink the region".into();
    let place = scene.domain.as_ref().map_or(fluid.regions.place, |domain| domain.place);
    Err(scene.error(place, ErrorKind::Invalid { what, help }))
}
