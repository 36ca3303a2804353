//! The report as a table for people.

use super::report::{Division, PartitionReport};
use crate::partition::Costs;
use crate::setup::grouped;
use std::fmt;

impl fmt::Display for PartitionReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{:<12} {} ({} dimensions)", "scene", self.name, self.dimension)?;
        let (fluid, walls) = (grouped(self.fluid as f64), grouped(self.walls as f64));
        let how = match self.sampled_by_blocks_of {
            Some(side) => format!(", sampled by blocks of {side}^{}", self.dimension),
            None => String::new(),
        };
        let spacing = format!("spacing {:.4e} m", self.spacing);
        writeln!(f, "{:<12} {fluid} fluid, {walls} wall, {spacing}{how}", "particles")?;
        let weighed = match self.costs {
            Costs::First => "all fluid alike, as before there are lists",
            Costs::Lists => "by list lengths",
        };
        writeln!(f, "{:<12} {weighed}", "weighed")?;
        let net = &self.network;
        writeln!(
            f,
            "{:<12} {}: L {:.2} us, o {:.2} us, g {:.2} us, {:.1} GB/s for {} ranks of a node",
            "network",
            net.name,
            1e6 * net.latency,
            1e6 * net.overhead,
            1e6 * net.gap,
            1e-9 * net.node_bandwidth,
            net.ranks_per_node,
        )?;
        writeln!(
            f,
            "{:<12} {:.0} M pairs/s, {:.0} M packs/s, {:.0} % in rebuilds every {:.1} steps",
            "core",
            1e-6 * self.pairs_per_second,
            1e-6 * self.packs_per_second,
            100.0 * self.rebuild_share,
            self.steps_per_rebuild,
        )?;
        writeln!(f, "\nFluid particles and messages per rank, mean (largest):\n")?;
        writeln!(
            f,
            "{:>8} {:>20} {:>20} {:>20} {:>11} {:>19} {:>9}",
            "ranks", "local", "inner", "outer", "neighbours", "kB in two passes", "imbalance"
        )?;
        for one in &self.partitions {
            one.counts(f)?;
        }
        writeln!(f, "\nPredicted step and efficiency (one rank computing all = 100 %):\n")?;
        writeln!(
            f,
            "{:>8} {:>12} {:>9} {:>10} {:>9} {:>14} {:>14}",
            "ranks", "step, ms", "exposed", "efficient", "blocking", "walls repeated", "both"
        )?;
        for one in &self.partitions {
            one.times(f)?;
        }
        Ok(())
    }
}

impl Division {
    fn counts(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let pair = |mean: f64, max: f64| format!("{} ({})", grouped(mean), grouped(max));
        let [density, force] = [self.density_pass_bytes, self.force_pass_bytes];
        writeln!(
            f,
            "{:>8} {:>20} {:>20} {:>20} {:>11} {:>19} {:>9.3}",
            self.ranks,
            pair(self.local.mean, self.local.max),
            pair(self.inner.mean, self.inner.max),
            pair(self.outer.mean, self.outer.max),
            format!("{:.1} ({})", self.neighbours.mean, self.neighbours.max),
            format!(
                "{:.1} ({:.1})",
                1e-3 * (density.mean + force.mean),
                1e-3 * (density.max + force.max)
            ),
            self.pair_imbalance,
        )
    }

    fn times(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |share: f64| format!("{:.1} %", 100.0 * share);
        let best = &self.overlapped;
        writeln!(
            f,
            "{:>8} {:>12.4} {:>9} {:>10} {:>9} {:>14} {:>14}",
            self.ranks,
            1e3 * best.step_seconds,
            percent(best.exposed_seconds / best.step_seconds),
            percent(best.efficiency),
            percent(self.blocking.efficiency),
            percent(self.overlapped_repeating_walls.efficiency),
            percent(self.blocking_repeating_walls.efficiency),
        )
    }
}
