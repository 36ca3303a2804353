//! Which neighbours of the fluid a thin solid keeps from being seen.

use crate::model::Model;
use crate::space;
use crate::walls::WallSet;
use sph_kernels::Real;
use sph_neighbors::ClusterList;

/// Pieces of surface reach so far around their middle, in spacings: half the diagonal of a cell.
const HALF: f64 = 0.75;

/// Two sides of a solid face away from each other when the cosine of the angle between their normals is
/// below this.
const OPPOSITE: f64 = -0.5;

/// More sides than this are not looked at on the way to a neighbour.
const MOST: usize = 8;

/// Those neighbours of each particle to which the way leads through a thin solid: in through one side and
/// out through another that faces away. Around an edge particles see each other. `places` are the
/// positions of the owned particles and of the others, m. Empty where there is no thin solid.
pub fn across<const D: usize, S: Real>(
    near_fluid: &ClusterList,
    walls: &[WallSet<D, S>],
    places: [&[[f64; D]]; 2],
    model: &Model<D>,
) -> ClusterList {
    let thin: Vec<&WallSet<D, S>> = walls.iter().filter(|wall| wall.thin.is_some()).collect();
    if thin.is_empty() {
        return ClusterList::default();
    }
    let [targets, others] = places;
    let place = |source: usize| match source.checked_sub(targets.len()) {
        None => &targets[source],
        Some(other) => &others[other],
    };
    near_fluid.one_by_one(
        |target| {
            let cluster = near_fluid.clusters().containing(target);
            let x = &targets[target];
            let mut planes: Vec<Plane<D>> = Vec::new();
            for wall in &thin {
                let Some(spacing) = wall.thin.map(|thin| thin.spacing) else { continue };
                // What the lists of all clusters with this particle hold, whoever is in them.
                let reach = model.reach() - spacing;
                for (point, normal) in wall.surface_near(cluster) {
                    let from = space::offset(x, point, &model.periods);
                    if dot(&from, &from) < reach * reach {
                        Plane::add(&mut planes, from, *normal, spacing);
                    }
                }
            }
            planes
        },
        |planes, target, source| {
            !planes.is_empty() && {
                let way = space::offset(place(source as usize), &targets[target], &model.periods);
                is_hidden(planes, &way)
            }
        },
    )
}

/// Pieces of surface in one plane as a particle sees them.
struct Plane<const D: usize> {
    normal: [f64; D],
    /// Height of the particle over it, m.
    height: f64,
    spacing: f64,
    /// The particle from the middle of each piece, m.
    pieces: Vec<[f64; D]>,
}

impl<const D: usize> Plane<D> {
    fn add(planes: &mut Vec<Self>, from: [f64; D], normal: [f64; D], spacing: f64) {
        let height = dot(&from, &normal);
        let same = |plane: &&mut Self| {
            (plane.height - height).abs() < 1e-6 * spacing
                && dot(&plane.normal, &normal) > 1.0 - 1e-12
        };
        match planes.iter_mut().find(same) {
            Some(plane) => plane.pieces.push(from),
            None => planes.push(Self { normal, height, spacing, pieces: vec![from] }),
        }
    }

    /// Whether a way from the particle leads through one of the pieces.
    fn is_passed(&self, way: &[f64; D]) -> bool {
        let change = dot(way, &self.normal);
        if (self.height > 0.0) == (self.height + change > 0.0) {
            return false;
        }
        let share = -self.height / change;
        let through = |from: &[f64; D]| {
            let there: [f64; D] = std::array::from_fn(|k| from[k] + share * way[k]);
            dot(&there, &there) < (HALF * self.spacing).powi(2)
        };
        self.pieces.iter().any(through)
    }
}

/// Whether a way from the particle leads through two sides that face away from each other.
fn is_hidden<const D: usize>(planes: &[Plane<D>], way: &[f64; D]) -> bool {
    let (mut passed, mut count) = ([[0.0; D]; MOST], 0);
    for plane in planes.iter().filter(|plane| plane.is_passed(way)) {
        if passed[..count].iter().any(|normal| dot(normal, &plane.normal) < OPPOSITE) {
            return true;
        }
        if count < MOST {
            passed[count] = plane.normal;
            count += 1;
        }
    }
    false
}

fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (0..D).map(|k| a[k] * b[k]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sides of a plate that is 0.1 m thick and ends at x = 1, y = 0 in its middle, pieces of 0.1 m, as seen
    /// from `x`.
    fn plate(x: [f64; 2]) -> Vec<Plane<2>> {
        let mut planes = Vec::new();
        let mut side = |point: [f64; 2], normal: [f64; 2]| {
            Plane::add(&mut planes, [x[0] - point[0], x[1] - point[1]], normal, 0.1);
        };
        side([1.0, 0.0], [1.0, 0.0]);
        for k in 0..10 {
            let along = 0.05 + 0.1 * f64::from(k);
            side([along, 0.05], [0.0, 1.0]);
            side([along, -0.05], [0.0, -1.0]);
        }
        assert_eq!(planes.len(), 3);
        planes
    }

    fn sees(x: [f64; 2], y: [f64; 2]) -> bool {
        !is_hidden(&plate(x), &[y[0] - x[0], y[1] - x[1]])
    }

    #[test]
    fn a_plate_hides_what_is_behind_it() {
        for (x, y) in [([0.5, 0.1], [0.52, -0.1]), ([0.5, 0.06], [0.7, -0.07])] {
            assert!(!sees(x, y) && !sees(y, x), "{x:?} {y:?}");
        }
        assert!(sees([0.5, 0.1], [0.7, 0.2]));
        assert!(sees([0.5, -0.1], [0.5, -0.3]));
    }

    #[test]
    fn around_its_edge_particles_see_each_other() {
        for (x, y) in [([0.95, 0.08], [1.1, 0.0]), ([1.04, 0.1], [1.04, -0.1])] {
            assert!(sees(x, y) && sees(y, x), "{x:?} {y:?}");
        }
    }
}
