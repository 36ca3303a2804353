//! How much communication stays exposed: a ring of ranks, each sending and receiving megabytes
//! per pass beside some milliseconds of work, with and without polling.
//!
//! ```text
//! cargo run --release --example overlap_cost
//! cargo build --release --features mpi --example overlap_cost
//! mpirun -n 2 target/release/examples/overlap_cost [megabytes] [about so many milliseconds of work]
//! ```

use std::time::Instant;

use sph_decomp::{CommError, Communicator, Halo, HaloPlan};

/// One kind of pass.
#[derive(Clone, Copy)]
enum Work {
    /// All work is done before the messages leave: nothing is hidden.
    First,
    /// Work and messages overlap; the work polls so many times.
    Polling(u32),
}

/// A piece of work that takes about one microsecond on a quiet core. It is counted, not timed, so
/// that time lost to other programs does not make it shorter.
fn microseconds(count: f64) {
    let mut x = 1.0_f64;
    for _ in 0..(count * 350.0) as u64 {
        x = std::hint::black_box(x * 1.000_000_1);
    }
}

fn measure<C: Communicator>(comm: &C, megabytes: f64, work: f64) -> Result<(), CommError> {
    let count = (megabytes * 1e6 / 8.0) as u32;
    let other = (comm.rank() + 1) % comm.size();
    let plan = HaloPlan::new(comm, vec![(other, (0..count).collect())])?;
    let values: Vec<f64> = (0..count).map(f64::from).collect();
    let mut halo = Halo::<f64>::new();
    for (name, kind) in [
        ("no overlap", Work::First),
        ("overlap, no polling", Work::Polling(0)),
        ("overlap, 1 poll", Work::Polling(1)),
        ("overlap, 4 polls", Work::Polling(4)),
        ("overlap, 20 polls", Work::Polling(20)),
        ("overlap, 100 polls", Work::Polling(100)),
    ] {
        let mut waits = Vec::new();
        let mut passes = Vec::new();
        for _ in 0..25 {
            // Start together, so that a slow rank is not taken for slow messages.
            comm.max_f64(&mut [0.0])?;
            let start = Instant::now();
            let mut time_step = [0.0];
            let (_, exposed) = halo.exchange(
                comm,
                &plan,
                &mut time_step,
                |send| {
                    if matches!(kind, Work::First) {
                        microseconds(work);
                    }
                    plan.pack(send, |i| values[i as usize]);
                },
                |progress| match kind {
                    Work::First => (),
                    Work::Polling(polls) => {
                        for _ in 0..polls {
                            microseconds(work / f64::from(polls + 1));
                            progress.poll();
                        }
                        microseconds(work / f64::from(polls + 1));
                    }
                },
            )?;
            waits.push(exposed.wait_seconds * 1e3);
            passes.push(start.elapsed().as_secs_f64() * 1e3);
        }
        let median = |values: &mut Vec<f64>| {
            values.sort_by(f64::total_cmp);
            values[values.len() / 2]
        };
        let mut slowest = [median(&mut waits), median(&mut passes)];
        comm.max_f64(&mut slowest)?;
        if comm.rank() == 0 {
            println!("{name:20} exposed {:8.4} ms, pass {:8.3} ms", slowest[0], slowest[1]);
        }
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let argument = |k: usize, default: f64| match std::env::args().nth(k) {
        Some(text) => text.parse::<f64>(),
        None => Ok(default),
    };
    let megabytes = argument(1, 2.0)?;
    let work = argument(2, 20.0)? * 1e3;
    #[cfg(feature = "mpi")]
    sph_decomp::Mpi::run(|comm| measure(comm, megabytes, work))?;
    #[cfg(not(feature = "mpi"))]
    sph_decomp::ThreadRanks::run(2, |comm| measure(&comm, megabytes, work))?;
    Ok(())
}
