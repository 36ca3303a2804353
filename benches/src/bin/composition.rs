//! What composing terms costs, to be counted and not timed: run under callgrind by
//! `composition.sh`, which compares the instructions of the solver's sweep with absent terms and of
//! the same sums written out by hand.
//!
//! `composition WHAT PASSES [PARTICLES]` runs the sweep so many times; the difference between two
//! numbers of passes is free of set-up. WHAT is one of
//! `density`, `density-by-hand`, `force`, `force-by-hand`, and `force-viscous`, which shows that a
//! term that is present does count.
#![forbid(unsafe_code)]

use sph_benches::{SweepCase, by_hand, density_terms, force_terms, inviscid_force_terms};
use std::error::Error;
use std::hint::black_box;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let what = arguments.first().ok_or("say what to run, such as `density`")?;
    let passes: u32 = arguments.get(1).ok_or("say how many passes to run")?.parse()?;
    let particles = arguments.get(2).map_or(Ok(8000), |n| n.parse())?;
    let case = SweepCase::<f32>::new(particles, 2.63, 0.0);
    let radius = case.scale.support_radius;
    let terms = density_terms(radius);
    let (strength, gradient) = (terms.strength, terms.hydrostatic_gradient);
    let pass = || match what.as_str() {
        "density" => drop(black_box(case.density_rates(terms))),
        "density-by-hand" => drop(black_box(by_hand::density_rates(&case, strength, gradient))),
        "force" => drop(black_box(case.accelerations(inviscid_force_terms()))),
        "force-by-hand" => drop(black_box(by_hand::accelerations(&case))),
        "force-viscous" => drop(black_box(case.accelerations(force_terms(radius)))),
        other => panic!("no sweep is called {other}"),
    };
    (0..passes).for_each(|_| pass());
    println!("{} {} {}", case.len(), case.list.pairs(), passes);
    Ok(())
}
