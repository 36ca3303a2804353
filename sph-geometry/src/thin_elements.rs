//! Wall elements of thin solids: each side is a wall of its own, as deep as the support.
//!
//! Material thinner than the support does not fill it, and what lies behind is not wall but the fluid of
//! the other side. So below every piece of the surface there is a column of elements as if the material
//! went on; an element has to act on what is in front of its own side alone. Behind an edge into which
//! the material is hollow, as in the corner of a jug, elements fill the gap between the columns.

use crate::boundary::Domain;
use crate::lattice::{CellBox, Lattice, LatticeError};
use crate::solid::Solid;
use crate::surface_pieces::{Piece, cell_of, pieces, sample_distance};
use crate::vector::{add_scaled, cross, distance, dot, norm, resized, scaled, sub};
use crate::wall_elements::WallElements;
use std::collections::{BTreeMap, HashMap};

/// Makes the wall elements of solids at rest that are thin: columns of a depth of `support` (m) below
/// their surface as far as it is inside the domain and not in or on one of the `others`, which are not
/// thin. A column is a layer of elements per spacing. The order is that of the lattice, x fastest.
///
/// # Errors
///
/// When the support is no length, or the domain has no end or too many cells.
pub fn thin_wall_elements<const D: usize>(
    solids: &[Solid<D>],
    others: &[Solid<D>],
    lattice: &Lattice<D>,
    support: f64,
    domain: &Domain<D>,
) -> Result<WallElements<D>, LatticeError> {
    let cells = domain.cells(lattice, lattice.spacing())?;
    let mut elements = made(solids, others, lattice, support, cells)?;
    elements.wrap_into(domain, support);
    Ok(elements)
}

/// The same for one solid that moves: all around it.
///
/// # Errors
///
/// When the support is no length, the surface has no end, or there are too many cells.
pub fn thin_body_elements<const D: usize>(
    solid: &Solid<D>,
    lattice: &Lattice<D>,
    support: f64,
) -> Result<WallElements<D>, LatticeError> {
    let bounds = solid.shape.bounding_box().inflated(lattice.spacing());
    let cells = lattice.cells("moving solid", &bounds)?;
    made(std::slice::from_ref(solid), &[], lattice, support, cells)
}

fn made<const D: usize>(
    solids: &[Solid<D>],
    others: &[Solid<D>],
    lattice: &Lattice<D>,
    support: f64,
    cells: CellBox<D>,
) -> Result<WallElements<D>, LatticeError> {
    if !support.is_finite() || support <= 0.0 {
        return Err(LatticeError::Support { support });
    }
    let pieces = pieces(solids, others, lattice, cells);
    let mut elements = WallElements::default();
    for piece in &pieces {
        elements.add_column(piece, lattice.spacing(), support);
    }
    let mut behind = BTreeMap::new();
    for corner in corners(&pieces, lattice) {
        corner.fill(lattice, support, &mut behind);
    }
    for ((_, owner, _), behind) in behind {
        elements.add_behind(owner, &behind);
    }
    Ok(elements)
}

/// Cell, solid and edge of some material behind an edge.
type Place<const D: usize> = ([i64; D], usize, [[i64; D]; 2]);

/// Material behind an edge, of samples of its volume.
#[derive(Debug, Clone, Copy)]
struct Behind<const D: usize> {
    count: f64,
    /// Volume of all of them, m^D.
    volume: f64,
    /// Sum of their positions, m.
    positions: [f64; D],
    /// Sum of the ways from them to the edge, m.
    out: [f64; D],
}

/// A point of an edge into which the material is hollow, and how much of the edge it stands for.
struct Corner<const D: usize> {
    point: [f64; D],
    owner: usize,
    /// Normals of the two sides.
    normals: [[f64; D]; 2],
    /// m; 1 in two dimensions.
    length: f64,
}

/// The hollow edges between pieces, point by point.
fn corners<const D: usize>(pieces: &[Piece<D>], lattice: &Lattice<D>) -> Vec<Corner<D>> {
    let (spacing, step) = (lattice.spacing(), sample_distance(lattice));
    let mut by_cell: HashMap<[i64; D], Vec<usize>> = HashMap::new();
    for (number, piece) in pieces.iter().enumerate() {
        by_cell.entry(piece.cell).or_default().push(number);
    }
    // Pairs of pieces that share an edge find the same points.
    let apart = if D == 2 { 0.5 * spacing } else { 0.7 * step };
    let mut found: Vec<Corner<D>> = Vec::new();
    let mut known: HashMap<[i64; D], Vec<[f64; D]>> = HashMap::new();
    for (number, one) in pieces.iter().enumerate() {
        for cell in around(&one.cell) {
            for other in by_cell.get(&cell).into_iter().flatten().filter(|k| **k > number) {
                let two = &pieces[*other];
                let way = sub(&two.center, &one.center);
                let hollow = dot(&one.normal, &way) > 0.02 * spacing
                    && dot(&two.normal, &way) < -0.02 * spacing;
                if !hollow || dot(&one.normal, &two.normal) > 0.9 {
                    continue;
                }
                for corner in edge(one, two, lattice, step) {
                    let place = cell_of(lattice, &corner.point);
                    let mut near = around(&place).filter_map(|cell| known.get(&cell)).flatten();
                    if near.all(|x| distance(x, &corner.point) > apart) {
                        known.entry(place).or_default().push(corner.point);
                        found.push(corner);
                    }
                }
            }
        }
    }
    found
}

/// A cell and all around it.
fn around<const D: usize>(cell: &[i64; D]) -> impl Iterator<Item = [i64; D]> {
    let cell = *cell;
    (0..3_i64.pow(D as u32)).map(move |number| {
        let mut rest = number;
        cell.map(|place| {
            let side = rest % 3 - 1;
            rest /= 3;
            place + side
        })
    })
}

/// The points of the edge where the planes of two pieces meet.
fn edge<const D: usize>(
    one: &Piece<D>,
    two: &Piece<D>,
    lattice: &Lattice<D>,
    step: f64,
) -> Vec<Corner<D>> {
    let normals = [one.normal, two.normal];
    let cosine = dot(&one.normal, &two.normal);
    let sine2 = 1.0 - cosine * cosine;
    if sine2 < 1e-3 {
        return Vec::new();
    }
    // The point of both planes closest to the middle between the pieces.
    let middle = scaled(0.5, &add_scaled(&one.center, 1.0, &two.center));
    let to_one = dot(&sub(&one.center, &middle), &one.normal);
    let to_two = dot(&sub(&two.center, &middle), &two.normal);
    let a = (to_one - cosine * to_two) / sine2;
    let b = (to_two - cosine * to_one) / sine2;
    let point = add_scaled(&add_scaled(&middle, a, &one.normal), b, &two.normal);
    let reach = 0.75 * lattice.spacing();
    let within = |x: &[f64; D]| {
        let far = |piece: &Piece<D>| norm(&sub(x, &piece.center)) > 2.0 * reach;
        !far(one) && !far(two)
    };
    if D == 2 {
        let corner = Corner { point, owner: one.owner, normals, length: 1.0 };
        return if within(&point) { vec![corner] } else { Vec::new() };
    }
    let along = cross(&resized(&one.normal), &resized(&two.normal));
    let along: [f64; D] = resized(&scaled(1.0 / norm(&along), &along));
    // Both pieces must reach there; samples are counted from the origin.
    let place = |x: &[f64; D]| dot(&sub(x, &lattice.origin()), &along);
    let side = |piece: &Piece<D>| {
        let half = 0.5 * piece.area.sqrt();
        (place(&piece.center) - half, place(&piece.center) + half)
    };
    let ((low, high), (below, above)) = (side(one), side(two));
    let (low, high) = (low.max(below), high.min(above));
    let first = (low / step - 0.5).ceil() as i64;
    let here = place(&point);
    (first..)
        .map(|i| (i as f64 + 0.5) * step)
        .take_while(|place| *place < high)
        .map(|place| add_scaled(&point, place - here, &along))
        .filter(within)
        .map(|point| Corner { point, owner: one.owner, normals, length: step })
        .collect()
}

impl<const D: usize> Corner<D> {
    /// Adds what lies behind the point, between the columns of both sides, cell by cell.
    fn fill(&self, lattice: &Lattice<D>, support: f64, behind: &mut BTreeMap<Place<D>, Behind<D>>) {
        let step = sample_distance(lattice);
        let [one, two] = &self.normals;
        let cosine = dot(one, two);
        let sine = (1.0 - cosine * cosine).sqrt();
        let across = scaled(1.0 / sine, &add_scaled(two, -cosine, one));
        // Edges of different directions stay apart.
        let edge = self.normals.map(|normal| normal.map(|n| (8.0 * n).round() as i64));
        let count = (support / step).ceil() as i64;
        for (i, j) in (-count..count).flat_map(|i| (-count..count).map(move |j| (i, j))) {
            let (u, v) = ((i as f64 + 0.5) * step, (j as f64 + 0.5) * step);
            // x = point − a n₁ − b n₂ with a and b not negative.
            let b = -v / sine;
            let a = -u - b * cosine;
            if a < 0.0 || b < 0.0 || u * u + v * v >= support * support {
                continue;
            }
            let x = add_scaled(&add_scaled(&self.point, u, one), v, &across);
            let none = Behind { count: 0.0, volume: 0.0, positions: [0.0; D], out: [0.0; D] };
            let part = behind.entry((cell_of(lattice, &x), self.owner, edge)).or_insert(none);
            part.count += 1.0;
            part.volume += step * step * self.length;
            part.positions = add_scaled(&part.positions, 1.0, &x);
            part.out = add_scaled(&part.out, 1.0, &sub(&self.point, &x));
        }
    }
}

impl<const D: usize> WallElements<D> {
    /// Adds the column of elements below a piece of surface.
    fn add_column(&mut self, piece: &Piece<D>, spacing: f64, support: f64) {
        let depths = (0..).map(|k| (f64::from(k) + 0.5) * spacing);
        for depth in depths.take_while(|depth| *depth < support * (1.0 - 1e-9)) {
            // What is below a convex surface is narrower than it.
            let narrower = piece.curvature.map(|curvature| (1.0 - curvature * depth).max(0.0));
            let volume = piece.area * spacing * narrower[0] * narrower[1];
            if volume > 0.0 {
                self.positions.push(add_scaled(&piece.center, -depth, &piece.normal));
                self.volumes.push(volume);
                self.solids.push(piece.owner as u32);
                self.normals.push(piece.normal);
                self.depths.push(depth);
            }
        }
    }

    /// Adds what lies behind an edge in a cell.
    fn add_behind(&mut self, owner: usize, behind: &Behind<D>) {
        let share = 1.0 / behind.count;
        let out = scaled(share, &behind.out);
        let depth = norm(&out);
        self.positions.push(scaled(share, &behind.positions));
        self.volumes.push(behind.volume);
        self.solids.push(owner as u32);
        self.normals.push(scaled(1.0 / depth, &out));
        self.depths.push(depth);
    }

    /// Keeps what fluid in the domain can see, and brings it to where a periodic domain has it.
    fn wrap_into(&mut self, domain: &Domain<D>, support: f64) {
        let mut seen = Vec::new();
        for x in &mut self.positions {
            for k in (0..D).filter(|&k| domain.periodic[k]) {
                let length = domain.bounds.max[k] - domain.bounds.min[k];
                x[k] -= length * ((x[k] - domain.bounds.min[k]) / length).floor();
            }
            seen.push(domain.bounds.signed_distance(x) < support);
        }
        fn keep<T>(column: &mut Vec<T>, seen: &[bool]) {
            let mut seen = seen.iter();
            column.retain(|_| seen.next() == Some(&true));
        }
        keep(&mut self.positions, &seen);
        keep(&mut self.volumes, &seen);
        keep(&mut self.solids, &seen);
        keep(&mut self.normals, &seen);
        keep(&mut self.depths, &seen);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aabb::Aabb;
    use crate::affine::Affine;
    use crate::shape::Shape;
    use crate::solid::FluidSide;
    use crate::wall_elements::wall_elements;

    const DP: f64 = 0.1;
    const SUPPORT: f64 = 0.3;

    fn lattice<const D: usize>() -> Lattice<D> {
        Lattice::new([0.0; D], DP).unwrap()
    }

    fn around<const D: usize>() -> Domain<D> {
        Domain::new(Aabb::new([-2.0; D], [2.0; D]))
    }

    fn solid<const D: usize>(shape: Shape<D>, side: FluidSide) -> Solid<D> {
        Solid::new("plate", shape, side)
    }

    fn of<const D: usize>(shape: Shape<D>) -> WallElements<D> {
        let solids = [solid(shape, FluidSide::Outside)];
        thin_wall_elements(&solids, &[], &lattice(), SUPPORT, &around()).unwrap()
    }

    /// The elements near a point, rounded to be compared: position, volume, normal, depth.
    fn near<const D: usize>(elements: &WallElements<D>, x: [f64; D]) -> Vec<Vec<i64>> {
        let round = |x: &f64| (x * 1e6).round() as i64;
        let mut all: Vec<Vec<i64>> = (0..elements.positions.len())
            .filter(|&k| distance(&elements.positions[k], &x) < 0.9 * SUPPORT)
            .map(|k| {
                let numbers = elements.positions[k].iter().chain(&elements.normals[k]);
                let rest = [elements.volumes[k], elements.depths[k]];
                numbers.chain(&rest).map(round).collect()
            })
            .collect();
        all.sort();
        all
    }

    #[test]
    fn a_side_of_a_plate_is_as_a_thick_wall() {
        let plate = of(Shape::cuboid([-1.0, -0.1, -1.0], [1.0, 0.0, 1.0]).unwrap());
        let thick = Shape::cuboid([-1.0, -1.0, -1.0], [1.0, 0.0, 1.0]).unwrap();
        let thick = [solid(thick, FluidSide::Outside)];
        let thick = wall_elements(&thick, &lattice(), SUPPORT, &around()).unwrap();
        let upper = |elements: &WallElements<3>| {
            let mut all = near(elements, [0.03, 0.05, 0.02]);
            all.retain(|element| element[4] == 1_000_000);
            all
        };
        assert_eq!(upper(&plate), upper(&thick));
        assert!(upper(&plate).len() > 20);
    }

    #[test]
    fn columns_stand_below_all_of_a_turned_plate() {
        for degrees in [7.0, 17.0, 45.0, 80.0] {
            for thickness in [0.03, 0.1, 0.25] {
                let turn = Affine::rotation([0.0, 0.0, 1.0], degrees).unwrap();
                let plate = Shape::cuboid([-1.0, -thickness], [1.0, 0.0]).unwrap();
                let plate = of(plate.moved(&turn).unwrap());
                let normal: [f64; 2] = turn.apply(&[0.0, 1.0]);
                let upper = (0..plate.positions.len()).filter(|&k| {
                    dot(&plate.normals[k], &normal) > 0.99 && plate.depths[k] < 0.5 * DP + 1e-9
                });
                let area = upper.map(|k| plate.volumes[k] / DP).sum::<f64>();
                assert!((area / 2.0 - 1.0).abs() < 0.02, "{degrees} {thickness}: {area}");
            }
        }
    }

    /// Inside, a jug whose walls are one spacing thick is as a tank in endless material.
    #[test]
    fn the_corner_of_a_jug_is_filled() {
        let jug = [[0.0, 0.8], [-0.1, 0.8], [-0.1, -0.1], [1.0, -0.1], [1.0, 0.8], [0.9, 0.8]];
        let jug = [&jug[..], &[[0.9, 0.0], [0.0, 0.0]]].concat();
        let jug = of(Shape::polygon(&jug).unwrap());
        let tank = [solid(Shape::cuboid([0.0; 2], [0.9, 2.0]).unwrap(), FluidSide::Inside)];
        let tank = wall_elements(&tank, &lattice(), SUPPORT, &around()).unwrap();
        let x = [0.05, 0.05];
        let inner = |elements: &WallElements<2>| {
            let mut all = near(elements, x);
            // Out of the jug look the elements of its outer sides.
            all.retain(|element| element[2] >= 0 && element[3] >= 0);
            all
        };
        assert_eq!(inner(&jug), inner(&tank));
    }

    /// Below the outer side of a tube the columns fill what they stand for, and so do those of the inner.
    #[test]
    fn columns_below_curved_sides_grow_narrower_or_wider() {
        let [inner, outer] =
            [1.0, 1.1].map(|radius| Shape::sphere([0.013, 0.027], radius).unwrap());
        let tube = of(Shape::difference(outer, vec![inner]));
        for (radius, way) in [(1.1, 1.0), (1.0, -1.0)] {
            let of_side = |k: &usize| {
                let out = [tube.positions[*k][0] - 0.013, tube.positions[*k][1] - 0.027];
                dot(&out, &tube.normals[*k]) * way > 0.0
            };
            let volume: f64 =
                (0..tube.positions.len()).filter(of_side).map(|k| tube.volumes[k]).sum();
            let other = radius - way * SUPPORT;
            let expected = std::f64::consts::PI * (radius * radius - other * other).abs();
            assert!((volume / expected - 1.0).abs() < 0.02, "{radius}: {volume} {expected}");
        }
    }

    #[test]
    fn the_edge_of_a_thin_vessel_is_filled_along_its_length() {
        let outer = Shape::cuboid([-0.1; 3], [1.1, 1.1, 0.6]).unwrap();
        let inner = Shape::cuboid([0.0; 3], [1.0, 1.0, 0.7]).unwrap();
        let vessel = of(Shape::difference(outer, vec![inner.clone()]));
        let tank = [solid(inner, FluidSide::Inside)];
        let tank = wall_elements(&tank, &lattice(), SUPPORT, &around()).unwrap();
        // Beside an edge, away from the corners.
        let inside = |elements: &WallElements<3>| {
            let mut all = near(elements, [0.05, 0.55, 0.05]);
            all.retain(|element| element[3] >= 0 && element[5] >= 0);
            all
        };
        assert_eq!(inside(&vessel), inside(&tank));
    }

    #[test]
    fn what_another_solid_covers_is_no_side() {
        let plate = solid(Shape::cuboid([0.0, -0.5], [0.1, 0.5]).unwrap(), FluidSide::Outside);
        let floor = solid(Shape::cuboid([-2.0, -2.0], [2.0, 0.0]).unwrap(), FluidSide::Outside);
        let made = thin_wall_elements(&[plate], &[floor], &lattice(), SUPPORT, &around()).unwrap();
        assert!(made.positions.iter().zip(&made.normals).all(|(x, n)| n[1] > 0.5 || x[1] > 0.0));
        assert!(thin_wall_elements::<2>(&[], &[], &lattice(), -1.0, &around()).is_err());
    }
}
