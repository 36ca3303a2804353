//! The rebuild: who owns what, who needs what, in which order, and who is near whom.

use super::Rank;
use super::traveller::{Traveller, arrive, depart, place};
use crate::error::RunError;
use crate::model::Model;
use crate::records::record;
use crate::spray::mark_spray;
use crate::state::{FLUID, State};
use crate::team::Team;
use crate::terms::Acceleration;
use bytemuck::Pod;
use sph_decomp::{
    Askew, Communicator, Halo, HaloPlan, MaxReach, Orb, Partition, Parts, Reach, Zone, ZoneOptions,
    migrate,
};
use sph_kernels::Real;
use sph_neighbors::{CellList, Grid, NeighborList};

/// List entries are padded to this many, the widest lanes in use.
const PAD: usize = 8;

/// Cost of a wall particle, in pairs: no sweep visits it as a target. It is stored, sorted and
/// sent at rebuilds, so that a rank is not left with all the walls of a dry half for nothing.
const WALL_COST: f64 = 0.5;
/// Cost of a fluid particle besides its neighbours, in pairs.
const FLUID_COST: f64 = 20.0;
/// Neighbours of a fluid particle before there are lists.
const USUAL_NEIGHBOURS: usize = 90;

impl<const D: usize, S: Real + Pod> Rank<D, S> {
    /// Brings the particles to their owners, finds the overlap zone, sorts, and builds the lists.
    /// Returns the particles that have left the domain; they are gone. With `division`, space is
    /// divided anew, and the particles of this rank weigh that many times their cost. Collective.
    pub fn rebuild(
        &mut self,
        comm: &dyn Communicator,
        team: &Team,
        model: &Model<D>,
        has_walls: bool,
        division: Option<f64>,
    ) -> Result<Vec<(u64, [f64; D])>, RunError> {
        let gone = self.remove_outside(model);
        let grid = Grid::new(model.domain.0, model.reach())?;
        if comm.size() > 1 {
            self.send_home(comm, division)?;
        }
        let reach = Reach::Uniform(model.reach());
        let options = ZoneOptions::default();
        let zone = Zone::build(&comm, &self.state.position, reach, MaxReach, &options)?;
        let mut plan = zone.into_plan(&comm)?;
        self.sort_owned(&grid, &mut plan);
        let outer = fetch_outer(comm, &grid, &mut plan, &self.state)?;
        self.fluid.outer = outer.kind.iter().filter(|&&kind| kind == FLUID).count();
        self.solid.outer = outer.len() - self.fluid.outer;
        self.lay_out(model, &outer);
        let (fluid_owned, fluid_outer) = (self.fluid.owned() as u32, self.fluid.outer as u32);
        // Solids at rest are sent here and never in a pass.
        self.plan = plan.restrict(|i| i < fluid_owned, |slot| slot < fluid_outer);
        team.install(|| self.build_lists(&grid, model.reach(), &outer, has_walls));
        self.spray = mark_spray(model, &self.near_fluid, &self.near_walls);
        Ok(gone)
    }

    fn remove_outside(&mut self, model: &Model<D>) -> Vec<(u64, [f64; D])> {
        let state = &self.state;
        let outside = |i: usize| state.kind[i] == FLUID && !model.contains(&state.position[i]);
        if !(0..state.len()).any(outside) {
            return Vec::new();
        }
        let (gone, kept): (Vec<u32>, Vec<u32>) =
            (0..state.len() as u32).partition(|&i| outside(i as usize));
        let gone =
            gone.iter().map(|&i| (state.id[i as usize], state.position[i as usize])).collect();
        self.state.keep(&kept);
        gone
    }

    /// Sends every particle to the rank that owns its place.
    fn send_home(
        &mut self,
        comm: &dyn Communicator,
        division: Option<f64>,
    ) -> Result<(), RunError> {
        if let Some(rate) = division {
            let weights: Vec<f64> = self.costs().iter().map(|cost| rate * cost).collect();
            let positions = Askew::view(&self.state.position);
            self.partition = Some(Askew::new(Orb::build(&comm, &positions, &weights)?));
        }
        if let Some(partition) = &self.partition {
            let owners = partition.owners(&self.state.position);
            migrate(&comm, &owners, &mut self.state.columns())?;
        }
        Ok(())
    }

    /// Cost of each owned particle in one step, in pairs: the lengths of its lists once there are
    /// lists. Particles that were just taken out shift the rest, which blurs the estimate a little.
    fn costs(&self) -> Vec<f64> {
        let pairs = |list: &NeighborList, i| if i < list.len() { list.count(i) } else { 0 };
        let neighbours = |i: usize| match self.near_fluid.is_empty() {
            true => USUAL_NEIGHBOURS,
            false => pairs(&self.near_fluid, i) + pairs(&self.near_walls, i),
        };
        let cost = |i: usize| match self.state.kind[i] {
            FLUID => FLUID_COST + neighbours(i) as f64,
            _ => WALL_COST,
        };
        (0..self.state.len()).map(cost).collect()
    }

    /// Sum of the costs of the owned particles with the present lists; 0 before there are lists.
    pub fn predicted_cost(&self) -> f64 {
        let pairs = self.near_fluid.pairs() + self.near_walls.pairs();
        let (fluid, solid) = (self.fluid.owned() as f64, self.solid.owned() as f64);
        FLUID_COST * fluid + WALL_COST * solid + pairs as f64
    }

    /// Order of the owned particles: class, then local before inner, then cell, then id.
    fn sort_owned(&mut self, grid: &Grid<D>, plan: &mut HaloPlan) {
        let state = &self.state;
        let inner = plan.is_inner(state.len());
        let mut keys: Vec<(bool, bool, u64, u64, u32)> = (0..state.len())
            .map(|i| {
                let key = grid.key(&state.position[i]);
                (state.kind[i] != FLUID, inner[i], key, state.id[i], i as u32)
            })
            .collect();
        keys.sort_unstable();
        let order: Vec<u32> = keys.iter().map(|key| key.4).collect();
        let count = |solid: bool, inner: bool| {
            keys.iter().filter(|key| key.0 == solid && key.1 == inner).count()
        };
        self.fluid = Parts { local: count(false, false), inner: count(false, true), outer: 0 };
        self.solid = Parts { local: count(true, false), inner: count(true, true), outer: 0 };
        plan.renumber_owned(&order);
        self.state.keep(&order);
    }

    /// Writes the records: owned particles, then outer ones.
    fn lay_out(&mut self, model: &Model<D>, outer: &State<D>) {
        let encoder = model.encoder();
        let density0 = model.equation_of_state.density0();
        let write = |state: &State<D>, i: usize| {
            let volume = encoder.volume(state.mass[i] / state.density[i]);
            let deviation = S::from_f64(state.density[i] - density0);
            record(encoder.motion(&state.position[i], &state.velocity[i]), deviation, volume)
        };
        let (owned, others) = (self.fluid.owned(), self.fluid.outer);
        self.deviation.clear();
        self.deviation.extend((0..owned).map(|i| write(&self.state, i)));
        self.deviation.extend((0..others).map(|i| write(outer, i)));
        // The density pass writes every one of these before anybody reads them.
        self.pressure.resize(self.deviation.len(), [S::from_f64(0.0); 8]);
        self.walls.clear();
        self.walls.extend((owned..self.state.len()).map(|i| write(&self.state, i)));
        self.walls.extend((others..outer.len()).map(|i| write(outer, i)));
        self.walls.push([S::from_f64(0.0); 8]);
        self.acceleration.resize(owned, Acceleration::default());
        self.density_rate.resize(owned, 0.0);
    }

    fn build_lists(&mut self, grid: &Grid<D>, reach: f64, outer: &State<D>, has_walls: bool) {
        let (owned, others) = (self.fluid.owned(), self.fluid.outer);
        let gather = |mine: std::ops::Range<usize>, theirs: std::ops::Range<usize>| {
            let ids = [&self.state.id[mine.clone()], &outer.id[theirs.clone()]].concat();
            let positions = [&self.state.position[mine], &outer.position[theirs]].concat();
            (ids, positions)
        };
        let targets = &self.state.position[..owned];
        let (ids, positions) = gather(0..owned, 0..others);
        let cells = CellList::build(grid, &positions, &ids);
        let itself = |t: usize| t as u32;
        self.near_fluid.rebuild(&cells, targets, itself, reach, PAD);
        if has_walls {
            let (ids, positions) = gather(owned..self.state.len(), others..outer.len());
            let cells = CellList::build(grid, &positions, &ids);
            let nobody = positions.len() as u32;
            self.near_walls.rebuild(&cells, targets, |_| nobody, reach, PAD);
        }
    }
}

/// Receives the state of the outer particles and sorts them: class, then cell, then id.
fn fetch_outer<const D: usize>(
    comm: &dyn Communicator,
    grid: &Grid<D>,
    plan: &mut HaloPlan,
    state: &State<D>,
) -> Result<State<D>, RunError> {
    let mut halo = Halo::<Traveller>::new();
    let received = halo.exchange_now(&comm, plan, |i| depart(state, i as usize))?;
    let mut order: Vec<u32> = (0..received.len() as u32).collect();
    order.sort_by_cached_key(|&k| {
        let (id, kind, position) = place(&received[k as usize]);
        (kind != FLUID, grid.key(&position), id)
    });
    let mut outer = State::default();
    for &k in &order {
        arrive(&received[k as usize], &mut outer);
    }
    plan.arrange_outer(&order);
    Ok(outer)
}
