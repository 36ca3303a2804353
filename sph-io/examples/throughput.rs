//! Measures size and speed of each kind of file for a given number of particles in space.
//!
//! ```text
//! cargo run --release -p sph-io --example throughput -- 1000000 target/throughput
//! ```

use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::Instant;
use std::{env, fs};

use sph_io::{
    Checkpoint, ParticleFrame, TableWriter, read_checkpoint, write_checkpoint, write_vtu,
};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = env::args().skip(1);
    let n: u32 = arguments.next().map_or(Ok(1_000_000), |n| n.parse())?;
    let folder = PathBuf::from(arguments.next().unwrap_or("target/throughput".to_owned()));
    fs::create_dir_all(&folder)?;

    let ids: Vec<u64> = (0..u64::from(n)).collect();
    // Multiples of square roots do not repeat, so that nothing packs better than in a simulation.
    let positions: Vec<[f64; 3]> =
        ids.iter().map(|&i| [2.0, 3.0, 5.0].map(|k: f64| (i as f64 * k.sqrt()).fract())).collect();
    let velocities: Vec<[f64; 3]> = positions.iter().map(|x| x.map(f64::sin)).collect();
    let density: Vec<f64> = positions.iter().map(|x| 1000.0 + x[0]).collect();
    let mass = vec![1e-3; positions.len()];
    let pressure: Vec<f32> = density.iter().map(|&x| x as f32).collect();
    let velocities_f32: Vec<[f32; 3]> = velocities.iter().map(|v| v.map(|v| v as f32)).collect();
    let density_f32 = pressure.clone();
    let kind: Vec<u8> = ids.iter().map(|i| u8::from(i % 7 == 0)).collect();
    let order: Vec<u32> = (0..n).rev().collect();

    println!("{n} particles\n");
    println!("| file | MB | bytes per particle | s |");
    println!("|---|---|---|---|");
    let frame = ParticleFrame::new(0.5, &positions)
        .with("velocity", &velocities_f32)
        .with("pressure", &pressure)
        .with("density", &density_f32)
        .with("kind", &kind)
        .with("id", &ids);
    let path = folder.join("a.vtu");
    report("snapshot `.vtu`", &path, n, || write_vtu(&path, &frame))?;
    let ordered = frame.clone().select(&order);
    report("snapshot in another order", &path, n, || write_vtu(&path, &ordered))?;

    let state = Checkpoint::new(0.5, 10, &ids, &positions)
        .with("velocity", &velocities)
        .with("density", &density)
        .with("mass", &mass)
        .with("kind", &kind);
    let path = folder.join("a.vtkhdf");
    report("checkpoint `.vtkhdf`, written", &path, n, || write_checkpoint(&path, &state))?;
    report("checkpoint `.vtkhdf`, read", &path, n, || read_checkpoint::<3>(&path).map(|_| ()))?;

    let path = folder.join("a.csv");
    let mut table = TableWriter::create(&path, &[("pressure", "Pa"), ("depth", "m")])?;
    let start = Instant::now();
    for (x, p) in positions.iter().zip(&density).take(100_000) {
        table.row(x[0], &[*p, x[1]])?;
    }
    println!("\n{:.2} µs per table row", start.elapsed().as_secs_f64() * 10.0);
    Ok(())
}

fn report<E>(
    what: &str,
    path: &Path,
    n: u32,
    mut work: impl FnMut() -> Result<(), E>,
) -> Result<(), Box<dyn Error>>
where
    E: Error + 'static,
{
    let mut seconds = f64::INFINITY;
    for _ in 0..3 {
        let start = Instant::now();
        work()?;
        seconds = seconds.min(start.elapsed().as_secs_f64());
    }
    let bytes = fs::metadata(path)?.len() as f64;
    println!("| {what} | {:.0} | {:.1} | {seconds:.2} |", bytes / 1e6, bytes / f64::from(n));
    Ok(())
}
