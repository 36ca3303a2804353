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

/// More pieces of surface than this are not looked at on the way to a neighbour.
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
            let mut sides = Vec::new();
            for wall in &thin {
                let Some(spacing) = wall.thin.map(|thin| thin.spacing) else { continue };
                // What the lists of all clusters with this particle hold, whoever is in them.
                let reach = model.reach() - spacing;
                let near = wall.surface_near(cluster).filter_map(|(point, normal)| {
                    let from = space::offset(x, point, &model.periods);
                    let side = Side { from, normal: *normal, height: dot(&from, normal), spacing };
                    (dot(&from, &from) < reach * reach).then_some(side)
                });
                sides.extend(near);
            }
            sides
        },
        |sides, target, source| {
            !sides.is_empty() && {
                let way = space::offset(place(source as usize), &targets[target], &model.periods);
                is_hidden(sides, &way)
            }
        },
    )
}

/// A piece of surface as a particle sees it.
struct Side<const D: usize> {
    /// The particle from the middle of the piece, m.
    from: [f64; D],
    normal: [f64; D],
    /// Height of the particle over it, m.
    height: f64,
    spacing: f64,
}

/// Whether a way from the particle leads through two sides that face away from each other.
fn is_hidden<const D: usize>(sides: &[Side<D>], way: &[f64; D]) -> bool {
    let (mut passed, mut count) = ([[0.0; D]; MOST], 0);
    for side in sides {
        let change = dot(way, &side.normal);
        if (side.height > 0.0) == (side.height + change > 0.0) {
            continue;
        }
        let share = -side.height / change;
        let there: [f64; D] = std::array::from_fn(|k| side.from[k] + share * way[k]);
        if dot(&there, &there) > (HALF * side.spacing).powi(2) {
            continue;
        }
        if passed[..count].iter().any(|normal| dot(normal, &side.normal) < OPPOSITE) {
            return true;
        }
        if count < MOST {
            passed[count] = side.normal;
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
    fn plate(x: [f64; 2]) -> Vec<Side<2>> {
        let side = |point: [f64; 2], normal: [f64; 2]| {
            let from = [x[0] - point[0], x[1] - point[1]];
            Side { from, normal, height: dot(&from, &normal), spacing: 0.1 }
        };
        let mut sides = vec![side([1.0, 0.0], [1.0, 0.0])];
        for k in 0..10 {
            let along = 0.05 + 0.1 * f64::from(k);
            sides.push(side([along, 0.05], [0.0, 1.0]));
            sides.push(side([along, -0.05], [0.0, -1.0]));
        }
        sides
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
