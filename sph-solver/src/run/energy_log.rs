//! The energy budget over time: what `energies.csv` and the summary tell of it.
//!
//! What sinks took is kept as whole numbers on the rank whose fluid gave it, and summed over the ranks when
//! a row is due. Whole numbers add up to the same in any order, so neither ranks nor restarts matter.

use super::samples::Budget;
use crate::energy::{EnergyScale, Quanta, SINKS, Taken};
use crate::error::RunError;
use crate::loads::{apart, on_all_ranks, together};
use sph_decomp::Communicator;

/// The budget at the time of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnergyRow {
    /// What each sink took since the start, J.
    pub taken: [f64; SINKS],
    /// Energy now and all that was taken, less the energy at the start, J.
    pub residual: f64,
    /// The residual as a share of the energy that the fluid had or was given.
    pub share: f64,
}

/// The row whose residual is the largest share.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Worst {
    /// Share of the energy that the fluid had or was given.
    pub share: f64,
    /// When, s.
    pub time: f64,
}

/// The first row.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Start {
    /// Energy and all that was taken by then, J.
    total: f64,
    /// Kinetic, potential and elastic energy, J.
    energy: f64,
    /// Mass, kg.
    mass: f64,
}

/// The energy budget of a run.
#[derive(Debug, Clone)]
pub struct EnergyLog {
    scale: EnergyScale,
    /// Up to the last full step.
    taken: Quanta,
    /// After it.
    after: Quanta,
    start: Option<Start>,
    /// Lowest potential energy per mass that a particle had in any row, J/kg.
    lowest: f64,
    worst: Worst,
}

/// Numbers of a saved log.
const SAVED: usize = 4 * SINKS + 7;

impl EnergyLog {
    /// For a run that begins.
    pub fn new(scale: EnergyScale) -> Self {
        let (taken, after) = ([0; SINKS], [0; SINKS]);
        Self { scale, taken, after, start: None, lowest: f64::INFINITY, worst: Worst::default() }
    }

    /// Whether the first row is still to come.
    pub fn wants_start(&self) -> bool {
        self.start.is_none()
    }

    /// Adds what was taken in a step.
    pub fn record(&mut self, step: &Taken) {
        for k in 0..SINKS {
            self.taken[k] += self.after[k] + step.before[k];
        }
        self.after = step.after;
    }

    /// The budget in the full step of the last record, whose energies are in `now`. Collective.
    pub fn row<const D: usize>(
        &mut self,
        comm: &dyn Communicator,
        time: f64,
        now: &Budget<D>,
    ) -> Result<EnergyRow, RunError> {
        let all = on_all_ranks(comm, [self.taken])?;
        let taken = self.scale.in_joules(&all[0]);
        let energy = now.kinetic + now.potential + now.elastic;
        let total = energy + taken.iter().sum::<f64>();
        let start = *self.start.get_or_insert(Start { total, energy, mass: now.mass });
        self.lowest = self.lowest.min(now.lowest);
        let residual = total - start.total;
        // What may turn into motion: not what lies below the lowest place that fluid was at.
        let had = start.energy - start.mass * self.lowest;
        let given: f64 = taken.iter().map(|taken| (-taken).max(0.0)).sum();
        let share = if residual == 0.0 { 0.0 } else { residual / (had.max(0.0) + given) };
        if share.abs() > self.worst.share.abs() {
            self.worst = Worst { share, time };
        }
        Ok(EnergyRow { taken, residual, share })
    }

    /// The row with the largest residual.
    pub fn worst(&self) -> Worst {
        self.worst
    }

    /// Everything that a checkpoint must hold, as numbers. Collective.
    pub fn save(&self, comm: &dyn Communicator) -> Result<Vec<f64>, RunError> {
        let own = std::array::from_fn(|k| self.taken[k] + self.after[k]);
        let all = on_all_ranks::<SINKS>(comm, [own])?;
        // Words of 32 bits, which numbers hold exactly.
        let mut numbers: Vec<f64> = apart(all[0]).map(|word| word as f64).collect();
        let Start { total, energy, mass } =
            self.start.unwrap_or(Start { total: f64::NAN, energy: 0.0, mass: 0.0 });
        numbers.extend([total, energy, mass, self.lowest, self.worst.share, self.worst.time]);
        numbers.push(self.scale.joules);
        Ok(numbers)
    }

    /// Goes on from what [`save`](Self::save) gave. Returns whether that was a budget, and one in the same
    /// quanta. Of the ranks, one at most goes on with what was taken: the `first`.
    pub fn restore(&mut self, numbers: &[f64], first: bool) -> bool {
        if numbers.len() != SAVED || numbers[SAVED - 1] != self.scale.joules {
            return false;
        }
        let (words, rest) = numbers.split_at(4 * SINKS);
        let words: Vec<u64> = words.iter().map(|word| *word as u64).collect();
        self.taken = if first { together(&words) } else { [0; SINKS] };
        let start = Start { total: rest[0], energy: rest[1], mass: rest[2] };
        self.start = (!start.total.is_nan()).then_some(start);
        self.lowest = rest[3];
        self.worst = Worst { share: rest[4], time: rest[5] };
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::energy::Sink;
    use sph_decomp::{Solo, ThreadRanks};

    const SCALE: EnergyScale = EnergyScale { joules: 1e-15 };

    fn budget(kinetic: f64, potential: f64) -> Budget<2> {
        Budget {
            kinetic,
            potential,
            elastic: 0.0,
            momentum: [0.0; 2],
            mass: 2.0,
            compression: 0.0,
            speed: 0.0,
            lowest: 5.0,
        }
    }

    fn step(before: f64, after: f64) -> Taken {
        let mut taken = Taken::new(SCALE);
        taken.add(Sink::Viscosity, [before, after]);
        taken
    }

    #[test]
    fn what_was_taken_is_no_residual_and_what_is_missing_is() {
        let mut log = EnergyLog::new(SCALE);
        log.record(&step(0.5, 0.25));
        assert_eq!(log.row(&Solo, 0.0, &budget(1.0, 12.0)).unwrap().residual, 0.0);
        log.record(&step(0.5, 7.0));
        let row = log.row(&Solo, 1.0, &budget(2.0, 10.2)).unwrap();
        // 13 J and the half taken before; the 7 J after the step are not in the row.
        assert!((row.taken[Sink::Viscosity as usize] - 1.25).abs() < 1e-12);
        assert!((row.residual + 0.05).abs() < 1e-12, "{row:?}");
        // Of the 12 J of potential energy 10 lie below the lowest place.
        assert!((row.share + 0.05 / 3.0).abs() < 1e-12);
        assert_eq!(log.worst(), Worst { share: row.share, time: 1.0 });
    }

    #[test]
    fn ranks_and_restarts_do_not_matter() {
        let run = |ranks: usize, restart: bool| {
            let results = ThreadRanks::run(ranks, |comm| {
                let mut log = EnergyLog::new(SCALE);
                for k in 0..40_i32 {
                    let mine = k as usize % comm.size() == comm.rank();
                    let share = 0.1 * f64::from(k);
                    log.record(&if mine { step(share, 0.3) } else { step(0.0, 0.0) });
                    if k == 3 {
                        log.row(&comm, 0.1, &budget(9.0, 11.0))?;
                    }
                    if restart && k == 25 {
                        let saved = log.save(&comm)?;
                        log = EnergyLog::new(SCALE);
                        assert!(log.restore(&saved, comm.rank() == 0));
                    }
                }
                Ok::<_, RunError>((log.row(&comm, 1.0, &budget(4.0, 11.0))?, log.worst()))
            });
            results.unwrap().swap_remove(0)
        };
        let alone = run(1, false);
        assert_eq!(run(3, false), alone);
        assert_eq!(run(2, true), alone);
        assert!(!EnergyLog::new(SCALE).restore(&[], true));
    }
}
