//! Writes a short series of snapshots, a probe table and checkpoints of a drop that turns, then
//! picks the run up from its newest checkpoint.
//!
//! ```text
//! cargo run -p sph-io --example snapshots -- target/drop
//! ```
//!
//! Open `target/drop/drop.pvd` or one of the `.vtkhdf` files in ParaView.

use std::path::{Path, PathBuf};
use std::{env, fs};

use sph_io::{
    Checkpoint, IoError, ParticleFrame, SnapshotSeries, TableWriter, checkpoint_name,
    latest_checkpoint, prune_checkpoints, write_checkpoint, write_text_atomically,
};

/// Particles across the drop.
const ACROSS: i32 = 40;
/// Diameter in metres.
const DIAMETER: f64 = 0.1;
/// Turns per second, times 2 π.
const RATE: f64 = 3.0;
const PROBE: [(&str, &str); 2] = [("pressure", "Pa"), ("particles", "")];

struct Drop {
    time: f64,
    step: u64,
    ids: Vec<u64>,
    positions: Vec<[f64; 2]>,
}

impl Drop {
    fn new() -> Self {
        let spacing = DIAMETER / f64::from(ACROSS);
        let along = |i: i32| (f64::from(i) + 0.5) * spacing - DIAMETER / 2.0;
        let positions: Vec<[f64; 2]> = (0..ACROSS * ACROSS)
            .map(|i| [along(i % ACROSS), along(i / ACROSS)])
            .filter(|x| x[0].hypot(x[1]) < DIAMETER / 2.0)
            .collect();
        Self { time: 0.0, step: 0, ids: (0..positions.len() as u64).collect(), positions }
    }

    fn turn(&mut self, dt: f64) {
        let (sin, cos) = (RATE * dt).sin_cos();
        for x in &mut self.positions {
            *x = [cos * x[0] - sin * x[1], sin * x[0] + cos * x[1]];
        }
        self.time += dt;
        self.step += 1;
    }

    /// Velocity in m/s.
    fn velocities(&self) -> Vec<[f64; 2]> {
        self.positions.iter().map(|x| [-RATE * x[1], RATE * x[0]]).collect()
    }

    /// Pressure in Pa of water that turns as a solid, 0 in the middle.
    fn pressures(&self) -> Vec<f32> {
        let pressure = |x: &[f64; 2]| 500.0 * RATE * RATE * (x[0] * x[0] + x[1] * x[1]);
        self.positions.iter().map(|x| pressure(x) as f32).collect()
    }
}

fn run(mut drop: Drop, folder: &Path, until: f64) -> Result<(), IoError> {
    let fresh = drop.step == 0;
    let plate: Vec<[f64; 2]> = (0..ACROSS).map(|i| [f64::from(i) * 0.004 - 0.08, -0.06]).collect();
    let (mut series, mut probe) = if fresh {
        (
            SnapshotSeries::create(folder, "drop")?,
            TableWriter::create(folder.join("P1.csv"), &PROBE)?,
        )
    } else {
        (
            SnapshotSeries::resume(folder, "drop", drop.time)?,
            TableWriter::resume(folder.join("P1.csv"), &PROBE, drop.time)?,
        )
    };
    series.fixed_part("plate", &ParticleFrame::new(0.0, &plate))?;
    while drop.time < until {
        if drop.step.is_multiple_of(5) {
            let (velocities, pressures) = (drop.velocities(), drop.pressures());
            series.write(
                &ParticleFrame::new(drop.time, &drop.positions)
                    .with("velocity", &velocities)
                    .with("pressure", &pressures)
                    .with("id", &drop.ids),
            )?;
            let state = Checkpoint::new(drop.time, drop.step, &drop.ids, &drop.positions)
                .with("velocity", &velocities)
                .with_attribute("rate", RATE);
            write_checkpoint(folder.join(checkpoint_name(drop.step)), &state)?;
            prune_checkpoints(folder, 2)?;
        }
        drop.turn(0.01);
        let highest = drop.pressures().into_iter().fold(0.0, f32::max);
        probe.row(drop.time, &[f64::from(highest), drop.ids.len() as f64])?;
    }
    write_text_atomically(
        folder.join("summary.json"),
        &format!("{{\"steps\": {}, \"time\": {}}}\n", drop.step, drop.time),
    )
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(env::args().nth(1).unwrap_or("target/drop".to_owned()));
    fs::create_dir_all(&folder)?;
    sph_io::remove_checkpoints(&folder, ..)?;
    run(Drop::new(), &folder, 0.3)?;

    let latest = latest_checkpoint(&folder)?.ok_or("the run left no checkpoint")?;
    let state = sph_io::read_checkpoint::<2>(&latest.path)?;
    println!("goes on from {} at {} s", latest.path.display(), state.time);
    let drop = Drop {
        time: state.time,
        step: state.step,
        ids: state.ids.into_owned(),
        positions: state.positions.into_owned(),
    };
    run(drop, &folder, 0.6)?;
    println!("wrote {}", folder.join("drop.pvd").display());
    Ok(())
}
