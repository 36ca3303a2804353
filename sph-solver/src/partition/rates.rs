//! How fast a core of this machine is, measured by a short run of the scene itself.

use super::error::StudyError;
use super::field::spacing_for;
use crate::error::RunError;
use crate::run::{Existing, RunOptions, World, run};
use crate::scene::{Precision, Scene};
use crate::setup::{Setup, time_step};
use std::path::{Path, PathBuf};

/// Fluid particles and steps of the run: large enough to be out of the first caches, and done within
/// some seconds.
const PARTICLES: f64 = 40_000.0;
const STEPS: f64 = 60.0;

/// Elements of six words that a core of a present machine packs in a second.
pub const PACKS_PER_CORE_SECOND: f64 = 2.0e8;

/// Words of an element in the density pass and in the force pass.
const WORDS: [f64; 2] = [3.0, 6.0];

/// Bytes of an element in the density pass and in the force pass of a scene.
pub fn element_bytes(scene: &Scene) -> [f64; 2] {
    let word = match scene.numerics.precision {
        Precision::Mixed => 4.0,
        Precision::Double => 8.0,
    };
    WORDS.map(|words| words * word)
}

/// What a short run on one core shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredRates {
    /// List entries per second in the passes.
    pub pairs: f64,
    /// Share of the rebuilds in rebuilds and passes.
    pub rebuild_share: f64,
    /// Steps between two rebuilds.
    pub steps_per_rebuild: f64,
}

/// Runs the scene in `path` for some steps with about 40 000 particles on one core. Files go to a
/// temporary folder that is removed again.
///
/// # Errors
///
/// When the scene is wrong or its run fails.
pub fn measure_rates(path: &Path, overrides: &[String]) -> Result<MeasuredRates, StudyError> {
    let scene = Scene::read(path, overrides)?;
    match scene.dimension() {
        2 => measure::<2>(&scene, path, overrides),
        _ => measure::<3>(&scene, path, overrides),
    }
}

fn measure<const D: usize>(
    scene: &Scene,
    path: &Path,
    overrides: &[String],
) -> Result<MeasuredRates, StudyError> {
    let spacing = spacing_for::<D>(scene, PARTICLES)?;
    let mut overrides = overrides.to_vec();
    overrides.push(format!("numerics.spacing={spacing}"));
    let scene = Scene::read(path, &overrides)?;
    let setup = Setup::<D>::new(&scene)?;
    let (step, _) = time_step(&setup.constants, setup.expected_speed);
    drop(setup);
    let folder = Folder(std::env::temp_dir().join(format!("sph-rates-{}", std::process::id())));
    let options = RunOptions {
        out: folder.0.clone(),
        end_time: Some(STEPS * step),
        threads: Some(1),
        existing: Existing::Overwrite,
        ..RunOptions::default()
    };
    let summary = run(&World::Process, &scene, &options, &|_| ()).map_err(|error| match error {
        RunError::Scene(error) => StudyError::Scene(error),
        other => StudyError::Measurement(other),
    })?;
    let phases = summary.phases;
    let passes = phases.density + phases.force;
    Ok(MeasuredRates {
        pairs: summary.pair_interactions_per_second,
        rebuild_share: (phases.rebuild / (phases.rebuild + passes)).clamp(0.0, 0.99),
        steps_per_rebuild: summary.steps_per_rebuild,
    })
}

/// A folder that is removed with this value.
struct Folder(PathBuf);

impl Drop for Folder {
    fn drop(&mut self) {
        // Nothing depends on it, and there is nobody to tell.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
