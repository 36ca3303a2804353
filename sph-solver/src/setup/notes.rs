//! What is allowed in a scene but deserves a look: the same from `sph check` and `sph run`.

use super::{Setup, memory};
use crate::scene::{ProbeKind, Scene, vector};
use sph_geometry::{Aabb, Solid};

/// Particles may hold this much more or less fluid than the regions without a word.
const TOLERATED_VOLUME: f64 = 0.01;

/// A sound speed below this multiple of the expected speed is too low; "auto" gives 10.
const LOWEST_SOUND_SPEED: f64 = 9.8;

impl<const D: usize> Setup<D> {
    /// Notes about the scene.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        for (solid, kind) in self.solids.iter().zip(1..) {
            if self.particles.of_kind(kind).is_empty() {
                notes.push(format!(
                    "solid {} has no particles: it is thinner than the spacing or out of reach of the \
                     fluid",
                    solid.name
                ));
            }
        }
        notes.extend(self.choice.note());
        let ratio = self.constants.sound_speed / self.expected_speed;
        if ratio < LOWEST_SOUND_SPEED {
            notes.push(format!(
                "the sound speed is only {ratio:.1} times the expected flow speed; below 10 the \
                 fluid is visibly compressible"
            ));
        }
        let (asked, courant) = (self.constants.cfl, self.constants.courant());
        if courant < asked {
            notes.push(format!(
                "steps have the Courant number {courant:.3} instead of {asked}: a density diffusion of \
                 {} with an artificial viscosity of {} is noisy or unstable beyond",
                self.constants.density_diffusion, self.constants.artificial_viscosity,
            ));
        }
        notes.extend(self.note_on_volume());
        let needed = self.memory_bytes();
        if let Some(free) = memory::available().filter(|available| needed > *available) {
            let [needed, free] = [needed, free].map(memory::gibibytes);
            notes.push(format!("a run needs about {needed}, and {free} are free here"));
        }
        notes.extend_from_slice(&self.notes_on_geometry);
        notes
    }

    fn note_on_volume(&self) -> Option<String> {
        let (particles, regions) = (self.volume(), self.volume_of_regions);
        let surplus = particles / regions - 1.0;
        let word = if surplus < 0.0 { "less" } else { "more" };
        (surplus.abs() > TOLERATED_VOLUME).then(|| {
            format!(
                "the particles hold {:.1} % {word} fluid than the regions: {particles:.6} instead \
                 of {regions:.6} {}. Sides that are whole multiples of numerics.spacing, {} m, lose \
                 nothing",
                100.0 * surplus.abs(),
                if D == 2 { "m²" } else { "m³" },
                self.constants.spacing,
            )
        })
    }
}

/// Notes on point and patch probes that cannot read, or not at once. A probe reads the fluid within `support`
/// (m) of it.
pub fn on_probes<const D: usize>(
    scene: &Scene,
    domain: &Aabb<D>,
    solids: &[Solid<D>],
    fluid: &[[f64; D]],
    support: f64,
) -> Vec<String> {
    let mut notes = Vec::new();
    let mut dry = Vec::new();
    let reads_fields = |kind| matches!(kind, ProbeKind::Point | ProbeKind::Patch);
    for probe in scene.probe.iter().filter(|probe| reads_fields(probe.kind)) {
        let name = probe.name.as_str();
        let at: [f64; D] = vector(probe.at.as_deref().map_or(&[], Vec::as_slice));
        if !domain.contains(&at) {
            notes.push(format!(
                "probe {name} at {at:?} is outside of the domain, {:?} to {:?}: it reads nothing",
                domain.min, domain.max
            ));
            continue;
        }
        let depth = |solid: &Solid<D>| solid.depth_in_solid(&at);
        let deepest = solids.iter().max_by(|a, b| depth(a).total_cmp(&depth(b)));
        // A sensor in the surface of a wall is as it should be.
        if let Some(solid) = deepest.filter(|solid| depth(solid) > 1e-3 * support) {
            let depth = depth(solid);
            let reads = if depth < support {
                "it reads the fluid in front of the wall"
            } else {
                "it reads nothing"
            };
            notes.push(format!(
                "probe {name} at {at:?} is {depth:.4} m inside solid {}: {reads}",
                solid.name
            ));
        }
        let square = |x: &[f64; D]| (0..D).map(|k| (x[k] - at[k]).powi(2)).sum::<f64>();
        if !fluid.iter().any(|x| square(x) < support * support) {
            dry.push(name);
        }
    }
    if !dry.is_empty() {
        notes.push(format!(
            "dry at the start, so that their cells stay empty until fluid is within {support:.4} m: \
             probe {}",
            dry.join(", ")
        ));
    }
    notes
}
