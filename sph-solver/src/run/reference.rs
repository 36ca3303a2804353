//! Errors of the fluid against a reference that is a formula of place and time. The same bits on any
//! ranks.

use crate::error::RunError;
use crate::model::Model;
use crate::scene::{Reference, TimedFormula};
use crate::simulation::FullStep;
use sph_decomp::{Communicator, ExactSum, global_sums};

/// A field that is known everywhere.
#[derive(Debug, Clone, PartialEq)]
pub enum KnownField {
    /// Velocity, m/s, a formula per component. Its length is compared as well.
    Velocity(Vec<TimedFormula>),
    /// Pressure, Pa.
    Pressure(TimedFormula),
}

/// Formulas of a scene to compare the fluid with.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldReference {
    /// What is known.
    pub field: KnownField,
    /// What errors are divided by, m/s or Pa; the same norm of the reference when absent.
    pub scale: Option<f64>,
}

impl FieldReference {
    /// That of a scene, if its reference is a field.
    pub fn of(reference: &Reference) -> Option<Self> {
        let velocity = reference.velocity.as_ref().map(|formulas| {
            KnownField::Velocity(formulas.iter().map(|formula| formula.value.clone()).collect())
        });
        let pressure = || Some(KnownField::Pressure(reference.pressure.as_ref()?.value.clone()));
        let scale = reference.scale.map(|scale| *scale);
        Some(Self { field: velocity.or_else(pressure)?, scale })
    }

    /// Names and units of the errors, three norms of each quantity.
    pub fn columns(&self) -> Vec<(&'static str, &'static str)> {
        match self.field {
            KnownField::Velocity(_) => vec![
                ("velocity_l1", "1"),
                ("velocity_l2", "1"),
                ("velocity_max", "1"),
                ("speed_l1", "1"),
                ("speed_l2", "1"),
                ("speed_max", "1"),
            ],
            KnownField::Pressure(_) => {
                vec![("pressure_l1", "1"), ("pressure_l2", "1"), ("pressure_max", "1")]
            }
        }
    }

    /// Errors of the fluid in the order of the columns; NaN where the reference vanishes and there is no
    /// scale. Collective.
    pub fn errors<const D: usize>(
        &self,
        comm: &dyn Communicator,
        model: &Model<D>,
        full: &FullStep<D>,
    ) -> Result<Vec<f64>, RunError> {
        let mut norms = Vec::new();
        match &self.field {
            KnownField::Velocity(formulas) => {
                let mut both = [Norms::default(), Norms::default()];
                for (x, v) in full.position.iter().zip(&full.velocity) {
                    let exact: [f64; D] = std::array::from_fn(|k| formulas[k].at(x, full.time));
                    let off = std::array::from_fn(|k| v[k] - exact[k]);
                    let (speed, known) = (length(v), length(&exact));
                    both[0].add(length::<D>(&off), known);
                    both[1].add((speed - known).abs(), known);
                }
                norms.extend(both);
            }
            KnownField::Pressure(formula) => {
                let mut one = Norms::default();
                for (x, density) in full.position.iter().zip(&full.density) {
                    let exact = formula.at(x, full.time);
                    let off = model.equation_of_state.pressure(*density) - exact;
                    one.add(off.abs(), exact.abs());
                }
                norms.push(one);
            }
        }
        let count = full.id.len() as f64;
        let mut errors = Vec::new();
        for one in norms {
            errors.extend(one.errors(comm, count, self.scale)?);
        }
        Ok(errors)
    }
}

fn length<const D: usize>(v: &[f64; D]) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}

/// Sums and maxima of differences and of what they are relative to.
#[derive(Default)]
struct Norms {
    sums: [ExactSum; 4],
    largest: [f64; 2],
}

impl Norms {
    fn add(&mut self, difference: f64, known: f64) {
        let numbers = [difference, difference * difference, known, known * known];
        for (sum, number) in self.sums.iter_mut().zip(numbers) {
            sum.add(number);
        }
        self.largest = [self.largest[0].max(difference), self.largest[1].max(known)];
    }

    /// Mean, root of the mean square and maximum over all ranks. Collective.
    fn errors(
        &self,
        comm: &dyn Communicator,
        count: f64,
        scale: Option<f64>,
    ) -> Result<[f64; 3], RunError> {
        let mut sums = self.sums.to_vec();
        sums.push(ExactSum::from_iter([count]));
        let sums = global_sums(&comm, &sums)?;
        let mut largest = self.largest;
        comm.max_f64(&mut largest)?;
        let count = sums[4];
        let off = [sums[0] / count, (sums[1] / count).sqrt(), largest[0]];
        let known = [sums[2] / count, (sums[3] / count).sqrt(), largest[1]];
        Ok(std::array::from_fn(|k| {
            let unit = scale.unwrap_or(known[k]);
            if unit > 0.0 { off[k] / unit } else { f64::NAN }
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sph_decomp::Solo;

    #[test]
    fn norms_are_relative_to_those_of_the_reference() {
        let mut norms = Norms::default();
        norms.add(0.1, 1.0);
        norms.add(0.3, 3.0);
        let errors = norms.errors(&Solo, 2.0, None).unwrap();
        for (error, expected) in errors.iter().zip([0.1, 0.1, 0.1]) {
            assert!((error - expected).abs() < 1e-15, "{errors:?}");
        }
        let errors = norms.errors(&Solo, 2.0, Some(2.0)).unwrap();
        assert!((errors[0] - 0.1).abs() < 1e-15 && errors[2] == 0.15, "{errors:?}");
        let mut nothing = Norms::default();
        nothing.add(0.1, 0.0);
        assert!(nothing.errors(&Solo, 1.0, None).unwrap()[0].is_nan());
    }
}
