//! Runs that differ in spacing and seed only.

use super::cost::{CostAt, with_spread};
use super::measure::Figure;
use super::order;
use super::pareto;
use super::plan::Case;
use serde::Serialize;

/// The runs of one spacing, over all seeds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Point {
    /// Initial particle distance, m.
    pub spacing: f64,
    /// Fluid particles.
    pub particles: Option<u64>,
    /// Median of the errors.
    pub error: Option<f64>,
    /// Smallest and largest error.
    pub error_range: Option<(f64, f64)>,
    /// Median of the cost, core-seconds.
    pub core_seconds: Option<f64>,
    /// Runs with an error, and all of them.
    pub runs: (usize, usize),
    /// Whether no other point of the study is both better and cheaper.
    pub on_front: bool,
}

/// Errors over spacings of one scheme, kernel and so on.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Curve {
    /// What it is, in words; empty when nothing but the spacing is varied.
    pub label: String,
    /// Points from the coarsest spacing to the finest.
    pub points: Vec<Point>,
    /// Order of convergence over all spacings.
    pub order: Option<f64>,
    /// The same over the two finest.
    pub last_order: Option<f64>,
    /// What given errors cost.
    pub costs: Vec<CostAt>,
}

/// The curves of a study, in the order of its runs, with the cost of each of the errors `targets`.
pub fn curves(cases: &[Case], figures: &[Figure], targets: &[f64]) -> Vec<Curve> {
    let mut groups: Vec<(String, Vec<(&Case, &Figure)>)> = Vec::new();
    for run in cases.iter().zip(figures) {
        let label = run.0.label();
        match groups.iter_mut().find(|(other, _)| *other == label) {
            Some((_, runs)) => runs.push(run),
            None => groups.push((label, vec![run])),
        }
    }
    let mut curves: Vec<Curve> =
        groups.into_iter().map(|(label, runs)| curve(label, &runs, targets)).collect();
    let all = || curves.iter().flat_map(|curve| &curve.points);
    let number = |value: Option<f64>| value.unwrap_or(f64::NAN);
    let places: Vec<_> = all().map(|p| (number(p.error), number(p.core_seconds))).collect();
    let on_front = pareto::front(&places);
    let points = curves.iter_mut().flat_map(|curve| &mut curve.points);
    points.zip(on_front).for_each(|(point, on)| point.on_front = on);
    curves
}

fn curve(label: String, runs: &[(&Case, &Figure)], targets: &[f64]) -> Curve {
    let mut spacings: Vec<f64> = runs.iter().map(|(case, _)| case.spacing).collect();
    spacings.sort_by(|a, b| b.total_cmp(a));
    spacings.dedup();
    let points: Vec<Point> = spacings.iter().map(|spacing| point(*spacing, runs)).collect();
    let measured = |f: fn(&Point) -> Option<f64>| {
        points.iter().filter_map(move |p| Some((f(p)?, p.error?))).collect::<Vec<_>>()
    };
    let over_spacing = measured(|p| Some(p.spacing));
    let swap =
        |points: Vec<(f64, f64)>| points.into_iter().map(|(a, b)| (b, a)).collect::<Vec<_>>();
    let medians = swap(measured(|p| p.core_seconds));
    let mut seeds: Vec<Option<u64>> = runs.iter().map(|(case, _)| case.seed).collect();
    seeds.sort_unstable();
    seeds.dedup();
    let by_seed: Vec<Vec<(f64, f64)>> = seeds
        .iter()
        .map(|seed| {
            let mut mine: Vec<_> = runs.iter().filter(|(case, _)| case.seed == *seed).collect();
            mine.sort_by(|a, b| b.0.spacing.total_cmp(&a.0.spacing));
            mine.iter().filter_map(|(_, figure)| Some((figure.error?, figure.cost()?))).collect()
        })
        .collect();
    Curve {
        order: order::fitted(&over_spacing),
        last_order: order::fitted(&over_spacing[over_spacing.len().saturating_sub(2)..]),
        costs: targets.iter().map(|target| with_spread(&medians, &by_seed, *target)).collect(),
        label,
        points,
    }
}

fn point(spacing: f64, runs: &[(&Case, &Figure)]) -> Point {
    let mine = || runs.iter().filter(move |(case, _)| case.spacing == spacing);
    let errors: Vec<f64> = mine().filter_map(|(_, figure)| figure.error).collect();
    let costs: Vec<f64> = mine().filter_map(|(_, figure)| figure.cost()).collect();
    let low = errors.iter().copied().reduce(f64::min);
    Point {
        spacing,
        particles: mine().find_map(|(_, figure)| figure.particles),
        error: median(&errors),
        error_range: low.zip(errors.iter().copied().reduce(f64::max)),
        core_seconds: median(&costs),
        runs: (errors.len(), mine().count()),
        on_front: false,
    }
}

/// The middle one, or the mean of the two in the middle.
fn median(numbers: &[f64]) -> Option<f64> {
    let mut sorted = numbers.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    match sorted.len() {
        0 => None,
        n if n % 2 == 1 => Some(sorted[middle]),
        _ => Some(0.5 * (sorted[middle - 1] + sorted[middle])),
    }
}

/// CPU time is counted in units of 0.01 s; half of one stands for less.
const SHORTEST: f64 = 0.005;

impl Figure {
    /// Core-seconds, never 0.
    pub fn cost(&self) -> Option<f64> {
        self.core_seconds.map(|seconds| seconds.max(SHORTEST))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Outcome;

    fn run(scheme: &str, spacing: f64, seed: u64, error: Option<f64>, cost: f64) -> (Case, Figure) {
        let case = Case {
            name: String::new(),
            settings: vec![("scheme".into(), scheme.into())],
            spacing,
            seed: Some(seed),
            overrides: vec![],
            identity: String::new(),
        };
        let figure = Figure {
            outcome: Outcome::Finished,
            error,
            remark: None,
            core_seconds: Some(cost),
            particles: Some(1),
            steps: Some(1),
        };
        (case, figure)
    }

    #[test]
    fn seeds_are_put_together_and_schemes_kept_apart() {
        let (cases, figures): (Vec<_>, Vec<_>) = [
            run("a", 0.2, 1, Some(0.4), 1.0),
            run("a", 0.2, 2, Some(0.5), 1.0),
            run("a", 0.2, 3, None, 1.0),
            run("a", 0.1, 1, Some(0.1), 8.0),
            run("a", 0.1, 2, Some(0.125), 8.0),
            run("b", 0.2, 1, Some(0.6), 2.0),
        ]
        .into_iter()
        .unzip();
        let curves = curves(&cases, &figures, &[0.2]);
        assert_eq!(curves.len(), 2);
        let a = &curves[0];
        assert_eq!(a.label, "scheme = a");
        assert_eq!(a.points[0].error, Some(0.45));
        assert_eq!((a.points[0].error_range, a.points[0].runs), (Some((0.4, 0.5)), (2, 3)));
        assert!((a.order.unwrap() - 2.0).abs() < 1e-12, "{:?}", a.order);
        assert_eq!(a.costs[0].seeds, (2, 3));
        assert!(a.points.iter().all(|point| point.on_front));
        assert!(!curves[1].points[0].on_front && curves[1].order.is_none());
    }
}
