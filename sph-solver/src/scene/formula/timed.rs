//! Formulas that also know the time.

use super::{Formula, FormulaError, FormulaVisitor, functions};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Deserialize, Deserializer};
use serde::{Serialize, Serializer};
use std::borrow::Cow;

/// A formula in the coordinates x, y, z (m), the time t (s) and `start`, the first value of the
/// column that it is compared with.
#[derive(Debug, Clone, PartialEq)]
pub struct TimedFormula(Formula);

/// Names of the variables, in order.
const VARIABLES: [&str; 5] = ["x", "y", "z", "t", "start"];
const START: usize = 4;

impl TimedFormula {
    /// Reads a formula. Mistakes show in the checks.
    pub fn new(text: &str) -> Self {
        Self(Formula::of(text, &VARIABLES))
    }

    /// The text.
    pub fn text(&self) -> &str {
        self.0.text()
    }

    /// What is wrong with a field over the particles of a scene of so many dimensions, if anything.
    ///
    /// # Errors
    ///
    /// A formula that cannot be read, uses z in two dimensions, or `start`.
    pub fn check_field(&self, dimension: usize) -> Result<(), FormulaError> {
        self.0.check(dimension)?;
        match &self.0.parsed {
            Ok(program) if program.uses(START) => Err(FormulaError {
                reason: "it uses `start`, which only a column of a table has".into(),
                help: "use x, y, z and t".into(),
            }),
            _ => Ok(()),
        }
    }

    /// What is wrong with a formula for a column of a table, if anything.
    ///
    /// # Errors
    ///
    /// A formula that cannot be read or uses coordinates.
    pub fn check_column(&self) -> Result<(), FormulaError> {
        self.0.check(3)?;
        match &self.0.parsed {
            Ok(program) if (0..3).any(|axis| program.uses(axis)) => Err(FormulaError {
                reason: "it uses coordinates, which a column of a table does not have".into(),
                help: "use t, the time in seconds, and start, the first value of the column".into(),
            }),
            _ => Ok(()),
        }
    }

    /// What is wrong with a function of time alone, if anything.
    ///
    /// # Errors
    ///
    /// A formula that cannot be read or uses anything but t.
    pub fn check_of_time(&self) -> Result<(), FormulaError> {
        let program = self.0.parsed.as_ref().map_err(Clone::clone)?;
        let used = VARIABLES.iter().zip(0..).find(|(name, at)| **name != "t" && program.uses(*at));
        match used {
            Some((name, _)) => Err(FormulaError {
                reason: format!("it uses {name}, but it is a function of time"),
                help: "use t, in seconds".into(),
            }),
            None => Ok(()),
        }
    }

    /// The value of a function of time alone at a time (s).
    pub fn at_time(&self, time: f64) -> f64 {
        self.of_column(time, f64::NAN)
    }

    /// The value at a point (m) and a time (s).
    pub fn at<const D: usize>(&self, x: &[f64; D], time: f64) -> f64 {
        let coordinate = |axis: usize| x.get(axis).copied().unwrap_or(0.0);
        self.0.evaluate(&[coordinate(0), coordinate(1), coordinate(2), time, f64::NAN])
    }

    /// The value at a time (s), of a column that begins with `start`.
    pub fn of_column(&self, time: f64, start: f64) -> f64 {
        self.0.evaluate(&[f64::NAN, f64::NAN, f64::NAN, time, start])
    }
}

impl Default for TimedFormula {
    fn default() -> Self {
        Self::new("0")
    }
}

impl Serialize for TimedFormula {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for TimedFormula {
    fn deserialize<R: Deserializer<'de>>(reader: R) -> Result<Self, R::Error> {
        let formula = reader.deserialize_any(FormulaVisitor)?;
        Ok(Self::new(formula.text()))
    }
}

impl JsonSchema for TimedFormula {
    fn schema_name() -> Cow<'static, str> {
        "TimedFormula".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": format!(
                "A formula in x, y, z (m) and t (s), or in t and start, with + - * / ^, \
                 parentheses, pi, e and {}",
                functions()
            ),
            "type": ["string", "number"],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn knows_place_and_time() {
        let formula = TimedFormula::new("x + 10*y + 100*t");
        formula.check_field(2).unwrap();
        assert_eq!(formula.at(&[1.0, 2.0], 3.0), 321.0);
        assert!(formula.check_column().unwrap_err().reason.contains("coordinates"));
    }

    #[test]
    fn a_column_has_a_start() {
        let formula = TimedFormula::new("start*exp(-t)");
        formula.check_column().unwrap();
        assert_eq!(formula.of_column(0.0, 7.0), 7.0);
        assert!(formula.check_field(3).unwrap_err().reason.contains("start"));
        assert!(TimedFormula::new("z*t").check_field(2).is_err());
        assert!(TimedFormula::new("2*s").check_column().unwrap_err().help.contains("start"));
    }
}
