//! Formulas of scene files: `-exp(-((x - 0.5)^2 + y^2)/0.02)`.
//!
//! The usual precedence of mathematics holds: `-x^2` is −(x²), `2^3^2` is 2^(3²), and numbers may be
//! written as `1e-3`. A formula is checked when the scene is read, so that evaluation cannot fail; it
//! may give NaN, as 1/x does at 0.
//!
//! There is a parser here because the published ones that were tried read `-x^2` as (−x)², which
//! would turn a Gaussian pulse into an explosion without a word.

mod parse;
mod timed;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Deserialize, Deserializer, Visitor};
use serde::{Serialize, Serializer};
use std::borrow::Cow;
use std::f64::consts::{E, PI};

pub use parse::FormulaError;
pub use timed::TimedFormula;

/// A formula in the coordinates x, y, z (m).
#[derive(Debug, Clone)]
pub struct Formula {
    text: String,
    parsed: Result<Program, FormulaError>,
}

/// Instructions in postfix order and the largest number of values that wait at once.
#[derive(Debug, Clone, Default)]
struct Program {
    steps: Vec<Step>,
    depth: usize,
}

impl Program {
    fn uses(&self, variable: usize) -> bool {
        self.steps.iter().any(|step| matches!(step, Step::Variable(used) if *used == variable))
    }
}

#[derive(Debug, Clone, Copy)]
enum Step {
    Number(f64),
    Variable(usize),
    Unary(fn(f64) -> f64),
    Binary(fn(f64, f64) -> f64),
}

/// Names of the variables, in order.
const VARIABLES: [&str; 3] = ["x", "y", "z"];

const CONSTANTS: [(&str, f64); 2] = [("pi", PI), ("e", E)];

/// A function of one number, by name.
type NamedUnary = (&'static str, fn(f64) -> f64);

/// A function of two numbers, by name.
type NamedBinary = (&'static str, fn(f64, f64) -> f64);

const UNARY: [NamedUnary; 20] = [
    ("abs", f64::abs),
    ("sign", |a| if a == 0.0 { 0.0 } else { a.signum() }),
    ("sqrt", f64::sqrt),
    ("cbrt", f64::cbrt),
    ("exp", f64::exp),
    ("ln", f64::ln),
    ("log10", f64::log10),
    ("sin", f64::sin),
    ("cos", f64::cos),
    ("tan", f64::tan),
    ("asin", f64::asin),
    ("acos", f64::acos),
    ("atan", f64::atan),
    ("sinh", f64::sinh),
    ("cosh", f64::cosh),
    ("tanh", f64::tanh),
    ("floor", f64::floor),
    ("ceil", f64::ceil),
    ("round", f64::round),
    ("step", |a| if a < 0.0 { 0.0 } else { 1.0 }),
];

const BINARY: [NamedBinary; 3] = [("min", f64::min), ("max", f64::max), ("atan2", f64::atan2)];

impl Formula {
    /// Reads a formula. Mistakes show in [`check`](Self::check).
    pub fn new(text: &str) -> Self {
        Self::of(text, &VARIABLES)
    }

    /// A formula in variables with these names.
    fn of(text: &str, variables: &[&'static str]) -> Self {
        Self { text: text.into(), parsed: parse::parse(text, variables) }
    }

    /// The text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// What is wrong with the formula in a scene of so many dimensions, if anything.
    pub fn check(&self, dimension: usize) -> Result<(), FormulaError> {
        let program = self.parsed.as_ref().map_err(Clone::clone)?;
        if dimension < 3 && program.uses(2) {
            return Err(FormulaError {
                reason: "it uses z, but the scene has dimension = 2".into(),
                help: "use x and y".into(),
            });
        }
        Ok(())
    }

    /// Whether the formula is the plain number 0.
    pub fn is_zero(&self) -> bool {
        matches!(&self.parsed, Ok(program) if matches!(program.steps[..], [Step::Number(0.0)]))
    }

    /// The value at a point. NaN where the formula is undefined or could not be read.
    pub fn at<const D: usize>(&self, x: &[f64; D]) -> f64 {
        self.evaluate(x)
    }

    /// The value for these values of the variables.
    fn evaluate(&self, variables: &[f64]) -> f64 {
        let Ok(program) = &self.parsed else { return f64::NAN };
        let mut stack = Vec::with_capacity(program.depth);
        for step in &program.steps {
            let value = match *step {
                Step::Number(number) => Some(number),
                Step::Variable(number) => variables.get(number).copied(),
                Step::Unary(f) => stack.pop().map(f),
                Step::Binary(f) => {
                    let right = stack.pop();
                    let left = stack.pop();
                    left.zip(right).map(|(left, right)| f(left, right))
                }
            };
            stack.push(value.unwrap_or(f64::NAN));
        }
        stack.pop().unwrap_or(f64::NAN)
    }
}

impl PartialEq for Formula {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text
    }
}

impl Default for Formula {
    fn default() -> Self {
        Self::new("0")
    }
}

impl<'de> Deserialize<'de> for Formula {
    fn deserialize<R: Deserializer<'de>>(reader: R) -> Result<Self, R::Error> {
        reader.deserialize_any(FormulaVisitor)
    }
}

struct FormulaVisitor;

impl Visitor<'_> for FormulaVisitor {
    type Value = Formula;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a formula in quotes or a number")
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Formula, E> {
        Ok(Formula::new(text))
    }

    fn visit_i64<E: serde::de::Error>(self, number: i64) -> Result<Formula, E> {
        Ok(Formula::new(&number.to_string()))
    }

    fn visit_f64<E: serde::de::Error>(self, number: f64) -> Result<Formula, E> {
        Ok(Formula::new(&number.to_string()))
    }
}

impl Serialize for Formula {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.text)
    }
}

impl JsonSchema for Formula {
    fn schema_name() -> Cow<'static, str> {
        "Formula".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let functions = functions();
        json_schema!({
            "description": format!(
                "A formula in x, y, z (m) with + - * / ^, parentheses, pi, e and {functions}"
            ),
            "type": ["string", "number"],
        })
    }
}

/// Names of all functions, for descriptions.
fn functions() -> String {
    let names = UNARY.iter().map(|f| f.0).chain(BINARY.iter().map(|f| f.0));
    names.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn value(text: &str) -> f64 {
        let formula = Formula::new(text);
        formula.check(3).unwrap();
        formula.at(&[3.0, 0.5, -2.0])
    }

    #[test]
    fn follows_the_precedence_of_mathematics() {
        for (text, expected) in [
            ("-x^2", -9.0),
            ("2-x^2", -7.0),
            ("2^x^2", 512.0),
            ("x^-1", 1.0 / 3.0),
            ("-2^-2", -0.25),
            ("x - -2", 5.0),
            ("6/x*2", 4.0),
            ("8 - 2 - 1", 5.0),
            ("-x*z", 6.0),
            ("1/-x^2", -1.0 / 9.0),
        ] {
            assert_eq!(value(text), expected, "{text}");
        }
    }

    #[test]
    fn knows_numbers_constants_and_functions() {
        for (text, expected) in [
            ("1e-3", 1e-3),
            (".5E+2*y", 25.0),
            ("2.", 2.0),
            ("e", E),
            ("2e", f64::NAN),
            ("min(sin(0) + 1, max(x, y))", 1.0),
            ("max(1, 2, x, 0)", 3.0),
            ("atan2(1, 1)", PI / 4.0),
            ("step(x) + step(-x) + sign(z)", 0.0),
            ("-exp(-((x - 3)^2 + (y-0.5)^2)/0.02) * cos(2*pi*x)", -1.0),
        ] {
            if expected.is_nan() {
                assert!(Formula::new(text).check(3).is_err(), "{text}");
            } else {
                assert_eq!(value(text), expected, "{text}");
            }
        }
    }

    #[test]
    fn says_what_is_wrong() {
        for (text, reason, help) in [
            ("", "it is empty", "0"),
            ("2*siin(x)", "unknown function `siin`", "did you mean `sin`?"),
            ("2*t", "unknown name `t`", "`x`, `y`, `z`"),
            ("2x", "`x` after a complete expression (character 2)", "2*x"),
            ("(x + 1", "a parenthesis is not closed", ")"),
            ("x + ", "it ends where a value should follow", ""),
            ("x + * 2", "`*` where a value should be (character 5)", ""),
            ("min(x)", "`min` needs 2 arguments or more, found 1", ""),
            ("sqrt(x, y)", "`sqrt` needs 1 argument, found 2", ""),
            ("sin x", "`sin` needs its argument in parentheses", "sin("),
            ("x § 2", "`§`", ""),
        ] {
            let error = Formula::new(text).check(3).unwrap_err();
            assert!(error.reason.contains(reason), "{text}: {error:?}");
            assert!(error.help.contains(help), "{text}: {error:?}");
        }
        assert!(Formula::new("z").check(2).unwrap_err().reason.contains("dimension = 2"));
    }

    #[test]
    fn endless_nesting_is_refused() {
        for text in ["(".repeat(4000), "-".repeat(4000), "sin(".repeat(1000)] {
            assert!(Formula::new(&text).check(3).unwrap_err().reason.contains("nested"));
        }
        assert!(Formula::new(&"2^".repeat(2000)).check(3).is_err());
    }

    #[test]
    fn endless_formulas_are_refused() {
        let sum = |terms: usize| format!("1{}", "+x".repeat(terms));
        Formula::new(&sum(2000)).check(3).unwrap();
        let error = Formula::new(&sum(100_000)).check(3).unwrap_err();
        assert!(error.reason.contains("200001 characters, more than 4096"), "{error:?}");
    }

    proptest! {
        #[test]
        fn garbage_never_panics(text in "\\PC{0,40}") {
            let formula = Formula::new(&text);
            let _ = formula.check(2);
            let _ = formula.at(&[1.0, 2.0]);
        }

        #[test]
        fn token_soup_never_panics(
            tokens in proptest::collection::vec(
                proptest::sample::select(vec![
                    "x", "1", "e", "+", "-", "^", "*", "(", ")", ",", "min", "sin", "2.5e", " ",
                ]),
                0..30,
            ),
        ) {
            let formula = Formula::new(&tokens.concat());
            if formula.check(3).is_ok() {
                let _ = formula.at(&[1.0, 2.0, 3.0]);
            }
        }
    }
}
