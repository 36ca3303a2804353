//! A block: the state of consecutive particles, borrowed apart so that blocks advance in parallel.

use crate::records::Record;
use crate::sweep::Beside;
use sph_neighbors::Clusters;
use std::ops::Range;

/// Columns of the owned fluid particles that a pass may change.
#[derive(Debug)]
pub struct FluidColumns<'a, const D: usize> {
    /// Positions, m.
    pub position: &'a mut [[f64; D]],
    /// Velocities, m/s.
    pub velocity: &'a mut [[f64; D]],
    /// Densities, kg/m³.
    pub density: &'a mut [f64],
    /// Masses, kg.
    pub mass: &'a [f64],
    /// ∇p/ρ as walls continue it, m/s².
    pub pressure_gradient: &'a mut [[f64; D]],
    /// Lowest pressures that a wall has towards them, Pa.
    pub lowest_wall_pressure: &'a mut [f64],
    /// How much the walls around them count as one plane.
    pub flatness: &'a mut [f64],
    /// Velocities by which they are shifted, as shares of the largest speed; nothing if the scheme does not
    /// shift.
    pub shift: &'a mut [[f64; D]],
    /// ∇R of each over the largest support radius, 1/m; nothing where all are the same.
    pub radius_slope: &'a [[f64; D]],
}

impl<'a, const D: usize> FluidColumns<'a, D> {
    /// The block of all owned fluid particles.
    pub fn block<S, R>(self, rates: &'a mut [R], new: &'a mut [Record<S>]) -> Block<'a, D, S, R> {
        let Self {
            position,
            velocity,
            density,
            mass,
            pressure_gradient,
            lowest_wall_pressure,
            flatness,
            shift,
            radius_slope,
        } = self;
        Block {
            first: 0,
            position,
            velocity,
            density,
            mass,
            pressure_gradient,
            lowest_wall_pressure,
            flatness,
            shift,
            radius_slope,
            rates,
            new,
        }
    }
}

/// Consecutive fluid particles of a rank: what a pass may change.
#[derive(Debug)]
pub struct Block<'a, const D: usize, S, R> {
    /// Index of the first particle among the fluid particles of the rank.
    pub first: usize,
    /// Positions, m.
    pub position: &'a mut [[f64; D]],
    /// Velocities, m/s.
    pub velocity: &'a mut [[f64; D]],
    /// Densities, kg/m³.
    pub density: &'a mut [f64],
    /// Masses, kg.
    pub mass: &'a [f64],
    /// ∇p/ρ as walls continue it, m/s².
    pub pressure_gradient: &'a mut [[f64; D]],
    /// Lowest pressures that a wall has towards them, Pa.
    pub lowest_wall_pressure: &'a mut [f64],
    /// How much the walls around them count as one plane.
    pub flatness: &'a mut [f64],
    /// Velocities by which they are shifted, as shares of the largest speed; nothing if the scheme does not
    /// shift.
    pub shift: &'a mut [[f64; D]],
    /// ∇R of each over the largest support radius, 1/m; nothing where all are the same.
    pub radius_slope: &'a [[f64; D]],
    /// Results of the flux loop.
    pub rates: &'a mut [R],
    /// Records that the next pass reads.
    pub new: &'a mut [Record<S>],
}

/// The particles of a block as targets of a sum: read only.
#[derive(Debug, Clone, Copy)]
pub struct Targets<'a, const D: usize> {
    /// Index of the first one among the fluid particles of the rank.
    pub first: usize,
    /// Positions, m.
    pub position: &'a [[f64; D]],
    /// Densities, kg/m³.
    pub density: &'a [f64],
    /// Masses, kg.
    pub mass: &'a [f64],
    /// What wall terms are told of them.
    pub beside: Beside<'a, D>,
}

impl<const D: usize> Targets<'_, D> {
    /// Some of them, counted from the first.
    #[must_use]
    pub fn part(&self, range: Range<usize>) -> Self {
        Self {
            first: self.first + range.start,
            position: &self.position[range.clone()],
            density: &self.density[range.clone()],
            mass: &self.mass[range.clone()],
            beside: Beside {
                lowest_pressure: &self.beside.lowest_pressure[range.clone()],
                flatness: &self.beside.flatness[range.clone()],
                pressure_gradient: &self.beside.pressure_gradient[range.clone()],
                position: &self.beside.position[range],
                ..self.beside
            },
        }
    }
}

impl<'a, const D: usize, S, R> Block<'a, D, S, R> {
    /// Number of particles.
    pub fn len(&self) -> usize {
        self.density.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.density.is_empty()
    }

    /// The first `n` particles and the rest.
    pub fn split_at(self, n: usize) -> (Self, Self) {
        let (position, position2) = self.position.split_at_mut(n);
        let (velocity, velocity2) = self.velocity.split_at_mut(n);
        let (density, density2) = self.density.split_at_mut(n);
        let (mass, mass2) = self.mass.split_at(n);
        let (gradient, gradient2) = self.pressure_gradient.split_at_mut(n);
        let (lowest, lowest2) = self.lowest_wall_pressure.split_at_mut(n);
        let (flatness, flatness2) = self.flatness.split_at_mut(n);
        let (shift, shift2) = self.shift.split_at_mut(n.min(self.shift.len()));
        let (slope, slope2) = self.radius_slope.split_at(n.min(self.radius_slope.len()));
        let (rates, rates2) = self.rates.split_at_mut(n);
        let (new, new2) = self.new.split_at_mut(n);
        (
            Block {
                first: self.first,
                position,
                velocity,
                density,
                mass,
                pressure_gradient: gradient,
                lowest_wall_pressure: lowest,
                flatness,
                shift,
                radius_slope: slope,
                rates,
                new,
            },
            Block {
                first: self.first + n,
                position: position2,
                velocity: velocity2,
                density: density2,
                mass: mass2,
                pressure_gradient: gradient2,
                lowest_wall_pressure: lowest2,
                flatness: flatness2,
                shift: shift2,
                radius_slope: slope2,
                rates: rates2,
                new: new2,
            },
        )
    }

    /// What sums over walls read of the particles, and the rates that they add to.
    pub fn targets(&mut self) -> (Targets<'_, D>, &mut [R]) {
        let targets = Targets {
            first: self.first,
            position: self.position,
            density: self.density,
            mass: self.mass,
            beside: Beside {
                lowest_pressure: self.lowest_wall_pressure,
                flatness: self.flatness,
                pressure_gradient: self.pressure_gradient,
                radius_slope: self.radius_slope,
                position: self.position,
                frame: None,
                thin: None,
            },
        };
        (targets, self.rates)
    }

    /// The smallest number of particles, at least `size`, after which a cluster begins or the block
    /// ends: cutting there computes no cluster twice.
    pub fn cut(&self, size: usize, clusters: &Clusters) -> usize {
        if size >= self.len() {
            return self.len();
        }
        (clusters.next_start(self.first + size) - self.first).min(self.len())
    }

    /// The same block for a shorter time.
    pub fn reborrow(&mut self) -> Block<'_, D, S, R> {
        Block {
            first: self.first,
            position: self.position,
            velocity: self.velocity,
            density: self.density,
            mass: self.mass,
            pressure_gradient: self.pressure_gradient,
            lowest_wall_pressure: self.lowest_wall_pressure,
            flatness: self.flatness,
            shift: self.shift,
            radius_slope: self.radius_slope,
            rates: self.rates,
            new: self.new,
        }
    }

    /// Pieces of `size` particles, each filled up to a whole cluster; the last one may be shorter.
    pub fn pieces<'b>(
        &'b mut self,
        size: usize,
        clusters: &'b Clusters,
    ) -> impl Iterator<Item = Block<'b, D, S, R>> {
        let mut rest = Some(self.reborrow());
        std::iter::from_fn(move || {
            let block = rest.take().filter(|block| !block.is_empty())?;
            let size = block.cut(size, clusters);
            let (piece, tail) = block.split_at(size);
            rest = Some(tail);
            Some(piece)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_cover_the_block_once() {
        let n = 10;
        let (mut x, mut v, mut d) = (vec![[0.0; 2]; n], vec![[0.0; 2]; n], vec![0.0; n]);
        let (m, mut r, mut new) = (vec![1.0; n], vec![0.0; n], vec![[0.0f32; 8]; n]);
        let mut block = Block {
            first: 5,
            position: &mut x,
            velocity: &mut v,
            density: &mut d,
            mass: &m,
            pressure_gradient: &mut [[0.0; 2]; 10],
            lowest_wall_pressure: &mut [0.0; 10],
            flatness: &mut [1.0; 10],
            shift: &mut [],
            radius_slope: &[],
            rates: &mut r,
            new: &mut new,
        };
        let mut sizes = Vec::new();
        // Clusters begin at 0, 5 and 13.
        let clusters = Clusters::new(15, &[5]);
        for piece in block.pieces(4, &clusters) {
            piece.density.iter_mut().for_each(|d| *d += 1.0);
            sizes.push((piece.first, piece.len()));
        }
        assert_eq!(sizes, [(5, 8), (13, 2)]);
        assert_eq!(d, vec![1.0; n]);
    }
}
