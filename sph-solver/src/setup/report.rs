//! What `sph check` says about a scene.

use super::choice::SchemeChoice;
use super::constants::StepLimit;
use serde::Serialize;
use std::fmt;

/// Memory per fluid particle, bytes, at the peak: state, records, neighbour lists and skin at about 92
/// neighbours, and what a rebuild needs for a moment.
/// Runs report what they used as `bytes_per_particle`, over fluid and walls, in `summary.json`.
pub const BYTES_PER_FLUID_PARTICLE: f64 = 450.0;

/// Memory per wall particle, bytes. Walls are sources only and have no neighbour lists.
pub const BYTES_PER_WALL_PARTICLE: f64 = 200.0;

/// Pairs that one core of a present machine evaluates in a second in mixed precision, search, skin and
/// walls included, to within a factor of two. For the cost estimate only.
pub const PAIRS_PER_CORE_SECOND: f64 = 8.0e8;

/// Passes over all pairs in a step: density and force.
pub const PASSES_PER_STEP: f64 = 2.0;

/// A scene in numbers: what would run, and what it would cost.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CheckReport {
    /// Name of the scene.
    pub name: String,
    /// Number of space dimensions.
    pub dimension: usize,
    /// Particles by kind.
    pub particles: ParticleCounts,
    /// Box around all particles, m: lowest and highest corner.
    pub bounding_box: [Vec<f64>; 2],
    /// Box that particles may be in, m.
    pub domain: [Vec<f64>; 2],
    /// Volume of the fluid.
    pub volume: VolumeOfFluid,
    /// The scheme, and why.
    pub scheme: SchemeChoice,
    /// Initial particle distance, m.
    pub spacing: f64,
    /// Particles by their spacing, the coarsest first; one band where all have the same.
    pub bands: Vec<Band>,
    /// Smoothing length, m.
    pub smoothing_length: f64,
    /// Support radius, m.
    pub support_radius: f64,
    /// Neighbours of a particle inside the fluid on the initial lattice.
    pub neighbours: usize,
    /// Sound speed, m/s.
    pub sound_speed: f64,
    /// Largest speed expected, m/s; the sound speed is at least ten times that when it is "auto".
    pub expected_speed: f64,
    /// Time step in calm flow, s. Impacts make it shorter for a while.
    pub time_step: f64,
    /// What limits the time step.
    pub step_limit: StepLimit,
    /// End of the run, s.
    pub end_time: f64,
    /// Steps until then.
    pub steps: u64,
    /// Fluid particles times steps.
    pub particle_updates: f64,
    /// Rough cost in core-seconds, see [`PAIRS_PER_CORE_SECOND`].
    pub core_seconds: f64,
    /// Memory of all ranks together, bytes.
    pub memory_bytes: f64,
    /// Snapshots on the disk, if the scene has any.
    pub snapshots: Option<SnapshotVolume>,
    /// Ranks asked for.
    pub ranks: usize,
    /// Meshes in use.
    pub meshes: Vec<MeshSummary>,
    /// What is allowed but deserves a look; a run says the same.
    pub notes: Vec<String>,
}

/// Particles by kind.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ParticleCounts {
    /// All.
    pub total: usize,
    /// Of the fluid.
    pub fluid: usize,
    /// Of each solid, in the order of the scene.
    pub solids: Vec<SolidCount>,
}

/// Fluid particles of about the same spacing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Band {
    /// Largest and smallest spacing, m.
    pub spacing: [f64; 2],
    /// Number of particles.
    pub particles: usize,
}

/// Volume of the fluid, m³ (m² in two dimensions).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct VolumeOfFluid {
    /// Of the regions of the scene, measured to about a thousandth; exact for boxes.
    pub regions: f64,
    /// Of the particles that fill them.
    pub particles: f64,
}

/// Snapshots of a whole run on the disk.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SnapshotVolume {
    /// Number of them.
    pub count: u64,
    /// Bytes of all of them and of the walls, once nothing lies on a lattice any more; less where a
    /// region leaves some out.
    pub bytes: f64,
    /// Bytes of a particle.
    pub bytes_per_particle: f64,
}

/// Wall particles of a solid.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SolidCount {
    /// Name of the solid.
    pub name: String,
    /// Kind of its particles.
    pub kind: u16,
    /// Number of its particles.
    pub particles: usize,
}

/// A mesh of the scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeshSummary {
    /// Who uses it: a solid or a region.
    pub used_by: String,
    /// The file.
    pub path: String,
    /// Number of triangles.
    pub triangles: usize,
    /// Box around it, m.
    pub bounding_box: [Vec<f64>; 2],
    /// Enclosed volume, m³.
    pub volume: f64,
    /// Defects that were repaired or can be lived with.
    pub defects: String,
}

impl fmt::Display for CheckReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut row = |name: &str, value: String| writeln!(f, "{name:<18} {value}");
        row("scene", format!("{} ({} dimensions)", self.name, self.dimension))?;
        row("particles", grouped(self.particles.total as f64))?;
        row("  fluid", grouped(self.particles.fluid as f64))?;
        for solid in &self.particles.solids {
            row(&format!("  solid {}", solid.name), grouped(solid.particles as f64))?;
        }
        let unit = if self.dimension == 2 { "m²" } else { "m³" };
        let VolumeOfFluid { regions, particles } = self.volume;
        let (regions, particles) = (short(regions), short(particles));
        row("volume", format!("{particles} {unit} of particles for regions of {regions} {unit}"))?;
        row("bounding box", corners(&self.bounding_box))?;
        row("domain", corners(&self.domain))?;
        row("spacing", format!("{} m", short(self.spacing)))?;
        for Band { spacing: [most, least], particles } in
            self.bands.iter().filter(|_| self.bands.len() > 1)
        {
            let range = format!("{} to {} m", short(*most), short(*least));
            row("  band", format!("{range}: {} particles", grouped(*particles as f64)))?;
        }
        let (h, support) = (short(self.smoothing_length), short(self.support_radius));
        row("smoothing length", format!("{h} m, support radius {support} m"))?;
        row("neighbours", format!("{} inside the fluid", self.neighbours))?;
        row(
            "sound speed",
            format!(
                "{} m/s for flow speeds up to {} m/s",
                short(self.sound_speed),
                short(self.expected_speed)
            ),
        )?;
        let limit = match self.step_limit {
            StepLimit::Sound => "sound",
            StepLimit::Forces => "gravity",
            StepLimit::Viscosity => "viscosity",
        };
        row("time step", format!("{} s, limited by {limit}", short(self.time_step)))?;
        let steps = grouped(self.steps as f64);
        row("steps", format!("{steps} for {} s", short(self.end_time)))?;
        row(
            "cost",
            format!(
                "{} particle updates, about {} on one core",
                scaled(self.particle_updates),
                duration(self.core_seconds)
            ),
        )?;
        let memory = self.memory_bytes / (1u64 << 20) as f64;
        row("memory", format!("about {} MiB on {} rank(s)", grouped(memory.ceil()), self.ranks))?;
        if let Some(SnapshotVolume { count, bytes, bytes_per_particle }) = self.snapshots {
            let count = grouped(count as f64);
            let bytes = size(bytes);
            row(
                "on disk",
                format!(
                    "up to {bytes} in {count} snapshots, {bytes_per_particle:.0} bytes per particle"
                ),
            )?;
        }
        for mesh in &self.meshes {
            let (path, corners) = (&mesh.path, corners(&mesh.bounding_box));
            let triangles = grouped(mesh.triangles as f64);
            let volume = short(mesh.volume);
            row(
                &format!("mesh of {}", mesh.used_by),
                format!("{path}: {triangles} triangles, {volume} m³, {corners}; {}", mesh.defects),
            )?;
        }
        for note in &self.notes {
            row("note", note.clone())?;
        }
        Ok(())
    }
}

/// A number with about six significant digits.
fn short(number: f64) -> String {
    if number == 0.0 {
        return "0".into();
    }
    let magnitude = number.abs().log10().floor();
    if (-4.0..6.0).contains(&magnitude) {
        let decimals = (5.0 - magnitude).max(0.0) as usize;
        let text = format!("{number:.decimals$}");
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').into()
        } else {
            text
        }
    } else {
        format!("{number:.5e}")
    }
}

fn corners(corners: &[Vec<f64>; 2]) -> String {
    let point = |point: &[f64]| point.iter().map(|x| short(*x)).collect::<Vec<_>>().join(", ");
    format!("[{}] to [{}] m", point(&corners[0]), point(&corners[1]))
}

/// A whole number with thin groups of three digits.
pub(crate) fn grouped(number: f64) -> String {
    let digits = format!("{number:.0}");
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index) % 3 == 0 {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

fn scaled(number: f64) -> String {
    let (scale, unit) = match number {
        n if n >= 1e12 => (1e12, " T"),
        n if n >= 1e9 => (1e9, " G"),
        n if n >= 1e6 => (1e6, " M"),
        _ => (1.0, ""),
    };
    format!("{:.3}{unit}", number / scale)
}

/// Bytes in decimal units.
fn size(bytes: f64) -> String {
    match bytes {
        b if b >= 1e12 => format!("{:.1} TB", b / 1e12),
        b if b >= 1e9 => format!("{:.1} GB", b / 1e9),
        b if b >= 1e6 => format!("{:.1} MB", b / 1e6),
        b => format!("{:.0} kB", (b / 1e3).ceil()),
    }
}

fn duration(seconds: f64) -> String {
    match seconds {
        s if s >= 2.0 * 86400.0 => format!("{:.1} days", s / 86400.0),
        s if s >= 2.0 * 3600.0 => format!("{:.1} hours", s / 3600.0),
        s if s >= 120.0 => format!("{:.0} minutes", s / 60.0),
        s => format!("{:.0} seconds", s.ceil()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_but_exact_enough() {
        for (number, text) in [
            (0.02, "0.02"),
            (-9.81, "-9.81"),
            (1.0 / 3.0, "0.333333"),
            (100.0, "100"),
            (123_456.0, "123456"),
            (1.5e-5, "1.50000e-5"),
            (0.0, "0"),
        ] {
            assert_eq!(short(number), text);
        }
        assert_eq!(grouped(1_234_567.0), "1 234 567");
        assert_eq!(grouped(12.0), "12");
        assert_eq!([0.4, 999.6, 1e9].map(grouped), ["0", "1 000", "1 000 000 000"]);
        assert_eq!(scaled(2.5e9), "2.500 G");
        assert_eq!(duration(90.0), "90 seconds");
        assert_eq!(duration(7200.0 * 3.0), "6.0 hours");
    }
}
