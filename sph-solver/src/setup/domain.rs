//! The box that particles may be in.

use crate::scene::{ErrorKind, Fluid, Place, Scene, SceneError, vector};
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

/// The periods of the axes that repeat. Between two images of a particle there must be room for its
/// support and that of its neighbours, and the lattice must go on across the sides.
pub fn periods<const D: usize>(
    scene: &Scene,
    domain: &Aabb<D>,
    spacing: f64,
    reach: f64,
) -> Result<[Option<f64>; D], SceneError> {
    let mut periods = [None; D];
    for (axis, periodic) in scene.periodic_axes::<D>().into_iter().enumerate() {
        if !periodic {
            continue;
        }
        let length = domain.max[axis] - domain.min[axis];
        let name = ["x", "y", "z"][axis];
        let place = scene.domain.as_ref().map_or(Place::default(), |domain| domain.place);
        let refuse =
            |what: String, help: String| Err(scene.error(place, ErrorKind::Invalid { what, help }));
        if length < 2.0 * reach {
            return refuse(
                format!("the domain is {length} m long along the periodic axis {name}"),
                format!(
                    "make it at least {} m long: twice the support radius and the skin",
                    2.0 * reach
                ),
            );
        }
        let cells = length / spacing;
        if (cells - cells.round()).abs() > 1e-6 * cells {
            return refuse(
                format!(
                    "the domain is {length} m long along the periodic axis {name}, which is \
                     {cells:.3} spacings"
                ),
                format!(
                    "give it a whole number of spacings, or set numerics.spacing to {}",
                    length / cells.round()
                ),
            );
        }
        periods[axis] = Some(length);
    }
    Ok(periods)
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
