//! Loads on solids: force and moment as the exact reaction of what the fluid feels.
//!
//! Every particle that a wall pushes pushes back with −m a. These parts are added up as whole numbers
//! of a tiny quantum, so that their sum is the same on any number of ranks and threads, and momentum
//! that the fluid gains is momentum that the solids lose, to the last bit of the quantum.

use crate::bodies::in_space;
use crate::model::Model;
use sph_decomp::{CommError, Communicator};

/// Parts of a load: what the pressure does and what the friction does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Along the normal of the wall.
    Pressure,
    /// Along the wall.
    Friction,
}

/// Numbers of a load: force and moment, three components each, of both parts.
pub const NUMBERS: usize = 12;

/// A load in whole quanta: force (3) and moment (3) by pressure, then by friction.
pub type Quanta = [i128; NUMBERS];

/// Sizes of the quanta.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadScale {
    /// Newtons per quantum of force.
    pub force: f64,
    /// Newton metres per quantum of moment.
    pub moment: f64,
}

impl LoadScale {
    /// For particles of a mass (kg) with this spacing (m) and sound speed (m/s): a quantum is 2⁻⁴⁴ of
    /// the force that stops such a particle from the speed of sound within a spacing. A single
    /// particle may push 2¹⁹ times as hard.
    pub fn new(mass: f64, spacing: f64, sound_speed: f64) -> Self {
        let quantum = 2.0_f64.powi(-44);
        let force = quantum * mass * sound_speed * sound_speed / spacing;
        Self { force, moment: force * spacing }
    }

    /// For a run of this model.
    pub fn of_model<const D: usize>(model: &Model<D>) -> Self {
        let mass = model.equation_of_state.density0() * model.spacing.powi(D as i32);
        Self::new(mass, model.spacing, model.limits.sound_speed)
    }

    /// A load in N and N m, from its quanta.
    pub fn in_newtons(&self, quanta: &Quanta) -> [f64; NUMBERS] {
        std::array::from_fn(|k| quanta[k] as f64 * if k % 6 < 3 { self.force } else { self.moment })
    }
}

/// Words of a number on its way between ranks: 32 bits in each, so that those of many ranks add up without
/// overflow.
const WORDS: usize = 4;

/// The sums over all ranks of whole numbers that each rank has a part of, in the same order. Collective.
///
/// # Errors
///
/// When communication fails.
pub fn on_all_ranks<const N: usize>(
    comm: &dyn Communicator,
    parts: impl IntoIterator<Item = [i128; N]>,
) -> Result<Vec<[i128; N]>, CommError> {
    let mut words: Vec<u64> = parts.into_iter().flat_map(apart).collect();
    comm.sum_u64(&mut words)?;
    Ok(words.chunks_exact(WORDS * N).map(together).collect())
}

/// The words of some numbers.
pub fn apart<const N: usize>(quanta: [i128; N]) -> impl Iterator<Item = u64> {
    quanta
        .into_iter()
        .flat_map(|number| (0..4).map(move |k| (number as u128 >> (32 * k)) as u64 & 0xffff_ffff))
}

/// The numbers again, or the sums of those whose words were summed.
pub fn together<const N: usize>(words: &[u64]) -> [i128; N] {
    let number = |words: &[u64]| {
        let word = |k: usize| u128::from(words[k]) << (32 * k);
        (0..4).map(word).fold(0_u128, u128::wrapping_add) as i128
    };
    std::array::from_fn(|k| number(&words[WORDS * k..][..WORDS]))
}

/// Loads on solids, by the number of the solid in the scene; solids without a load may be missing.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Loads {
    by_solid: Vec<(u16, Quanta)>,
}

impl Loads {
    /// No loads.
    pub const NONE: Self = Self { by_solid: Vec::new() };

    /// The load on a solid.
    pub fn of(&self, solid: u16) -> Quanta {
        let found = self.by_solid.binary_search_by_key(&solid, |(solid, _)| *solid);
        found.map_or([0; NUMBERS], |k| self.by_solid[k].1)
    }

    /// Adds a force (N) and its moment (N m, about x, y and z) to the load on a solid.
    pub fn add<const D: usize>(
        &mut self,
        solid: u16,
        part: Part,
        force: [f64; D],
        moment: [f64; 3],
        scale: &LoadScale,
    ) {
        let quanta = self.entry(solid);
        let first = if part == Part::Pressure { 0 } else { 6 };
        for k in 0..D {
            quanta[first + k] += whole(force[k] / scale.force);
        }
        let axes = if D == 2 { 2..3 } else { 0..3 };
        for k in axes {
            quanta[first + 3 + k] += whole(moment[k] / scale.moment);
        }
    }

    /// Loads of both sets of particles.
    #[must_use]
    pub fn plus(mut self, other: Self) -> Self {
        if self.by_solid.is_empty() {
            return other;
        }
        for (solid, more) in other.by_solid {
            let quanta = self.entry(solid);
            for (sum, part) in quanta.iter_mut().zip(more) {
                *sum = sum.wrapping_add(part);
            }
        }
        self
    }

    fn entry(&mut self, solid: u16) -> &mut Quanta {
        let k = match self.by_solid.binary_search_by_key(&solid, |(solid, _)| *solid) {
            Ok(k) => k,
            Err(k) => {
                self.by_solid.insert(k, (solid, [0; NUMBERS]));
                k
            }
        };
        &mut self.by_solid[k].1
    }
}

/// The moment (N m) about x, y and z of a force (N) at `arm` (m).
pub fn moment<const D: usize>(arm: &[f64; D], force: &[f64; D]) -> [f64; 3] {
    in_space(arm).cross(&in_space(force)).into()
}

/// The nearest whole number. What is out of range has diverged, which the watch for faults reports.
pub fn whole(x: f64) -> i128 {
    // Much faster than `round` and a cast to 128 bits.
    i128::from((x + 0.5_f64.copysign(x)) as i64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SCALE: LoadScale = LoadScale { force: 1e-15, moment: 1e-16 };

    proptest! {
        #[test]
        fn numbers_survive_the_sum_over_ranks(a in any::<i64>(), b in any::<i64>()) {
            let (a, b) = (i128::from(a) << 40, i128::from(b) << 40);
            let words = |number: i128| apart([number; NUMBERS]).collect::<Vec<_>>();
            let sum: Vec<u64> = words(a).iter().zip(words(b)).map(|(x, y)| x + y).collect();
            prop_assert_eq!(together(&sum), [a + b; NUMBERS]);
        }
    }

    #[test]
    fn moments_follow_the_right_hand() {
        let mut loads = Loads::NONE;
        loads.add(3, Part::Friction, [0.0, 2.0], moment(&[0.5, 0.0], &[0.0, 2.0]), &SCALE);
        let load = SCALE.in_newtons(&loads.of(3));
        assert!((load[7] - 2.0).abs() < 1e-12 && (load[11] - 1.0).abs() < 1e-12, "{load:?}");
        assert_eq!(load[..6], [0.0; 6]);
        assert_eq!(loads.of(2), [0; NUMBERS]);
    }

    proptest! {
        #[test]
        fn sums_do_not_depend_on_order(
            forces in prop::collection::vec((0_u16..3, prop::array::uniform3(-1e5..1e5)), 1..40),
            cut in 0_usize..40,
        ) {
            let sum = |some: &[(u16, [f64; 3])]| {
                let mut loads = Loads::NONE;
                for (solid, f) in some {
                    loads.add(*solid, Part::Pressure, *f, moment(&[f[1], f[2], 0.1], f), &SCALE);
                }
                loads
            };
            let cut = cut.min(forces.len());
            let parts = sum(&forces[cut..]).plus(sum(&forces[..cut]));
            prop_assert_eq!(parts, sum(&forces));
        }
    }
}
