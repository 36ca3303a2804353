//! The loads on solids over time: what `solid-NAME.csv` and the summary tell.
//!
//! Every step leaves its loads on the rank whose fluid caused them. They are brought together when a
//! row is due, and from time to time so that the log stays short; sums and maxima run over the steps in
//! order, so that neither the ranks nor the moments of bringing together matter.

use crate::error::RunError;
use crate::loads::{LoadScale, Loads, NUMBERS, on_all_ranks};
use sph_decomp::Communicator;

/// Steps after which loads are brought together though no row is due.
const LONGEST: usize = 256;

/// What is known of the load on one solid between two rows.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct LoadRow {
    /// Force (3, N) and moment (3, N m) by pressure, then by friction, at this time.
    pub now: [f64; NUMBERS],
    /// Its mean since the last row.
    pub mean: [f64; NUMBERS],
    /// Largest magnitude of the force since the last row, N.
    pub largest: f64,
}

/// What is known of the load on one solid over the whole run.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct LoadTotal {
    /// Time integral of force and moment, N s and N m s, as in [`LoadRow::now`].
    pub impulse: [f64; NUMBERS],
    /// Largest magnitude of the force, N.
    pub largest: f64,
}

#[derive(Debug, Clone, Copy, Default)]
struct Entry {
    now: [f64; NUMBERS],
    impulse: [f64; NUMBERS],
    largest: f64,
    total: LoadTotal,
}

/// The loads on the solids of a run.
#[derive(Debug, Clone)]
pub struct LoadLog {
    scale: LoadScale,
    solids: Vec<Entry>,
    /// Time since the last row, s.
    span: f64,
    /// Steps not yet brought together: seconds for which the load acts before and after the time of
    /// its positions, and this rank's part of it.
    pending: Vec<([f64; 2], Loads)>,
}

impl LoadLog {
    /// For so many solids.
    pub fn new(solids: usize, scale: LoadScale) -> Self {
        Self { scale, solids: vec![Entry::default(); solids], span: 0.0, pending: Vec::new() }
    }

    /// How loads are counted.
    pub fn scale(&self) -> LoadScale {
        self.scale
    }

    /// Notes the loads of a step: those at its full step, between kicks over half of `dt_before` and
    /// half of `dt` (s). Collective from time to time.
    pub fn record(
        &mut self,
        comm: &dyn Communicator,
        loads: &Loads,
        dt_before: f64,
        dt: f64,
    ) -> Result<(), RunError> {
        self.pending.push(([0.5 * dt_before, 0.5 * dt], loads.clone()));
        if self.pending.len() >= LONGEST {
            // The last step may still have a row of its own.
            let last = self.pending.pop();
            self.settle(comm)?;
            self.pending.extend(last);
        }
        Ok(())
    }

    /// A row for each solid at the time of the last step. Collective.
    pub fn rows(&mut self, comm: &dyn Communicator) -> Result<Vec<LoadRow>, RunError> {
        let mut rest = None;
        if let Some(([_, after], loads)) = self.pending.last_mut() {
            // What acts after this row belongs to the next one.
            rest = Some(([0.0, std::mem::take(after)], loads.clone()));
        }
        self.settle(comm)?;
        let span = self.span;
        let row = |solid: &mut Entry| {
            let mean = if span > 0.0 { solid.impulse.map(|sum| sum / span) } else { solid.now };
            let row = LoadRow { now: solid.now, mean, largest: solid.largest };
            (solid.impulse, solid.largest) = ([0.0; NUMBERS], 0.0);
            row
        };
        let rows = self.solids.iter_mut().map(row).collect();
        self.span = 0.0;
        self.pending.extend(rest);
        Ok(rows)
    }

    /// What acted over the whole run. Collective.
    pub fn totals(&mut self, comm: &dyn Communicator) -> Result<Vec<LoadTotal>, RunError> {
        self.settle(comm)?;
        Ok(self.solids.iter().map(|solid| solid.total).collect())
    }

    /// Everything that a checkpoint must hold, as numbers. Collective.
    pub fn save(&mut self, comm: &dyn Communicator) -> Result<Vec<f64>, RunError> {
        self.settle(comm)?;
        let mut numbers = vec![self.span];
        for solid in &self.solids {
            numbers.extend(solid.now.iter().chain(&solid.impulse).chain(&solid.total.impulse));
            numbers.extend([solid.largest, solid.total.largest]);
        }
        Ok(numbers)
    }

    /// Goes on from what [`save`](Self::save) gave; numbers for other solids are ignored.
    pub fn restore(&mut self, numbers: &[f64]) {
        const STRIDE: usize = 3 * NUMBERS + 2;
        let Some((span, rest)) = numbers.split_first() else { return };
        if rest.len() != STRIDE * self.solids.len() {
            return;
        }
        self.span = *span;
        for (solid, numbers) in self.solids.iter_mut().zip(rest.chunks_exact(STRIDE)) {
            let part = |k: usize| std::array::from_fn(|i| numbers[k * NUMBERS + i]);
            *solid = Entry {
                now: part(0),
                impulse: part(1),
                largest: numbers[3 * NUMBERS],
                total: LoadTotal { impulse: part(2), largest: numbers[3 * NUMBERS + 1] },
            };
        }
    }

    /// Brings the pending steps of all ranks together. Collective.
    fn settle(&mut self, comm: &dyn Communicator) -> Result<(), RunError> {
        let pending = std::mem::take(&mut self.pending);
        let solids = self.solids.len() as u16;
        let own = pending.iter().flat_map(|(_, loads)| (0..solids).map(|solid| loads.of(solid)));
        let mut all = on_all_ranks(comm, own)?.into_iter();
        for ([before, after], _) in pending {
            for (solid, quanta) in self.solids.iter_mut().zip(&mut all) {
                solid.now = self.scale.in_newtons(&quanta);
                let force = (0..3).map(|k| (solid.now[k] + solid.now[6 + k]).powi(2));
                let force = force.sum::<f64>().sqrt();
                solid.largest = solid.largest.max(force);
                solid.total.largest = solid.total.largest.max(force);
                for k in 0..NUMBERS {
                    // Two products: a row between the two halves must not change the sum.
                    solid.impulse[k] += before * solid.now[k];
                    solid.impulse[k] += after * solid.now[k];
                    solid.total.impulse[k] += before * solid.now[k];
                    solid.total.impulse[k] += after * solid.now[k];
                }
            }
            self.span += before;
            self.span += after;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::loads::Part;
    use sph_decomp::{Solo, ThreadRanks};

    const SCALE: LoadScale = LoadScale { force: 1e-12, moment: 1e-12 };

    fn step(force: f64) -> Loads {
        let mut loads = Loads::NONE;
        loads.add(0, Part::Pressure, [force, 0.0], [0.0; 3], &SCALE);
        loads
    }

    #[test]
    fn no_impulse_is_lost_between_rows() {
        let mut log = LoadLog::new(1, SCALE);
        let (mut impulse, mut dt_before, mut time) = (0.0, 0.0, 0.0);
        let (mut from_rows, mut last_row) = (0.0, 0.0);
        for k in 0..700 {
            let (force, dt) = (f64::from(k % 7), 1e-3 * f64::from(1 + k % 3));
            log.record(&Solo, &step(force), dt_before, dt).unwrap();
            impulse += 0.5 * (dt_before + dt) * force;
            if k % 300 == 150 {
                let row = log.rows(&Solo).unwrap()[0];
                assert!((row.now[0] - force).abs() < 1e-11);
                from_rows += row.mean[0] * (time - last_row);
                last_row = time;
                assert!((row.largest - 6.0).abs() < 1e-11);
            }
            time += dt;
            dt_before = dt;
        }
        let rest = log.solids[0].impulse[0];
        let total = log.totals(&Solo).unwrap()[0].impulse[0];
        assert!((total - impulse).abs() < 1e-9, "{total} {impulse}");
        assert!(from_rows + rest <= impulse && from_rows > 0.5 * impulse);
    }

    #[test]
    fn ranks_and_restarts_do_not_matter() {
        let run = |ranks: usize, restart: bool| {
            let results = ThreadRanks::run(ranks, |comm| {
                let mut log = LoadLog::new(1, SCALE);
                for k in 0..40_i32 {
                    // Every rank causes a part of the load; together it is the same.
                    let share = f64::from(k) + 1.0;
                    let own = if comm.rank() == 0 { step(share) } else { Loads::NONE };
                    log.record(&comm, &own, 0.1, 0.1)?;
                    if restart && k == 25 {
                        let saved = log.save(&comm)?;
                        log = LoadLog::new(1, SCALE);
                        log.restore(&saved);
                    }
                }
                Ok::<_, RunError>((log.rows(&comm)?, log.totals(&comm)?))
            });
            results.unwrap().swap_remove(0)
        };
        let alone = run(1, false);
        assert_eq!(run(3, false), alone);
        assert_eq!(run(2, true), alone);
    }
}
