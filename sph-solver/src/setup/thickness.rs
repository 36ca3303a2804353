//! Walls that are too thin to hold the fluid.

use super::particles::Particles;
use crate::scene::Scene;
use sph_geometry::{Aabb, Solid, depth_in_solids};

/// A wall holds the fluid when it is so many spacings thick.
const HOLDS: f64 = 2.0;

/// Two sides of a wall face away from each other when the cosine of the angle between their normals is
/// below this: 25 degrees. Edges and corners, where material is always thin, do not.
const OPPOSITE: f64 = -0.9;

/// The thinnest place of a solid.
struct Thin<const D: usize> {
    /// m.
    thickness: f64,
    at: [f64; D],
    /// How many of the wall particles at the surface are in front of too little material.
    count: usize,
    /// Wall particles at the surface.
    of: usize,
}

/// Notes on solids with walls that may leak: the solid, the place, the thickness and the spacing that
/// would do.
pub fn notes<const D: usize>(
    scene: &Scene,
    solids: &[Solid<D>],
    domain: &Aabb<D>,
    particles: &Particles<D>,
) -> Vec<String> {
    let spacing = *scene.numerics.spacing;
    let walls = particles.fluid().end;
    let mut notes = Vec::new();
    for (index, solid) in solids.iter().enumerate() {
        let mut thin = Thin { thickness: f64::INFINITY, at: [0.0; D], count: 0, of: 0 };
        for particle in particles.of_kind(1 + index as u16) {
            let (depth, normal) =
                (particles.depth[particle - walls], particles.normal[particle - walls]);
            if depth > spacing {
                continue;
            }
            thin.of += 1;
            let x = particles.position[particle];
            let surface = std::array::from_fn(|k| x[k] + depth * normal[k]);
            let Some(thickness) = thickness(solids, &surface, &normal, HOLDS * spacing) else {
                continue;
            };
            let behind: [f64; D] =
                std::array::from_fn(|k| surface[k] - (thickness + 0.5 * spacing) * normal[k]);
            if !domain.contains(&behind) {
                continue;
            }
            thin.count += 1;
            if thickness < thin.thickness {
                (thin.thickness, thin.at) = (thickness, surface);
            }
        }
        if thin.count > 0 {
            notes.push(in_words(&solid.name, &thin, spacing));
        }
    }
    notes
}

fn in_words<const D: usize>(name: &str, thin: &Thin<D>, spacing: f64) -> String {
    let Thin { thickness, at, count, of } = thin;
    let at = at.map(|x| (x / spacing * 100.0).round() * spacing / 100.0);
    let at: Vec<String> = at.iter().map(|x| format!("{x:.4}")).collect();
    format!(
        "solid {name} is only {thickness:.4} m thick at [{}], {:.1} spacings, and may leak there \
         ({:.0} % of its surface is thinner than {HOLDS} spacings): numerics.spacing = {} or less \
         would do, or a thicker wall",
        at.join(", "),
        thickness / spacing,
        (100.0 * *count as f64 / *of as f64).max(1.0),
        rounded_down(thickness / HOLDS),
    )
}

/// Two significant digits, not more than the number but for rounding.
fn rounded_down(number: f64) -> f64 {
    if number <= 0.0 {
        return number;
    }
    let decimals = (1.0 - number.log10().floor()).clamp(0.0, 300.0) as i32;
    let unit = 10.0_f64.powi(decimals);
    (number * unit * (1.0 + 1e-9)).floor() / unit
}

/// Thickness of the material of all solids behind a point of a surface, if it is below `most` (m) and
/// ends in a side that faces away.
fn thickness<const D: usize>(
    solids: &[Solid<D>],
    surface: &[f64; D],
    normal: &[f64; D],
    most: f64,
) -> Option<f64> {
    let point = |t: f64| -> [f64; D] { std::array::from_fn(|k| surface[k] - t * normal[k]) };
    let step = 1e-3 * most;
    let mut t = step;
    while t < most * (1.0 - 1e-6) {
        let depth = depth_in_solids(solids, &point(t));
        if depth < -1e-6 * most {
            // Back to the surface, which is at least so far before.
            let t = (t + depth).max(0.0);
            let x = point(t);
            let deepest = solids
                .iter()
                .max_by(|a, b| a.depth_in_solid(&x).total_cmp(&b.depth_in_solid(&x)))?;
            let other = deepest.normal(&x);
            let cosine = (0..D).map(|k| other[k] * normal[k]).sum::<f64>();
            return (cosine < OPPOSITE).then_some(t);
        }
        t += depth.max(step);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use sph_geometry::{FluidSide, Shape};

    fn solid(shape: Shape<2>) -> Solid<2> {
        Solid::new("wall", shape, FluidSide::Outside)
    }

    #[test]
    fn plates_are_as_thick_as_they_are_at_any_angle() {
        for degrees in [0.0, 17.0, 45.0] {
            let map = sph_geometry::Affine::rotation([0.0, 0.0, 1.0], degrees).unwrap();
            let plate = Shape::cuboid([-1.0, -0.03], [1.0, 0.03]).unwrap().moved(&map).unwrap();
            let (surface, normal) = (map.apply(&[0.2, 0.03]), map.apply(&[0.0, 1.0]));
            let found = thickness(&[solid(plate)], &surface, &normal, 0.2).unwrap();
            assert!((found - 0.06).abs() < 1e-9, "{degrees}: {found}");
        }
    }

    #[test]
    fn corners_and_thick_walls_are_not_thin() {
        let block = [solid(Shape::cuboid([0.0; 2], [1.0, 1.0]).unwrap())];
        assert_eq!(thickness(&block, &[0.5, 1.0], &[0.0, 1.0], 0.2), None);
        // Beside a corner, seen from its other side.
        assert_eq!(thickness(&block, &[0.001, 1.0], &[0.0, 1.0], 0.2), None);
        // The edge of a wedge of 45 degrees.
        let wedge = Shape::polygon(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]).unwrap();
        assert_eq!(thickness(&[solid(wedge)], &[0.05, 0.0], &[0.0, -1.0], 0.2), None);
    }

    #[test]
    fn two_solids_back_to_back_are_one_wall() {
        let plate = |low, high| solid(Shape::cuboid([0.0, low], [1.0, high]).unwrap());
        let both = [plate(0.0, 0.05), plate(0.05, 0.3)];
        assert!(thickness(&both[1..], &[0.5, 0.05], &[0.0, -1.0], 0.2).is_none());
        assert_eq!(thickness(&both, &[0.5, 0.0], &[0.0, -1.0], 0.2), None);
        assert!(thickness(&both[..1], &[0.5, 0.0], &[0.0, -1.0], 0.2).is_some());
    }

    #[test]
    fn spacings_that_do_are_short_numbers() {
        let found = [0.0051, 0.01, 0.123, 3.99, 0.01499999999999998].map(rounded_down);
        assert_eq!(found, [0.0051, 0.01, 0.12, 3.9, 0.015]);
    }
}
