//! How fast this machine packs messages.

use crate::{CommError, HaloPlan, Solo};
use std::time::Instant;

/// Particles of the measurement, of which every other one is sent.
const PARTICLES: u32 = 200_000;
/// Repetitions; the fastest counts, because other programs only slow down.
const REPETITIONS: usize = 9;

/// Elements of six words that this core packs per second, gathered from records of eight words as a
/// force pass gathers them.
///
/// # Errors
///
/// When the plan of the measurement cannot be made.
pub fn measure_pack_rate() -> Result<f64, CommError> {
    let records: Vec<[f32; 8]> = (0..PARTICLES).map(|i| [i as f32; 8]).collect();
    // Runs of neighbours with gaps, as an overlap zone has them.
    let sent: Vec<u32> = (0..PARTICLES).filter(|i| i / 8 % 2 == 0).collect();
    let plan = HaloPlan::new(&Solo, vec![(0, sent)])?;
    let mut buffer = vec![[0.0_f32; 6]; plan.send_count()];
    let mut fastest = f64::INFINITY;
    for _ in 0..REPETITIONS {
        let start = Instant::now();
        plan.pack(&mut buffer, |i| {
            let [x, y, z, u, v, w, ..] = records[i as usize];
            [x, y, z, u, v, w]
        });
        std::hint::black_box(&buffer);
        fastest = fastest.min(start.elapsed().as_secs_f64());
    }
    Ok(plan.send_count() as f64 / fastest.max(1e-9))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packing_takes_time() {
        let rate = measure_pack_rate().unwrap();
        assert!(rate.is_finite() && rate > 0.0);
    }
}
