//! What the overlap zone of a cube of particles costs: particles sent, how many of them needlessly,
//! and the time to build it, for several sizes of block.
//!
//! `cargo run --release --example zone_report -- [particles per side] [ranks]`

use std::time::Instant;

use sph_decomp::{
    Columns, Communicator, MeanReach, Orb, Partition, Reach, ThreadRanks, Zone, ZoneOptions,
    migrate,
};

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// A jittered lattice with spacing 1; each particle sees three spacings far.
fn cube(side: usize) -> Vec<[f64; 3]> {
    let noise = |n: usize| ((n as f64 * 12.9898).sin() * 43758.5453).fract() * 0.4;
    let number = 0..side.pow(3);
    let x = |n: usize, axis: u32| (n / side.pow(axis) % side) as f64 + noise(3 * n + axis as usize);
    number.map(|n| [x(n, 0), x(n, 1), x(n, 2)]).collect()
}

/// Particles sent and bytes of summaries of all ranks, and the time of the slowest.
fn zones(side: usize, ranks: usize, block: usize) -> Result<(u64, u64, f64), Failure> {
    let report = ThreadRanks::run(ranks, |comm| {
        let mut positions = if comm.rank() == 0 { cube(side) } else { vec![] };
        let orb = Orb::build(&comm, &positions, &[])?;
        migrate(&comm, &orb.owners(&positions), &mut positions)?;
        let mut order: Vec<u32> = (0..positions.len() as u32).collect();
        order.sort_by_key(|&i| positions[i as usize].map(|x| (x / 3.0) as i64));
        positions.permute(&order);
        let options = ZoneOptions { block, ..Default::default() };
        let start = Instant::now();
        let zone = Zone::build(&comm, &positions, Reach::Uniform(3.0), MeanReach, &options)?;
        let mut time = [start.elapsed().as_secs_f64()];
        let sent: usize = zone.sends().iter().map(|(_, particles)| particles.len()).sum();
        let mut sums = [sent as u64, zone.summary_bytes];
        comm.sum_u64(&mut sums)?;
        comm.max_f64(&mut time)?;
        Ok::<_, Failure>((sums[0], sums[1], time[0]))
    });
    Ok(report.map_err(|e| e.to_string())?[0])
}

fn main() -> Result<(), Failure> {
    let argument = |k: usize, default: usize| match std::env::args().nth(k) {
        Some(text) => text.parse(),
        None => Ok(default),
    };
    let (side, ranks) = (argument(1, 40)?, argument(2, 2)?);
    println!("{} particles on {ranks} ranks", side.pow(3));
    // Blocks of one particle send exactly what is needed.
    let exact = zones(side, ranks, 1)?.0;
    for block in [1, 2, 4, 8, 16, 32] {
        let (sent, bytes, time) = zones(side, ranks, block)?;
        println!(
            "blocks of {block:2}: {sent} sent, {:.4} of what is needed, {bytes} bytes of summaries, {:.1} ms",
            sent as f64 / exact as f64,
            time * 1e3,
        );
    }
    Ok(())
}
