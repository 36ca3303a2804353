//! How well wall particles continue the fluid at walls that are not aligned with the lattice:
//! points left on the lattice, or moved along the normal of the wall into layers at (k + ½)
//! spacings of depth.
//!
//! For tilted planes and a disc in two dimensions it prints the least distance between two
//! particles of which one is a wall particle, and the error of `ΣVW − 1` at fluid particles within
//! one support radius of the wall (Wendland C2, support of three spacings, V = spacing²), root
//! mean square and largest.

use sph_geometry::{Aabb, Domain, FluidSide, Lattice, Shape, Solid, fill_lattice, wall_particles};

const SPACING: f64 = 0.02;
const SUPPORT: f64 = 3.0 * SPACING;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("wall                  points   least distance   rms error   largest error");
    for degrees in [0.0_f64, 5.0, 10.0, 20.0, 26.565, 30.0, 45.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let plane = Shape::half_space([0.5, 0.5003], [-sin, cos])?;
        measure(&format!("plane at {degrees:5.1}°"), &plane)?;
    }
    measure("disc, radius 0.20 m", &Shape::sphere([0.503, 0.501], 0.2)?)
}

fn measure(name: &str, shape: &Shape<2>) -> Result<(), Box<dyn std::error::Error>> {
    let lattice = Lattice::new([0.0; 2], SPACING)?;
    let domain = Aabb::new([0.0; 2], [1.0; 2]);
    let all = Shape::cuboid(domain.min, domain.max)?;
    let fluid = fill_lattice(&Shape::difference(all, vec![shape.clone()]), &lattice)?;
    let solids = [Solid::new("wall", shape.clone(), FluidSide::Outside)];
    let lattice_points =
        wall_particles(&solids, &lattice, SUPPORT, &Domain::new(domain))?.positions;
    let moved = |x: &[f64; 2]| {
        let nearest = shape.nearest(x);
        let depth = ((-nearest.distance / SPACING).floor() + 0.5) * SPACING;
        let shift = -nearest.distance - depth;
        [x[0] + shift * nearest.normal[0], x[1] + shift * nearest.normal[1]]
    };
    let moved_points: Vec<_> = lattice_points.iter().map(moved).collect();
    for (kind, walls) in [("lattice", lattice_points), ("moved", moved_points)] {
        let least = least_distance(&fluid, &walls);
        let (rms, largest) = sum_error(shape, &fluid, &walls);
        println!("{name:20}  {kind:7}  {:14.3}   {rms:9.4}   {largest:13.4}", least / SPACING);
    }
    Ok(())
}

fn distance(a: &[f64; 2], b: &[f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn least_distance(fluid: &[[f64; 2]], walls: &[[f64; 2]]) -> f64 {
    let inner = |x: &[f64; 2]| x.iter().all(|x| (0.1..0.9).contains(x));
    let mut least = f64::INFINITY;
    for (index, x) in walls.iter().enumerate().filter(|(_, x)| inner(x)) {
        let others = walls[..index].iter().chain(fluid);
        least = others.map(|y| distance(x, y)).fold(least, f64::min);
    }
    least
}

fn sum_error(shape: &Shape<2>, fluid: &[[f64; 2]], walls: &[[f64; 2]]) -> (f64, f64) {
    let kernel = |r: f64| {
        let q = r / SUPPORT;
        if q >= 1.0 {
            return 0.0;
        }
        let w = (1.0 - q).powi(4) * (1.0 + 4.0 * q);
        7.0 / (std::f64::consts::PI * SUPPORT * SUPPORT) * w
    };
    let (mut squares, mut largest, mut count) = (0.0, 0.0_f64, 0.0);
    for x in fluid.iter().filter(|x| x.iter().all(|x| (0.1..0.9).contains(x))) {
        if shape.signed_distance(x) < SUPPORT {
            let all = fluid.iter().chain(walls);
            let sum: f64 = all.map(|y| kernel(distance(x, y)) * SPACING * SPACING).sum();
            squares += (sum - 1.0).powi(2);
            largest = largest.max((sum - 1.0).abs());
            count += 1.0;
        }
    }
    (f64::sqrt(squares / count), largest)
}
