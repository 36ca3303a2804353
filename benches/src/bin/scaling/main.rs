//! Figures 1 and 2 of Oger, Guibert, de Leffe and Piccinali, *Parallelization of a 3-D SPH code for
//! massive HPC simulations*, as the model of `sph partition` predicts them for this program: strong
//! and weak scaling up to 32 768 ranks. Then the model beside real runs on 1 to 8 ranks.
//!
//! `cargo run --release -p sph-benches --bin scaling -- [--svg FILE] [--pair-rate R] [--pack-rate R]
//! [--skip-runs]`, some minutes on one core. Prints Markdown tables.

mod runs;
mod series;

use clap::Parser;
use series::{Case, Row};
use sph_benches::plot::{Plot, Series, side_by_side};
use sph_decomp::scale::{Rates, Rebuilds, measure_pack_rate};
use sph_solver::partition::network;
use std::error::Error;
use std::path::PathBuf;

type Outcome<T> = Result<T, Box<dyn Error>>;

/// Predicts the paper's scaling figures for this program.
#[derive(Debug, Parser)]
struct Arguments {
    /// Write the plots to this file
    #[arg(long)]
    svg: Option<PathBuf>,
    /// Network
    #[arg(long, default_value = "gemini")]
    network: String,
    /// List entries that a core evaluates per second; the default is about what the sweeps of a dam
    /// break do on a present core
    #[arg(long, default_value_t = 1.2e9)]
    pair_rate: f64,
    /// Message elements that a core packs per second [default: measured]
    #[arg(long)]
    pack_rate: Option<f64>,
    /// Only predict, run nothing
    #[arg(long)]
    skip_runs: bool,
    /// Only run, predict no large cases
    #[arg(long)]
    only_runs: bool,
}

/// A core that evaluates pairs as the codes of 2013 did: what DualSPHysics does on a present one.
const SLOW_PAIRS: f64 = 2.0e7;

fn main() -> Outcome<()> {
    let arguments = Arguments::parse();
    if !arguments.only_runs {
        figures(&arguments)?;
    }
    if !arguments.skip_runs {
        runs::compare()?;
    }
    Ok(())
}

fn figures(arguments: &Arguments) -> Outcome<()> {
    let packs = match arguments.pack_rate {
        Some(rate) => rate,
        None => measure_pack_rate()?,
    };
    let fast = Rates {
        pairs: arguments.pair_rate,
        packs,
        element_bytes: [12.0, 24.0],
        rebuilds: Rebuilds { share: 0.3, steps: 5.0, per_partition: 20.0 },
    };
    let slow = Rates { pairs: SLOW_PAIRS, ..fast };
    let net = network(&arguments.network)?.parameters();
    println!(
        "Network {}; fast: {:.0} M pairs/s and core, slow: {:.0} M; {:.0} M packs/s; 30 % of the \
         computing in rebuilds, one every 5 steps, a partition every 100.\n",
        arguments.network,
        1e-6 * fast.pairs,
        1e-6 * slow.pairs,
        1e-6 * fast.packs
    );
    println!("### Strong scaling (Figure 1)\n");
    Row::print_head();
    let mut strong = Vec::new();
    for (particles, ranks) in [
        (1e7, &[8, 32, 128, 256][..]),
        (1e8, &[256, 1024, 4096, 16384, 32768]),
        (1e9, &[4096, 8192, 16384, 32768]),
    ] {
        let mut case = Case::new(particles)?;
        let rows: Result<Vec<Row>, _> =
            ranks.iter().map(|&ranks| case.row(ranks, [&fast, &slow], &net)).collect();
        let rows = rows?;
        rows.iter().for_each(Row::print);
        strong.push((particles, rows));
    }
    println!("\n### Weak scaling, 100 000 particles per rank (Figure 2)\n");
    Row::print_head();
    let mut weak = Vec::new();
    for ranks in [1, 8, 64, 512, 4096, 32768] {
        let row = Case::new(1e5 * ranks as f64)?.row(ranks, [&fast, &slow], &net)?;
        row.print();
        weak.push(row);
    }
    relative(&weak);
    if let Some(path) = &arguments.svg {
        let command = format!(
            "cargo run --release -p sph-benches --bin scaling, network {}, {:.2e} pairs/s, {:.2e} packs/s",
            arguments.network, fast.pairs, fast.packs
        );
        std::fs::write(path, side_by_side(&[strong_plot(&strong), weak_plot(&weak)], &command))?;
        println!("\nplots in {}", path.display());
    }
    Ok(())
}

/// Weak efficiency with respect to the smaller runs of the series.
fn relative(weak: &[Row]) {
    let Some(last) = weak.last() else { return };
    println!(
        "\n| from … ranks to {} | fast overlapped | fast blocking | slow overlapped | slow blocking |",
        last.ranks
    );
    println!("|---|---|---|---|---|");
    for row in &weak[..weak.len() - 1] {
        let share = |now: f64, then: f64| format!("{:.1} %", 100.0 * now / then);
        println!(
            "| {} | {} | {} | {} | {} |",
            row.ranks,
            share(last.fast.overlapped, row.fast.overlapped),
            share(last.fast.blocking, row.fast.blocking),
            share(last.slow.overlapped, row.slow.overlapped),
            share(last.slow.blocking, row.slow.blocking),
        );
    }
    println!("\nThe paper states about 95 %.");
}

const COLORS: [&str; 3] = ["#1f77b4", "#2ca02c", "#d62728"];

fn strong_plot(strong: &[(f64, Vec<Row>)]) -> Plot {
    let ends = (8.0, 32768.0);
    let mut series = vec![Series {
        name: "ideal".into(),
        color: "#999",
        dashed: false,
        points: vec![(ends.0, ends.0), (ends.1, ends.1)],
    }];
    for ((particles, rows), color) in strong.iter().zip(COLORS) {
        let points = |efficiency: &dyn Fn(&Row) -> f64| -> Vec<(f64, f64)> {
            let point = |row: &Row| (row.ranks as f64, row.ranks as f64 * efficiency(row));
            rows.iter().map(point).collect()
        };
        let name = |what: &str| format!("10^{:.0} particles, {what}", particles.log10());
        series.push(Series {
            name: name("overlapped"),
            color,
            dashed: false,
            points: points(&|row| row.fast.overlapped),
        });
        series.push(Series {
            name: name("blocking, walls repeated"),
            color,
            dashed: true,
            points: points(&|row| row.fast.neither),
        });
    }
    series.push(Series {
        name: "paper: 10^8 saturates from here".into(),
        color: "#777",
        dashed: true,
        points: vec![(16384.0, ends.0), (16384.0, ends.1)],
    });
    Plot {
        title: "Strong scaling (predicted)".into(),
        x_name: "ranks",
        y_name: "speedup over one rank",
        log_y: true,
        x: ends,
        y: ends,
        series,
    }
}

fn weak_plot(weak: &[Row]) -> Plot {
    let line = |name: &str, color, dashed, efficiency: &dyn Fn(&Row) -> f64| Series {
        name: name.into(),
        color,
        dashed,
        points: weak.iter().map(|row| (row.ranks as f64, 100.0 * efficiency(row))).collect(),
    };
    Plot {
        title: "Weak scaling, 100 000 particles per rank (predicted)".into(),
        x_name: "ranks",
        y_name: "efficiency over one rank, %",
        log_y: false,
        x: (1.0, 32768.0),
        // With room for the legend above 100 %.
        y: (85.0, 110.0),
        series: vec![
            line("overlapped", COLORS[0], false, &|row| row.fast.overlapped),
            line("blocking, walls repeated", COLORS[0], true, &|row| row.fast.neither),
            line("core of 2013, overlapped", COLORS[1], false, &|row| row.slow.overlapped),
            line("core of 2013, blocking, walls repeated", COLORS[1], true, &|row| {
                row.slow.neither
            }),
            line("paper: about 95 %", "#777", true, &|_| 0.95),
        ],
    }
}
