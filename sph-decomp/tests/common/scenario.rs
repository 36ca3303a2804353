//! One program for every communicator: all steps of a decomposed computation.

use sph_decomp::{
    Columns, Communicator, ExactSum, Halo, HilbertCurve, MeanReach, Orb, Partition, Parts,
    RankStatistics, Reach, Zone, ZoneOptions, global_sums, migrate,
};

use super::Cloud;

/// Sums over neighbours of a value that changes in every pass: what a particle method does, in
/// the order of the local–inner–outer scheme. Returns everything that a rank knows at the end.
pub fn run<C: Communicator>(
    comm: &C,
    hilbert: bool,
) -> Result<Vec<f64>, Box<dyn std::error::Error + Send + Sync>> {
    // Particles start on the wrong ranks.
    let cloud = Cloud::<3>::lattice(9, 1.0 / 9.0, 0.5, 1.5, 11);
    let first = (0..cloud.positions.len()).filter(|i| i % comm.size() == comm.rank());
    let mut ids: Vec<u64> = first.map(|i| i as u64).collect();
    let mut positions: Vec<_> = ids.iter().map(|&id| cloud.positions[id as usize]).collect();
    let mut reach: Vec<_> = ids.iter().map(|&id| cloud.reach[id as usize]).collect();

    let weights: Vec<f64> = positions.iter().map(|x| 1.0 + x[0]).collect();
    let owners = if hilbert {
        HilbertCurve::build(comm, &positions, &weights)?.owners(&positions)
    } else {
        Orb::build(comm, &positions, &weights)?.owners(&positions)
    };
    migrate(comm, &owners, &mut (&mut ids, &mut positions, &mut reach))?;

    let options = ZoneOptions::default();
    let zone = Zone::build(comm, &positions, Reach::PerParticle(&reach), MeanReach, &options)?;
    let mut plan = zone.into_plan(comm)?;
    let (parts, order) = Parts::arrange(ids.len(), &plan, |i| ids[i as usize]);
    ids.permute(&order);
    plan.renumber_owned(&order);
    plan.verify(comm)?;

    let mut halo = Halo::<[f64; 2]>::new();
    let arrived = halo.exchange_now(comm, &plan, |i| [ids[i as usize] as f64, 0.0])?;
    let mut outer_order: Vec<u32> = (0..arrived.len() as u32).collect();
    outer_order.sort_by_key(|&slot| arrived[slot as usize][0] as u64);
    plan.arrange_outer(&outer_order);
    let outer_ids: Vec<u64> = {
        let mut outer = vec![0; parts.outer];
        let arrived = halo.exchange_now(comm, &plan, |i| [ids[i as usize] as f64, 0.0])?;
        plan.unpack(arrived, |slot, element| outer[slot] = element[0] as u64);
        outer
    };
    assert!(outer_ids.is_sorted());
    ids.extend(&outer_ids);

    // Particles with an even id are at rest and travel in the first pass only.
    let moves = |place: usize| ids[place] % 2 == 1;
    let moving = plan.restrict(|i| moves(i as usize), |slot| moves(parts.owned() + slot as usize));
    moving.verify(comm)?;

    let neighbours = neighbours(&cloud, &ids, parts.owned());
    let mut values: Vec<f64> = ids.iter().map(|&id| (id as f64).sin()).collect();
    let mut statistics = RankStatistics::default();
    statistics.layout(comm, &parts, &plan);
    let mut largest = 0.0;
    for _ in 0..5 {
        let step = Step { values: &values, neighbours: &neighbours, moves: &moves };
        let mut next = values.clone();
        let mut maxima = [next[..parts.owned()].iter().copied().fold(0.0, f64::max)];
        let (next_local, next_inner, _) = parts.split_mut(&mut next);
        let (arrived, exposed) = halo.exchange(
            comm,
            &moving,
            &mut maxima,
            |send| {
                for (k, place) in parts.inner_range().enumerate() {
                    next_inner[k] = step.value(place);
                }
                moving.pack(send, |i| [next_inner[i as usize - parts.local], 0.0]);
            },
            |progress| {
                for place in parts.local_range() {
                    next_local[place] = step.value(place);
                    if place % 16 == 0 {
                        progress.poll();
                    }
                }
            },
        )?;
        moving.unpack(arrived, |slot, element| next[parts.owned() + slot] = element[0]);
        values = next;
        largest += maxima[0];
        statistics.pass(&exposed);
    }
    let sum: ExactSum = values[..parts.owned()].iter().copied().collect();
    let mut result = vec![largest, global_sums(comm, &[sum])?[0]];
    result.extend(&values);
    for mut rank in statistics.gather(comm)? {
        rank.exposed_seconds = 0.0;
        result.extend(rank.values());
    }
    Ok(result)
}

struct Step<'a, M> {
    values: &'a [f64],
    neighbours: &'a [Vec<u32>],
    moves: &'a M,
}

impl<M: Fn(usize) -> bool> Step<'_, M> {
    fn value(&self, place: usize) -> f64 {
        if !(self.moves)(place) {
            return self.values[place];
        }
        let list = &self.neighbours[place];
        let sum: f64 = list.iter().map(|&j| self.values[j as usize]).sum();
        0.5 * self.values[place] + 0.5 * sum / list.len().max(1) as f64
    }
}

/// The neighbours of each owned particle, ascending by id, found by looking at all pairs.
fn neighbours(cloud: &Cloud<3>, ids: &[u64], owned: usize) -> Vec<Vec<u32>> {
    let mut by_id: Vec<u32> = (0..ids.len() as u32).collect();
    by_id.sort_by_key(|&place| ids[place as usize]);
    let list = |i: usize| {
        let near = |&&place: &&u32| {
            let (i, j) = (ids[i] as usize, ids[place as usize] as usize);
            i != j && cloud.distance(i, j, &[None; 3]) < 0.5 * (cloud.reach[i] + cloud.reach[j])
        };
        by_id.iter().filter(near).copied().collect()
    };
    (0..owned).map(list).collect()
}
