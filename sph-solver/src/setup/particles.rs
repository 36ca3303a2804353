//! The particles that a run begins with.

use std::ops::Range;

/// Structure of arrays over all particles: the fluid first, then the walls, solid by solid. The index
/// of a particle is its global id.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Particles<const D: usize> {
    /// Positions, m.
    pub position: Vec<[f64; D]>,
    /// Velocities, m/s.
    pub velocity: Vec<[f64; D]>,
    /// Densities, kg/m³: those that the equation of state gives for the initial pressure.
    pub density: Vec<f64>,
    /// Masses, kg (kg/m in two dimensions): reference density times spacing to the power D.
    pub mass: Vec<f64>,
    /// 0 for the fluid, 1 + k for solid number k of the scene.
    pub kind: Vec<u16>,
}

impl<const D: usize> Particles<D> {
    /// Number of particles, walls included.
    pub fn len(&self) -> usize {
        self.position.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.position.is_empty()
    }

    /// The particles of a kind.
    pub fn of_kind(&self, kind: u16) -> Range<usize> {
        let start = self.kind.partition_point(|other| *other < kind);
        start..self.kind.partition_point(|other| *other <= kind)
    }

    pub(super) fn push(
        &mut self,
        position: [f64; D],
        velocity: [f64; D],
        density: f64,
        mass: f64,
        kind: u16,
    ) {
        self.position.push(position);
        self.velocity.push(velocity);
        self.density.push(density);
        self.mass.push(mass);
        self.kind.push(kind);
    }
}
