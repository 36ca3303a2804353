//! Clouds of particles and the plainest search there is.
#![allow(dead_code)] // Each test program uses a part of it.

use proptest::prelude::*;
use proptest::sample::select;
use sph_neighbors::{CellList, Grid, NeighborList};

/// What the search may find beyond the reach, relative to it.
pub const MARGIN: f64 = 1e-5;

/// Particles with ids that are in no order.
#[derive(Debug, Clone)]
pub struct Cloud<const D: usize> {
    pub positions: Vec<[f64; D]>,
    pub ids: Vec<u64>,
}

impl<const D: usize> Cloud<D> {
    pub fn new(positions: Vec<[f64; D]>) -> Self {
        let ids =
            (0..positions.len() as u64).map(|i| i.wrapping_mul(0x9e37_79b9_7f4a_7c15)).collect();
        Self { positions, ids }
    }

    pub fn take(&self, order: &[usize]) -> Self {
        Self {
            positions: order.iter().map(|&i| self.positions[i]).collect(),
            ids: order.iter().map(|&i| self.ids[i]).collect(),
        }
    }
}

/// Random, clustered, collinear, coincident, with outliers far away, of any size from none, around
/// any centre. Lengths are such that a reach of about 1 finds some neighbours.
pub fn cloud<const D: usize>() -> impl Strategy<Value = Cloud<D>> {
    let point = || prop::array::uniform::<_, D>(0.0..4.0);
    let points = move |n| prop::collection::vec(point(), n);
    let shape = prop_oneof![
        points(0..200),
        points(0..3),
        // Clusters.
        (
            points(1..5),
            prop::collection::vec(
                (any::<prop::sample::Index>(), prop::array::uniform::<_, D>(-0.3..0.3)),
                0..200
            )
        )
            .prop_map(
                |(centres, points): (Vec<[f64; D]>, Vec<(prop::sample::Index, [f64; D])>)| points
                    .into_iter()
                    .map(|(i, x)| std::array::from_fn(|a| i.get(&centres)[a] + x[a]))
                    .collect()
            ),
        // On a line along one axis.
        (points(1..100), 0..D).prop_map(|(mut points, axis)| {
            points.iter_mut().for_each(|x| (0..D).filter(|&a| a != axis).for_each(|a| x[a] = 0.5));
            points
        }),
        // All at one place or two.
        (points(2..3), prop::collection::vec(0..2_usize, 0..80))
            .prop_map(|(places, who)| who.into_iter().map(|i| places[i]).collect()),
        // On a lattice whose spacing divides the reach: many pairs at exactly the reach.
        prop::collection::vec(prop::array::uniform::<_, D>(0..8_i32), 0..150)
            .prop_map(|points| points.into_iter().map(|x| x.map(|n| f64::from(n) * 0.5)).collect()),
        // Splashes far from the rest.
        (points(0..100), points(1..8)).prop_map(|(mut points, far)| {
            points.extend(far.iter().map(|x| x.map(|c| (c - 2.0) * 5e4)));
            points
        }),
    ];
    (shape, select(vec![0.0, -3.0, 0.25, 1e4, -1e6])).prop_map(|(points, centre)| {
        Cloud::new(points.iter().map(|x| x.map(|c| c + centre)).collect())
    })
}

pub fn distance<const D: usize>(x: &[f64; D], y: &[f64; D]) -> f64 {
    (0..D).map(|a| (x[a] - y[a]).powi(2)).sum::<f64>().sqrt()
}

/// Lists of a cloud among itself.
pub fn lists<const D: usize>(grid: &Grid<D>, cloud: &Cloud<D>, reach: f64) -> NeighborList {
    let cells = CellList::build(grid, &cloud.positions, &cloud.ids);
    NeighborList::build(&cells, &cloud.positions, |t| t as u32, reach, 8)
}

/// Id of each target with the ids of its neighbours, by id of the target.
pub fn by_id<const D: usize>(cloud: &Cloud<D>, list: &NeighborList) -> Vec<(u64, Vec<u64>)> {
    let ids = |t: usize| list.neighbors(t).iter().map(|&j| cloud.ids[j as usize]).collect();
    let mut lists: Vec<_> = (0..list.len()).map(|t| (cloud.ids[t], ids(t))).collect();
    lists.sort();
    lists
}
