//! Lists from k-d trees, against the search of all pairs and the search in levels.
#![cfg(feature = "kiddo")]

mod support;

use proptest::prelude::*;
use proptest::sample::select;
use sph_neighbors::{Grid, GridError, LevelList, NeighborList, PairReach, TreeList};
use support::{Cloud, cloud};

/// Largest radius that the tests use.
const LARGEST: f64 = 1.6;

/// From the largest down by a factor of up to `spread`, the same for the same id.
fn radii<const D: usize>(cloud: &Cloud<D>, spread: f64) -> Vec<f64> {
    let part = |id: u64| (id >> 11) as f64 / (1_u64 << 53) as f64;
    cloud.ids.iter().map(|&id| LARGEST * spread.powf(-part(id))).collect()
}

fn rules() -> impl Strategy<Value = PairReach> {
    select(vec![PairReach::Mean, PairReach::Max])
}

fn spreads() -> impl Strategy<Value = f64> {
    select(vec![1.0, 8.0, 1e3, 1e6])
}

/// Whether `x` and `y` are nearer than `reach`, to the bit.
fn near<const D: usize>(x: &[f64; D], y: &[f64; D], reach: f64) -> bool {
    let mut distance2 = 0.0;
    for axis in 0..D {
        distance2 += (x[axis] - y[axis]) * (x[axis] - y[axis]);
    }
    distance2 < reach * reach
}

/// Everything that a list promises, for targets with or without an index among the sources.
fn check<const D: usize>(
    sources: &Cloud<D>,
    targets: &Cloud<D>,
    own: bool,
    spread: f64,
    rule: PairReach,
) -> Result<(), TestCaseError> {
    let grid = Grid::new([0.5; D], LARGEST / 2.0).unwrap();
    let (their_radii, my_radii) = (radii(sources, spread), radii(targets, spread));
    let trees = TreeList::build(&grid, &sources.positions, &their_radii, &sources.ids).unwrap();
    prop_assert_eq!((trees.len(), trees.outside()), (sources.ids.len(), 0));
    let nobody = sources.ids.len() as u32;
    let filler = |t: usize| if own { t as u32 } else { nobody };
    let list =
        NeighborList::build_with_tree(&trees, &targets.positions, &my_radii, filler, rule, 8);
    let mut place = vec![0; sources.ids.len()];
    for (n, &i) in trees.order().iter().enumerate() {
        place[i as usize] = n;
    }
    prop_assert_eq!(list.len(), targets.ids.len());
    let mut pairs = 0;
    for (t, x) in targets.positions.iter().enumerate() {
        let mut expected: Vec<u32> = (0..nobody)
            .filter(|&j| {
                let reach = rule.of(my_radii[t], their_radii[j as usize]);
                !(own && j as usize == t) && near(x, &sources.positions[j as usize], reach)
            })
            .collect();
        expected.sort_by_key(|&j| place[j as usize]);
        prop_assert_eq!(list.neighbors(t), &expected[..]);
        pairs += expected.len() as u64;
        expected.resize(expected.len().next_multiple_of(8), filler(t));
        prop_assert_eq!(list.of(t), expected);
    }
    prop_assert_eq!(list.pairs(), pairs);
    prop_assert!(list.tests() >= pairs);
    Ok(())
}

/// The order is by level, then by cell as far as grids are fine enough to tell, then by id.
fn check_order<const D: usize>(cloud: &Cloud<D>, spread: f64) -> Result<(), TestCaseError> {
    let grid = Grid::new([0.5; D], LARGEST / 2.0).unwrap();
    let radii = radii(cloud, spread);
    let trees = TreeList::build(&grid, &cloud.positions, &radii, &cloud.ids).unwrap();
    let levels = LevelList::build(&grid, &cloud.positions, &radii, &cloud.ids).unwrap();
    let grids = radii.iter().all(|&radius| grid.level(radius) < 12);
    if grids && levels.outside() == 0 {
        prop_assert!(levels.order().eq(trees.order().iter().copied()));
    }
    // Radii within a level differ by a factor of two at most.
    let sorted: Vec<f64> = trees.order().iter().map(|&i| radii[i as usize]).collect();
    prop_assert!(sorted.windows(2).all(|r| r[1] < 2.0 * r[0]));
    Ok(())
}

/// Where the resolution of levels suffices, trees find the same, in the same order.
fn check_levels<const D: usize>(
    grid: &Grid<D>,
    cloud: &Cloud<D>,
    spread: f64,
    rule: PairReach,
) -> Result<(), TestCaseError> {
    let (positions, radii, filler) = (&cloud.positions, radii(cloud, spread), |t| t as u32);
    let levels = LevelList::build(grid, positions, &radii, &cloud.ids).unwrap();
    prop_assume!(levels.outside() == 0);
    let with_levels = NeighborList::build_with_radii(&levels, positions, &radii, filler, rule, 1);
    let trees = TreeList::build(grid, positions, &radii, &cloud.ids).unwrap();
    let with_trees = NeighborList::build_with_tree(&trees, positions, &radii, filler, rule, 1);
    for t in 0..cloud.ids.len() {
        let (few, many) = (with_trees.neighbors(t), with_levels.neighbors(t));
        // Levels may list a few more, at the reach itself.
        let same: Vec<u32> = many.iter().copied().filter(|j| few.contains(j)).collect();
        prop_assert_eq!(few, &same[..]);
        for &j in many.iter().filter(|j| !few.contains(j)) {
            let reach = rule.of(radii[t], radii[j as usize]);
            let d2: f64 = (0..D)
                .map(|a| {
                    let d = positions[t][a] - positions[j as usize][a];
                    grid.periods()[a].map_or(d, |period| d - period * (d / period).round()).powi(2)
                })
                .sum();
            prop_assert!(d2.sqrt() >= reach - 1e-9 && d2.sqrt() <= reach + 1e-5 * LARGEST);
        }
    }
    Ok(())
}

fn by_id(cloud: &Cloud<3>, radii: &[f64], rule: PairReach) -> Vec<(u64, Vec<u64>)> {
    let grid = Grid::new([0.0; 3], LARGEST / 2.0).unwrap();
    let trees = TreeList::build(&grid, &cloud.positions, radii, &cloud.ids).unwrap();
    let list =
        NeighborList::build_with_tree(&trees, &cloud.positions, radii, |t| t as u32, rule, 8);
    support::by_id(cloud, &list)
}

fn shuffled_cloud() -> impl Strategy<Value = (Cloud<3>, Vec<usize>)> {
    cloud::<3>().prop_flat_map(|cloud| {
        let order: Vec<usize> = (0..cloud.ids.len()).collect();
        (Just(cloud), Just(order).prop_shuffle())
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn three_dimensions(a in cloud::<3>(), b in cloud::<3>(), spread in spreads(), rule in rules()) {
        check(&a, &a, true, spread, rule)?;
        check(&a, &b, false, spread, rule)?;
        check_order(&a, spread)?;
    }

    #[test]
    fn two_dimensions(a in cloud::<2>(), b in cloud::<2>(), spread in spreads(), rule in rules()) {
        check(&a, &a, true, spread, rule)?;
        check(&a, &b, false, spread, rule)?;
        check_order(&a, spread)?;
    }

    #[test]
    fn one_dimension(a in cloud::<1>(), b in cloud::<1>(), spread in spreads(), rule in rules()) {
        check(&a, &a, true, spread, rule)?;
        check(&a, &b, false, spread, rule)?;
        check_order(&a, spread)?;
    }

    #[test]
    fn levels_find_the_same(cloud in cloud::<3>(), spread in select(vec![1.0, 8.0, 50.0]), rule in rules()) {
        let origin = cloud.positions.first().map_or([0.0; 3], |x| x.map(f64::round));
        check_levels(&Grid::new(origin, LARGEST / 2.0).unwrap(), &cloud, spread, rule)?;
    }

    #[test]
    fn levels_find_the_same_in_periodic_boxes(
        cloud in cloud::<2>(),
        spread in select(vec![1.0, 8.0, 50.0]),
        rule in rules(),
        periods in select(vec![[Some(3.3), None], [None, Some(4.7)], [Some(3.3), Some(4.7)]]),
    ) {
        let grid = Grid::new([-0.1, 0.7], LARGEST / 2.0).unwrap().periodic(periods).unwrap();
        check_levels(&grid, &cloud, spread, rule)?;
    }

    #[test]
    fn order_is_irrelevant((cloud, shuffled) in shuffled_cloud(), spread in spreads(), rule in rules()) {
        let radii = radii(&cloud, spread);
        let permuted = cloud.take(&shuffled);
        let permuted_radii: Vec<f64> = shuffled.iter().map(|&i| radii[i]).collect();
        prop_assert_eq!(by_id(&cloud, &radii, rule), by_id(&permuted, &permuted_radii, rule));
    }

    /// Clusters of the smallest particles at the resolution of their own radii.
    #[test]
    fn tiny_particles_in_a_wide_domain(
        offsets in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 0..60),
        centre in select(vec![0.0, 3.0, -2e5]),
        rule in rules(),
    ) {
        let tiny = 1e-6 * LARGEST;
        let mut positions: Vec<[f64; 3]> =
            offsets.iter().map(|x| x.map(|c| centre + 2.0 * tiny * c)).collect();
        positions.extend(offsets.iter().map(|x| x.map(|c| centre + c)));
        let cloud = Cloud::new(positions);
        let radii: Vec<f64> =
            (0..cloud.ids.len()).map(|i| if i < offsets.len() { tiny } else { LARGEST }).collect();
        let grid = Grid::new([0.0; 3], LARGEST / 2.0).unwrap();
        let trees = TreeList::build(&grid, &cloud.positions, &radii, &cloud.ids).unwrap();
        let list =
            NeighborList::build_with_tree(&trees, &cloud.positions, &radii, |t| t as u32, rule, 1);
        for (t, x) in cloud.positions.iter().enumerate() {
            for (j, y) in cloud.positions.iter().enumerate() {
                let expected = t != j && near(x, y, rule.of(radii[t], radii[j]));
                prop_assert_eq!(list.neighbors(t).contains(&(j as u32)), expected);
            }
        }
    }
}

/// Particles of two octaves on a line along an axis.
fn on_a_line(n: usize) -> (Cloud<3>, Vec<f64>) {
    let points = (0..n).map(|i| [7.0, -0.001 * i as f64, 0.25]).collect();
    (Cloud::new(points), (0..n).map(|i| if i % 3 == 0 { 0.01 } else { 0.0045 }).collect())
}

#[test]
fn more_equal_coordinates_than_a_leaf_holds() {
    let (mut cloud, mut radii) = on_a_line(300);
    // Of which a hundred coincide.
    let extra = (0..100).map(|i| (cloud.positions[70], u64::MAX - i));
    for (x, id) in extra.collect::<Vec<_>>() {
        cloud.positions.push(x);
        cloud.ids.push(id);
        radii.push(0.01);
    }
    for rule in [PairReach::Mean, PairReach::Max] {
        for (id, neighbors) in by_id(&cloud, &radii, rule) {
            let t = cloud.ids.iter().position(|&i| i == id).unwrap();
            let expected = (0..400)
                .filter(|&j| {
                    j != t
                        && near(
                            &cloud.positions[t],
                            &cloud.positions[j],
                            rule.of(radii[t], radii[j]),
                        )
                })
                .count();
            assert_eq!(neighbors.len(), expected);
            assert!(t < 300 || expected > 100, "those that coincide are neighbours");
        }
    }
}

#[test]
fn threads_are_irrelevant() {
    let (cloud, radii) = on_a_line(3000);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| by_id(&cloud, &radii, PairReach::Max))
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn a_rebuild_is_a_build() {
    let grid = Grid::new([0.0; 3], LARGEST / 2.0).unwrap();
    let point = |i: usize| [0.82, 0.67, 0.55].map(|s: f64| (i as f64 * s).fract() * 4.0);
    let mut list = NeighborList::default();
    for (n, spread) in [(300, 1e4), (100, 2.0), (0, 1.0), (600, 30.0), (200, 1.0)] {
        let cloud = Cloud::new((0..n).map(point).collect());
        let (radii, filler, rule) = (radii(&cloud, spread), |t| t as u32, PairReach::Mean);
        let trees = TreeList::build(&grid, &cloud.positions, &radii, &cloud.ids).unwrap();
        list.rebuild_with_tree(&trees, &cloud.positions, &radii, filler, rule, 8);
        let fresh =
            NeighborList::build_with_tree(&trees, &cloud.positions, &radii, filler, rule, 8);
        assert!((0..n).all(|t| list.of(t) == fresh.of(t)));
        assert_eq!((list.len(), list.pairs()), (n, fresh.pairs()));
    }
}

#[test]
fn nobody_finds_particles_without_a_place() {
    let grid = Grid::new([0.0; 2], 0.5).unwrap();
    let positions =
        [[0.0, f64::NAN], [0.0, 0.0], [f64::INFINITY, 0.0], [0.1, 0.0], [0.0, -1e200], [1e100; 2]];
    let (radii, ids) = ([1.0; 6], [0, 1, 2, 3, 4, 5]);
    let trees = TreeList::build(&grid, &positions, &radii, &ids).unwrap();
    assert_eq!((trees.len(), trees.outside()), (6, 3));
    let list =
        NeighborList::build_with_tree(&trees, &positions, &radii, |t| t as u32, PairReach::Max, 1);
    let lists: Vec<&[u32]> = (0..6).map(|t| list.of(t)).collect();
    assert_eq!(lists, [&[][..], &[3], &[], &[1], &[], &[]]);
}

#[test]
fn bad_radii_are_refused() {
    let grid = Grid::new([0.0; 2], 0.5).unwrap();
    for radius in [-1.0, f64::NAN, f64::INFINITY, 2.1] {
        let error = TreeList::build(&grid, &[[0.0; 2]; 2], &[1.0, radius], &[0, 1]).unwrap_err();
        assert!(matches!(error, GridError::Reach { most: 2.0, .. }), "{error}");
    }
    let grid = grid.periodic([Some(2.5), None]).unwrap();
    let error = TreeList::build(&grid, &[[0.0; 2]], &[1.5], &[0]).unwrap_err();
    assert!(matches!(error, GridError::ShortPeriod { axis: 0, .. }), "{error}");
}
