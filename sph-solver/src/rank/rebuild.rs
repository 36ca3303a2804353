//! The rebuild: who owns what, who needs what, in which order, and who is near whom.

use super::across::across;
use super::costs::{FLUID_COST, USUAL_NEIGHBOURS, WALL_COST};
use super::traveller::{Traveller, arrive, depart, place};
use super::{Rank, record_of};
use crate::bodies::Bodies;
use crate::error::RunError;
use crate::model::Model;
use crate::passes::square;
use crate::records::Encoder;
use crate::search::{Search, Seekers, Sorted};
use crate::space::wrapped;
use crate::state::State;
use crate::team::Team;
use crate::terms::{Acceleration, DensityRate};
use bytemuck::Pod;
use sph_decomp::{
    Askew, Communicator, Halo, HaloPlan, MaxReach, MeanReach, Orb, Partition, Parts, Reach, Zone,
    ZoneOptions, migrate,
};
use sph_geometry::Aabb;
use sph_kernels::Real;
use sph_neighbors::{ClusterList, Clusters, ColumnOrder, GridError};

/// The fluid is sorted again when this much of the compactness of its clusters is left.
const LOOSE: f64 = 0.95;

/// Consecutive targets of a cluster are not farther apart than this many reaches. Coordinates of
/// records wrap around after 256 support radii: what is far must not seem near.
const JUMP: f64 = 8.0;

/// A particle that has left the domain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gone<const D: usize> {
    /// Global id.
    pub id: u64,
    /// Where it was, m.
    pub position: [f64; D],
    /// Kinetic, potential and elastic energy that it had, J.
    pub energy: f64,
}

impl<const D: usize, S: Real + Pod> Rank<D, S> {
    /// Brings the particles to their owners, finds the overlap zone, sorts, and builds the lists.
    /// Returns the particles that have left the domain; they are gone. With `division`, space is
    /// divided anew, and the particles of this rank weigh that many times their cost. `bodies` become walls
    /// where they are now. Collective.
    pub fn rebuild(
        &mut self,
        comm: &dyn Communicator,
        team: &Team,
        model: &Model<D>,
        encoder: &Encoder<D, S>,
        division: Option<f64>,
        bodies: &Bodies<D>,
    ) -> Result<Vec<Gone<D>>, RunError> {
        let gone = self.remove_outside(model);
        let mut turned = false;
        for x in &mut self.state.position {
            let before = std::mem::replace(x, wrapped(*x, &model.domain.0, &model.periods));
            turned |= before != *x;
        }
        let search = Search::new(model)?;
        let settled = self.settled;
        let divided = comm.size() > 1 && self.send_home(comm, division)?;
        if divided || !settled {
            self.settle_walls(comm, team, model, encoder, &search)?;
        }
        let loose = self.near_fluid.compactness() < LOOSE * self.compactness;
        let sorts = comm.size() > 1 || !settled || !gone.is_empty() || loose;
        let outer = if sorts {
            let outer = self.arrange_fluid(comm, model, &search)?;
            self.lay_out(model, encoder, &outer);
            outer
        } else {
            if turned {
                // Words of double precision do not wrap around by themselves, and a difference to the
                // nearest image rounds otherwise than one that is the nearest already.
                self.lay_out(model, encoder, &State::default());
            }
            State::default()
        };
        self.walls.retain(|wall| wall.frame().is_none());
        if !bodies.is_empty() {
            let fluid = Aabb::around(&self.state.position);
            self.walls.extend(bodies.sets(&search, encoder, &fluid, model)?);
        }
        team.install(|| self.build_lists(&search, model, &outer))?;
        if sorts {
            self.compactness = self.near_fluid.compactness();
        }
        Ok(gone)
    }

    fn remove_outside(&mut self, model: &Model<D>) -> Vec<Gone<D>> {
        let state = &self.state;
        let outside = |i: usize| !model.contains(&state.position[i]);
        if !(0..state.len()).any(outside) {
            return Vec::new();
        }
        let (gone, kept): (Vec<u32>, Vec<u32>) =
            (0..state.len() as u32).partition(|&i| outside(i as usize));
        let one = |&i: &u32| {
            let i = i as usize;
            let (position, speed2) = (state.position[i], square(state.velocity[i]));
            let stored = model.elastic_energy(state.density[i]) + model.potential_energy(&position);
            Gone { id: state.id[i], position, energy: state.mass[i] * (0.5 * speed2 + stored) }
        };
        let gone = gone.iter().map(one).collect();
        self.state.keep(&kept);
        gone
    }

    /// Sends every particle to the rank that owns its place. Returns whether space was divided anew:
    /// only then do solids travel.
    fn send_home(
        &mut self,
        comm: &dyn Communicator,
        division: Option<f64>,
    ) -> Result<bool, RunError> {
        if let Some(rate) = division {
            let weights: Vec<f64> = self.costs().iter().map(|cost| rate * cost).collect();
            let positions = [&self.state.position[..], &self.elements.position[..]].concat();
            let positions = Askew::view(&positions);
            self.partition = Some(Askew::new(Orb::build(&comm, &positions, &weights)?));
        }
        if let Some(partition) = &self.partition {
            migrate(&comm, &partition.owners(&self.state.position), &mut self.state.columns())?;
            if division.is_some() {
                let owners = partition.owners(&self.elements.position);
                migrate(&comm, &owners, &mut self.elements.columns())?;
            }
        }
        Ok(division.is_some())
    }

    /// Cost of each owned particle in one step, fluid first, in pairs: its neighbours once there are
    /// lists. Particles that were just taken out shift the rest, which blurs the estimate a little.
    fn costs(&self) -> Vec<f64> {
        let pairs = |list: &ClusterList, i| if i < list.len() { list.count(i) } else { 0 };
        let neighbours = |i: usize| match self.near_fluid.is_empty() {
            true => USUAL_NEIGHBOURS,
            false => {
                let walls = self.walls.iter().map(|wall| pairs(&wall.near, i));
                pairs(&self.near_fluid, i) + walls.sum::<usize>()
            }
        };
        let fluid = (0..self.state.len()).map(|i| FLUID_COST + neighbours(i) as f64);
        fluid.chain(std::iter::repeat_n(WALL_COST, self.elements.len())).collect()
    }

    /// Sum of the costs of the owned particles with the present lists; 0 before there are lists.
    pub fn predicted_cost(&self) -> f64 {
        let (fluid, solid) = (self.state.len() as f64, self.elements.len() as f64);
        FLUID_COST * fluid + WALL_COST * solid + self.pairs() as f64
    }

    /// Finds who needs which fluid particles, sorts those of this rank, and fetches those of others.
    /// Collective.
    fn arrange_fluid(
        &mut self,
        comm: &dyn Communicator,
        model: &Model<D>,
        search: &Search<'_, D>,
    ) -> Result<State<D>, RunError> {
        let options = ZoneOptions { period: model.periods, ..ZoneOptions::default() };
        let position = &self.state.position;
        let zone = match search.reaches(self.state.mass.iter().copied()) {
            None => {
                let reach = Reach::Uniform(model.reach());
                Zone::build(&comm, position, reach, MaxReach, &options)?
            }
            Some(mut reaches) => {
                // Wider by more than the rounding of the search.
                reaches.iter_mut().for_each(|reach| *reach *= 1.0 + 1e-4);
                let reach = Reach::PerParticle(&reaches);
                Zone::build(&comm, position, reach, MeanReach, &options)?
            }
        };
        let mut plan = zone.into_plan(&comm)?;
        self.sort_owned(model, &mut plan)?;
        let outer = fetch_outer(comm, search, &mut plan, &self.state)?;
        self.fluid.outer = outer.len();
        self.plan = plan;
        Ok(outer)
    }

    /// Order of the owned fluid: local before inner, then such that clusters are compact. Sums follow
    /// the order of the lists, so this one may depend on how particles came here.
    fn sort_owned(&mut self, model: &Model<D>, plan: &mut HaloPlan) -> Result<(), RunError> {
        let levels = columns_of_levels(model)?;
        let position = &self.state.position;
        let is_inner = plan.is_inner(position.len());
        // One number to compare: class, level of the spacing, place in the columns, and who it is.
        let mut keys: Vec<u128> = (0..position.len())
            .map(|i| {
                let level = level_of(model, self.state.mass[i]).min(levels.len() - 1);
                let place = u128::from(levels[level].key(&position[i])) << 32;
                u128::from(is_inner[i]) << 112 | (level as u128) << 96 | place | i as u128
            })
            .collect();
        keys.sort_unstable();
        let order: Vec<u32> = keys.iter().map(|&key| key as u32).collect();
        let inner = is_inner.iter().filter(|&&inner| inner).count();
        self.fluid = Parts { local: keys.len() - inner, inner, outer: 0 };
        plan.renumber_owned(&order);
        self.state.keep(&order);
        Ok(())
    }

    /// Writes the records of the fluid: owned particles, then outer ones.
    fn lay_out(&mut self, model: &Model<D>, encoder: &Encoder<D, S>, outer: &State<D>) {
        let density0 = model.equation_of_state.density0();
        let write = |state: &State<D>, i: usize| record_of(encoder, density0, state, i);
        let owned = self.state.len();
        self.deviation.clear();
        self.deviation.extend((0..owned).map(|i| write(&self.state, i)));
        self.deviation.extend((0..outer.len()).map(|i| write(outer, i)));
        // The density pass writes every one of these before anybody reads them.
        self.pressure.resize(self.deviation.len(), [S::from_f64(0.0); 8]);
        self.force_rate.resize(owned, Acceleration::default());
        self.density_rate.resize(owned, DensityRate::default());
        self.lowest_wall_pressure.resize(owned, 0.0);
        self.halves = model.grading.map(|grading| {
            let masses = self.state.mass.iter().chain(&outer.mass);
            masses.map(|mass| S::from_f64(0.5 * grading.ratio::<D>(*mass))).collect()
        });
        self.flatness.resize(owned, 1.0);
    }

    fn build_lists(
        &mut self,
        search: &Search<'_, D>,
        model: &Model<D>,
        outer: &State<D>,
    ) -> Result<(), RunError> {
        let position = &self.state.position[..];
        let reach = search.reach();
        let clusters = &Clusters::without_jumps(position, &[self.fluid.local], JUMP * reach);
        let all = search.reaches(self.state.mass.iter().chain(&outer.mass).copied());
        let reaches = all.as_ref().map(|all| &all[..position.len()]);
        let seekers = Seekers { clusters, position, reaches };
        let sorted = match &mut self.sorted {
            Some(sorted) => sorted,
            none => none.insert(Sorted::new(search, &[], all.as_ref().map(|_| &[][..]), &[])?),
        };
        if outer.is_empty() {
            sorted.renew(search, position, reaches, &self.state.id)?;
        } else {
            let ids = [&self.state.id[..], &outer.id[..]].concat();
            let positions = [position, &outer.position[..]].concat();
            sorted.renew(search, &positions, all.as_deref(), &ids)?;
        }
        sorted.find_each_other(&mut self.near_fluid, search, &seekers);
        for wall in &mut self.walls {
            wall.find(search, &seekers);
        }
        let places = [position, &outer.position[..]];
        self.across = across(&self.near_fluid, &self.walls, places, model);
        Ok(())
    }
}

/// The columns that particles of each level of spacing are sorted into: level l halves the largest
/// spacing l times.
fn columns_of_levels<const D: usize>(model: &Model<D>) -> Result<Vec<ColumnOrder<D>>, GridError> {
    let levels = model.grading.map_or(1, |grading| 1 + level_of_ratio(grading.smallest()));
    let of_level = |level: usize| {
        let spacing = model.spacing * 0.5_f64.powi(level as i32);
        // Particles of a level have a spacing between this one and half of it.
        let typical = if levels > 1 { 0.75 * spacing } else { spacing };
        ColumnOrder::new(model.domain.0, typical)
    };
    (0..levels).map(of_level).collect()
}

/// Level of the spacing of a particle.
fn level_of<const D: usize>(model: &Model<D>, mass: f64) -> usize {
    model.grading.map_or(0, |grading| level_of_ratio(grading.ratio::<D>(mass)))
}

/// How often 1 can be halved before it falls below a ratio.
fn level_of_ratio(ratio: f64) -> usize {
    let mut level = 0;
    while 0.5_f64.powi(level + 1) >= ratio && level < 30 {
        level += 1;
    }
    level as usize
}

/// Receives the state of the outer particles and sorts them: by cell, then by id.
fn fetch_outer<const D: usize>(
    comm: &dyn Communicator,
    search: &Search<'_, D>,
    plan: &mut HaloPlan,
    state: &State<D>,
) -> Result<State<D>, RunError> {
    let mut halo = Halo::<Traveller>::new();
    let received = halo.exchange_now(&comm, plan, |i| depart(state, i as usize))?;
    let mut order: Vec<u32> = (0..received.len() as u32).collect();
    order.sort_by_cached_key(|&k| {
        let (id, position) = place(&received[k as usize]);
        (search.grid.key(&position), id)
    });
    let mut outer = State::default();
    for &k in &order {
        arrive(&received[k as usize], &mut outer);
    }
    plan.arrange_outer(&order);
    Ok(outer)
}
