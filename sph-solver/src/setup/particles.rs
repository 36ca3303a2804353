//! The particles that a run begins with.

use crate::state::State;
use crate::walls::WallElements;
use std::ops::Range;

/// Structure of arrays over all particles: the fluid first, then the walls, solid by solid. The index
/// of a particle is its global id. A wall particle is an element of the wall of its solid.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Particles<const D: usize> {
    /// Positions, m.
    pub position: Vec<[f64; D]>,
    /// Velocities, m/s.
    pub velocity: Vec<[f64; D]>,
    /// Densities, kg/m³: those that the equation of state gives for the initial pressure.
    pub density: Vec<f64>,
    /// Masses, kg (kg/m in two dimensions): reference density times spacing to the power D; walls have
    /// none.
    pub mass: Vec<f64>,
    /// 0 for the fluid, 1 + k for solid number k of the scene.
    pub kind: Vec<u16>,
    /// Those of the fluid whose pressure carries its weight, with ∇p/ρ, m/s²; in the rest of it that is zero.
    pub resting: Vec<(Range<usize>, [f64; D])>,
    /// Unit normals of the wall particles alone, out of the wall into the fluid.
    pub normal: Vec<[f64; D]>,
    /// Volumes of the wall particles alone, m^D.
    pub volume: Vec<f64>,
    /// Depths of the wall particles alone below the surface, m.
    pub depth: Vec<f64>,
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

    /// The fluid.
    pub fn fluid(&self) -> Range<usize> {
        self.of_kind(0)
    }

    /// Copies of some of the fluid, `part` of [`fluid`](Self::fluid).
    pub fn state(&self, part: Range<usize>) -> State<D> {
        let mut pressure_gradient = vec![[0.0; D]; part.len()];
        for (range, gradient) in &self.resting {
            let own = |i: usize| i.clamp(part.start, part.end) - part.start;
            pressure_gradient[own(range.start)..own(range.end)].fill(*gradient);
        }
        State {
            id: part.clone().map(|i| i as u64).collect(),
            mass: self.mass[part.clone()].to_vec(),
            density: self.density[part.clone()].to_vec(),
            position: self.position[part.clone()].to_vec(),
            velocity: self.velocity[part].to_vec(),
            pressure_gradient,
        }
    }

    /// Copies of some of the walls, `part` of so many as there are wall particles.
    pub fn walls(&self, part: Range<usize>) -> WallElements<D> {
        let first = self.fluid().end;
        let all = first + part.start..first + part.end;
        WallElements {
            id: all.clone().map(|i| i as u64).collect(),
            solid: self.kind[all.clone()].iter().map(|kind| kind - 1).collect(),
            volume: self.volume[part.clone()].to_vec(),
            depth: self.depth[part.clone()].to_vec(),
            position: self.position[all].to_vec(),
            normal: self.normal[part].to_vec(),
        }
    }

    /// The particles of a kind.
    pub fn of_kind(&self, kind: u16) -> Range<usize> {
        let start = self.kind.partition_point(|other| *other < kind);
        start..self.kind.partition_point(|other| *other <= kind)
    }

    /// Adds the place of an element of a wall; volume and depth follow.
    pub(super) fn push_wall(
        &mut self,
        position: [f64; D],
        density: f64,
        kind: u16,
        normal: [f64; D],
    ) {
        self.push(position, [0.0; D], density, 0.0, kind);
        self.normal.push(normal);
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
