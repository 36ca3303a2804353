//! Particles of graded reach that move, migrate and are balanced.

use sph_decomp::{
    Askew, Balancer, Columns, Communicator, Evenness, Halo, HaloPlan, Load, MeanReach, Orb,
    Partition, Parts, Reach, Zone, ZoneOptions, migrate,
};

type Failure = Box<dyn std::error::Error + Send + Sync>;

const STEPS: u64 = 120;
const STEPS_PER_REBUILD: u64 = 3;
const TIME_STEP: f64 = 0.002;
/// Twice what a particle moves until the next rebuild, at most.
const SKIN: f64 = 0.024;

/// What a rank knows at the end.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Id and bits of the position of each owned particle, by id.
    pub state: Vec<[u64; 3]>,
    /// List entries evaluated by this rank in all steps.
    pub pairs: u64,
    /// How even the load was.
    pub evenness: Evenness,
}

/// Owned particles, and in `id`, `x` and `reach` also those that this rank needs of others.
#[derive(Default)]
struct Swarm {
    id: Vec<u64>,
    x: Vec<[f64; 2]>,
    reach: Vec<f64>,
    parts: Parts,
    plan: HaloPlan,
    /// By owned particle, in the order of ids.
    lists: Vec<Vec<u32>>,
}

/// A unit square whose spacing grows by a factor of four from left to right, all on rank 0.
fn square(rank: usize) -> Swarm {
    let mut swarm = Swarm::default();
    let mut left = 0.0;
    while left < 1.0 && rank == 0 {
        let spacing = 0.014 * 4.0_f64.powf(left);
        for row in 0..(1.0 / spacing) as u32 {
            swarm.id.push(swarm.id.len() as u64);
            swarm.x.push([left + 0.5 * spacing, (f64::from(row) + 0.5) * spacing]);
            swarm.reach.push(2.5 * spacing);
        }
        left += spacing;
    }
    swarm
}

impl Swarm {
    /// Cost of an owned particle: its list, and something for itself.
    fn cost(&self, i: usize) -> f64 {
        1.0 + self.lists.get(i).map_or(0.0, |list| list.len() as f64)
    }

    fn rebuild<C: Communicator>(
        &mut self,
        comm: &C,
        balancer: &mut Balancer,
        partition: &mut Option<Askew<Orb<2>>>,
        steps: u64,
    ) -> Result<(), Failure> {
        let owned = if self.lists.is_empty() { self.x.len() } else { self.parts.owned() };
        let costs: Vec<f64> = (0..owned).map(|i| self.cost(i)).collect();
        let mut columns = (&mut self.id, &mut self.x, &mut self.reach);
        columns.resize(owned);
        let predicted = costs.iter().sum();
        let review = balancer.review(comm, Load { predicted, seconds: 0.0, steps })?;
        if review.divide {
            *partition = Some(Askew::new(Orb::build(comm, &Askew::view(columns.1), &costs)?));
        }
        if let Some(partition) = partition {
            migrate(comm, &partition.owners(columns.1), &mut columns)?;
        }
        let wide: Vec<f64> = columns.2.iter().map(|reach| reach + SKIN).collect();
        let (reach, options) = (Reach::PerParticle(&wide), ZoneOptions::default());
        self.plan = Zone::build(comm, columns.1, reach, MeanReach, &options)?.into_plan(comm)?;
        let (parts, order) = Parts::arrange(columns.len(), &self.plan, |i| columns.0[i as usize]);
        columns.permute(&order);
        self.plan.renumber_owned(&order);
        self.parts = parts;
        let mut halo = Halo::<[u64; 4]>::new();
        let outer = halo.exchange_now(comm, &self.plan, |i| {
            let i = i as usize;
            let [x, y] = self.x[i].map(f64::to_bits);
            [self.id[i], x, y, self.reach[i].to_bits()]
        })?;
        for &[id, x, y, reach] in outer {
            self.id.push(id);
            self.x.push([x, y].map(f64::from_bits));
            self.reach.push(f64::from_bits(reach));
        }
        self.lists = self.near();
        Ok(())
    }

    fn near(&self) -> Vec<Vec<u32>> {
        let mut by_id: Vec<u32> = (0..self.id.len() as u32).collect();
        by_id.sort_by_key(|&j| self.id[j as usize]);
        let near = |i: usize, j: usize| i != j && self.pair(i, j).0 < self.mean(i, j) + SKIN;
        let list = |i: usize| by_id.iter().copied().filter(|&j| near(i, j as usize)).collect();
        (0..self.parts.owned()).map(list).collect()
    }

    fn mean(&self, i: usize, j: usize) -> f64 {
        0.5 * (self.reach[i] + self.reach[j])
    }

    /// Distance of two particles, and the vector between them.
    fn pair(&self, i: usize, j: usize) -> (f64, [f64; 2]) {
        let d = [self.x[i][0] - self.x[j][0], self.x[i][1] - self.x[j][1]];
        ((d[0] * d[0] + d[1] * d[1]).sqrt(), d)
    }

    /// The next place of a particle: it goes round the centre and away from those near it.
    fn moved(&self, i: usize) -> [f64; 2] {
        let x = self.x[i];
        let mut v = [1.5 * (0.5 - x[1]), 1.5 * (x[0] - 0.5)];
        for &j in &self.lists[i] {
            let ((distance, d), mean) = (self.pair(i, j as usize), self.mean(i, j as usize));
            if distance < mean {
                let push = (1.0 - distance / mean).powi(2) / mean;
                v = [v[0] + push * d[0], v[1] + push * d[1]];
            }
        }
        [x[0] + TIME_STEP * v[0], x[1] + TIME_STEP * v[1]]
    }

    /// One overlapped pass; returns how far the fastest particle has moved.
    fn step<C: Communicator>(
        &mut self,
        comm: &C,
        halo: &mut Halo<[f64; 2]>,
    ) -> Result<f64, Failure> {
        let (old, parts, plan) = (&*self, self.parts, &self.plan);
        let mut new = old.x.clone();
        let (local, inner, _) = parts.split_mut(&mut new);
        let (received, _) = halo.exchange(
            comm,
            plan,
            &mut [],
            |send| {
                for (new, i) in inner.iter_mut().zip(parts.inner_range()) {
                    *new = old.moved(i);
                }
                plan.pack(send, |i| inner[i as usize - parts.local]);
            },
            |progress| {
                for (new, i) in local.iter_mut().zip(parts.local_range()) {
                    *new = old.moved(i);
                    progress.poll();
                }
            },
        )?;
        plan.unpack(received, |slot, x| new[parts.owned() + slot] = *x);
        let distance = |(a, b): (&[f64; 2], &[f64; 2])| (a[0] - b[0]).hypot(a[1] - b[1]);
        let fastest = new.iter().zip(&self.x).map(distance).fold(0.0, f64::max);
        self.x = new;
        Ok(fastest)
    }
}

/// Runs the swarm. Weights come from the lists alone, so that partitions are the same each time.
pub fn run<C: Communicator>(comm: &C) -> Result<Outcome, Failure> {
    let mut swarm = square(comm.rank());
    let (mut balancer, mut partition) = (Balancer::new(1.02), None);
    let (mut halo, mut pairs, mut moved) = (Halo::new(), 0, 0.0);
    swarm.rebuild(comm, &mut balancer, &mut partition, 0)?;
    swarm.rebuild(comm, &mut balancer, &mut partition, 0)?;
    for step in 0..STEPS {
        if step > 0 && step % STEPS_PER_REBUILD == 0 {
            swarm.rebuild(comm, &mut balancer, &mut partition, STEPS_PER_REBUILD)?;
            moved = 0.0;
        }
        pairs += swarm.lists.iter().map(|list| list.len() as u64).sum::<u64>();
        moved += swarm.step(comm, &mut halo)?;
        assert!(2.0 * moved < SKIN, "the lists are not valid any more: {moved}");
    }
    let mut state: Vec<[u64; 3]> = (0..swarm.parts.owned())
        .map(|i| [swarm.id[i], swarm.x[i][0].to_bits(), swarm.x[i][1].to_bits()])
        .collect();
    state.sort_unstable();
    Ok(Outcome { state, pairs, evenness: balancer.evenness() })
}
