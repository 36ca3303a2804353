//! How much fluid the regions of a scene hold.

use super::overlap;
use sph_geometry::{Shape, Solid};

/// Points that measure a region: the result is right to about a thousandth.
const POINTS: u32 = 1 << 16;

/// Volume of all regions together, without the solids in them, m³ (m² in two dimensions): the share of
/// evenly spread points in the box around each region that are in it and in no earlier one. Exact for
/// boxes that do not overlap.
///
/// The points are the additive recurrence of Roberts (2018), "The unreasonable effectiveness of
/// quasirandom sequences": multiples of the powers of 1/φ, φ the root of φ^(D+1) = φ + 1.
pub fn of_regions<const D: usize>(regions: &[Shape<D>], solids: &[Solid<D>]) -> f64 {
    let steps = steps::<D>();
    let volume = |(index, region): (usize, &Shape<D>)| {
        let bounds = region.bounding_box();
        let sides: [f64; D] = std::array::from_fn(|k| (bounds.max[k] - bounds.min[k]).max(0.0));
        let solids: Vec<Solid<D>> =
            solids.iter().filter(|solid| overlap::may_meet(solid, region)).cloned().collect();
        let inside = (0..POINTS).filter(|&n| {
            let x = std::array::from_fn(|k| {
                bounds.min[k] + sides[k] * (0.5 + f64::from(n) * steps[k]).fract()
            });
            region.contains(&x)
                && !regions[..index].iter().any(|earlier| earlier.contains(&x))
                && overlap::is_free(&solids, &x)
        });
        sides.iter().product::<f64>() * inside.count() as f64 / f64::from(POINTS)
    };
    regions.iter().enumerate().map(volume).sum()
}

fn steps<const D: usize>() -> [f64; D] {
    let mut phi: f64 = 2.0;
    for _ in 0..40 {
        phi = (1.0 + phi).powf(1.0 / (D as f64 + 1.0));
    }
    std::array::from_fn(|k| phi.powi(-(k as i32 + 1)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn shapes_have_their_volumes() {
        let cuboid = |max| Shape::cuboid([0.0; 3], max).unwrap();
        assert_eq!(of_regions(&[cuboid([0.31, 0.2, 0.1])], &[]), 0.31 * 0.2 * 0.1);
        let ball = Shape::sphere([1.0, 2.0, 3.0], 0.5).unwrap();
        let volume = 4.0 / 3.0 * PI * 0.125;
        assert!((of_regions(&[ball], &[]) / volume - 1.0).abs() < 2e-3);
        let disk = Shape::sphere([0.0, 0.0], 2.0).unwrap();
        assert!((of_regions(&[disk], &[]) / (4.0 * PI) - 1.0).abs() < 2e-3);
        let corner = Shape::difference(cuboid([1.0; 3]), vec![cuboid([0.77, 0.5, 1.0])]);
        assert!((of_regions(&[corner], &[]) / (1.0 - 0.385) - 1.0).abs() < 2e-3);
    }

    #[test]
    fn what_overlaps_counts_once() {
        let bar = |max| Shape::cuboid([0.0; 2], max).unwrap();
        let volume = of_regions(&[bar([1.0, 0.2]), bar([0.2, 1.0])], &[]);
        assert!((volume / 0.36 - 1.0).abs() < 2e-3, "{volume}");
    }

    #[test]
    fn what_solids_take_does_not_count() {
        let bar = |min, max| Shape::cuboid(min, max).unwrap();
        let post = bar([0.4, -1.0], [0.6, 0.5]);
        let solids = [Solid::new("post", post, sph_geometry::FluidSide::Outside)];
        let volume = of_regions(&[bar([0.0; 2], [1.0, 1.0])], &solids);
        assert!((volume / 0.9 - 1.0).abs() < 2e-3, "{volume}");
    }
}
