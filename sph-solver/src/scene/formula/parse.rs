//! Recursive descent over the grammar
//!
//! ```text
//! sum     = product { ("+" | "-") product }
//! product = signed { ("*" | "/") signed }
//! signed  = { "+" | "-" } power
//! power   = atom [ "^" signed ]
//! atom    = number | name | function "(" sum { "," sum } ")" | "(" sum ")"
//! ```

use super::super::suggest;
use super::{BINARY, CONSTANTS, Program, Step, UNARY};

/// Why a formula cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{reason}")]
pub struct FormulaError {
    /// What is wrong.
    pub reason: String,
    /// What to do.
    pub help: String,
}

/// Parentheses and exponents within each other; more would exhaust the call stack.
const DEEPEST: usize = 100;
/// Bytes of a formula: it is evaluated once per particle.
const LONGEST: usize = 4096;

/// Reads a formula in variables with these names.
pub(super) fn parse(text: &str, variables: &[&'static str]) -> Result<Program, FormulaError> {
    if text.len() > LONGEST {
        let reason = format!("it has {} characters, more than {LONGEST}", text.chars().count());
        return Err(error(reason, "simplify it, or divide the region into several"));
    }
    let program = Program::default();
    let mut parser = Parser { text, variables, at: 0, nesting: 0, waiting: 0, program };
    if parser.peek().is_none() {
        return Err(error("it is empty", "write 0 for nothing"));
    }
    parser.sum()?;
    if let Some(next) = parser.peek() {
        let reason = parser.place(&format!("`{next}` after a complete expression"));
        return Err(error(reason, "multiplication needs a sign: 2*x, not 2x"));
    }
    Ok(parser.program)
}

struct Parser<'a> {
    text: &'a str,
    /// Names of the variables.
    variables: &'a [&'static str],
    /// Next byte.
    at: usize,
    nesting: usize,
    /// Values on the stack of the evaluation at this point.
    waiting: usize,
    program: Program,
}

fn error(reason: impl Into<String>, help: impl Into<String>) -> FormulaError {
    FormulaError { reason: reason.into(), help: help.into() }
}

impl<'a> Parser<'a> {
    fn rest(&self) -> &'a str {
        self.text.get(self.at..).unwrap_or("")
    }

    /// Skips white space and looks at the next character.
    fn peek(&mut self) -> Option<char> {
        let rest = self.rest();
        self.at += rest.len() - rest.trim_start().len();
        self.rest().chars().next()
    }

    fn take(&mut self, wanted: char) -> bool {
        let found = self.peek() == Some(wanted);
        if found {
            self.at += wanted.len_utf8();
        }
        found
    }

    fn place(&self, what: &str) -> String {
        let character = 1 + self.text[..self.at].chars().count();
        format!("{what} (character {character})")
    }

    fn emit(&mut self, step: Step) {
        match step {
            Step::Number(_) | Step::Variable(_) => self.waiting += 1,
            Step::Unary(_) => {}
            Step::Binary(_) => self.waiting = self.waiting.saturating_sub(1),
        }
        self.program.depth = self.program.depth.max(self.waiting);
        self.program.steps.push(step);
    }

    fn deeper<T>(
        &mut self,
        inner: impl FnOnce(&mut Self) -> Result<T, FormulaError>,
    ) -> Result<T, FormulaError> {
        if self.nesting == DEEPEST {
            return Err(error("it is nested too deeply", "split it up or simplify it"));
        }
        self.nesting += 1;
        let result = inner(self);
        self.nesting -= 1;
        result
    }

    fn sum(&mut self) -> Result<(), FormulaError> {
        self.product()?;
        loop {
            if self.take('+') {
                self.product()?;
                self.emit(Step::Binary(|a, b| a + b));
            } else if self.take('-') {
                self.product()?;
                self.emit(Step::Binary(|a, b| a - b));
            } else {
                return Ok(());
            }
        }
    }

    fn product(&mut self) -> Result<(), FormulaError> {
        self.signed()?;
        loop {
            if self.take('*') {
                self.signed()?;
                self.emit(Step::Binary(|a, b| a * b));
            } else if self.take('/') {
                self.signed()?;
                self.emit(Step::Binary(|a, b| a / b));
            } else {
                return Ok(());
            }
        }
    }

    fn signed(&mut self) -> Result<(), FormulaError> {
        if self.take('-') {
            self.deeper(Self::signed)?;
            self.emit(Step::Unary(|a| -a));
            Ok(())
        } else if self.take('+') {
            self.deeper(Self::signed)
        } else {
            self.power()
        }
    }

    fn power(&mut self) -> Result<(), FormulaError> {
        self.atom()?;
        if self.take('^') {
            self.deeper(Self::signed)?;
            self.emit(Step::Binary(f64::powf));
        }
        Ok(())
    }

    fn atom(&mut self) -> Result<(), FormulaError> {
        match self.peek() {
            None => Err(error(
                "it ends where a value should follow",
                "complete it, for example 2*x + 1",
            )),
            Some('(') => {
                self.take('(');
                self.deeper(Self::sum)?;
                self.close()
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_alphabetic() || c == '_' => self.name(),
            Some(c) => Err(error(
                self.place(&format!("`{c}` where a value should be")),
                "a value is a number, a name such as x or pi, a function such as sin(x), or (…)",
            )),
        }
    }

    fn close(&mut self) -> Result<(), FormulaError> {
        match self.peek() {
            Some(')') => {
                self.take(')');
                Ok(())
            }
            None => Err(error("a parenthesis is not closed", "add `)`")),
            Some(c) => Err(error(
                self.place(&format!("`{c}` where `)` or an operator should be")),
                "multiplication needs a sign: 2*x, not 2x",
            )),
        }
    }

    fn number(&mut self) -> Result<(), FormulaError> {
        let rest = self.rest();
        let digits = |from: usize| {
            rest[from..].find(|c: char| !c.is_ascii_digit()).map_or(rest.len(), |n| from + n)
        };
        let mut end = digits(0);
        if rest[end..].starts_with('.') {
            end = digits(end + 1);
        }
        // An `e` belongs to the number only when digits follow.
        if rest[end..].starts_with(['e', 'E']) {
            let sign = usize::from(rest[end + 1..].starts_with(['+', '-']));
            let exponent = digits(end + 1 + sign);
            if exponent > end + 1 + sign {
                end = exponent;
            }
        }
        let number: f64 = rest[..end].parse().map_err(|_| {
            error(
                self.place(&format!("`{}` is no number", &rest[..end])),
                "numbers are written like 12, 0.5 or 1e-3",
            )
        })?;
        self.at += end;
        self.emit(Step::Number(number));
        Ok(())
    }

    fn name(&mut self) -> Result<(), FormulaError> {
        let rest = self.rest();
        let inside = |c: char| c.is_alphanumeric() || c == '_';
        let name = &rest[..rest.find(|c| !inside(c)).unwrap_or(rest.len())];
        self.at += name.len();
        if let Some((_, f)) = UNARY.iter().find(|(known, _)| *known == name) {
            let count = self.arguments(name, |_| {})?;
            if count != 1 {
                return Err(error(
                    format!("`{name}` needs 1 argument, found {count}"),
                    format!("write {name}(x)"),
                ));
            }
            self.emit(Step::Unary(*f));
            Ok(())
        } else if let Some((_, f)) = BINARY.iter().find(|(known, _)| *known == name) {
            let count = self.arguments(name, |parser| parser.emit(Step::Binary(*f)))?;
            if count < 2 {
                let reason = format!("`{name}` needs 2 arguments or more, found {count}");
                return Err(error(reason, format!("write {name}(x, y)")));
            }
            if name == "atan2" && count > 2 {
                let reason = format!("`{name}` needs 2 arguments, found {count}");
                return Err(error(reason, "write atan2(y, x)"));
            }
            Ok(())
        } else if let Some(axis) = self.variables.iter().position(|known| *known == name) {
            self.emit(Step::Variable(axis));
            Ok(())
        } else if let Some((_, number)) = CONSTANTS.iter().find(|(known, _)| *known == name) {
            self.emit(Step::Number(*number));
            Ok(())
        } else {
            Err(self.unknown(name))
        }
    }

    /// Reads `(a, b, …)` and calls `combine` after each argument but the first.
    fn arguments(
        &mut self,
        name: &str,
        combine: impl Fn(&mut Self),
    ) -> Result<usize, FormulaError> {
        if !self.take('(') {
            let reason = format!("`{name}` needs its argument in parentheses");
            return Err(error(reason, format!("write {name}(…)")));
        }
        self.deeper(Self::sum)?;
        let mut count = 1;
        while self.take(',') {
            self.deeper(Self::sum)?;
            combine(self);
            count += 1;
        }
        self.close()?;
        Ok(count)
    }

    fn unknown(&mut self, name: &str) -> FormulaError {
        let functions = UNARY.iter().map(|f| f.0).chain(BINARY.iter().map(|f| f.0));
        if self.peek() == Some('(') {
            let valid: Vec<_> = functions.map(String::from).collect();
            let help = suggest::help(name, &valid, "functions");
            error(format!("unknown function `{name}`"), help)
        } else {
            let constants = CONSTANTS.iter().map(|constant| constant.0);
            let variables = self.variables.iter().copied();
            let valid: Vec<_> = variables.chain(constants).map(String::from).collect();
            let help = suggest::help(name, &valid, "variables and constants");
            error(format!("unknown name `{name}`"), help)
        }
    }
}
