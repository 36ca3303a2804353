//! A drop of atoms in two dimensions with Lennard-Jones forces, on ranks that are threads.
//!
//! The atoms move, so every few steps they migrate to the ranks that own the space they are in,
//! and zone, plan and neighbour lists are built again; a skin keeps them valid in between. In each
//! step the positions of the inner atoms travel while the forces on the local ones are computed.
//!
//! `cargo run --release --example molecular_dynamics`

use sph_decomp::{
    Columns, Communicator, ExactSum, Halo, HaloPlan, MaxReach, Orb, Partition, Parts, Reach,
    ThreadRanks, Zone, ZoneOptions, global_sums, migrate,
};

type Failure = Box<dyn std::error::Error + Send + Sync>;

const CUTOFF: f64 = 2.5;
const SKIN: f64 = 0.4;
const TIME_STEP: f64 = 0.004;
const STEPS: usize = 300;

/// The atoms of a rank: owned ones, and in `id` and `x` also those that it needs of others.
#[derive(Default)]
struct Atoms {
    id: Vec<u64>,
    x: Vec<[f64; 2]>,
    v: Vec<[f64; 2]>,
    parts: Parts,
    plan: HaloPlan,
    neighbours: Vec<Vec<u32>>,
}

/// A square of atoms in a shear flow; rank 0 makes them all.
fn drop(rank: usize) -> Atoms {
    let mut atoms = Atoms::default();
    for k in 0..if rank == 0 { 1600_u32 } else { 0 } {
        let (i, j) = (f64::from(k % 40), f64::from(k / 40));
        atoms.id.push(u64::from(k));
        atoms.x.push([1.12 * i, 1.12 * j]);
        atoms.v.push([0.1 * (j - 19.5) + 0.3 * (7.0 * i + j).sin(), 0.3 * (3.0 * j - i).cos()]);
    }
    atoms
}

impl Atoms {
    fn rebuild<C: Communicator>(&mut self, comm: &C) -> Result<(), Failure> {
        let mut columns = (&mut self.id, &mut self.x, &mut self.v);
        let owned = columns.2.len();
        columns.resize(owned);
        let owners = Orb::build(comm, columns.1, &[])?.owners(columns.1);
        migrate(comm, &owners, &mut columns)?;
        let (reach, options) = (Reach::Uniform(CUTOFF + SKIN), ZoneOptions::default());
        self.plan = Zone::build(comm, columns.1, reach, MaxReach, &options)?.into_plan(comm)?;
        let (parts, order) = Parts::arrange(columns.len(), &self.plan, |i| columns.0[i as usize]);
        columns.permute(&order);
        self.plan.renumber_owned(&order);
        self.parts = parts;
        let (id, x) = (&mut self.id, &mut self.x);
        id.extend_from_slice(Halo::new().exchange_now(comm, &self.plan, |i| id[i as usize])?);
        x.extend_from_slice(Halo::new().exchange_now(comm, &self.plan, |i| x[i as usize])?);
        // In the order of ids, the same on any number of ranks. A toy may look at all pairs.
        let mut by_id: Vec<u32> = (0..self.id.len() as u32).collect();
        by_id.sort_by_key(|&j| self.id[j as usize]);
        let near = |i: usize, j| j as usize != i && self.pair(i, j).0 < (CUTOFF + SKIN).powi(2);
        let list = |i| by_id.iter().copied().filter(|&j| near(i, j)).collect();
        self.neighbours = (0..parts.owned()).map(list).collect();
        Ok(())
    }

    /// Square of the distance of two atoms, and the vector between them.
    fn pair(&self, i: usize, j: u32) -> (f64, [f64; 2]) {
        let (a, b) = (self.x[i], self.x[j as usize]);
        let d = [a[0] - b[0], a[1] - b[1]];
        (d[0] * d[0] + d[1] * d[1], d)
    }

    /// Force on an atom, and its half of the potential energies.
    fn force(&self, i: usize) -> ([f64; 2], f64) {
        let (mut force, mut energy) = ([0.0; 2], 0.0);
        for &j in &self.neighbours[i] {
            let (r2, d) = self.pair(i, j);
            if r2 < CUTOFF * CUTOFF {
                let s6 = 1.0 / (r2 * r2 * r2);
                energy += 2.0 * (s6 * s6 - s6) + 0.008_16; // 0 at the cutoff
                let strength = (48.0 * s6 * s6 - 24.0 * s6) / r2;
                force = [force[0] + strength * d[0], force[1] + strength * d[1]];
            }
        }
        (force, energy)
    }
}

fn kick(v: &mut [f64; 2], f: &[f64; 2], dt: f64) {
    *v = [v[0] + dt * f[0], v[1] + dt * f[1]];
}

/// Runs the drop; returns the total energy at the start and the end, and how often it rebuilt.
fn simulate<C: Communicator>(comm: &C) -> Result<([f64; 2], usize), Failure> {
    let mut atoms = drop(comm.rank());
    atoms.rebuild(comm)?;
    let mut halo = Halo::<[f64; 2]>::new();
    let (mut energies, mut rebuilds, mut moved) = ([0.0; 2], 0, 0.0);
    for step in 0..=STEPS {
        // Lists are valid until two atoms may have come closer by the skin. The bound on how far
        // any atom has moved is the same on all ranks, so all rebuild in the same step.
        if 2.0 * moved > SKIN {
            atoms.rebuild(comm)?;
            (rebuilds, moved) = (rebuilds + 1, 0.0);
        }
        let (parts, plan) = (atoms.parts, &atoms.plan);
        let mut fastest = [atoms.v.iter().map(|v| v[0].hypot(v[1])).fold(0.0, f64::max)];
        let mut forces = Vec::with_capacity(parts.owned());
        let (received, _) = halo.exchange(
            comm,
            plan,
            &mut fastest,
            |send| plan.pack(send, |i| atoms.x[i as usize]),
            |progress| {
                for i in parts.local_range() {
                    forces.push(atoms.force(i));
                    progress.poll();
                }
            },
        )?;
        plan.unpack(received, |slot, x| atoms.x[parts.owned() + slot] = *x);
        forces.extend(parts.inner_range().map(|i| atoms.force(i)));
        // Leapfrog: the force kicks twice by half a step, before and after the energy is taken.
        let half = if step == 0 { 0.0 } else { 0.5 * TIME_STEP };
        let mut energy = ExactSum::new();
        for ((x, v), (f, potential)) in atoms.x.iter_mut().zip(&mut atoms.v).zip(&forces) {
            kick(v, f, half);
            energy.add(potential + 0.5 * (v[0] * v[0] + v[1] * v[1]));
            kick(v, f, 0.5 * TIME_STEP);
            kick(x, v, TIME_STEP);
        }
        // A kick later in this step may have made an atom faster; half as much again is plenty.
        moved += 1.5 * fastest[0] * TIME_STEP;
        if step == 0 || step == STEPS {
            energies[usize::from(step > 0)] = global_sums(comm, &[energy])?[0];
        }
    }
    Ok((energies, rebuilds))
}

fn main() -> Result<(), Failure> {
    let mut first = None;
    for ranks in [1, 2, 6] {
        let results = ThreadRanks::run(ranks, |comm| simulate(&comm)).map_err(|e| e.to_string())?;
        let ([start, end], rebuilds) = results[0];
        println!("{ranks} ranks: energy {start:.9} → {end:.9}, {rebuilds} rebuilds");
        assert_eq!(*first.get_or_insert(results[0]), results[0], "the same bits");
        assert!((end - start).abs() < 2e-3 * start.abs(), "energy is conserved");
    }
    Ok(())
}
