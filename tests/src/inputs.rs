//! What users and other programs hand to this one: every reader of it, fed with bytes. None may panic, hang, or ask
//! for absurd amounts of memory, whatever the bytes are; errors are what readers are for.
//!
//! The targets in `fuzz/` and the test `mutated_input.rs` share these functions.

use crate::program::workspace;
use crate::scenes::SMALL;
use sph_geometry::{MeshFile, Shape, TriangleMesh, bodies, check, mass_properties, repaired};
use sph_io::{
    Checkpoint, CheckpointFile, ParticleFrame, TableWriter, read_table, read_vtu, write_checkpoint,
    write_vtu,
};
use sph_solver::scene::{Formula, Scene, Template, TimedFormula};
use std::fs;
use std::path::{Path, PathBuf};

/// A kind of input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Input {
    /// A scene file.
    Scene,
    /// A formula in a scene.
    Formula,
    /// A mesh: STL, OBJ, PLY or VTK.
    Mesh,
    /// A checkpoint, `.vtkhdf`.
    Checkpoint,
    /// A snapshot, `.vtu`.
    Snapshot,
    /// A table, `.csv`.
    Table,
}

/// Meshes with more triangles are read and no more: what comes then takes its time.
const MOST_TRIANGLES: usize = 2000;

impl Input {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Scene, Self::Formula, Self::Mesh, Self::Checkpoint, Self::Snapshot, Self::Table];

    /// Reads bytes as far as a run does; returns whether they were taken.
    pub fn read(self, bytes: &[u8]) -> bool {
        let text = || String::from_utf8_lossy(bytes).into_owned();
        match self {
            Self::Scene => Scene::parse("scene.toml", text(), &[]).is_ok(),
            Self::Formula => formula(&text()),
            Self::Mesh => mesh(bytes),
            Self::Checkpoint => {
                with_file("a.vtkhdf", bytes, |path| match CheckpointFile::open(path) {
                    Ok(file) if file.info().dimension == 2 => file.read::<2>().is_ok(),
                    Ok(file) => file.read::<3>().is_ok(),
                    Err(_) => false,
                })
            }
            Self::Snapshot => with_file("a.vtu", bytes, |path| read_vtu(path).is_ok()),
            Self::Table => with_file("a.csv", bytes, |path| read_table(path).is_ok()),
        }
    }

    /// Inputs in order, to begin with.
    ///
    /// # Panics
    ///
    /// When they cannot be made.
    pub fn seeds(self) -> Vec<Vec<u8>> {
        let positions = [[0.0, 0.5, 1.0], [1.0, 0.25, -3.0], [2.0, 0.0, 1e-3]];
        match self {
            Self::Scene => {
                let mut seeds = vec![SMALL.into()];
                seeds.extend(files(&workspace().join("scenes"), "toml"));
                seeds.extend(Template::ALL.map(|kind| kind.text(3, "new").into_bytes()));
                seeds
            }
            Self::Formula => [
                "0.02*(1 - cos(2*pi*t/1.25))",
                "-sin(pi*x)*cos(pi*y)*exp(-8*pi^2*0.01*t)",
                "max(0, min(1, atan2(y, x)/2)) + step(z)^-2.5e-3",
                "((((x+1)*2-3)/4)^5)",
            ]
            .map(Vec::from)
            .into(),
            Self::Mesh => {
                let mut seeds = files(&workspace().join("docs/tutorial"), "stl");
                seeds.extend(files(&workspace().join("scenes"), "stl"));
                seeds.extend(OTHER_MESHES.map(Vec::from));
                seeds.push(written("ball.stl", |path| {
                    let ball = TriangleMesh::sphere([0.0; 3], 1.0, 1);
                    ball.write_stl(path).expect("a scratch file");
                }));
                seeds
            }
            Self::Checkpoint => vec![written("a.vtkhdf", |path| {
                let state = Checkpoint::new(0.25, 7, &[3_u64, 1, 2][..], &positions[..])
                    .with("density", &[1000.0, 1001.0, 999.0][..])
                    .with("velocity", &positions[..])
                    .with_attribute("dt", 1e-3);
                write_checkpoint(path, &state).expect("a scratch file");
            })],
            Self::Snapshot => vec![written("a.vtu", |path| {
                let frame = ParticleFrame::new(0.5, &positions)
                    .with("pressure", vec![1.0_f32, 2.0, 3.0])
                    .with("id", vec![1_u64, 2, 3]);
                write_vtu(path, &frame).expect("a scratch file");
            })],
            Self::Table => vec![written("a.csv", |path| {
                let mut table = TableWriter::create(path, &[("force", "N"), ("level", "m")])
                    .expect("a scratch file");
                table.row(0.0, &[1.0, f64::NAN]).expect("a scratch file");
                table.row(0.5, &[-2.5e-7, 3.0]).expect("a scratch file");
            })],
        }
    }
}

/// A tetrahedron in the other formats.
const OTHER_MESHES: [&str; 3] = [
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
     element face 4\nproperty list uchar int vertex_indices\nend_header\n\
     0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n",
    "# vtk DataFile Version 3.0\ntetrahedron\nASCII\nDATASET POLYDATA\nPOINTS 4 double\n\
     0 0 0 1 0 0 0 1 0 0 0 1\nPOLYGONS 4 16\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n",
];

fn formula(text: &str) -> bool {
    let (fixed, timed) = (Formula::new(text), TimedFormula::new(text));
    let known = fixed.check(3).is_ok();
    let _ = (fixed.at(&[0.5, -1.0, 0.0]), fixed.is_zero(), fixed.text());
    if timed.check_field(3).is_ok() {
        let _ = timed.at(&[0.5, -1.0, 0.0], 1.5);
    }
    if timed.check_of_time().is_ok() {
        let _ = timed.at_time(1.5);
    }
    if timed.check_column().is_ok() {
        let _ = timed.of_column(1.5, 2.0);
    }
    known
}

fn mesh(bytes: &[u8]) -> bool {
    let Ok(file) = MeshFile::from_bytes(bytes) else { return false };
    if file.mesh.triangles.len() > MOST_TRIANGLES {
        return true;
    }
    let _ = check(&file.mesh).map(|report| report.error());
    let Ok(mended) = repaired(&file.mesh) else { return false };
    let _ = mended.repairs.in_words();
    let _ = (bodies(&mended.mesh), mass_properties(&mended.mesh, 1000.0));
    match Shape::<3>::mesh(&mended.mesh) {
        Ok(shape) => !shape.signed_distance(&[0.1, 0.2, 0.3]).is_nan(),
        Err(_) => false,
    }
}

/// Lets `read` read a file with these bytes.
fn with_file(name: &str, bytes: &[u8], read: impl FnOnce(&Path) -> bool) -> bool {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let path = folder.path().join(name);
    fs::write(&path, bytes).expect("a scratch file");
    read(&path)
}

/// The bytes of a file that `write` writes.
fn written(name: &str, write: impl FnOnce(&Path)) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let path = folder.path().join(name);
    write(&path);
    fs::read(&path).expect("the file was written")
}

/// The bytes of all files with this ending, in the order of their names.
fn files(folder: &Path, ending: &str) -> Vec<Vec<u8>> {
    let entries = fs::read_dir(folder).expect("the folder is there");
    let mut paths: Vec<PathBuf> =
        entries.map(|entry| entry.expect("a readable folder").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|have| have == ending));
    paths.sort();
    paths.iter().map(|path| fs::read(path).expect("a readable file")).collect()
}
