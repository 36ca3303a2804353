//! Solids that are too thin to fill the support of the fluid beside them.

use super::moving;
use crate::model::ThinWall;
use crate::scene::Scene;
use sph_geometry::{Aabb, Lattice, Solid, depth_in_solids, near_surface_within};

/// Two sides of a wall face away from each other when the cosine of the angle between their normals is
/// below this: 25 degrees. Edges and corners, where material is always thin, do not.
const OPPOSITE: f64 = -0.9;

/// A solid is thin when more than this share of its surface is.
const SHARE: f64 = 0.02;

/// A solid thinner than this part of the spacing may leak: what is pressed into it so far comes out on the
/// other side.
const HOLDS: f64 = 0.3;

/// A solid whose sides are walls of their own, because the material between them is thinner than the
/// support.
#[derive(Debug, Clone, PartialEq)]
pub struct Thin<const D: usize> {
    /// Its least thickness, m.
    pub thickness: f64,
    /// Where that is, m.
    pub at: [f64; D],
    /// Share of its surface that is in front of too little material.
    pub share: f64,
}

impl<const D: usize> Thin<D> {
    /// What a run knows of it.
    pub fn wall(&self, spacing: f64) -> ThinWall {
        ThinWall { below: 0.5 * self.thickness.min(spacing), spacing }
    }
}

/// Which solids are thin where fluid may meet them, one answer per solid.
pub fn thin_solids<const D: usize>(
    scene: &Scene,
    solids: &[Solid<D>],
    lattice: &Lattice<D>,
    domain: &Aabb<D>,
    support: f64,
) -> Vec<Option<Thin<D>>> {
    let at_rest = moving::at_rest(scene, solids);
    let one = |(solid, moves): (&Solid<D>, bool)| {
        let material = if moves { std::slice::from_ref(solid) } else { &at_rest[..] };
        let bounds = if moves { &Aabb::EVERYWHERE } else { domain };
        thin(solid, material, lattice, bounds, support)
    };
    solids.iter().zip(moving::moves(scene)).map(one).collect()
}

fn thin<const D: usize>(
    solid: &Solid<D>,
    material: &[Solid<D>],
    lattice: &Lattice<D>,
    domain: &Aabb<D>,
    support: f64,
) -> Option<Thin<D>> {
    let spacing = lattice.spacing();
    let around = domain.inflated(support).intersection(&solid.shape.bounding_box());
    if !around.is_finite() {
        // Material without end is not thin.
        return None;
    }
    let half = 0.5 * spacing * (D as f64).sqrt();
    let surface = near_surface_within(&solid.shape, lattice, half, &around.inflated(half)).ok()?;
    let (mut count, mut of) = (0_usize, 0_usize);
    let mut thinnest = Thin { thickness: f64::INFINITY, at: [0.0; D], share: 0.0 };
    for near in &surface {
        let x = lattice.point(&near.index);
        let (depth, normal) = solid.depth_and_normal(&x);
        let point = |depth: f64| std::array::from_fn(|k| x[k] + depth * normal[k]);
        let surface: [f64; D] = point(depth);
        // Fluid must be able to be in front of it.
        let front = point(depth + 0.5 * spacing);
        if !domain.contains(&front) || depth_in_solids(material, &front) > -0.1 * spacing {
            continue;
        }
        of += 1;
        let Some(thickness) = thickness(material, &surface, &normal, support) else { continue };
        if !domain.contains(&point(depth - thickness - 0.5 * spacing)) {
            continue;
        }
        count += 1;
        if thickness < thinnest.thickness {
            (thinnest.thickness, thinnest.at) = (thickness, surface);
        }
    }
    thinnest.share = count as f64 / of.max(1) as f64;
    (thinnest.share > SHARE).then_some(thinnest)
}

/// What deserves to be said of thin solids.
pub fn notes<const D: usize>(
    solids: &[Solid<D>],
    thin: &[Option<Thin<D>>],
    spacing: f64,
) -> Vec<String> {
    let note = |(solid, thin): (&Solid<D>, &Option<Thin<D>>)| {
        thin.as_ref().map(|thin| in_words(&solid.name, thin, spacing))
    };
    solids.iter().zip(thin).filter_map(note).collect()
}

/// The same where spacings vary: there, thin solids are made as thick ones are.
pub fn graded_notes<const D: usize>(solids: &[Solid<D>], thin: &[Option<Thin<D>>]) -> Vec<String> {
    let note = |(solid, thin): (&Solid<D>, &Option<Thin<D>>)| {
        let Thin { thickness, at, .. } = thin.as_ref()?;
        Some(format!(
            "solid {} is only {thickness:.4} m thick at {at:.4?}, less than the support of coarse particles: \
             with [[refine]] it holds only what is fine enough there",
            solid.name
        ))
    };
    solids.iter().zip(thin).filter_map(note).collect()
}

fn in_words<const D: usize>(name: &str, thin: &Thin<D>, spacing: f64) -> String {
    let Thin { thickness, at, share } = thin;
    let at = at.map(|x| (x / spacing * 100.0).round() * spacing / 100.0);
    let at: Vec<String> = at.iter().map(|x| format!("{x:.4}")).collect();
    let place = format!(
        "solid {name} is only {thickness:.4} m thick at [{}], {:.1} spacings ({:.0} % of its surface is \
         thinner than the support)",
        at.join(", "),
        thickness / spacing,
        (100.0 * share).max(1.0),
    );
    if thickness / spacing < HOLDS {
        let enough = rounded_down(thickness / HOLDS);
        return format!(
            "{place}, and may leak there: numerics.spacing = {enough} or less would do, or a thicker wall"
        );
    }
    format!("{place}: each of its sides is a wall of its own")
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
