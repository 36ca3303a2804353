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
use sph_neighbors::ClusterList;
use std::f64::consts::PI;

/// A flat surface fills one half, a right-angled edge of fluid one quarter.
const FILLED: f64 = 0.3;

/// Marks the spray among the targets of the two lists.
pub fn mark_spray<const D: usize>(
    model: &Model<D>,
    near_fluid: &ClusterList,
    near_walls: &ClusterList,
) -> Vec<bool> {
    let ball = if D == 2 { PI } else { 4.0 / 3.0 * PI };
    let places = ball * (model.reach() / model.spacing).powi(D as i32);
    let walls = near_walls.counts().chain(std::iter::repeat(0));
    let filled = |(fluid, walls)| (fluid as f64) < FILLED * (places - walls as f64);
    near_fluid.counts().zip(walls).map(filled).collect()
}
