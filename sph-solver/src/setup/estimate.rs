//! What a run would be and cost.

use super::constants::{Constants, time_step};
use super::report::{
    Band, CheckReport, PAIRS_PER_CORE_SECOND, PASSES_PER_STEP, ParticleCounts, SnapshotVolume,
    SolidCount, VolumeOfFluid,
};
use super::{Setup, lattice_neighbours};
use crate::run::snapshot_choice::SnapshotChoice;
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
            scheme: self.choice.clone(),
            spacing: constants.spacing,
            bands: self.bands(),
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
            snapshots: snapshots::<D>(scene, fluid, total - fluid),
            ranks,
            meshes: self.meshes.clone(),
        })
    }
}

impl<const D: usize> Setup<D> {
    /// Fluid particles by how often the largest spacing was halved.
    fn bands(&self) -> Vec<Band> {
        let Constants { spacing, grading, .. } = &self.constants;
        let fluid = self.particles.of_kind(0);
        let mut bands = vec![Band { spacing: [*spacing; 2], particles: fluid.len() }];
        let Some(grading) = grading else { return bands };
        bands.clear();
        for mass in &self.particles.mass[fluid] {
            let own = spacing * grading.ratio::<D>(*mass);
            let number = (spacing / own).log2().floor() as usize;
            while bands.len() <= number {
                let most = spacing * 0.5_f64.powi(bands.len() as i32);
                bands.push(Band { spacing: [most, most], particles: 0 });
            }
            let band = &mut bands[number];
            band.spacing[1] = band.spacing[1].min(own);
            band.particles += 1;
        }
        bands
    }
}

/// Bytes of a wall element in a snapshot: its place and its normal, which repeat along a wall.
const WALL_BYTES: f64 = 40.0;

/// What the snapshots of a run take on the disk.
fn snapshots<const D: usize>(scene: &Scene, fluid: usize, walls: usize) -> Option<SnapshotVolume> {
    let interval = scene.output.snapshots.as_deref()?;
    let choice = SnapshotChoice::new(&scene.output);
    // The first state and the last one count too.
    let count = (*scene.end_time / interval).ceil() + 1.0;
    let bytes_per_particle = choice.bytes_per_particle(D);
    let bytes = count * choice.share() * fluid as f64 * bytes_per_particle;
    let bytes = bytes + WALL_BYTES * walls as f64;
    Some(SnapshotVolume { count: count as u64, bytes, bytes_per_particle })
}
