//! A study as text for the terminal.

use super::cost::{Cost, CostAt};
use super::outcome::Outcome;
use super::report::Report;
use std::fmt::Write;

/// A table of all points, orders of convergence and costs.
pub fn summary(report: &Report) -> String {
    let mut text = format!("{}: {}\n", report.scene, report.title);
    let width = report.curves.iter().map(|curve| curve.label.chars().count()).max().unwrap_or(0);
    let _ = writeln!(
        text,
        "{:width$}  {:>10} {:>10} {:>10}  {:<21} {:>9}  runs",
        "", "spacing", "particles", "error", "spread", "core-s"
    );
    for curve in &report.curves {
        for (number, point) in curve.points.iter().enumerate() {
            let label = if number == 0 { curve.label.as_str() } else { "" };
            let spread = match point.error_range {
                Some((low, high)) if point.runs.0 > 1 => format!("{low:.3e}..{high:.3e}"),
                _ => String::new(),
            };
            let error = point.error.map_or("-".into(), |error| format!("{error:.3e}"));
            let cost = point.core_seconds.map_or("-".into(), |cost| format!("{cost:.2}"));
            let particles = point.particles.map_or("-".into(), |count| count.to_string());
            let front = if point.on_front { " *" } else { "" };
            let runs = match point.runs {
                (done, all) if done == all => String::from("ok"),
                (done, all) => format!("{done} of {all}"),
            };
            let _ = writeln!(
                text,
                "{label:width$}  {:>10} {particles:>10} {error:>10}  {spread:<21} {cost:>9}  \
                 {runs}{front}",
                point.spacing
            );
        }
        let order = |order: Option<f64>| order.map_or("-".into(), |order| format!("{order:.2}"));
        let costs: Vec<String> = curve.costs.iter().map(cost).collect();
        let _ = writeln!(
            text,
            "{:width$}  order {} (last two spacings {}); {}",
            "",
            order(curve.order),
            order(curve.last_order),
            costs.join("; ")
        );
    }
    for row in &report.rows {
        if let (Some(remark), false) = (&row.remark, row.error.is_some()) {
            let what = match row.outcome {
                Outcome::Finished => "no error",
                Outcome::Diverged { .. } => "diverged",
                Outcome::OutOfTime => "out of time",
            };
            let _ = writeln!(text, "{}: {what}: {remark}", row.name);
        }
    }
    text + "* no other point is both better and cheaper\n"
}

/// The cost of an error in words.
pub fn cost(at: &CostAt) -> String {
    let error = at.error;
    let spread = match at.range {
        Some((low, high)) if at.seeds.1 > 1 => {
            format!(" ({low:.2}..{high:.2}, {} of {} seeds)", at.seeds.0, at.seeds.1)
        }
        _ => String::new(),
    };
    match at.cost {
        Cost::Yes(seconds) => format!("error {error} costs {seconds:.2} core-s{spread}"),
        Cost::AtMost(seconds) => {
            format!("error {error} costs less than {seconds:.2} core-s{spread}")
        }
        Cost::No => format!("error {error} is not reached{spread}"),
    }
}
