//! What the terms of a pass take from the energy of the fluid, see [`crate::energy`].

use super::{DensityPass, ForcePass};
use crate::block::Block;
use crate::bodies::Frame;
use crate::energy::{Kicks, Sink, Taken};
use crate::records::Record;
use crate::scheme::Accounts;
use crate::terms::{Acceleration, DensityRate};
use bytemuck::Pod;
use sph_kernels::Real;
use std::array::from_fn;

/// The part of a group in the accelerations of a block.
#[derive(Debug)]
pub(super) struct Share<const D: usize> {
    /// What its work counts as.
    pub sink: Sink,
    /// The frame in which it acts, if that moves.
    pub frame: Option<Frame<D>>,
    /// m/s².
    pub rates: Vec<Acceleration<D>>,
}

impl<const D: usize, S: Real + Pod> ForcePass<'_, D, S> {
    /// Books what forces take in the half kicks around the present positions, and what the shift after
    /// them changes. `shares` are those of walls; pressure and dissipation are told apart here.
    pub(super) fn book(
        &self,
        accounts: &Accounts<D, S>,
        mut shares: Vec<Share<D>>,
        old: &[Record<S>],
        block: &mut Block<'_, D, S, Acceleration<D>>,
        taken: &mut Taken,
    ) {
        if let Some(sum) = &accounts.undamped_walls {
            let (targets, _) = block.targets();
            let mut undamped = Vec::new();
            let mut damped = shares.iter_mut().filter(|share| share.sink == Sink::WallDamping);
            self.around.of_walls(
                &**sum,
                old,
                &targets,
                |_| true,
                |wall, own| {
                    let Some(share) = damped.next() else { return };
                    for (Acceleration(all), Acceleration(part)) in share.rates.iter_mut().zip(own) {
                        *all = from_fn(|k| all[k] - part[k]);
                    }
                    let frame = wall.frame().copied();
                    undamped.push(Share { sink: Sink::WallPressure, frame, rates: own.to_vec() });
                },
            );
            shares.append(&mut undamped);
        }
        if let Some((sink, sum)) = &accounts.viscosity {
            let rates = self.around.of_fluid(&**sum, old, block);
            shares.push(Share { sink: *sink, frame: None, rates });
        }
        let (open, driving) = self.model.parts_of_gravity();
        let dot = |a: &[f64; D], b: &[f64; D]| (0..D).map(|k| a[k] * b[k]).sum::<f64>();
        for k in 0..block.len() {
            let (mass, Acceleration(all)) = (block.mass[k], block.rates[k]);
            let steps = [self.dt_before, self.dt];
            let kicks = Kicks::new(mass, block.velocity[k], all, self.model.gravity, steps);
            for Share { sink, frame, rates } in &shares {
                let still = [0.0; D];
                let carrier = frame.map_or(still, |frame| frame.velocity_at(&block.position[k]));
                let (seen, carried) = kicks.taken(&rates[k].0, &carrier);
                taken.add(*sink, seen);
                if frame.is_some() {
                    taken.add(Sink::Solids, carried);
                }
            }
            taken.add(Sink::Driving, kicks.taken(&driving, &[0.0; D]).0);
            if let Some(shift) = block.shift.get(k) {
                taken.add(Sink::Shifting, [0.0, mass * self.dt * self.speed * dot(&open, shift)]);
            }
        }
    }
}

impl<const D: usize, S: Real + Pod> DensityPass<'_, D, S> {
    /// Books what changes of density take: m p/ρ² dρ, with p/ρ² in the middle of the change. `walls` are
    /// the rates by walls.
    pub(super) fn book(
        &self,
        accounts: &Accounts<D, S>,
        walls: &[DensityRate],
        old: &[Record<S>],
        block: &Block<'_, D, S, DensityRate>,
        taken: &mut Taken,
    ) {
        let diffusion = match &accounts.diffusion {
            Some(sum) => self.around.of_fluid(&**sum, old, block),
            None => vec![DensityRate::default(); block.len()],
        };
        for k in 0..block.len() {
            let (mass, before) = (block.mass[k], block.density[k]);
            let [moved, after] = self.next_density(before, &block.rates[k]);
            let pressure = 0.5 * (self.model.pressure(before) + self.model.pressure(moved));
            let per_density = self.dt * mass * pressure / (before * moved);
            taken.add(Sink::WallPressure, [-per_density * walls[k].rate, 0.0]);
            taken.add(Sink::DensityDiffusion, [-per_density * diffusion[k].rate, 0.0]);
            if after != moved {
                let energy = |density| mass * self.model.elastic_energy(density);
                taken.add(Sink::Spray, [energy(moved) - energy(after), 0.0]);
            }
        }
    }
}
