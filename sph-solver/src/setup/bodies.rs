//! Bodies of water: which particles of the fluid are connected at the start.

use sph_geometry::Lattice;

/// Number of the body that each lattice point belongs to, counted from 0, and how many bodies there
/// are. Points whose cells share a side are connected.
pub fn bodies<const D: usize>(lattice: &Lattice<D>, position: &[[f64; D]]) -> (Vec<u32>, usize) {
    let (keys, strides) = keys(lattice, position);
    let mut order: Vec<u32> = (0..keys.len() as u32).collect();
    order.sort_unstable_by_key(|&i| keys[i as usize]);
    let mut sets = Sets((0..keys.len() as u32).collect());
    for stride in strides {
        // Both places move forward only: keys keep their order when the same is added to all.
        let mut next = order.iter().peekable();
        for &one in &order {
            let wanted = keys[one as usize] + stride;
            while next.next_if(|&&other| keys[other as usize] < wanted).is_some() {}
            if let Some(&&other) = next.peek().filter(|&&&other| keys[other as usize] == wanted) {
                sets.join(one, other);
            }
        }
    }
    let mut numbers = vec![u32::MAX; keys.len()];
    let mut count = 0;
    let body = (0..keys.len() as u32).map(|i| {
        let number = &mut numbers[sets.root(i) as usize];
        if *number == u32::MAX {
            *number = count;
            count += 1;
        }
        *number
    });
    let body = body.collect();
    (body, count as usize)
}

/// A number for the cell of each point, and what the number grows by with one cell along each axis. No
/// cell beyond the last one of a row has the number of another.
fn keys<const D: usize>(lattice: &Lattice<D>, position: &[[f64; D]]) -> (Vec<u128>, [u128; D]) {
    let origin = lattice.origin();
    let cell = |x: &[f64; D]| -> [i64; D] {
        std::array::from_fn(|k| ((x[k] - origin[k]) / lattice.spacing() - 0.5).round() as i64)
    };
    let mut low = [i64::MAX; D];
    let mut high = [i64::MIN; D];
    for x in position {
        let cell = cell(x);
        for k in 0..D {
            (low[k], high[k]) = (low[k].min(cell[k]), high[k].max(cell[k]));
        }
    }
    let mut strides = [1_u128; D];
    for k in 1..D {
        // One cell more than there are; lattices beyond 2^40 cells along an axis are refused.
        strides[k] =
            strides[k - 1].saturating_mul((high[k - 1].saturating_sub(low[k - 1])) as u128 + 2);
    }
    let key = |x: &[f64; D]| {
        let cell = cell(x);
        (0..D).map(|k| (cell[k] - low[k]) as u128 * strides[k]).sum()
    };
    (position.iter().map(key).collect(), strides)
}

/// Disjoint sets: each element names another of its set, the root itself.
struct Sets(Vec<u32>);

impl Sets {
    fn root(&mut self, mut one: u32) -> u32 {
        while self.0[one as usize] != one {
            let above = self.0[self.0[one as usize] as usize];
            self.0[one as usize] = above;
            one = above;
        }
        one
    }

    fn join(&mut self, one: u32, other: u32) {
        let (one, other) = (self.root(one), self.root(other));
        // The root is the lowest element, so that bodies are numbered as they are met.
        self.0[one.max(other) as usize] = one.min(other);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn points(cells: &[[i64; 3]]) -> (Lattice<3>, Vec<[f64; 3]>) {
        let lattice = Lattice::new([0.3, -0.2, 5.0], 0.1).unwrap();
        let points = cells.iter().map(|cell| lattice.point(cell)).collect();
        (lattice, points)
    }

    #[test]
    fn corners_and_edges_do_not_connect() {
        let (lattice, points) = points(&[[0, 0, 0], [1, 1, 0], [2, 1, 0], [0, -1, 1]]);
        assert_eq!(bodies(&lattice, &points), (vec![0, 1, 1, 2], 3));
        assert_eq!(bodies(&lattice, &points[..0]), (vec![], 0));
    }

    /// The last cell of one row and the first of the next are neighbours in memory only.
    #[test]
    fn rows_do_not_wrap_around() {
        let (lattice, points) = points(&[[3, 0, 0], [0, 1, 0], [0, 0, 1]]);
        assert_eq!(bodies(&lattice, &points).1, 3);
    }

    proptest! {
        #[test]
        fn as_brute_force(
            cells in prop::collection::btree_set(prop::array::uniform3(-3_i64..3), 0..80),
        ) {
            let cells: Vec<[i64; 3]> = cells.into_iter().collect();
            let (lattice, points) = points(&cells);
            let (body, count) = bodies(&lattice, &points);
            // Spread the lowest number until nothing changes.
            let mut lowest: Vec<usize> = (0..cells.len()).collect();
            loop {
                let before = lowest.clone();
                for (i, a) in cells.iter().enumerate() {
                    for (j, b) in cells.iter().enumerate() {
                        if (0..3).map(|k| (a[k] - b[k]).abs()).sum::<i64>() == 1 {
                            lowest[i] = lowest[i].min(lowest[j]);
                        }
                    }
                }
                if lowest == before { break; }
            }
            let mut roots = lowest.clone();
            roots.sort_unstable();
            roots.dedup();
            prop_assert_eq!(count, roots.len());
            for i in 0..cells.len() {
                for j in 0..cells.len() {
                    prop_assert_eq!(body[i] == body[j], lowest[i] == lowest[j]);
                }
            }
        }
    }
}
