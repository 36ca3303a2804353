//! Scenes: the shipped ones at a size for tests, and a small one for mistakes and faults.

use crate::program::workspace;
use crate::run::Run;
use std::fs;
use std::path::{Path, PathBuf};

/// Path of a shipped scene.
///
/// # Panics
///
/// When there is no such scene.
pub fn scene(name: &str) -> PathBuf {
    let path = workspace().join("scenes").join(format!("{name}.toml"));
    assert!(path.is_file(), "there is no scene {}", path.display());
    path
}

/// A shipped scene at a size that takes seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reduced {
    /// Name of the scene.
    pub name: &'static str,
    /// Space dimensions.
    pub dimension: usize,
    /// Particle distance, m.
    pub spacing: f64,
    /// End of the run, s.
    pub end_time: f64,
}

/// The shipped scenes, large enough for several rebuilds, migrations and partitions.
pub const SHIPPED: [Reduced; 3] = [
    Reduced { name: "dam-break-2d", dimension: 2, spacing: 0.025, end_time: 0.4 },
    Reduced { name: "hydrostatic-2d", dimension: 2, spacing: 0.025, end_time: 0.25 },
    Reduced { name: "dam-break-3d", dimension: 3, spacing: 0.04, end_time: 0.5 },
];

impl Reduced {
    /// Runs the scene at this size.
    pub fn run(&self) -> Run {
        self.run_until(self.end_time)
    }

    /// Runs the scene at this spacing until another time, s.
    pub fn run_until(&self, end_time: f64) -> Run {
        Run::new(scene(self.name))
            .set(&format!("numerics.spacing={}", self.spacing))
            .end_time(end_time)
    }
}

/// A dam break of 300 particles in a tank: a base for mistakes and faults.
pub const SMALL: &str = r#"name = "small"
dimension = 2
end_time = 0.2
gravity = [0.0, -9.81]

[numerics]
spacing = 0.02

[fluid.water]
density = 1000.0
pressure = "hydrostatic"
regions = [{ box = { min = [0, 0], max = [0.3, 0.4] } }]

[[solid]]
name = "tank"
box = { min = [0, 0], max = [1.0, 0.6] }
fluid_side = "inside"

[[probe]]
name = "P1"
at = [1.0, 0.05]
fields = ["pressure"]

[output]
snapshots = 0.05
energies = 0.01
"#;

/// Writes `text` as `scene.toml` into `folder`.
///
/// # Panics
///
/// When it cannot be written.
pub fn write_scene(folder: &Path, text: &str) -> PathBuf {
    let path = folder.join("scene.toml");
    fs::write(&path, text).expect("a scratch file");
    path
}

/// Number of the first line of `text` with these words, counted from 1.
///
/// # Panics
///
/// When no line has them.
#[track_caller]
pub fn line_of(text: &str, words: &str) -> usize {
    let found = text.lines().position(|line| line.contains(words));
    found.unwrap_or_else(|| panic!("\"{words}\" is not in\n{text}")) + 1
}
