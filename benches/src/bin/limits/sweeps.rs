//! The two sweeps of δ-SPH beside the arithmetic peak of the same moment.

use crate::{Effort, machine::peak};
use serde::Serialize;
use sph_benches::{Clock, Spent, SweepCase, density_terms, force_terms, median};
use sph_kernels::Real;
use sph_solver::team::Team;
use sph_solver::terms::{Acceleration, DensityRate};
use std::error::Error;

/// Floating-point operations of a δ-SPH pair: one visit in the density sweep and one in the force
/// sweep. A convention, for comparison with other codes; divisions and roots count as one.
const FLOPS_PER_PAIR: f64 = 60.0;

/// Skin of the lists in support radii: that of the solver, and none. Rates are of pairs within the
/// support, but a sweep works on every lane.
const SKINS: [f64; 2] = [0.15, 0.0];

/// Rates of the sweeps on one case.
#[derive(Debug, Serialize)]
pub struct SweepRow {
    /// `mixed` or `double`.
    pub precision: &'static str,
    /// Number of particles.
    pub particles: usize,
    /// Support radius / spacing.
    pub support: f64,
    /// Skin / support radius.
    pub skin: f64,
    /// Mean number of neighbours within the support radius.
    pub neighbors: f64,
    /// Mean number of lanes that are computed for a particle: pairs, and what is beyond the support
    /// but near another particle of the cluster or in the skin.
    pub lanes: f64,
    /// Density sweep: pairs within the support visited per core second.
    pub density_visits: f64,
    /// Force sweep: the same.
    pub force_visits: f64,
    /// δ-SPH pairs (a visit in both sweeps) per core second.
    pub pairs: f64,
    /// 60 operations per δ-SPH pair / peak of multiply-adds in this precision.
    pub peak_fraction: f64,
    /// Wall time with one thread / with two.
    pub two_threads: f64,
}

/// Measures all cases.
pub fn measure(effort: Effort) -> Result<Vec<SweepRow>, Box<dyn Error>> {
    let counts: &[usize] = if effort.quick { &[20_000] } else { &[100_000, 1_000_000] };
    let mut rows = Vec::new();
    for &count in counts {
        // The support of the comparison with other codes, and one with 76 neighbours.
        for (support, skin) in [2.63, 3.46].iter().flat_map(|&s| SKINS.map(|skin| (s, skin))) {
            rows.push(case::<f32>("mixed", count, support, skin, effort)?);
            rows.push(case::<f64>("double", count, support, skin, effort)?);
        }
    }
    Ok(rows)
}

fn case<S: Real>(
    precision: &'static str,
    count: usize,
    support: f64,
    skin: f64,
    effort: Effort,
) -> Result<SweepRow, Box<dyn Error>> {
    let case = SweepCase::<S>::new(count, support, skin);
    let radius = case.scale.support_radius;
    let mut density_rates = vec![DensityRate::default(); case.len()];
    let mut accelerations = vec![Acceleration::default(); case.len()];
    let team = Team::new(2)?;
    let mut density = |team: Option<&Team>| {
        case.density_sweep(density_terms(radius), &mut density_rates, team);
    };
    let mut force =
        |team: Option<&Team>| case.force_sweep(force_terms(radius), &mut accelerations, team);
    let mut time = |team: Option<&Team>| -> (Spent, Spent) {
        let density = Clock::repeat(1, effort.seconds, || density(team));
        (density, Clock::repeat(1, effort.seconds, || force(team)))
    };
    time(None);
    // Peak and sweeps alternate, so that both see the same clock rate and the same neighbours.
    let rounds: Vec<_> = (0..effort.rounds)
        .map(|_| (peak::<S>(effort.seconds), time(None), time(Some(&team))))
        .collect();
    let middle = |of: &dyn Fn(f64, (Spent, Spent), (Spent, Spent)) -> f64| {
        median(rounds.iter().map(|&(peak, one, two)| of(peak, one, two)))
    };
    let pairs = case.true_pairs as f64;
    let both = |(density, force): (Spent, Spent)| density.core + force.core;
    Ok(SweepRow {
        precision,
        particles: case.len(),
        support,
        skin,
        neighbors: pairs / case.len() as f64,
        lanes: case.list.lanes() as f64 / case.len() as f64,
        density_visits: middle(&|_, one, _| pairs / one.0.core),
        force_visits: middle(&|_, one, _| pairs / one.1.core),
        pairs: middle(&|_, one, _| pairs / both(one)),
        peak_fraction: middle(&|peak, one, _| FLOPS_PER_PAIR * pairs / both(one) / peak),
        two_threads: middle(&|_, one, two| (one.0.wall + one.1.wall) / (two.0.wall + two.1.wall)),
    })
}
