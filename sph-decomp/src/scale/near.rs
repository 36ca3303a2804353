//! Which ranks may exchange anything.

use crate::zone::{Aabb, Period};

/// Pairs `(p, q)` of ranks, p < q, whose boxes are closer than `reach`.
///
/// A sweep along the longest side of all boxes: among 32 768 ranks in three dimensions each box
/// meets about three thousand others, not all.
pub(super) fn near_ranks<const D: usize>(
    boxes: &[Aabb<D>],
    reach: f64,
    period: &Period<D>,
) -> Vec<(u32, u32)> {
    let mut whole = Aabb::EMPTY;
    boxes.iter().filter(|one| !one.is_empty()).for_each(|one| whole.merge(one));
    let side = |axis: usize| whole.high[axis] - whole.low[axis];
    let open = (0..D).filter(|&axis| period[axis].is_none());
    let axis = open.max_by(|&a, &b| side(a).total_cmp(&side(b)));
    let mut order: Vec<u32> =
        (0..boxes.len() as u32).filter(|&rank| !boxes[rank as usize].is_empty()).collect();
    if let Some(axis) = axis {
        order.sort_by(|&a, &b| {
            boxes[a as usize].low[axis].total_cmp(&boxes[b as usize].low[axis]).then(a.cmp(&b))
        });
    }
    let mut pairs = Vec::new();
    for (place, &p) in order.iter().enumerate() {
        let mine = &boxes[p as usize];
        for &q in &order[place + 1..] {
            let other = &boxes[q as usize];
            if axis.is_some_and(|axis| other.low[axis] - mine.high[axis] >= reach) {
                break;
            }
            if mine.distance_squared(other, period) < reach * reach {
                pairs.push((p.min(q), p.max(q)));
            }
        }
    }
    pairs.sort_unstable();
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_sweep_finds_what_all_pairs_find(
            corners in prop::collection::vec((prop::array::uniform2(0.0..10.0), 0.0..2.0), 0..30),
            reach in 0.1..3.0,
            periodic in prop::array::uniform2(any::<bool>()),
        ) {
            let boxes: Vec<Aabb<2>> = corners
                .iter()
                .map(|&(low, side): &([f64; 2], f64)| Aabb { low, high: low.map(|x| x + side) })
                .chain([Aabb::EMPTY])
                .collect();
            let period = periodic.map(|yes| yes.then_some(12.0));
            let mut expected = Vec::new();
            for p in 0..corners.len() {
                for q in p + 1..corners.len() {
                    if boxes[p].distance_squared(&boxes[q], &period) < reach * reach {
                        expected.push((p as u32, q as u32));
                    }
                }
            }
            prop_assert_eq!(near_ranks(&boxes, reach, &period), expected);
        }
    }
}
