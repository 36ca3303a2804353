//! Cluster lists against the search of all pairs.

mod support;

use proptest::prelude::*;
use proptest::sample::select;
use sph_neighbors::{CLUSTER, CellList, ClusterList, Clusters, ColumnOrder, Grid};
use support::{Cloud, MARGIN, cloud, distance};

type Periods<const D: usize> = [Option<f64>; D];

fn apart<const D: usize>(x: &[f64; D], y: &[f64; D], periods: &Periods<D>) -> f64 {
    let nearest = std::array::from_fn(|axis| {
        let d = x[axis] - y[axis];
        periods[axis].map_or(d, |period| d - period * (d / period).round())
    });
    distance(&nearest, &[0.0; D])
}

/// Everything that a list promises.
fn check<const D: usize>(
    grid: &Grid<D>,
    sources: &Cloud<D>,
    targets: &[[f64; D]],
    own: bool,
    breaks: &[usize],
    reach: f64,
) -> Result<(), TestCaseError> {
    let cells = CellList::build(grid, &sources.positions, &sources.ids);
    let clusters = Clusters::new(targets.len(), breaks);
    let mut list = ClusterList::default();
    list.rebuild(&clusters, &cells, targets, own, reach);
    prop_assert_eq!(list.len(), targets.len());
    let place = |j: u32| (grid.key(&sources.positions[j as usize]), sources.ids[j as usize]);
    let (mut pairs, mut lanes) = (0, 0);
    for cluster in 0..clusters.len() {
        let found = list.sources(cluster);
        lanes += CLUSTER as u64 * found.len() as u64;
        prop_assert!(found.is_sorted_by(|&a, &b| place(a) < place(b)));
        let mut near = vec![false; sources.ids.len()];
        for t in clusters.targets_of(cluster) {
            let (mut least, mut most) = (0, 0);
            for (j, y) in sources.positions.iter().enumerate() {
                let r = apart(&targets[t], y, &grid.periods());
                let itself = own && j == t;
                if r < reach {
                    prop_assert!(found.contains(&(j as u32)), "{} and {} at {}", t, j, r);
                    least += usize::from(!itself);
                }
                if r < reach * (1.0 + MARGIN) {
                    near[j] = true;
                    most += usize::from(!itself);
                }
            }
            prop_assert!(least <= list.count(t) && list.count(t) <= most);
            pairs += list.count(t) as u64;
        }
        prop_assert!(found.iter().all(|&j| near[j as usize]), "only what is near a target");
    }
    prop_assert_eq!((list.pairs(), list.lanes()), (pairs, lanes));
    prop_assert!(list.counts().eq((0..targets.len()).map(|t| list.count(t))));
    let exactly = list.pairs_within(targets, &sources.positions, own, 0.8 * reach);
    let close = |x: &[f64; D], y: &[f64; D]| apart(x, y, &grid.periods()) < 0.8 * reach;
    let all = targets.iter().enumerate().flat_map(|(t, x)| {
        sources.positions.iter().enumerate().filter(move |(j, y)| !(own && *j == t) && close(x, y))
    });
    prop_assert_eq!(exactly, all.count() as u64);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn in_space(a in cloud::<3>(), b in cloud::<3>(), cell in select(vec![0.4, 0.7, 1.0, 2.0])) {
        let near = a.positions.first().map_or([0.0; 3], |x| x.map(f64::round));
        let grid = Grid::new(near, cell).unwrap();
        check(&grid, &a, &a.positions, true, &[a.positions.len() / 3], 1.0)?;
        check(&grid, &a, &b.positions, false, &[], 1.0)?;
    }

    #[test]
    fn in_the_plane(a in cloud::<2>(), cell in select(vec![0.4, 0.7, 1.0, 2.0])) {
        let near = a.positions.first().map_or([0.0; 2], |x| x.map(f64::round));
        let grid = Grid::new(near, cell).unwrap();
        check(&grid, &a, &a.positions, true, &[], 0.8)?;
    }

    #[test]
    fn in_a_periodic_box(
        points in prop::collection::vec(prop::array::uniform3(-1.0..3.0_f64), 0..100),
        periods in prop::array::uniform3(select(vec![None, Some(2.0), Some(2.3), Some(5.0)])),
        reach in 0.3..0.99,
    ) {
        let cloud = Cloud::new(points);
        let grid = Grid::new([-1.0, 0.0, 0.25], 0.7 * reach).unwrap().periodic(periods).unwrap();
        check(&grid, &cloud, &cloud.positions, true, &[], reach)?;
    }
}

#[test]
fn clusters_of_a_fluid_are_compact() {
    let mut state = 1_u64;
    let mut noise = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        0.5 * ((state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5)
    };
    let mut positions: Vec<[f64; 3]> = (0..24_i32.pow(3))
        .map(|i| [i % 24, i / 24 % 24, i / 576].map(|n| f64::from(n) + noise()))
        .collect();
    let order = ColumnOrder::new([0.3; 3], 1.0).unwrap();
    positions.sort_by_key(|x| order.key(x));
    let ids: Vec<u64> = (0..positions.len() as u64).collect();
    let grid = Grid::new([0.0; 3], 2.0).unwrap();
    let cells = CellList::build(&grid, &positions, &ids);
    let mut list = ClusterList::default();
    list.rebuild(&Clusters::new(positions.len(), &[]), &cells, &positions, true, 3.0);
    let compactness = list.compactness();
    assert!(compactness > 0.4, "{compactness} of the lanes are pairs");
}
