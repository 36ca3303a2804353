//! One size of the scene on several numbers of ranks.

use crate::Outcome;
use sph_decomp::scale::{Layout, Network, Prediction, RankLoad, Rates, Variant};
use sph_solver::partition::{Costs, Field, spacing_for};
use sph_solver::scene::Scene;
use std::path::{Path, PathBuf};

/// The scene of the study.
pub fn scene_path() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/dam-break-3d.toml")
}

/// The scene with about so many fluid particles.
pub fn scene_of(particles: f64) -> Outcome<Scene> {
    let scene = Scene::read(&scene_path(), &[])?;
    let spacing = spacing_for::<3>(&scene, particles)?;
    Ok(Scene::read(&scene_path(), &[format!("numerics.spacing={spacing}")])?)
}

/// A size.
pub struct Case {
    field: Field<3>,
}

/// Efficiencies over one rank.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Efficiencies {
    /// What the program does.
    pub overlapped: f64,
    /// Messages are waited for.
    pub blocking: f64,
    /// Overlapped, with walls computed by every rank that needs them.
    pub repeated: f64,
    /// Blocking and repeated.
    pub neither: f64,
    /// Shares of the overlapped step: waiting in passes, packing and message overhead, and messages
    /// of rebuilds.
    pub exposed: f64,
    pub packing: f64,
    pub rebuilds: f64,
}

/// One number of ranks.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    pub ranks: usize,
    per_rank: f64,
    inner: f64,
    outer: f64,
    neighbours: f64,
    imbalance: f64,
    pub fast: Efficiencies,
    pub slow: Efficiencies,
}

impl Case {
    pub fn new(particles: f64) -> Outcome<Self> {
        // Blocks agree with the particles themselves, and are there in seconds.
        let field = Field::<3>::read(&scene_of(particles)?, Costs::Lists, true)?;
        Ok(Self { field })
    }

    pub fn row(&mut self, ranks: usize, rates: [&Rates; 2], net: &Network) -> Outcome<Row> {
        let layout = self.field.layout(ranks)?;
        let mean = |number: &dyn Fn(&RankLoad) -> f64| layout.sum(number) / ranks as f64;
        let [fast, slow] = rates.map(|rates| efficiencies(&layout, rates, net));
        Ok(Row {
            ranks,
            per_rank: mean(&RankLoad::active),
            inner: mean(&|rank| rank.inner),
            outer: mean(&|rank| rank.outer),
            neighbours: mean(&|rank| f64::from(rank.messages_out)),
            imbalance: layout.imbalance(RankLoad::pairs).ratio(),
            fast,
            slow,
        })
    }
}

fn efficiencies(layout: &Layout, rates: &Rates, net: &Network) -> Efficiencies {
    let of = |overlap, repeats_walls| {
        Prediction::of(layout, rates, net, Variant { overlap, repeats_walls })
    };
    let best = of(true, false);
    Efficiencies {
        overlapped: best.efficiency(),
        blocking: of(false, false).efficiency(),
        repeated: of(true, true).efficiency(),
        neither: of(false, true).efficiency(),
        exposed: best.exposed(),
        packing: best.slowest.messages / best.step,
        rebuilds: best.slowest.rebuild_messages / best.step,
    }
}

impl Row {
    pub fn print_head() {
        println!(
            "| fluid | ranks | fluid per rank | inner | outer | neighbours | imbalance | fast: overlapped | \
             exposed | packing | rebuilds | blocking | walls repeated | both | slow: overlapped | \
             blocking | both |"
        );
        println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    }

    pub fn print(&self) {
        let percent = |share: f64| format!("{:.1} %", 100.0 * share);
        let (fast, slow) = (&self.fast, &self.slow);
        println!(
            "| {:.1e} | {} | {:.0} | {:.0} | {:.0} | {:.1} | {:.3} | {} | {} | {} | {} | {} | {} | {} | {} | {} \
             | {} |",
            self.per_rank * self.ranks as f64,
            self.ranks,
            self.per_rank,
            self.inner,
            self.outer,
            self.neighbours,
            self.imbalance,
            percent(fast.overlapped),
            percent(fast.exposed),
            percent(fast.packing),
            percent(fast.rebuilds),
            percent(fast.blocking),
            percent(fast.repeated),
            percent(fast.neither),
            percent(slow.overlapped),
            percent(slow.blocking),
            percent(slow.neither),
        );
    }
}
