//! Fluid where there is a solid.

use crate::scene::{ErrorKind, Fluid, Scene, SceneError};
use sph_geometry::Solid;

/// Points closer to a surface than this fraction of the spacing count as on it, as they do when wall
/// particles are made.
const ON_SURFACE: f64 = 1e-6;

/// Refuses fluid particles in or on a solid, region by region, solid by solid.
pub fn check<const D: usize>(
    scene: &Scene,
    name: &str,
    fluid: &Fluid,
    solids: &[Solid<D>],
    position: &[[f64; D]],
    ends: &[usize],
) -> Result<(), SceneError> {
    let margin = ON_SURFACE * *scene.numerics.spacing;
    let mut start = 0;
    for (index, (region, end)) in fluid.regions.iter().zip(ends).enumerate() {
        let particles = &position[start..*end];
        start = *end;
        for solid in solids {
            let (count, example) = inside(solid, particles, margin);
            if let Some(example) = example {
                let kind = ErrorKind::Overlap {
                    fluid: name.into(),
                    region: index,
                    solid: solid.name.clone(),
                    count,
                    example: example.to_vec(),
                };
                return Err(scene.error(region.place, kind));
            }
        }
    }
    Ok(())
}

/// How many points are in or on a solid, and the first of them.
fn inside<const D: usize>(
    solid: &Solid<D>,
    points: &[[f64; D]],
    margin: f64,
) -> (usize, Option<[f64; D]>) {
    let mut count = 0;
    let mut first = None;
    // Everything within `clear` of `center` is outside of the solid: most points of a row are.
    let (mut center, mut clear) = ([0.0; D], 0.0);
    for x in points {
        let square: f64 = x.iter().zip(&center).map(|(a, b)| (a - b) * (a - b)).sum();
        if square < clear * clear {
            continue;
        }
        let depth = solid.depth_in_solid(x);
        if depth >= -margin {
            count += 1;
            first.get_or_insert(*x);
        } else {
            (center, clear) = (*x, -depth - margin);
        }
    }
    (count, first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use sph_geometry::{FluidSide, Shape};

    proptest! {
        #[test]
        fn skipping_agrees_with_looking_at_every_point(
            center in prop::array::uniform2(-1.0..1.0),
            radius in 0.05..1.0,
            hollow: bool,
            points in prop::collection::vec(prop::array::uniform2(-2.0..2.0), 0..60),
        ) {
            let side = if hollow { FluidSide::Inside } else { FluidSide::Outside };
            let solid = Solid::new("ball", Shape::sphere(center, radius).unwrap(), side);
            let expected = points.iter().filter(|x| solid.depth_in_solid(x) >= 0.0);
            let (count, first) = inside(&solid, &points, 0.0);
            prop_assert_eq!(count, expected.clone().count());
            prop_assert_eq!(first.as_ref(), expected.clone().next());
        }
    }
}
