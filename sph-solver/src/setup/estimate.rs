//! What a run would be and cost.

use super::constants::time_step;
use super::report::{
    BYTES_PER_FLUID_PARTICLE, BYTES_PER_WALL_PARTICLE, CheckReport, PAIRS_PER_CORE_SECOND,
    PASSES_PER_STEP, ParticleCounts, SolidCount,
};
use super::{Setup, lattice_neighbours, memory};
use crate::scene::{ErrorKind, Scene, SceneError};
use sph_geometry::Aabb;

impl<const D: usize> Setup<D> {
    /// What a run of the scene on so many ranks would be and cost. Fails when there are more ranks
    /// than particles.
    pub fn report(&self, scene: &Scene, ranks: usize) -> Result<CheckReport, SceneError> {
        let total = self.particles.len();
        if ranks > total {
            let kind = ErrorKind::TooManyRanks { ranks, particles: total };
            return Err(scene.error_without_place(kind));
        }
        let constants = &self.constants;
        let fluid = self.particles.of_kind(0).len();
        let solids = self.solids.iter().zip(1..).map(|(solid, kind)| SolidCount {
            name: solid.name.clone(),
            kind,
            particles: self.particles.of_kind(kind).len(),
        });
        let solids: Vec<SolidCount> = solids.collect();
        let (step, step_limit) = time_step(constants, self.expected_speed);
        let steps = (*scene.end_time / step).ceil();
        let particle_updates = fluid as f64 * steps;
        let neighbours = lattice_neighbours::<D>(constants.support_radius / constants.spacing);
        let pairs = particle_updates * neighbours as f64 * PASSES_PER_STEP;
        let walls = total - fluid;
        let memory_bytes =
            fluid as f64 * BYTES_PER_FLUID_PARTICLE + walls as f64 * BYTES_PER_WALL_PARTICLE;
        let bounds = Aabb::around(&self.particles.position);
        Ok(CheckReport {
            name: scene.name().into(),
            dimension: D,
            warnings: self.warnings(&solids, memory_bytes),
            particles: ParticleCounts { total, fluid, solids },
            bounding_box: [bounds.min.to_vec(), bounds.max.to_vec()],
            domain: [constants.domain.0.to_vec(), constants.domain.1.to_vec()],
            spacing: constants.spacing,
            smoothing_length: constants.smoothing_length,
            support_radius: constants.support_radius,
            neighbours,
            sound_speed: constants.sound_speed,
            expected_speed: self.expected_speed,
            time_step: step,
            step_limit,
            end_time: *scene.end_time,
            steps: steps as u64,
            particle_updates,
            core_seconds: pairs / PAIRS_PER_CORE_SECOND,
            memory_bytes,
            ranks,
            meshes: self.meshes.clone(),
        })
    }

    fn warnings(&self, solids: &[SolidCount], memory_bytes: f64) -> Vec<String> {
        let mut warnings = Vec::new();
        for solid in solids.iter().filter(|solid| solid.particles == 0) {
            warnings.push(format!(
                "solid {} has no particles: it is thinner than the spacing or out of reach of the \
                 fluid",
                solid.name
            ));
        }
        let mach = self.expected_speed / self.constants.sound_speed;
        if mach > 0.102 {
            warnings.push(format!(
                "the sound speed is only {:.1} times the expected flow speed; below 10 the fluid \
                 is visibly compressible",
                1.0 / mach
            ));
        }
        if let Some(free) = memory::available().filter(|available| memory_bytes > *available) {
            let [needed, free] = [memory_bytes, free].map(memory::gibibytes);
            warnings.push(format!("a run needs about {needed}, and {free} are free here"));
        }
        warnings
    }
}
