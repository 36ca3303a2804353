//! `sph partition`: divides a scene among ranks and runs nothing.

use super::{BAD_INPUT, FAILED, SceneArguments, count, diagnostics};
use crate::partition::{
    Costs, PartitionReport, Study, StudyError, element_bytes, measure_rates, network, spacing_for,
};
use crate::scene::{ErrorKind, Scene, SceneError};
use clap::Args;
use sph_decomp::scale::{Rates, Rebuilds, ScaleError, measure_pack_rate};
use std::io::Write;
use std::process::ExitCode;

#[derive(Debug, Args)]
pub struct PartitionArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Numbers of ranks, for example 8,64,512,4096,32768
    #[arg(long, value_name = "P[,P...]", value_delimiter = ',', value_parser = ranks, required = true)]
    pub ranks: Vec<usize>,
    /// Report as JSON
    #[arg(long)]
    json: bool,
    /// Fluid particles: sets numerics.spacing so that there are about so many, for example 1e9
    #[arg(long, value_name = "N", value_parser = positive)]
    particles: Option<f64>,
    /// Sample by blocks of the lattice although all particles would fit (beyond 12 million always)
    #[arg(long)]
    sample: bool,
    /// Weigh by list lengths, as a run does from its first step on, or all fluid alike, as before it
    /// has lists
    #[arg(long, value_enum, default_value = "lists")]
    costs: Costs,
    /// gemini, slingshot, infiniband, or a TOML file with latency, overhead, gap, node_bandwidth and
    /// ranks_per_node
    #[arg(long, value_name = "NAME|FILE", default_value = "infiniband")]
    network: String,
    /// List entries that a core evaluates per second, or measured by a short run of the scene
    #[arg(long, value_name = "RATE", value_parser = rate, default_value = "measured")]
    pair_rate: Rate,
    /// Message elements that a core packs per second, or measured
    #[arg(long, value_name = "RATE", value_parser = rate, default_value = "measured")]
    pack_rate: Rate,
    /// Share of list rebuilds in the computing of a rank [default: measured with the pair rate, or 0.3]
    #[arg(long, value_name = "SHARE", value_parser = share)]
    rebuild_share: Option<f64>,
    /// Steps between two rebuilds [default: measured with the pair rate, or 5]
    #[arg(long, value_name = "N", value_parser = positive)]
    steps_per_rebuild: Option<f64>,
}

/// A number, or to be measured.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Rate {
    Measured,
    Given(f64),
}

/// What a run of violent flow shows when nothing is measured.
const REBUILD_SHARE: f64 = 0.3;
const STEPS_PER_REBUILD: f64 = 5.0;
/// Rebuilds between two partitions of a run.
const REBUILDS_PER_PARTITION: f64 = 20.0;
/// More ranks than any machine has; a typing error.
const MOST_RANKS: usize = 1 << 24;

pub fn main(arguments: &PartitionArguments) -> ExitCode {
    let report = match study(arguments) {
        Ok(report) => report,
        Err(StudyError::Scene(error)) => {
            diagnostics::show_scene_error(&error);
            return ExitCode::from(BAD_INPUT);
        }
        Err(StudyError::Scale(ScaleError::TooManyRanks { ranks, particles })) => {
            // The words of `sph run` and `sph check`.
            let kind = ErrorKind::TooManyRanks { ranks, particles: particles as usize };
            diagnostics::show_scene_error(&SceneError::new(kind, None, Default::default()));
            return ExitCode::from(BAD_INPUT);
        }
        Err(error) => {
            diagnostics::show_plain(&error);
            let failed = matches!(error, StudyError::Measurement(_) | StudyError::Packing(_));
            return ExitCode::from(if failed { FAILED } else { BAD_INPUT });
        }
    };
    let text = if arguments.json {
        serde_json::to_string_pretty(&report).unwrap_or_default() + "\n"
    } else {
        report.to_string()
    };
    // A reader that has seen enough, such as `head`, is no reason to complain.
    let _ = std::io::stdout().write_all(text.as_bytes());
    ExitCode::SUCCESS
}

fn study(arguments: &PartitionArguments) -> Result<PartitionReport, StudyError> {
    let network = network(&arguments.network)?;
    let scene = read(arguments)?;
    let rates = rates(arguments, &scene)?;
    let study = Study {
        ranks: arguments.ranks.clone(),
        costs: arguments.costs,
        sample: arguments.sample,
        network,
        rates,
    };
    PartitionReport::new(&scene, &study)
}

/// The scene at the spacing that gives the wanted number of particles.
fn read(arguments: &PartitionArguments) -> Result<Scene, SceneError> {
    let scene = arguments.scene.read()?;
    let Some(particles) = arguments.particles else { return Ok(scene) };
    let spacing = match scene.dimension() {
        2 => spacing_for::<2>(&scene, particles)?,
        _ => spacing_for::<3>(&scene, particles)?,
    };
    let mut overrides = arguments.scene.overrides.clone();
    overrides.push(format!("numerics.spacing={spacing}"));
    Scene::read(&arguments.scene.scene, &overrides)
}

fn rates(arguments: &PartitionArguments, scene: &Scene) -> Result<Rates, StudyError> {
    let (pairs, share, steps) = match arguments.pair_rate {
        Rate::Given(rate) => (rate, REBUILD_SHARE, STEPS_PER_REBUILD),
        Rate::Measured => {
            let measured = measure_rates(&arguments.scene.scene, &arguments.scene.overrides)?;
            (measured.pairs, measured.rebuild_share, measured.steps_per_rebuild)
        }
    };
    let packs = match arguments.pack_rate {
        Rate::Given(rate) => rate,
        Rate::Measured => measure_pack_rate()?,
    };
    let rebuilds = Rebuilds {
        share: arguments.rebuild_share.unwrap_or(share),
        steps: arguments.steps_per_rebuild.unwrap_or(steps),
        per_partition: REBUILDS_PER_PARTITION,
    };
    Ok(Rates { pairs, packs, element_bytes: element_bytes(scene), rebuilds })
}

fn ranks(text: &str) -> Result<usize, String> {
    match count(text)? {
        count if count <= MOST_RANKS => Ok(count),
        count => Err(format!("{count} is more than the {MOST_RANKS} that are looked at")),
    }
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number > 0.0 && number.is_finite() => Ok(number),
        _ => Err("give a positive number, for example 1e9".into()),
    }
}

fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(share) if (0.0..1.0).contains(&share) => Ok(share),
        _ => Err("give a share from 0 to below 1, for example 0.3".into()),
    }
}

fn rate(text: &str) -> Result<Rate, String> {
    match positive(text) {
        Ok(rate) => Ok(Rate::Given(rate)),
        Err(_) if text == "measured" => Ok(Rate::Measured),
        Err(_) => Err("give a number per second, for example 5e8, or the word measured".into()),
    }
}
