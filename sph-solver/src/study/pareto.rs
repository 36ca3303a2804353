//! Runs than which none is both better and cheaper.

/// Whether each of `points`, (error, cost), is on the Pareto front: no other has neither a larger
/// error nor a larger cost and is smaller in one of them. A point that is not finite is not on it.
pub fn front(points: &[(f64, f64)]) -> Vec<bool> {
    let finite = |p: &(f64, f64)| p.0.is_finite() && p.1.is_finite();
    let beats = |a: &(f64, f64), b: &(f64, f64)| a.0 <= b.0 && a.1 <= b.1 && a != b;
    points
        .iter()
        .map(|point| {
            finite(point) && !points.iter().any(|other| finite(other) && beats(other, point))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn only_the_best_stay() {
        let points = [(0.1, 1.0), (0.1, 2.0), (0.05, 2.0), (0.2, 3.0), (f64::NAN, 0.0)];
        assert_eq!(front(&points), [true, false, true, false, false]);
    }

    proptest! {
        #[test]
        fn every_point_is_beaten_by_one_of_the_front(
            points in prop::collection::vec((0.0..1.0_f64, 0.0..1.0_f64), 1..30),
        ) {
            let on = front(&points);
            for point in &points {
                let beaten = points
                    .iter()
                    .zip(&on)
                    .any(|(other, on)| *on && other.0 <= point.0 && other.1 <= point.1);
                prop_assert!(beaten);
            }
        }
    }
}
