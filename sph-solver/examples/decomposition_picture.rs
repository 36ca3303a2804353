//! Draws how ranks divide the fluid of a snapshot in the plane, as an SVG:
//!
//! ```text
//! cargo run --release -p sph-solver --example decomposition_picture -- \
//!     SNAPSHOT.vtu RANKS SPACING [SHOWN] > picture.svg
//! ```
//!
//! Who owns what and who needs what is found by the code of a run (`rank/rebuild.rs`): tilted bisection weighed by
//! the length of the lists, then the overlap zone of support + skin. Particles have the colour of their rank.
//! With SHOWN, only what that rank knows is drawn: its local, its inner and its outer particles.

use sph_decomp::{
    Askew, Columns, Communicator, Halo, MaxReach, Orb, Partition, Reach, ThreadRanks, Zone,
    ZoneOptions, migrate,
};
use sph_neighbors::{CellList, Grid, NeighborList};
use std::fmt::Write;

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Support and skin of the usual scene, in spacings.
const REACH: f64 = 3.0 * 1.15;

const COLOURS: [&str; 8] =
    ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#777777", "#b8a600"];

/// What one rank holds.
struct Piece {
    local: Vec<[f64; 2]>,
    inner: Vec<[f64; 2]>,
    outer: Vec<[f64; 2]>,
}

/// The pieces of all ranks.
fn divide(points: &[[f64; 2]], ranks: usize, reach: f64) -> Result<Vec<Piece>, Failure> {
    let ids: Vec<u64> = (0..points.len() as u64).collect();
    let cells = CellList::build(&Grid::new([0.0; 2], reach)?, points, &ids);
    let lists = NeighborList::build(&cells, points, |target| target as u32, reach, 1);
    let pieces = ThreadRanks::run(ranks, |comm| {
        // Rank 0 has read the snapshot.
        let mut positions = if comm.rank() == 0 { points.to_vec() } else { Vec::new() };
        let weights: Vec<f64> = (0..positions.len()).map(|i| lists.count(i) as f64).collect();
        let orb = Askew::new(Orb::build(&comm, &Askew::view(&positions), &weights)?);
        migrate(&comm, &orb.owners(&positions), &mut positions)?;
        let options = ZoneOptions::default();
        let zone = Zone::build(&comm, &positions, Reach::Uniform(reach), MaxReach, &options)?;
        let plan = zone.into_plan(&comm)?;
        let outer = Halo::new().exchange_now(&comm, &plan, |i| positions[i as usize])?.to_vec();
        let is_inner = plan.is_inner(positions.len());
        let part = |inner: bool| {
            let index: Vec<u32> =
                (0..positions.len() as u32).filter(|&i| is_inner[i as usize] == inner).collect();
            let mut part = positions.clone();
            part.permute(&index);
            part
        };
        Ok::<_, Failure>(Piece { local: part(false), inner: part(true), outer })
    });
    Ok(pieces.map_err(|error| error.to_string())?)
}

/// Points as round dots of one colour.
fn dots(
    svg: &mut String,
    points: &[[f64; 2]],
    colour: &str,
    place: impl Fn(&[f64; 2]) -> [f64; 2],
) {
    let mut path = String::new();
    for point in points {
        let [x, y] = place(point);
        // Writing to a string does not fail.
        let _ = write!(path, "M{x:.0} {y:.0}h0");
    }
    let _ = writeln!(svg, "<path stroke=\"{colour}\" d=\"{path}\"/>");
}

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, ranks, spacing, shown @ ..] = &arguments[..] else {
        return Err("give a snapshot, the number of ranks and the spacing".into());
    };
    let (ranks, spacing): (usize, f64) = (ranks.parse()?, spacing.parse()?);
    let shown = shown.first().map(|rank| rank.parse::<usize>()).transpose()?;
    let points: Vec<[f64; 2]> =
        sph_io::read_vtu(file)?.positions.iter().map(|&[x, y, _]| [x, y]).collect();
    let pieces = divide(&points, ranks, REACH * spacing)?;

    let end = |axis: usize, pick: fn(f64, f64) -> f64, from: f64| {
        points.iter().map(|point| point[axis]).fold(from, pick)
    };
    let low = [0, 1].map(|axis| end(axis, f64::min, f64::INFINITY) - spacing);
    let high = [0, 1].map(|axis| end(axis, f64::max, f64::NEG_INFINITY) + spacing);
    // Ten units per spacing.
    let unit = 10.0 / spacing;
    let place = |point: &[f64; 2]| [(point[0] - low[0]) * unit, (high[1] - point[1]) * unit];
    let [width, height] = [0, 1].map(|axis| (high[axis] - low[axis]) * unit);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" \
         width=\"760\" stroke-width=\"10\" stroke-linecap=\"round\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
    );
    match shown {
        None => {
            for (rank, piece) in pieces.iter().enumerate() {
                let colour = COLOURS[rank % COLOURS.len()];
                dots(&mut svg, &piece.local, colour, place);
                dots(&mut svg, &piece.inner, colour, place);
            }
        }
        Some(rank) => {
            let own = pieces.get(rank).ok_or("there is no such rank")?;
            for piece in &pieces {
                dots(&mut svg, &piece.local, "#e8e8e8", place);
                dots(&mut svg, &piece.inner, "#e8e8e8", place);
            }
            dots(&mut svg, &own.outer, "#d55e00", place);
            dots(&mut svg, &own.local, "#9cc9e6", place);
            dots(&mut svg, &own.inner, "#0072b2", place);
        }
    }
    for (rank, piece) in pieces.iter().enumerate() {
        let [local, inner, outer] = [&piece.local, &piece.inner, &piece.outer].map(Vec::len);
        eprintln!("rank {rank}: {local} local, {inner} inner, {outer} outer");
    }
    println!("{svg}</svg>");
    Ok(())
}
