//! Observed order of convergence.

/// The exponent q of error = C·spacing^q that fits best on logarithmic axes; `None` with fewer than two
/// spacings.
pub fn fitted(points: &[(f64, f64)]) -> Option<f64> {
    let logs: Vec<(f64, f64)> = points
        .iter()
        .filter(|(spacing, error)| *spacing > 0.0 && *error > 0.0)
        .map(|(spacing, error)| (spacing.ln(), error.ln()))
        .collect();
    let count = logs.len() as f64;
    let mean = |f: fn(&(f64, f64)) -> f64| logs.iter().map(f).sum::<f64>() / count;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let square: f64 = logs.iter().map(|p| (p.0 - x).powi(2)).sum();
    let product: f64 = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    // Equal spacings differ by less than rounding.
    (square > 1e-12).then(|| product / square)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_found() {
        let points: Vec<(f64, f64)> =
            [0.1_f64, 0.05, 0.025].map(|h| (h, 7.0 * h.powf(1.5))).to_vec();
        assert!((fitted(&points).unwrap() - 1.5).abs() < 1e-12);
        assert_eq!(fitted(&points[..1]), None);
        assert_eq!(fitted(&[(0.1, 1.0), (0.1, 2.0)]), None);
        assert_eq!(fitted(&[(0.1, 1.0), (0.05, 0.0)]), None);
    }
}
