//! Boxes, and distances to them, in open and periodic space.

/// An axis-aligned box. An empty one has `low > high`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Aabb<const D: usize> {
    pub low: [f64; D],
    pub high: [f64; D],
}

/// Lengths of the periodic axes; `None` for an axis without period.
pub(crate) type Period<const D: usize> = [Option<f64>; D];

impl<const D: usize> Aabb<D> {
    pub const EMPTY: Self = Self { low: [f64::INFINITY; D], high: [f64::NEG_INFINITY; D] };

    pub fn is_empty(&self) -> bool {
        self.low[0] > self.high[0]
    }

    pub fn add(&mut self, x: &[f64; D]) {
        self.merge(&Self { low: *x, high: *x });
    }

    pub fn merge(&mut self, other: &Self) {
        for axis in 0..D {
            self.low[axis] = self.low[axis].min(other.low[axis]);
            self.high[axis] = self.high[axis].max(other.high[axis]);
        }
    }

    pub fn of<'a>(positions: impl IntoIterator<Item = &'a [f64; D]>) -> Self {
        let mut all = Self::EMPTY;
        positions.into_iter().for_each(|x| all.add(x));
        all
    }

    /// Square of the smallest distance between points of two boxes. It is the same number from
    /// both sides, and never above the distance of two points in the boxes.
    pub fn distance_squared(&self, other: &Self, period: &Period<D>) -> f64 {
        let mut sum = 0.0;
        for (axis, length) in period.iter().enumerate() {
            let forth = other.low[axis] - self.high[axis];
            let back = self.low[axis] - other.high[axis];
            let mut gap = forth.max(back);
            if let Some(length) = length {
                // The images of `other` one period up and down.
                gap = gap.min((forth + length).max(back - length));
                gap = gap.min((forth - length).max(back + length));
            }
            let gap = gap.max(0.0);
            sum += gap * gap;
        }
        sum
    }

    /// Square of the distance of a point to the box.
    #[cfg(test)]
    pub fn distance_squared_to(&self, x: &[f64; D], period: &Period<D>) -> f64 {
        self.distance_squared(&Self { low: *x, high: *x }, period)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_nearest_image_counts() {
        let a = Aabb { low: [0.0, 0.0], high: [1.0, 1.0] };
        let b = Aabb { low: [8.0, 0.0], high: [9.5, 1.0] };
        assert_eq!(a.distance_squared(&b, &[None, None]), 49.0);
        assert_eq!(a.distance_squared(&b, &[Some(10.0), None]), 0.25);
        assert_eq!(b.distance_squared(&a, &[Some(10.0), None]), 0.25);
        assert_eq!(b.distance_squared_to(&[0.5, 3.0], &[Some(10.0), None]), 1.0 + 4.0);
    }

    proptest! {
        #[test]
        fn boxes_are_never_farther_apart_than_their_points(
            a in prop::collection::vec(prop::array::uniform3(0.0..10.0), 1..5),
            b in prop::collection::vec(prop::array::uniform3(0.0..10.0), 1..5),
            periodic: bool,
        ) {
            let period = [periodic.then_some(10.0), None, periodic.then_some(10.0)];
            let boxes = (Aabb::of(&a), Aabb::of(&b));
            let between = boxes.0.distance_squared(&boxes.1, &period);
            prop_assert_eq!(between, boxes.1.distance_squared(&boxes.0, &period));
            for x in &a {
                let to_box = boxes.1.distance_squared_to(x, &period);
                prop_assert!(between <= to_box);
                for y in &b {
                    let mut points = 0.0;
                    for axis in 0..3 {
                        let d: f64 = x[axis] - y[axis];
                        let d = period[axis].map_or(d.abs(), |l: f64| d.abs().min(l - d.abs()));
                        points += d * d;
                    }
                    prop_assert!(to_box <= points * (1.0 + 1e-12), "{to_box} {points}");
                }
            }
        }
    }
}
