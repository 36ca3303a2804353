//! `sph check`: reads everything and runs nothing.

use super::{BAD_INPUT, FAILED, SceneArguments, count, diagnostics};
use crate::scene::{Scene, SceneError};
use crate::setup::{CheckReport, Particles, Setup};
use clap::Args;
use sph_io::{IoError, ParticleFrame, write_vtu};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Debug, Args)]
pub struct CheckArguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// Number of ranks that the run is meant for
    #[arg(long, value_parser = count, default_value = "1")]
    ranks: usize,
    /// Report as JSON
    #[arg(long)]
    json: bool,
    /// Write the particles that would run as a .vtu file
    #[arg(long, value_name = "FILE")]
    write: Option<PathBuf>,
}

/// Why a check fails.
enum Failure {
    Scene(SceneError),
    File(IoError),
}

pub fn main(arguments: &CheckArguments) -> ExitCode {
    let checked =
        arguments.scene.read().map_err(Failure::Scene).and_then(|scene| match scene.dimension() {
            2 => check::<2>(&scene, arguments),
            _ => check::<3>(&scene, arguments),
        });
    let report = match checked {
        Ok(report) => report,
        Err(Failure::Scene(error)) => {
            diagnostics::show_scene_error(&error);
            return ExitCode::from(BAD_INPUT);
        }
        Err(Failure::File(error)) => {
            diagnostics::show_plain(&error);
            return ExitCode::from(FAILED);
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

fn check<const D: usize>(
    scene: &Scene,
    arguments: &CheckArguments,
) -> Result<CheckReport, Failure> {
    let setup = Setup::<D>::new(scene).map_err(Failure::Scene)?;
    let report = setup.report(scene, arguments.ranks).map_err(Failure::Scene)?;
    if let Some(path) = &arguments.write {
        write(path, &setup).map_err(Failure::File)?;
    }
    Ok(report)
}

fn write<const D: usize>(path: &Path, setup: &Setup<D>) -> Result<(), IoError> {
    let Particles { position, velocity, density, mass, kind, .. } = &setup.particles;
    let state = &setup.constants.equation_of_state;
    let pressure: Vec<f64> = density.iter().map(|density| state.pressure(*density)).collect();
    let ids: Vec<u64> = (0..position.len() as u64).collect();
    let frame = ParticleFrame::new(0.0, position)
        .with("velocity", velocity)
        .with("pressure", &pressure)
        .with("density", density)
        .with("mass", mass)
        .with("kind", kind)
        .with("id", &ids);
    write_vtu(path, &frame)
}
