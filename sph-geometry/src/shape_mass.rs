//! Mass, centre and inertia of a body of any shape.

use crate::mesh::MassProperties;
use crate::shape::Shape;
use nalgebra::{Matrix3, Vector3};

/// Cells along the longest side of the box around a shape.
const CELLS: f64 = 64.0;

/// Mass properties of a body that fills a shape of finite extent, by a sum over some 64^D cells of the
/// box around it; exact for a box along the axes, otherwise good to about a thousandth. `density` in
/// kg/m³. In two dimensions volume and mass are those of a metre of depth, and the inertia is that
/// about z.
///
/// Nothing has the volume 0 and the centre 0.
pub fn shape_mass_properties<const D: usize>(shape: &Shape<D>, density: f64) -> MassProperties {
    let bounds = shape.bounding_box();
    let sides: [f64; D] = std::array::from_fn(|k| (bounds.max[k] - bounds.min[k]).max(0.0));
    let longest = sides.iter().copied().fold(0.0, f64::max);
    let counts = sides.map(|side| (CELLS * side / longest).ceil().clamp(1.0, CELLS) as usize);
    let step: [f64; D] = std::array::from_fn(|k| sides[k] / counts[k] as f64);
    let cell: f64 = step.iter().product();
    let (mut volume, mut first, mut second) = (0.0, Vector3::zeros(), Matrix3::zeros());
    // The cells themselves have an inertia too.
    let own: Vector3<f64> =
        Vector3::from_fn(|k, _| step.get(k).map_or(0.0, |step| step * step / 12.0));
    for number in 0..counts.iter().product::<usize>() {
        let mut rest = number;
        let offset: [f64; D] = std::array::from_fn(|k| {
            let index = rest % counts[k];
            rest /= counts[k];
            (index as f64 + 0.5) * step[k]
        });
        let x: [f64; D] = std::array::from_fn(|k| bounds.min[k] + offset[k]);
        let nearest = shape.nearest(&x);
        // How far the cell reaches along the normal, for a slab of the same variance.
        let width = (0..D).map(|k| (nearest.normal[k] * step[k]).powi(2)).sum::<f64>().sqrt();
        let share = (0.5 - nearest.distance / width).clamp(0.0, 1.0);
        if share > 0.0 {
            // A part of a cell lies on its inner side.
            let inwards = 0.5 * width * (1.0 - share);
            let place = |k: usize| offset.get(k).map(|x| x - inwards * nearest.normal[k]);
            let r = Vector3::from_fn(|k, _| place(k).unwrap_or(0.0));
            volume += share * cell;
            first += r * (share * cell);
            second += (r * r.transpose() + Matrix3::from_diagonal(&own)) * (share * cell);
        }
    }
    let middle = if volume > 0.0 { first / volume } else { first };
    let spread = second - middle * middle.transpose() * volume;
    let low = Vector3::from_fn(|k, _| bounds.min.get(k).copied().unwrap_or(0.0));
    MassProperties {
        volume,
        mass: density * volume,
        center: if volume > 0.0 { low + middle } else { middle },
        inertia: (Matrix3::identity() * spread.trace() - spread) * density,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_is_exact() {
        let shape = Shape::cuboid([1.0, -1.0, 0.0], [1.5, 0.0, 0.3]).unwrap();
        let body = shape_mass_properties(&shape, 500.0);
        assert!((body.mass - 75.0).abs() < 1e-9);
        assert!((body.center - Vector3::new(1.25, -0.5, 0.15)).norm() < 1e-10);
        let [a, b, c] = [0.25, 1.0, 0.09];
        let inertia = Matrix3::from_diagonal(&Vector3::new(b + c, a + c, a + b)) * (75.0 / 12.0);
        assert!((body.inertia - inertia).norm() < 1e-10, "{}", body.inertia);
    }

    #[test]
    fn balls_and_discs_are_good_to_a_thousandth() {
        use std::f64::consts::PI;
        let ball = shape_mass_properties(&Shape::sphere([5.0, 2.0, 1.0], 0.7).unwrap(), 2.0);
        let mass = 8.0 / 3.0 * PI * 0.343;
        assert!((ball.mass / mass - 1.0).abs() < 1e-3, "{}", ball.mass / mass);
        let inertia = ball.inertia[(1, 1)] / (0.4 * mass * 0.49);
        assert!((inertia - 1.0).abs() < 1e-3, "{inertia}");
        let disc = shape_mass_properties(&Shape::sphere([5.0, 2.0], 0.7).unwrap(), 2.0);
        let mass = 2.0 * PI * 0.49;
        assert!((disc.mass / mass - 1.0).abs() < 1e-3);
        assert!((disc.inertia[(2, 2)] / (0.5 * mass * 0.49) - 1.0).abs() < 1e-3);
        assert!((disc.center - Vector3::new(5.0, 2.0, 0.0)).norm() < 1e-9);
    }
}
