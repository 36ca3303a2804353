//! Pairs at the reach itself: none is lost to rounding, and both particles see the same.

mod support;

use proptest::prelude::*;
use proptest::sample::select;
use sph_neighbors::{Grid, LevelList, NeighborList, PairReach};
use support::{Cloud, distance, lists};

/// A pair at a distance of `reach (1 + excess)`, somewhere, in some direction.
fn pair(reach: f64, x: [f64; 3], direction: [f64; 3], excess: f64) -> Cloud<3> {
    let length = distance(&direction, &[0.0; 3]);
    let r = reach * (1.0 + excess) / length;
    Cloud::new(vec![x, std::array::from_fn(|a| x[a] + r * direction[a])])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn no_pair_is_lost(
        x in prop::array::uniform3(-50.0..50.0),
        direction in prop::array::uniform3(-1.0..1.0_f64),
        ratio in select(vec![0.7, 1.0, 2.0, 3.3, 20.0, 50.0]),
    ) {
        prop_assume!(distance(&direction, &[0.0; 3]) > 0.01);
        let reach = 1.5;
        let cloud = pair(reach, x, direction, -1e-13);
        prop_assume!(distance(&cloud.positions[0], &cloud.positions[1]) < reach);
        let list = lists(&Grid::new([0.1; 3], reach / ratio).unwrap(), &cloud, reach);
        prop_assert_eq!((list.count(0), list.count(1)), (1, 1));
    }

    /// Within the margin a pair may count or not, but for both the same, whoever else is searched
    /// with them.
    #[test]
    fn rounding_is_the_same_for_both(
        x in prop::array::uniform3(-50.0..50.0),
        direction in prop::array::uniform3(-1.0..1.0_f64),
        companion in prop::array::uniform3(-0.5..0.5_f64),
        excess in 0.0..4e-6,
        ratio in select(vec![0.7, 1.0, 2.0, 3.3, 20.0, 50.0]),
    ) {
        prop_assume!(distance(&direction, &[0.0; 3]) > 0.01);
        let reach = 1.5;
        let mut cloud = pair(reach, x, direction, excess);
        let grid = Grid::new([0.1; 3], reach / ratio).unwrap();
        let list = lists(&grid, &cloud, reach);
        prop_assert_eq!(list.count(0), list.count(1));
        // In its cell or group the companion shifts what coordinates are relative to.
        let companion = std::array::from_fn(|a| x[a] + companion[a] * reach / ratio);
        cloud.positions.push(companion);
        cloud.ids.push(7);
        let joined = lists(&grid, &cloud, reach);
        for (t, other) in [(0, 1), (1, 0)] {
            prop_assert_eq!(joined.neighbors(t).contains(&other), list.count(t) == 1);
        }
    }

    #[test]
    fn no_pair_of_radii_is_lost(
        x in prop::array::uniform3(-50.0..50.0),
        direction in prop::array::uniform3(-1.0..1.0_f64),
        radii in [0.2..1.5, 0.2..1.5_f64],
        rule in select(vec![PairReach::Mean, PairReach::Max]),
    ) {
        prop_assume!(distance(&direction, &[0.0; 3]) > 0.01);
        let reach = rule.of(radii[0], radii[1]);
        let Cloud { positions, ids } = pair(reach, x, direction, -1e-13);
        prop_assume!(distance(&positions[0], &positions[1]) < reach);
        let grid = Grid::new([0.1; 3], 0.75).unwrap();
        let levels = LevelList::build(&grid, &positions, &radii, &ids).unwrap();
        let list =
            NeighborList::build_with_radii(&levels, &positions, &radii, |t| t as u32, rule, 8);
        prop_assert_eq!((list.count(0), list.count(1)), (1, 1));
    }
}
