//! From differences over time to one number.

use crate::scene::Norm;

/// Pairs of a value and what it should be.
pub fn error(pairs: &[(f64, f64)], norm: Norm, scale: Option<f64>) -> f64 {
    let count = pairs.len() as f64;
    let mean = |f: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(f).sum::<f64>() / count;
    let largest = |f: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(f).fold(0.0, f64::max);
    let (off, known) = match norm {
        Norm::L1 => (mean(&|(a, b)| (a - b).abs()), mean(&|(_, b)| b.abs())),
        Norm::L2 => (mean(&|(a, b)| (a - b).powi(2)).sqrt(), mean(&|(_, b)| b * b).sqrt()),
        Norm::Max => (largest(&|(a, b)| (a - b).abs()), largest(&|(_, b)| b.abs())),
        Norm::Mean => (mean(&|(a, b)| a - b).abs(), mean(&|(_, b)| *b).abs()),
        Norm::Last => match pairs.last() {
            Some((a, b)) => ((a - b).abs(), b.abs()),
            None => (f64::NAN, f64::NAN),
        },
    };
    off / scale.unwrap_or(known)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn norms_are_what_their_names_say() {
        let pairs = [(1.1, 1.0), (1.9, 2.0), (3.3, 3.0)];
        for (norm, expected) in [
            (Norm::L1, 0.5 / 6.0),
            (Norm::L2, (0.11_f64 / 14.0).sqrt()),
            (Norm::Max, 0.1),
            (Norm::Mean, 0.3 / 6.0),
            (Norm::Last, 0.1),
        ] {
            let error = error(&pairs, norm, None);
            assert!((error - expected).abs() < 1e-12, "{norm:?}: {error}");
        }
        assert!((error(&pairs, Norm::Max, Some(3.0)) - 0.1).abs() < 1e-12);
        assert!(error(&[], Norm::L2, None).is_nan());
    }
}
