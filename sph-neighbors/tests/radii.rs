//! Reaches from the radii of both particles of a pair, against the search of all pairs.

mod support;

use proptest::prelude::*;
use proptest::sample::select;
use sph_neighbors::{Grid, GridError, LevelList, NeighborList, PairReach};
use support::{Cloud, cloud, distance};

/// Largest radius that the tests use.
const LARGEST: f64 = 1.6;

/// Coordinates are rounded to the unit of the coarsest grid.
const MARGIN: f64 = 1e-5;

fn radii(cloud: &Cloud<3>, spread: f64) -> Vec<f64> {
    // From the largest down by a factor of up to `spread`, the same for the same id.
    let part = |id: u64| (id >> 11) as f64 / (1_u64 << 53) as f64;
    cloud.ids.iter().map(|&id| LARGEST * spread.powf(-part(id))).collect()
}

fn grid(cloud: &Cloud<3>) -> Grid<3> {
    let origin = cloud.positions.first().map_or([0.0; 3], |x| x.map(f64::round));
    Grid::new(origin, LARGEST / 2.0).unwrap()
}

fn rules() -> impl Strategy<Value = PairReach> {
    select(vec![PairReach::Mean, PairReach::Max])
}

fn by_id(cloud: &Cloud<3>, radii: &[f64], rule: PairReach) -> Vec<(u64, Vec<u64>)> {
    let grid = Grid::new([0.0; 3], LARGEST / 2.0).unwrap();
    let levels = LevelList::build(&grid, &cloud.positions, radii, &cloud.ids).unwrap();
    let list =
        NeighborList::build_with_radii(&levels, &cloud.positions, radii, |t| t as u32, rule, 8);
    support::by_id(cloud, &list)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn every_pair_within_its_own_reach(
        cloud in cloud::<3>(),
        spread in select(vec![1.0, 1.5, 8.0, 50.0]),
        rule in rules(),
    ) {
        let (grid, radii) = (grid(&cloud), radii(&cloud, spread));
        let levels = LevelList::build(&grid, &cloud.positions, &radii, &cloud.ids).unwrap();
        prop_assume!(levels.outside() == 0);
        let list =
            NeighborList::build_with_radii(&levels, &cloud.positions, &radii, |t| t as u32, rule, 8);
        let place = |j: u32| {
            let (x, r) = (&cloud.positions[j as usize], radii[j as usize]);
            let level = grid.level(r);
            (level, grid.finer(level).key(x), cloud.ids[j as usize])
        };
        let order: Vec<u32> = levels.order().collect();
        prop_assert_eq!(order.len(), cloud.ids.len());
        prop_assert!(order.is_sorted_by(|&a, &b| place(a) < place(b)));
        for (t, x) in cloud.positions.iter().enumerate() {
            let found = list.neighbors(t);
            prop_assert!(found.is_sorted_by(|&a, &b| place(a) < place(b)));
            for (j, y) in cloud.positions.iter().enumerate() {
                let (r, reach) = (distance(x, y), rule.of(radii[t], radii[j]));
                let listed = found.contains(&(j as u32));
                if r < reach {
                    prop_assert_eq!(listed, j != t, "{} and {} at {} < {}", t, j, r, reach);
                } else if r > reach + LARGEST * MARGIN {
                    prop_assert!(!listed, "{t} and {j} at {r} > {reach}");
                }
                prop_assert_eq!(listed, list.neighbors(j).contains(&(t as u32)));
            }
        }
    }

    #[test]
    fn order_is_irrelevant(
        (cloud, shuffled) in cloud::<3>().prop_flat_map(|cloud| {
            let order: Vec<usize> = (0..cloud.ids.len()).collect();
            (Just(cloud), Just(order).prop_shuffle())
        }),
        rule in rules(),
    ) {
        let radii = radii(&cloud, 8.0);
        let permuted = cloud.take(&shuffled);
        let permuted_radii: Vec<f64> = shuffled.iter().map(|&i| radii[i]).collect();
        let (a, b) = (by_id(&cloud, &radii, rule), by_id(&permuted, &permuted_radii, rule));
        prop_assert_eq!(a, b);
    }

    #[test]
    fn equal_radii_find_what_one_reach_finds(cloud in cloud::<3>(), rule in rules()) {
        let (grid, reach) = (grid(&cloud), 0.9 * LARGEST);
        let radii = vec![reach; cloud.ids.len()];
        let levels = LevelList::build(&grid, &cloud.positions, &radii, &cloud.ids).unwrap();
        prop_assume!(levels.outside() == 0);
        let list =
            NeighborList::build_with_radii(&levels, &cloud.positions, &radii, |t| t as u32, rule, 8);
        let uniform = support::lists(&grid, &cloud, reach);
        for t in 0..list.len() {
            let near = |j: &u32| distance(&cloud.positions[t], &cloud.positions[*j as usize]) < reach;
            let certain = |list: &NeighborList| -> Vec<u32> {
                list.neighbors(t).iter().copied().filter(near).collect()
            };
            prop_assert_eq!(certain(&list), certain(&uniform));
        }
    }
}

#[test]
fn a_rebuild_is_a_build() {
    let grid = Grid::new([0.0; 3], LARGEST / 2.0).unwrap();
    let point = |i: usize| [0.82, 0.67, 0.55].map(|s: f64| (i as f64 * s).fract() * 4.0);
    let mut levels = LevelList::build(&grid, &[], &[], &[]).unwrap();
    let mut list = NeighborList::default();
    for (n, spread) in [(300, 8.0), (100, 2.0), (0, 1.0), (200, 30.0), (200, 1.0)] {
        let cloud = Cloud::new((0..n).map(point).collect());
        let (radii, filler, rule) = (radii(&cloud, spread), |t| t as u32, PairReach::Max);
        levels.rebuild(&grid, &cloud.positions, &radii, &cloud.ids).unwrap();
        list.rebuild_with_radii(&levels, &cloud.positions, &radii, filler, rule, 8);
        let fresh = LevelList::build(&grid, &cloud.positions, &radii, &cloud.ids).unwrap();
        assert!(levels.order().eq(fresh.order()));
        let fresh =
            NeighborList::build_with_radii(&fresh, &cloud.positions, &radii, filler, rule, 8);
        assert!((0..n).all(|t| list.of(t) == fresh.of(t)));
        assert_eq!((list.len(), list.pairs()), (n, fresh.pairs()));
    }
}

#[test]
fn bad_radii_are_refused() {
    let grid = Grid::new([0.0; 2], 0.5).unwrap();
    for radius in [-1.0, f64::NAN, f64::INFINITY, 2.1] {
        let error = LevelList::build(&grid, &[[0.0; 2]; 2], &[1.0, radius], &[0, 1]).unwrap_err();
        assert!(matches!(error, GridError::Reach { most: 2.0, .. }), "{error}");
    }
    let grid = grid.periodic([Some(2.5), None]).unwrap();
    let error = LevelList::build(&grid, &[[0.0; 2]], &[1.5], &[0]).unwrap_err();
    assert!(matches!(error, GridError::ShortPeriod { axis: 0, .. }), "{error}");
}
