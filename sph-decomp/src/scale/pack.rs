//! How fast this machine packs messages.

use crate::{CommError, HaloPlan, Solo};
use std::time::Instant;

/// Particles of the measurement, of which every other one is sent.
const PARTICLES: u32 = 200_000;
/// Repetitions, of which the middle one counts.
const REPETITIONS: usize = 15;

/// Elements of six words that this core packs or unpacks per second: gathered from records of eight
/// words as a force pass gathers them, and scattered into such records again.
///
/// # Errors
///
/// When the plan of the measurement cannot be made.
pub fn measure_pack_rate() -> Result<f64, CommError> {
    let mut records: Vec<[f32; 8]> = (0..PARTICLES).map(|i| [i as f32; 8]).collect();
    // Runs of neighbours with gaps, as an overlap zone has them.
    let sent: Vec<u32> = (0..PARTICLES).filter(|i| i / 8 % 2 == 0).collect();
    let plan = HaloPlan::new(&Solo, vec![(0, sent)])?;
    let mut buffer = vec![[0.0_f32; 6]; plan.send_count()];
    let mut seconds = [0.0; REPETITIONS];
    for seconds in &mut seconds {
        let start = Instant::now();
        plan.pack(&mut buffer, |i| {
            let [x, y, z, u, v, w, ..] = records[i as usize];
            [x, y, z, u, v, w]
        });
        std::hint::black_box(&buffer);
        plan.unpack(&buffer, |slot, element| records[slot][..6].copy_from_slice(element));
        std::hint::black_box(&records);
        *seconds = start.elapsed().as_secs_f64();
    }
    seconds.sort_by(f64::total_cmp);
    Ok(2.0 * plan.send_count() as f64 / seconds[REPETITIONS / 2].max(1e-9))
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
