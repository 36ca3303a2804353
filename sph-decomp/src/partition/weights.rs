//! Weights as integers, so that their sums do not depend on which rank holds what.

use super::PartitionError;
use crate::Communicator;

/// The largest weight becomes this: 2³⁰, so that 2³³ particles still sum below 2⁶⁴.
pub(super) const LARGEST: f64 = (1_u64 << 30) as f64;

/// Scales weights to integers, with one scale on all ranks. An empty slice means that all are
/// equal. Collective.
pub(super) fn to_integers<C: Communicator>(
    comm: &C,
    weights: &[f64],
    particles: usize,
) -> Result<Vec<u64>, PartitionError> {
    if !weights.is_empty() && weights.len() != particles {
        return Err(PartitionError::Length { weights: weights.len(), particles });
    }
    let good = |weight: f64| weight.is_finite() && weight >= 0.0;
    if let Some(particle) = weights.iter().position(|&weight| !good(weight)) {
        return Err(PartitionError::Weight { particle, value: weights[particle] });
    }
    let mut largest = [weights.iter().copied().fold(0.0, f64::max)];
    comm.max_f64(&mut largest)?;
    if largest[0] == 0.0 {
        return Ok(vec![1; particles]);
    }
    if weights.is_empty() {
        // Only this rank gave none: it holds no particles, or all weigh as the heaviest.
        return Ok(vec![LARGEST as u64; particles]);
    }
    let integer = |&weight: &f64| (weight / largest[0] * LARGEST).round() as u64;
    Ok(weights.iter().map(integer).collect())
}
