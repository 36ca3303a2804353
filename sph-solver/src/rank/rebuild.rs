//! The rebuild: who owns what, who needs what, in which order, and who is near whom.

use super::across::across;
use super::costs::{FLUID_COST, USUAL_NEIGHBOURS, WALL_COST};
use super::traveller::{Traveller, arrive, depart, place};
use super::{Rank, record_of};
use crate::bodies::Bodies;
use crate::error::RunError;
use crate::model::Model;
use crate::records::Encoder;
use crate::space::wrapped;
use crate::state::State;
use crate::team::Team;
use crate::terms::{Acceleration, DensityRate};
use bytemuck::Pod;
use sph_decomp::{
    Askew, Communicator, Halo, HaloPlan, MaxReach, Orb, Partition, Parts, Reach, Zone, ZoneOptions,
    migrate,
};
use sph_geometry::Aabb;
use sph_kernels::Real;
use sph_neighbors::{CellList, ClusterList, Clusters, ColumnOrder, Grid};

/// Edge of a search cell in reaches. Smaller cells have fewer candidates in more rows; measured best
/// from a half to one.
const CELL: f64 = 0.67;

/// The fluid is sorted again when this much of the compactness of its clusters is left.
const LOOSE: f64 = 0.95;

/// Consecutive targets of a cluster are not farther apart than this many reaches. Coordinates of
/// records wrap around after 256 support radii: what is far must not seem near.
const JUMP: f64 = 8.0;

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
    ) -> Result<Vec<(u64, [f64; D])>, RunError> {
        let gone = self.remove_outside(model);
        for x in &mut self.state.position {
            *x = wrapped(*x, &model.domain.0, &model.periods);
        }
        let grid = Grid::new(model.domain.0, CELL * model.reach())?.periodic(model.periods)?;
        let settled = self.settled;
        let divided = comm.size() > 1 && self.send_home(comm, division)?;
        if divided || !settled {
            self.settle_walls(comm, team, model, encoder, &grid)?;
        }
        let loose = self.near_fluid.compactness() < LOOSE * self.compactness;
        let sorts = comm.size() > 1 || !settled || !gone.is_empty() || loose;
        let outer = if sorts {
            let outer = self.arrange_fluid(comm, model, &grid)?;
            self.lay_out(model, encoder, &outer);
            outer
        } else {
            State::default()
        };
        self.walls.retain(|wall| wall.frame().is_none());
        if !bodies.is_empty() {
            let fluid = Aabb::around(&self.state.position);
            self.walls.extend(bodies.sets(&grid, encoder, &fluid, model));
        }
        team.install(|| self.build_lists(&grid, model, &outer));
        if sorts {
            self.compactness = self.near_fluid.compactness();
        }
        Ok(gone)
    }

    fn remove_outside(&mut self, model: &Model<D>) -> Vec<(u64, [f64; D])> {
        let state = &self.state;
        let outside = |i: usize| !model.contains(&state.position[i]);
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
        grid: &Grid<D>,
    ) -> Result<State<D>, RunError> {
        let reach = Reach::Uniform(model.reach());
        let options = ZoneOptions { period: model.periods, ..ZoneOptions::default() };
        let zone = Zone::build(&comm, &self.state.position, reach, MaxReach, &options)?;
        let mut plan = zone.into_plan(&comm)?;
        self.sort_owned(model, &mut plan)?;
        let outer = fetch_outer(comm, grid, &mut plan, &self.state)?;
        self.fluid.outer = outer.len();
        self.plan = plan;
        Ok(outer)
    }

    /// Order of the owned fluid: local before inner, then such that clusters are compact. Sums follow
    /// the order of the lists, so this one may depend on how particles came here.
    fn sort_owned(&mut self, model: &Model<D>, plan: &mut HaloPlan) -> Result<(), RunError> {
        let columns = ColumnOrder::new(model.domain.0, model.spacing)?;
        let position = &self.state.position;
        let is_inner = plan.is_inner(position.len());
        // One number to compare: class, place in the columns, and who it is.
        let mut keys: Vec<u128> = (0..position.len())
            .map(|i| {
                let place = u128::from(columns.key(&position[i])) << 32;
                u128::from(is_inner[i]) << 96 | place | i as u128
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
        self.flatness.resize(owned, 1.0);
    }

    fn build_lists(&mut self, grid: &Grid<D>, model: &Model<D>, outer: &State<D>) {
        let reach = model.reach();
        let targets = &self.state.position[..];
        let clusters = Clusters::without_jumps(targets, &[self.fluid.local], JUMP * reach);
        let cells = self.cells.get_or_insert_with(|| CellList::build(grid, &[], &[]));
        if outer.is_empty() {
            cells.rebuild(grid, targets, &self.state.id);
        } else {
            let ids = [&self.state.id[..], &outer.id[..]].concat();
            let positions = [targets, &outer.position[..]].concat();
            cells.rebuild(grid, &positions, &ids);
        }
        self.near_fluid.rebuild(&clusters, cells, targets, true, reach);
        for wall in &mut self.walls {
            wall.find(&clusters, targets, reach);
        }
        let places = [targets, &outer.position[..]];
        self.across = across(&self.near_fluid, &self.walls, places, model);
    }
}

/// Receives the state of the outer particles and sorts them: by cell, then by id.
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
        let (id, position) = place(&received[k as usize]);
        (grid.key(&position), id)
    });
    let mut outer = State::default();
    for &k in &order {
        arrive(&received[k as usize], &mut outer);
    }
    plan.arrange_outer(&order);
    Ok(outer)
}
