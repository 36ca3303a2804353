//! Boxes that repeat, against all pairs with the nearest image.

mod support;

use proptest::prelude::*;
use proptest::sample::{Index, select};
use sph_neighbors::{CellList, Grid, LevelList, NeighborList, PairReach};
use support::{Cloud, MARGIN};

type Periods = [Option<f64>; 3];

fn distance(x: &[f64; 3], y: &[f64; 3], periods: &Periods) -> f64 {
    let along = |axis: usize| {
        let d = x[axis] - y[axis];
        periods[axis].map_or(d, |period| d - period * (d / period).round())
    };
    (0..3).map(|axis| along(axis).powi(2)).sum::<f64>().sqrt()
}

/// Particles inside the box and a few periods outside.
fn cloud() -> impl Strategy<Value = Cloud<3>> {
    let inside = prop::array::uniform3(-1.0..3.0_f64);
    let around = prop::array::uniform3(-30.0..30.0_f64);
    prop::collection::vec(prop_oneof![8 => inside, 1 => around], 0..150).prop_map(Cloud::new)
}

fn periods() -> impl Strategy<Value = Periods> {
    let period = select(vec![None, Some(2.0), Some(2.3), Some(4.0), Some(5.0 / 3.0 + 0.7)]);
    prop::array::uniform3(period)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn nearest_images(
        cloud in cloud(),
        periods in periods(),
        reach in 0.3..0.99,
        ratio in select(vec![0.6, 1.0, 2.0, 3.7]),
    ) {
        let grid = Grid::new([-1.0, 0.0, 0.25], reach / ratio).unwrap();
        let grid = grid.periodic(periods).unwrap();
        let cells = CellList::build(&grid, &cloud.positions, &cloud.ids);
        let list = NeighborList::build(&cells, &cloud.positions, |t| t as u32, reach, 8);
        let mut pairs = 0;
        for (t, x) in cloud.positions.iter().enumerate() {
            let mut found = list.neighbors(t).to_vec();
            found.sort_unstable();
            prop_assert!(found.is_sorted_by(|a, b| a < b), "twice in the list: {found:?}");
            for (j, y) in cloud.positions.iter().enumerate().filter(|&(j, _)| j != t) {
                let (r, listed) = (distance(x, y, &periods), found.contains(&(j as u32)));
                pairs += u64::from(r < 0.8 * reach);
                if r < reach * (1.0 - 1e-12) {
                    prop_assert!(listed, "{t} and {j} at {r}");
                } else if r > reach * (1.0 + MARGIN) {
                    prop_assert!(!listed, "{t} and {j} at {r}");
                }
                prop_assert_eq!(listed, list.neighbors(j).contains(&(t as u32)));
            }
        }
        let positions = &cloud.positions;
        prop_assert_eq!(list.pairs_within(positions, positions, 0.8 * reach), pairs);
    }

    /// Lists follow from images, not from which image a particle is stored as.
    #[test]
    fn any_image_will_do(cloud in cloud(), shifts in prop::collection::vec(any::<Index>(), 150)) {
        let periods = [2.0, 2.5, 3.0];
        let grid = Grid::new([-1.0; 3], 0.7).unwrap().periodic(periods.map(Some)).unwrap();
        // Whole numbers of 2⁻²⁰, so that moving them is exact.
        let round = |x: f64| (x * 1_048_576.0).round() / 1_048_576.0;
        let mut cloud = cloud;
        cloud.positions.iter_mut().for_each(|x| *x = x.map(round));
        let mut moved = cloud.clone();
        for (x, shift) in moved.positions.iter_mut().zip(&shifts) {
            let number = shift.index(27);
            for axis in 0..3 {
                x[axis] += periods[axis] * (number / 3_usize.pow(axis as u32) % 3) as f64;
            }
        }
        let lists = |cloud: &Cloud<3>| support::by_id(cloud, &support::lists(&grid, cloud, 0.7));
        prop_assert_eq!(lists(&cloud), lists(&moved));
    }

    #[test]
    fn radii_in_a_box(cloud in cloud(), periods in periods(), max in any::<bool>()) {
        let rule = if max { PairReach::Max } else { PairReach::Mean };
        let grid = Grid::new([-1.0, 0.0, 0.25], 0.5).unwrap().periodic(periods).unwrap();
        let radii: Vec<f64> = (0..cloud.ids.len()).map(|i| 0.99 / (1 + i % 9) as f64).collect();
        let levels = LevelList::build(&grid, &cloud.positions, &radii, &cloud.ids).unwrap();
        let list =
            NeighborList::build_with_radii(&levels, &cloud.positions, &radii, |t| t as u32, rule, 8);
        for (t, x) in cloud.positions.iter().enumerate() {
            for (j, y) in cloud.positions.iter().enumerate().filter(|&(j, _)| j != t) {
                let (r, reach) = (distance(x, y, &periods), rule.of(radii[t], radii[j]));
                let times = list.neighbors(t).iter().filter(|&&k| k as usize == j).count();
                if r < reach * (1.0 - 1e-12) {
                    prop_assert_eq!(times, 1, "{} and {} at {} < {}", t, j, r, reach);
                } else if r > reach + 2e-5 {
                    prop_assert_eq!(times, 0, "{} and {} at {} > {}", t, j, r, reach);
                }
            }
        }
    }
}
