//! What a run would be and cost.

use super::constants::time_step;
use super::report::{
    CheckReport, PAIRS_PER_CORE_SECOND, PASSES_PER_STEP, ParticleCounts, SolidCount, VolumeOfFluid,
};
use super::{Setup, lattice_neighbours};
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
        let bounds = Aabb::around(&self.particles.position);
        Ok(CheckReport {
            name: scene.name().into(),
            dimension: D,
            notes: self.notes(),
            particles: ParticleCounts { total, fluid, solids },
            bounding_box: [bounds.min.to_vec(), bounds.max.to_vec()],
            domain: [constants.domain.0.to_vec(), constants.domain.1.to_vec()],
            volume: VolumeOfFluid { regions: self.volume_of_regions, particles: self.volume() },
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
            memory_bytes: self.memory_bytes(),
            ranks,
            meshes: self.meshes.clone(),
        })
    }
}
