//! Rebuilding in place, threads, and memory.

mod support;

use proptest::prelude::*;
use sph_neighbors::{CellList, Grid, NeighborList};
use support::{Cloud, cloud, distance};

fn positions(n: usize) -> Vec<[f64; 3]> {
    let step = [0.819_172_5, 0.671_043_6, 0.549_700_5];
    (0..n).map(|i| step.map(|s| (i as f64 * s).fract())).collect()
}

fn same(a: &NeighborList, b: &NeighborList) -> bool {
    a.len() == b.len() && (0..a.len()).all(|t| a.of(t) == b.of(t) && a.count(t) == b.count(t))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Nothing of the last build is left in the next.
    #[test]
    fn a_rebuild_is_a_build(
        clouds in prop::collection::vec((cloud::<3>(), 0.3..1.2, 1.0..2.5), 2..5),
    ) {
        let first: &Cloud<3> = &clouds[0].0;
        let grid = Grid::new([0.0; 3], 1.0).unwrap();
        let mut cells = CellList::build(&grid, &first.positions, &first.ids);
        let mut list = NeighborList::default();
        for (cloud, reach, ratio) in &clouds {
            let grid = Grid::new([0.25; 3], reach / ratio).unwrap();
            cells.rebuild(&grid, &cloud.positions, &cloud.ids);
            let fresh = CellList::build(&grid, &cloud.positions, &cloud.ids);
            prop_assert_eq!(cells.order(), fresh.order());
            prop_assert!(cells.occupied().eq(fresh.occupied()));
            list.rebuild(&cells, &cloud.positions, |t| t as u32, *reach, 4);
            let fresh = NeighborList::build(&fresh, &cloud.positions, |t| t as u32, *reach, 4);
            prop_assert!(same(&list, &fresh));
            prop_assert_eq!((list.pairs(), list.max_index()), (fresh.pairs(), fresh.max_index()));
        }
    }
}

#[test]
fn a_rebuild_of_the_same_size_takes_no_new_memory() {
    let positions = positions(3000);
    let ids: Vec<u64> = (0..3000).collect();
    let grid = Grid::new([0.0; 3], 0.15).unwrap();
    let mut cells = CellList::build(&grid, &positions, &ids);
    let mut list = NeighborList::build(&cells, &positions, |t| t as u32, 0.15, 8);
    let memory = |cells: &CellList<3>, list: &NeighborList| {
        let lists: Vec<_> = (0..list.len()).map(|t| list.of(t).as_ptr()).collect();
        (cells.order().as_ptr(), lists, cells.bytes(), list.bytes())
    };
    let before = memory(&cells, &list);
    cells.rebuild(&grid, &positions, &ids);
    list.rebuild(&cells, &positions, |t| t as u32, 0.15, 8);
    assert_eq!(memory(&cells, &list), before);
}

#[test]
fn threads_do_not_matter() {
    let positions = positions(20_000);
    let ids: Vec<u64> = (0..20_000).map(|i| i * 7919 % 20_000).collect();
    let grid = Grid::new([0.0; 3], 0.05).unwrap();
    let build = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let cells = CellList::build(&grid, &positions, &ids);
            let list = NeighborList::build(&cells, &positions, |t| t as u32, 0.05, 8);
            (cells.order().to_vec(), list)
        })
    };
    let (order, list) = build(1);
    for threads in [2, 3, 5] {
        let (other_order, other) = build(threads);
        assert!(order == other_order && same(&list, &other), "{threads} threads");
    }
}

#[test]
fn a_splash_far_away_takes_no_memory() {
    let mut positions = positions(2000);
    let ids: Vec<u64> = (0..2001).collect();
    let grid = Grid::new([0.0; 3], 0.1).unwrap();
    let compact = CellList::build(&grid, &positions, &ids[..2000]);
    positions.push([9e4, -8e4, 7e4]);
    let splashed = CellList::build(&grid, &positions, &ids);
    assert!(splashed.bytes() < 2 * compact.bytes());
    // Both tables list the same cells.
    let cells = |cells: &CellList<3>| -> Vec<_> {
        cells.occupied().map(|(cell, places)| (cell, places.len())).collect()
    };
    let mut expected = cells(&compact);
    expected.push((grid.cell(&positions[2000]), 1));
    expected.sort_by_key(|(cell, _)| [cell[2], cell[1], cell[0]]);
    assert_eq!(cells(&splashed), expected);
}

#[test]
fn what_the_grid_cannot_place_has_no_neighbours() {
    let positions =
        [[0.1, 0.1], [f64::NAN, 0.1], [0.2, 0.1], [1e300, 0.1], [0.1, f64::NEG_INFINITY]];
    let ids = [4, 3, 2, 1, 0];
    let grid = Grid::new([0.0; 2], 0.5).unwrap();
    let cells = CellList::build(&grid, &positions, &ids);
    assert_eq!(cells.outside(), 3);
    assert_eq!(cells.order(), [2, 0, 4, 3, 1]);
    let list = NeighborList::build(&cells, &positions, |t| t as u32, 0.5, 2);
    let neighbors: Vec<&[u32]> = (0..5).map(|t| list.neighbors(t)).collect();
    assert_eq!(neighbors, [&[2][..], &[], &[0], &[], &[]]);
}

#[test]
fn a_reach_of_many_cells() {
    // More than 2²² units: the test drops bits of the coordinates.
    let positions = positions(300);
    let ids: Vec<u64> = (0..300).collect();
    let grid = Grid::new([0.0; 3], 0.01).unwrap();
    let cells = CellList::build(&grid, &positions, &ids);
    let list = NeighborList::build(&cells, &positions, |t| t as u32, 0.35, 1);
    assert_eq!(list.pairs(), list.pairs_within(&positions, &positions, 0.35));
    let all = positions.iter().flat_map(|x| positions.iter().map(move |y| distance(x, y)));
    assert_eq!(list.pairs() + 300, all.filter(|&r| r < 0.35).count() as u64);
}

#[test]
#[should_panic(expected = "reach 3 must be positive and at most 2.56")]
fn a_reach_of_too_many_cells_is_refused() {
    let grid = Grid::new([0.0; 2], 0.01).unwrap();
    let cells = CellList::build(&grid, &[], &[]);
    NeighborList::build(&cells, &[], |_| 0, 3.0, 8);
}
