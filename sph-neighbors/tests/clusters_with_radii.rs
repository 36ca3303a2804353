//! Cluster lists with a reach of its own for each pair, against the search of all pairs.

mod support;

use proptest::prelude::*;
use proptest::sample::select;
use sph_neighbors::{ClusterList, Clusters, Grid, LevelList, PairReach};
use support::{Cloud, cloud, distance};

/// Largest radius that the tests use.
const LARGEST: f64 = 1.6;

/// Coordinates are rounded to the unit of the coarsest grid.
const MARGIN: f64 = 1e-5;

fn radii<const D: usize>(cloud: &Cloud<D>, spread: f64) -> Vec<f64> {
    // From the largest down by a factor of up to `spread`, the same for the same id.
    let part = |id: u64| (id >> 11) as f64 / (1_u64 << 53) as f64;
    cloud.ids.iter().map(|&id| LARGEST * spread.powf(-part(id))).collect()
}

fn check<const D: usize>(
    cloud: &Cloud<D>,
    spread: f64,
    rule: PairReach,
    periods: [Option<f64>; D],
) -> Result<(), TestCaseError> {
    let origin = match periods[0] {
        Some(_) => [0.0; D],
        None => cloud.positions.first().map_or([0.0; D], |x| x.map(f64::round)),
    };
    let grid = Grid::new(origin, LARGEST / 2.0).unwrap().periodic(periods).unwrap();
    let radii = radii(cloud, spread);
    let levels = LevelList::build(&grid, &cloud.positions, &radii, &cloud.ids).unwrap();
    prop_assume!(levels.outside() == 0);
    let clusters = Clusters::new(cloud.positions.len(), &[]);
    let mut list = ClusterList::default();
    list.rebuild_with_radii(&clusters, &levels, &cloud.positions, &radii, true, rule);
    let place = |j: u32| {
        let (x, r) = (&cloud.positions[j as usize], radii[j as usize]);
        let level = grid.level(r);
        (level, grid.finer(level).key(x), cloud.ids[j as usize])
    };
    let apart = |x: &[f64; D], y: &[f64; D]| {
        let nearest = std::array::from_fn(|axis| {
            let d = x[axis] - y[axis];
            periods[axis].map_or(d, |period| d - period * (d / period).round())
        });
        distance(&nearest, &[0.0; D])
    };
    for cluster in 0..clusters.len() {
        let found = list.sources(cluster);
        prop_assert!(found.is_sorted_by(|&a, &b| place(a) < place(b)));
        let mut near = vec![false; cloud.ids.len()];
        for t in clusters.targets_of(cluster) {
            let (mut least, mut most) = (0, 0);
            for (j, y) in cloud.positions.iter().enumerate() {
                let (r, reach) = (apart(&cloud.positions[t], y), rule.of(radii[t], radii[j]));
                if r < reach {
                    prop_assert!(found.contains(&(j as u32)), "{t} and {j} at {r} < {reach}");
                    least += usize::from(j != t);
                }
                if r < reach + LARGEST * MARGIN {
                    near[j] = true;
                    most += usize::from(j != t);
                }
            }
            prop_assert!(least <= list.count(t) && list.count(t) <= most);
        }
        prop_assert!(found.iter().all(|&j| near[j as usize]), "only what is near a target");
    }
    Ok(())
}

fn rules() -> impl Strategy<Value = PairReach> {
    select(vec![PairReach::Mean, PairReach::Max, PairReach::Target])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn in_space(
        cloud in cloud::<3>(),
        spread in select(vec![1.0, 1.5, 8.0, 50.0]),
        rule in rules(),
    ) {
        check(&cloud, spread, rule, [None; 3])?;
    }

    #[test]
    fn in_a_periodic_box(
        cloud in cloud::<2>(),
        spread in select(vec![1.0, 1.5, 8.0]),
        rule in rules(),
    ) {
        check(&cloud, spread, rule, [Some(5.0), None])?;
    }
}
