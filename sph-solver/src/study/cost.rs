//! What a given error costs.

use serde::Serialize;

/// What it costs to reach an error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "reached", content = "core_seconds")]
pub enum Cost {
    /// Interpolated between two spacings, core-seconds.
    Yes(f64),
    /// The coarsest spacing is better already: this many core-seconds at most.
    AtMost(f64),
    /// Not at any spacing of the study.
    No,
}

/// Cost of the error `target` for runs given as (error, core-seconds) from the coarsest spacing to the
/// finest: linear between two of them on logarithmic axes.
pub fn cost_at(points: &[(f64, f64)], target: f64) -> Cost {
    let Some(&(error, cost)) = points.first() else { return Cost::No };
    if error <= target {
        return Cost::AtMost(cost);
    }
    let crossing = points.windows(2).find(|pair| pair[0].0 > target && pair[1].0 <= target);
    let Some([(e0, c0), (e1, c1)]) = crossing.map(|pair| [pair[0], pair[1]]) else {
        return Cost::No;
    };
    // An error of 0 is below any other on logarithmic axes.
    let share = if e1 > 0.0 { (e0 / target).ln() / (e0 / e1).ln() } else { 1.0 };
    Cost::Yes((c0.ln() + share * (c1 / c0).ln()).exp())
}

/// The cost of an error with its spread over seeds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CostAt {
    /// The error.
    pub error: f64,
    /// The cost by the medians of the seeds.
    #[serde(flatten)]
    pub cost: Cost,
    /// Seeds that reach the error, and all of them.
    pub seeds: (usize, usize),
    /// Lowest and highest cost among the seeds that reach it, core-seconds.
    pub range: Option<(f64, f64)>,
}

/// The cost of `target` by the medians and by each seed.
pub fn with_spread(medians: &[(f64, f64)], by_seed: &[Vec<(f64, f64)>], target: f64) -> CostAt {
    let costs: Vec<f64> = by_seed
        .iter()
        .filter_map(|points| match cost_at(points, target) {
            Cost::Yes(cost) | Cost::AtMost(cost) => Some(cost),
            Cost::No => None,
        })
        .collect();
    let range = costs.iter().fold(None, |range: Option<(f64, f64)>, &cost| {
        Some(range.map_or((cost, cost), |(low, high)| (low.min(cost), high.max(cost))))
    });
    let seeds = (costs.len(), by_seed.len());
    CostAt { error: target, cost: cost_at(medians, target), seeds, range }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_are_interpolated_on_logarithmic_axes() {
        let points = [(0.1, 1.0), (0.01, 100.0)];
        let Cost::Yes(cost) = cost_at(&points, 0.1_f64.powf(1.5)) else { panic!() };
        assert!((cost - 10.0).abs() < 1e-9, "{cost}");
        assert_eq!(cost_at(&points, 0.2), Cost::AtMost(1.0));
        assert_eq!(cost_at(&points, 0.001), Cost::No);
        assert_eq!(cost_at(&[], 0.001), Cost::No);
        // Errors that rise and fall again.
        let Cost::Yes(cost) = cost_at(&[(0.1, 1.0), (0.2, 2.0), (0.0, 4.0)], 0.05) else {
            panic!()
        };
        assert!((cost - 4.0).abs() < 1e-9, "{cost}");
    }

    #[test]
    fn seeds_give_a_range() {
        let seeds =
            [vec![(0.1, 1.0), (0.01, 10.0)], vec![(0.2, 1.0), (0.02, 10.0)], vec![(0.2, 1.0)]];
        let cost = with_spread(&[(0.2, 1.0), (0.015, 10.0)], &seeds, 0.05);
        assert_eq!(cost.seeds, (2, 3));
        let (low, high) = cost.range.unwrap();
        assert!(1.0 < low && low < high && high < 10.0, "{cost:?}");
        assert_eq!(with_spread(&[], &[], 0.05).range, None);
    }
}
