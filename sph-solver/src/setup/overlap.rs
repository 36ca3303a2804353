//! Fluid where there is a solid: the fluid gives way.

use crate::scene::{ErrorKind, Fluid, Scene, SceneError};
use sph_geometry::{Shape, Solid};

/// Points closer to a surface than this fraction of the spacing count as on it, as they do when wall
/// particles are made.
const ON_SURFACE: f64 = 1e-6;

/// Removes fluid particles in or on solids. `ends` are where the regions end in `position`, and are
/// kept up to date. Gives notes that say how many there were, region by region and solid by solid.
///
/// # Errors
///
/// When all particles are inside solids.
pub fn give_way<const D: usize>(
    scene: &Scene,
    name: &str,
    fluid: &Fluid,
    solids: &[Solid<D>],
    position: &mut Vec<[f64; D]>,
    ends: &mut [usize],
) -> Result<Vec<String>, SceneError> {
    let margin = ON_SURFACE * *scene.numerics.spacing;
    let mut notes = Vec::new();
    let mut dropped = vec![false; position.len()];
    // The region that has lost most to one solid, for the message when nothing is left.
    let mut most: Option<(usize, ErrorKind)> = None;
    let mut start = 0;
    for (region, end) in ends.iter().enumerate() {
        for solid in solids {
            let (count, example) =
                inside(solid, &position[start..*end], margin, &mut dropped[start..*end]);
            let Some(example) = example else { continue };
            let (solid, example) = (solid.name.clone(), example.to_vec());
            notes.push(format!(
                "{count} particles of region {region} of {name} would lie inside solid {solid}, the \
                 first at {example:?}: the fluid gives way to it"
            ));
            if most.as_ref().is_none_or(|(largest, _)| count > *largest) {
                let fluid = name.into();
                let kind = ErrorKind::Overlap { fluid, region, solid, count, example };
                most = Some((count, kind));
            }
        }
        start = *end;
    }
    let left = dropped.iter().filter(|dropped| !**dropped).count();
    if let Some((_, kind)) = most.filter(|_| left == 0) {
        let place = match &kind {
            ErrorKind::Overlap { region, .. } => fluid.regions.get(*region).map(|at| at.place),
            _ => None,
        };
        return Err(scene.error(place.unwrap_or(fluid.regions.place), kind));
    }
    for end in ends.iter_mut() {
        *end = dropped[..*end].iter().filter(|dropped| !**dropped).count();
    }
    let mut dropped = dropped.iter();
    position.retain(|_| dropped.next() != Some(&true));
    Ok(notes)
}

/// Whether a point of the fluid is free, that is, outside of all solids.
pub fn is_free<const D: usize>(solids: &[Solid<D>], x: &[f64; D]) -> bool {
    solids.iter().all(|solid| solid.depth_in_solid(x) < 0.0)
}

/// Whether the box around a region comes near the material of a solid at all.
pub fn may_meet<const D: usize>(solid: &Solid<D>, region: &Shape<D>) -> bool {
    let bounds = region.bounding_box();
    let middle = std::array::from_fn(|k| 0.5 * (bounds.min[k] + bounds.max[k]));
    let half = (0..D).map(|k| (0.5 * (bounds.max[k] - bounds.min[k])).powi(2)).sum::<f64>().sqrt();
    solid.depth_in_solid(&middle) > -half
}

/// How many points that no other solid has taken are in or on a solid, and the first of them. They are
/// taken.
fn inside<const D: usize>(
    solid: &Solid<D>,
    points: &[[f64; D]],
    margin: f64,
    taken: &mut [bool],
) -> (usize, Option<[f64; D]>) {
    let mut count = 0;
    let mut first = None;
    // Everything within `clear` of `center` is outside of the solid: most points of a row are.
    let (mut center, mut clear) = ([0.0; D], 0.0);
    for (x, taken) in points.iter().zip(taken).filter(|(_, taken)| !**taken) {
        let square: f64 = x.iter().zip(&center).map(|(a, b)| (a - b) * (a - b)).sum();
        if square < clear * clear {
            continue;
        }
        let depth = solid.depth_in_solid(x);
        if depth >= -margin {
            count += 1;
            *taken = true;
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
            let mut taken = vec![false; points.len()];
            let (count, first) = inside(&solid, &points, 0.0, &mut taken);
            prop_assert_eq!(taken.iter().filter(|taken| **taken).count(), count);
            prop_assert_eq!(count, expected.clone().count());
            prop_assert_eq!(first.as_ref(), expected.clone().next());
        }
    }
}
