//! Spray: particles that have torn off from the body of the fluid.
//!
//! While a particle tears off, its departing neighbours leave it with a density below ρ0. Nothing
//! holds a drop under tension, yet without neighbours nothing restores its density either, and the
//! missing part would later let it run deep into a wall or a pool before any pressure arises. A
//! particle is taken for spray when fluid fills less than three tenths of the space around it that is
//! not wall; its density is then kept at ρ0 or above. Marrone, Colagrossi, Le Touzé & Graziani
//! (2010), J. Comput. Phys. 229, tell such particles by an eigenvalue; counting neighbours at each
//! rebuild costs no pair loop.

use crate::model::Model;
use crate::walls::WallSet;
use sph_neighbors::ClusterList;
use std::f64::consts::PI;

/// A flat surface fills one half, a right-angled edge of fluid one quarter.
const FILLED: f64 = 0.3;

/// Marks the spray among the targets of the lists of fluid and walls.
pub fn mark_spray<const D: usize, S>(
    model: &Model<D>,
    near_fluid: &ClusterList,
    walls: &[WallSet<D, S>],
) -> Vec<bool> {
    let ball = if D == 2 { PI } else { 4.0 / 3.0 * PI };
    let places = ball * (model.reach() / model.spacing).powi(D as i32);
    let mut filled: Vec<f64> = near_fluid.counts().map(|fluid| fluid as f64).collect();
    // What walls take away of the space around counts as filled in proportion.
    for wall in walls {
        for (filled, elements) in filled.iter_mut().zip(wall.near.counts()) {
            *filled += FILLED * elements as f64;
        }
    }
    filled.iter().map(|filled| *filled < FILLED * places).collect()
}
