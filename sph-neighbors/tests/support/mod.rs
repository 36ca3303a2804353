//! Clouds of particles and the plainest search there is.
#![allow(dead_code)] // Each test program uses a part of it.

use proptest::array::uniform;
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::{Index, select};
use sph_neighbors::{CellList, Grid, NeighborList};
use std::array::from_fn;

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
    let shape = prop_oneof![
        points::<D>(200),
        points::<D>(3),
        clusters::<D>(),
        line::<D>(),
        (points::<D>(3), vec(any::<Index>(), 0..80)).prop_map(|(places, who)| {
            who.iter().filter(|_| !places.is_empty()).map(|i| *i.get(&places)).collect()
        }),
        lattice::<D>(),
        splashes::<D>(),
    ];
    (shape, select(std::vec![0.0, -3.0, 0.25, 1e4, -1e6])).prop_map(|(points, centre)| {
        Cloud::new(points.iter().map(|x| x.map(|c| c + centre)).collect())
    })
}

type Points<const D: usize> = Vec<[f64; D]>;

fn points<const D: usize>(most: usize) -> BoxedStrategy<Points<D>> {
    vec(uniform(0.0..4.0), 0..most).boxed()
}

fn clusters<const D: usize>() -> impl Strategy<Value = Points<D>> {
    let offsets = vec((any::<Index>(), uniform::<_, D>(-0.3..0.3)), 0..200);
    (vec(uniform::<_, D>(0.0..4.0), 1..5), offsets).prop_map(|(centres, offsets)| {
        let place = |(i, x): &(Index, [f64; D])| from_fn(|a| i.get(&centres)[a] + x[a]);
        offsets.iter().map(place).collect()
    })
}

/// On a line along one axis.
fn line<const D: usize>() -> impl Strategy<Value = Points<D>> {
    (points::<D>(100), 0..D).prop_map(|(points, axis)| {
        points.iter().map(|x| from_fn(|a| if a == axis { x[a] } else { 0.5 })).collect()
    })
}

/// On a lattice whose spacing divides a reach of 1: many pairs at exactly that reach.
fn lattice<const D: usize>() -> impl Strategy<Value = Points<D>> {
    vec(uniform(0..8_i32), 0..150)
        .prop_map(|points| points.iter().map(|x| x.map(|n| f64::from(n) * 0.5)).collect())
}

/// A few particles far from the rest and from each other.
fn splashes<const D: usize>() -> impl Strategy<Value = Points<D>> {
    (points::<D>(100), points::<D>(8)).prop_map(|(mut points, far)| {
        points.extend(far.iter().map(|x| x.map(|c| (c - 2.0) * 5e4)));
        points
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
