//! Lists against the search of all pairs.

mod support;

use proptest::prelude::*;
use proptest::sample::select;
use sph_neighbors::{CellList, Grid, NeighborList};
use support::{Cloud, MARGIN, by_id, cloud, distance, lists};

/// Everything that a list promises, for targets with or without an index among the sources.
fn check<const D: usize>(
    grid: &Grid<D>,
    sources: &Cloud<D>,
    targets: &[[f64; D]],
    own: bool,
    reach: f64,
) -> Result<(), TestCaseError> {
    let cells = CellList::build(grid, &sources.positions, &sources.ids);
    let nobody = sources.ids.len() as u32;
    let filler = |t: usize| if own { t as u32 } else { nobody };
    let list = NeighborList::build(&cells, targets, filler, reach, 8);
    prop_assert_eq!(list.len(), targets.len());
    let mut pairs = 0;
    for (t, x) in targets.iter().enumerate() {
        let (found, padded) = (list.neighbors(t), list.of(t));
        prop_assert_eq!(found.len(), list.count(t));
        prop_assert_eq!(padded.len(), found.len().next_multiple_of(8));
        prop_assert!(padded[found.len()..].iter().all(|&j| j == filler(t)));
        pairs += found.len() as u64;
        prop_assert!(padded.iter().all(|&j| Some(j) <= list.max_index()));
        // Canonical order, which also shows that nothing occurs twice.
        let place = |j: u32| (grid.key(&sources.positions[j as usize]), sources.ids[j as usize]);
        prop_assert!(found.is_sorted_by(|&a, &b| place(a) < place(b)));
        for (j, y) in sources.positions.iter().enumerate() {
            let (r, listed) = (distance(x, y), found.contains(&(j as u32)));
            let expected = !(own && j == t);
            if r < reach {
                prop_assert_eq!(listed, expected, "{} and {} at {}", t, j, r);
            } else if r > reach * (1.0 + MARGIN) {
                prop_assert!(!listed, "{t} and {j} at {r}");
            }
        }
    }
    prop_assert_eq!(list.pairs(), pairs);
    let largest = sources.ids.len().max(usize::from(!own) + sources.ids.len()).checked_sub(1);
    prop_assert_eq!(list.max_index(), largest.filter(|_| !targets.is_empty()).map(|n| n as u32));
    Ok(())
}

fn check_all<const D: usize>(
    cloud: &Cloud<D>,
    others: &Cloud<D>,
    reach: f64,
    cells_per_reach: f64,
) -> Result<(), TestCaseError> {
    // Far from the origin there are no more than 21 bits of cells in three dimensions.
    let near = cloud.positions.first().map_or([0.0; D], |x| x.map(f64::round));
    for origin in [[0.0; D], near] {
        let grid = Grid::new(origin, reach / cells_per_reach).unwrap();
        let cells = CellList::build(&grid, &cloud.positions, &cloud.ids);
        if cells.outside() > 0 {
            continue;
        }
        check(&grid, cloud, &cloud.positions, true, reach)?;
        // Targets of another kind. Those that the grid cannot place have no neighbours.
        let placed = |x: &&[f64; D]| grid.key(x) != u64::MAX;
        let targets: Vec<[f64; D]> = others.positions.iter().filter(placed).copied().collect();
        check(&grid, cloud, &targets, false, reach)?;
    }
    Ok(())
}

fn symmetric<const D: usize>(cloud: &Cloud<D>, reach: f64) -> Result<(), TestCaseError> {
    let grid = Grid::new(cloud.positions.first().copied().unwrap_or([0.0; D]), reach).unwrap();
    let list = lists(&grid, cloud, reach);
    for t in 0..list.len() {
        for &j in list.neighbors(t) {
            prop_assert!(list.neighbors(j as usize).contains(&(t as u32)));
        }
    }
    Ok(())
}

/// Neither the order of the particles nor where parts of them come from changes a list.
fn order_is_irrelevant<const D: usize>(
    cloud: &Cloud<D>,
    shuffled: &[usize],
    reach: f64,
) -> Result<(), TestCaseError> {
    let grid = Grid::new([0.5; D], reach * 0.7).unwrap();
    let expected = by_id(cloud, &lists(&grid, cloud, reach));
    let permuted = cloud.take(shuffled);
    prop_assert_eq!(&by_id(&permuted, &lists(&grid, &permuted, reach)), &expected);
    // Three parts, as three ranks would hold them, in another order.
    let part = |p: usize| (0..cloud.ids.len()).filter(move |i| (i * 7 + i / 5) % 3 == p);
    let parts: Vec<usize> = part(2).chain(part(0)).chain(part(1)).collect();
    let joined = cloud.take(&parts);
    prop_assert_eq!(&by_id(&joined, &lists(&grid, &joined, reach)), &expected);
    Ok(())
}

/// Particles beyond the reach of a target do not change its list: a rank needs no more than a zone.
fn far_sources_are_irrelevant<const D: usize>(
    cloud: &Cloud<D>,
    reach: f64,
) -> Result<(), TestCaseError> {
    let grid = Grid::new([0.5; D], reach).unwrap();
    let all = by_id(cloud, &lists(&grid, cloud, reach));
    let Some(centre) = cloud.positions.first() else {
        return Ok(());
    };
    let zone: Vec<usize> = (0..cloud.ids.len())
        .filter(|&i| distance(centre, &cloud.positions[i]) < 2.0 * reach)
        .collect();
    let zone = cloud.take(&zone);
    let lists = by_id(&zone, &lists(&grid, &zone, reach));
    let of = |lists: &[(u64, Vec<u64>)]| {
        lists.iter().find(|(id, _)| *id == cloud.ids[0]).map(|(_, list)| list.clone())
    };
    prop_assert_eq!(of(&lists), of(&all));
    Ok(())
}

fn shuffled_cloud<const D: usize>() -> impl Strategy<Value = (Cloud<D>, Vec<usize>)> {
    cloud::<D>().prop_flat_map(|cloud| {
        let order: Vec<usize> = (0..cloud.ids.len()).collect();
        (Just(cloud), Just(order).prop_shuffle())
    })
}

fn ratios() -> impl Strategy<Value = f64> {
    select(vec![0.6, 1.0, 1.5, 2.0, 3.0, 6.5])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn two_dimensions(a in cloud::<2>(), b in cloud::<2>(), reach in 0.2..1.5, ratio in ratios()) {
        check_all(&a, &b, reach, ratio)?;
    }

    #[test]
    fn three_dimensions(a in cloud::<3>(), b in cloud::<3>(), reach in 0.4..1.5, ratio in ratios()) {
        check_all(&a, &b, reach, ratio)?;
    }

    #[test]
    fn one_dimension(a in cloud::<1>(), b in cloud::<1>(), reach in 0.1..1.5, ratio in ratios()) {
        check_all(&a, &b, reach, ratio)?;
    }

    #[test]
    fn pairs_are_mutual(cloud in cloud::<3>(), exact in any::<bool>(), reach in 0.4..1.5) {
        symmetric(&cloud, if exact { 1.0 } else { reach })?;
    }

    #[test]
    fn order_2d((cloud, shuffled) in shuffled_cloud::<2>(), reach in 0.2..1.5) {
        order_is_irrelevant(&cloud, &shuffled, reach)?;
    }

    #[test]
    fn order_3d((cloud, shuffled) in shuffled_cloud::<3>(), reach in 0.4..1.5) {
        order_is_irrelevant(&cloud, &shuffled, reach)?;
    }

    #[test]
    fn zones(a in cloud::<2>(), b in cloud::<3>(), reach in 0.4..1.5) {
        far_sources_are_irrelevant(&a, reach)?;
        far_sources_are_irrelevant(&b, reach)?;
    }
}
