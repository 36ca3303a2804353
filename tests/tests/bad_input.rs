//! Every mistake of a user: exit code 2, one message with the place and a way out, nothing written.

use sph_tests::{BoxMesh, Outcome, Run, SMALL, line_of, mpi_program, program, scene, write_scene};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// A scene with a mesh, which lies beside it.
const WITH_MESH: &str = r#"dimension = 3
end_time = 0.1
gravity = [0.0, 0.0, -9.81]

[numerics]
spacing = 0.05

[fluid.water]
density = 1000.0
regions = [{ box = { min = [0, 0, 0], max = [0.2, 0.4, 0.3] } }]

[[solid]]
name = "tank"
mesh = "tank.stl"
fluid_side = "inside"
"#;

fn tank() -> BoxMesh {
    BoxMesh::new([0.0; 3], [0.4; 3])
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<_> =
        entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// Runs both commands on the scene in `folder`; both must refuse it with the same message, in which
/// all `words` are, and leave no file.
#[track_caller]
fn refused(folder: &Path, scene: &Path, change: impl Fn(Run) -> Run, words: &[&str]) {
    let before = names(folder);
    let check = change(Run::check(scene)).within(folder).fail(2);
    let run = change(Run::new(scene)).out(folder.join("results")).within(folder).fail(2);
    for outcome in [&check, &run] {
        outcome.message.assert_contains(words);
        assert!(outcome.output.is_empty(), "{outcome}");
        assert_eq!(outcome.message.count("error:"), 1, "{outcome}");
    }
    assert_eq!(check.message, run.message);
    assert_eq!(names(folder), before, "files were written");
}

/// Asserts that `text` is refused for the line with `culprit`.
#[track_caller]
fn refused_at(text: &str, culprit: &str, words: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    tank().write(&folder.path().join("tank.stl"));
    let path = write_scene(folder.path(), text);
    let place = format!("scene.toml:{}:", line_of(text, culprit));
    refused(folder.path(), &path, |run| run, &[words, &[place.as_str(), "help:"]].concat());
}

/// The small scene after `old` became `new`, which is the mistake.
#[track_caller]
fn spoilt(old: &str, new: &str, words: &[&str]) {
    assert!(SMALL.contains(old), "{old}");
    refused_at(&SMALL.replacen(old, new, 1), new, words);
}

/// The scene with a mesh that is `mesh`.
#[track_caller]
fn refused_mesh(mesh: &BoxMesh, words: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    mesh.write(&folder.path().join("tank.stl"));
    let path = write_scene(folder.path(), WITH_MESH);
    let place = format!("scene.toml:{}:", line_of(WITH_MESH, "tank.stl"));
    let words = [words, &[place.as_str(), "tank.stl", "help:"]].concat();
    refused(folder.path(), &path, |run| run, &words);
}

/// The small scene with a `--set` that is a mistake.
#[track_caller]
fn refused_change(change: &str, words: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let path = write_scene(folder.path(), SMALL);
    refused(folder.path(), &path, |run| run.set(change), &[words, &["--set", "help:"]].concat());
}

#[test]
fn the_scenes_are_right_before_they_are_spoilt() {
    let folder = tempfile::tempdir().unwrap();
    tank().write(&folder.path().join("tank.stl"));
    Run::check(write_scene(folder.path(), WITH_MESH)).succeed();
    Run::check(write_scene(folder.path(), SMALL)).succeed();
}

#[test]
fn an_unknown_key() {
    spoilt("spacing =", "spacng =", &["unknown key `spacng`", "[numerics]", "`spacing`?"]);
    spoilt("end_time", "endtime", &["unknown key `endtime`", "did you mean `end_time`?"]);
    spoilt("max = [1.0", "mx = [1.0", &["unknown key `mx`", "did you mean `max`?"]);
    spoilt("[output]", "[ouput]", &["unknown key `ouput`", "did you mean `output`?"]);
}

#[test]
fn a_missing_key() {
    refused_at(&SMALL.replacen("spacing = 0.02", "", 1), "[numerics]", &["lacks", "`spacing`"]);
    refused_at(&SMALL.replacen("density = 1000.0", "", 1), "[fluid.water]", &["`density`"]);
    let no_side = SMALL.replacen("fluid_side = \"inside\"", "", 1);
    refused_at(&no_side, "[[solid]]", &["fluid_side", "\"inside\"", "\"outside\""]);
}

#[test]
fn a_wrong_type() {
    spoilt(
        "spacing = 0.02",
        "spacing = \"0.02\"",
        &["`numerics.spacing`", "a number", "the string \"0.02\"", "without quotes"],
    );
    spoilt("gravity = [0.0, -9.81]", "gravity = -9.81", &["`gravity`", "array", "number -9.81"]);
    spoilt("dimension = 2", "dimension = 2.5", &["`dimension`", "whole number"]);
}

#[test]
fn a_wrong_choice() {
    spoilt("\"inside\"", "\"insde\"", &["\"insde\"", "did you mean `inside`?"]);
    spoilt("[\"pressure\"]", "[\"presure\"]", &["\"presure\"", "did you mean `pressure`?"]);
}

#[test]
fn values_out_of_range() {
    spoilt("spacing = 0.02", "spacing = -0.02", &["`numerics.spacing`", "positive", "-0.02"]);
    spoilt("spacing = 0.02", "spacing = 0", &["`numerics.spacing`", "positive"]);
    spoilt("end_time = 0.2", "end_time = -1", &["`end_time`", "positive", "-1"]);
    spoilt("density = 1000.0", "density = 0.0", &["`fluid.water.density`", "positive"]);
    spoilt("snapshots = 0.05", "snapshots = 0", &["`output.snapshots`", "positive"]);
    spoilt("dimension = 2", "dimension = 4", &["`dimension`", "2 or 3"]);
    let unstable = SMALL.replacen("spacing = 0.02", "spacing = 0.02\ncfl = 2.5", 1);
    refused_at(&unstable, "cfl", &["`numerics.cfl`", "at most", "2.5", "stability"]);
}

#[test]
fn the_wrong_number_of_components() {
    spoilt("gravity = [0.0, -9.81]", "gravity = [0.0, 0.0, -9.81]", &["`gravity`", "3 components"]);
    spoilt("max = [0.3, 0.4]", "max = [0.3]", &["1 components", "dimension = 2"]);
}

#[test]
fn contradictions() {
    spoilt("max = [0.3, 0.4]", "max = [0.3, -0.4]", &["empty along y"]);
    let second = "[[solid]]\nname = \"tank\"\nsphere = { center = [0.7, 0.3], radius = 0.1 }\n\
                  fluid_side = \"outside\"\n";
    let twice = format!("{SMALL}\n{second}");
    let folder = tempfile::tempdir().unwrap();
    let path = write_scene(folder.path(), &twice);
    let line = twice.lines().count() - 2;
    let place = format!("scene.toml:{line}:");
    refused(folder.path(), &path, |run| run, &["two solids", "`tank`", &place, "help:"]);
    let oil = format!("{SMALL}\n[fluid.oil]\ndensity = 900.0\nregions = []\n");
    refused_at(&oil, "[fluid.oil]", &["more than one fluid"]);
}

#[test]
fn formulas() {
    let with = |velocity: &str| {
        SMALL.replacen("density = 1000.0", &format!("density = 1000.0\nvelocity = {velocity}"), 1)
    };
    refused_at(&with("[\"sinn(x)\", \"0\"]"), "sinn", &["sinn(x)", "did you mean `sin`?"]);
    refused_at(&with("[\"0\", \"2*(x\"]"), "2*(x", &["2*(x"]);
    refused_at(&with("[\"z\", \"0\"]"), "\"z\"", &["dimension = 2", "use x and y"]);
    refused_at(&with("[\"log(x - 10)\", \"0\"]"), "log", &["log(x - 10)"]);
}

#[test]
fn an_initial_pressure_that_no_density_has() {
    let pressure = "pressure = \"-1e7*x\"";
    let words = ["initial pressure", "Pa", "numerics.sound_speed"];
    spoilt("pressure = \"hydrostatic\"", pressure, &words);
}

#[test]
fn not_toml() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_scene(folder.path(), &SMALL.replacen("= 0.02", "= = 0.02", 1));
    let place = format!("scene.toml:{}:", line_of(SMALL, "spacing"));
    refused(folder.path(), &path, |run| run, &["not valid TOML", &place, "help:"]);
    let path = write_scene(folder.path(), "solid tank\nfacet normal 0 0 0\n");
    refused(folder.path(), &path, |run| run, &["not valid TOML", "scene.toml:1:", "help:"]);
    fs::write(&path, [0x89, b'P', b'N', b'G', 0, 0xff]).unwrap();
    refused(folder.path(), &path, |run| run, &["scene.toml", "UTF-8", "help:"]);
    fs::write(&path, "").unwrap();
    refused(folder.path(), &path, |run| run, &["scene.toml:1:", "lacks", "help:"]);
}

#[test]
fn a_scene_that_is_not_there() {
    let folder = tempfile::tempdir().unwrap();
    let words = ["cannot read the scene", "none.toml", "help:", "scenes/"];
    refused(folder.path(), &folder.path().join("none.toml"), |run| run, &words);
    refused(folder.path(), folder.path(), |run| run, &["cannot read the scene", "help:"]);
}

#[test]
fn changes_on_the_command_line() {
    refused_change("numerics.spacng=0.01", &["unknown key `spacng`", "did you mean `spacing`?"]);
    refused_change("numerics.spacing=-1", &["`numerics.spacing`", "positive, found -1"]);
    refused_change("numerics.spacing=fine", &["`numerics.spacing`", "the string \"fine\""]);
    refused_change("numerics.cfl=100", &["`numerics.cfl`", "at most"]);
    refused_change("numerics.spacing", &["key.path=value"]);
    refused_change("solid.3.name=wall", &["`3`", "array of 1"]);
    refused_change("numerics.spacing.fine=1", &["leads through the number 0.02"]);
}

#[test]
fn meshes_that_cannot_be_used() {
    refused_mesh(&tank().open(), &["open", "the mesh"]);
    refused_mesh(&tank().open().with_a_turned_triangle(), &["the mesh"]);
}

#[test]
fn a_mesh_that_is_not_there() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_scene(folder.path(), WITH_MESH);
    let place = format!("scene.toml:{}:", line_of(WITH_MESH, "tank.stl"));
    refused(folder.path(), &path, |run| run, &["the mesh", "tank.stl", &place, "help:"]);
    for garbage in ["", "hello", "solid box\nfacet normal 0 0\n"] {
        fs::write(folder.path().join("tank.stl"), garbage).unwrap();
        refused(folder.path(), &path, |run| run, &["the mesh", "tank.stl", &place, "help:"]);
    }
    // The end of a binary file is missing: 80 bytes of head, a count of 100 triangles, one of them.
    let mut cut = vec![b' '; 80];
    cut.extend(100_u32.to_le_bytes());
    cut.extend([0; 50]);
    fs::write(folder.path().join("tank.stl"), cut).unwrap();
    refused(folder.path(), &path, |run| run, &["the mesh", "tank.stl", &place, "help:"]);
}

#[test]
fn nothing_but_fluid_inside_a_solid() {
    let block = "[[solid]]\nname = \"block\"\nbox = { min = [-0.1, -0.1], max = [0.5, 0.5] }\n\
                 fluid_side = \"outside\"\n";
    let words = ["overlaps solid `block`", "fluid `water`", "particles", "fluid_side"];
    refused_at(&format!("{SMALL}\n{block}"), "regions", &words);
}

#[test]
fn nothing_to_simulate() {
    let (start, rest) = SMALL.split_once("[fluid.water]").unwrap();
    let (_, end) = rest.split_once("[[solid]]").unwrap();
    let dry = format!("{start}[[solid]]{end}");
    refused_at(&dry, "name = \"small\"", &["nothing to simulate", "[fluid.water]"]);
    let empty = "regions = []";
    let region = "regions = [{ box = { min = [0, 0], max = [0.3, 0.4] } }]";
    spoilt(region, empty, &["nothing to simulate", "no regions"]);
    // Thinner than a particle, between two places of the lattice.
    let thin = "regions = [{ box = { min = [0.001, 0.001], max = [0.002, 0.002] } }]";
    spoilt(region, thin, &["nothing to simulate"]);
}

#[test]
fn more_ranks_than_particles() {
    let folder = tempfile::tempdir().unwrap();
    let text = SMALL.replacen("spacing = 0.02", "spacing = 0.1", 1);
    let path = write_scene(folder.path(), &text);
    let change = |run: Run| run.ranks(5000);
    refused(folder.path(), &path, change, &["5000 ranks", "particles", "help:", "at most"]);
    Run::check(&path).ranks(2).succeed();
}

/// Numbers for the command line itself.
#[test]
fn arguments() {
    let small = tempfile::tempdir().unwrap();
    let path = write_scene(small.path(), SMALL);
    let refused = |run: Run, words: &[&str]| {
        let outcome = run.out(small.path().join("results")).fail(2);
        outcome.message.assert_contains(words);
        assert_eq!(names(small.path()), ["scene.toml"]);
    };
    refused(Run::new(&path).arg("--ranks").arg("0"), &["--ranks", "from 1"]);
    refused(Run::new(&path).arg("--threads").arg("two"), &["--threads", "from 1"]);
    refused(Run::new(&path).end_time(-1.0), &["--end-time", "positive"]);
    refused(Run::new(&path).arg("--checkpoint-every").arg("never"), &["--checkpoint-every"]);
    refused(Run::new(&path).arg("--end-tme=1"), &["--end-tme", "--end-time"]);
}

/// Every process would run the whole scene, and all would write the same files.
#[test]
fn the_program_without_mpi_under_mpirun() {
    if mpi_program("the program without MPI under mpirun").is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let run = Run::new(write_scene(folder.path(), SMALL)).mpi(&program(), 2);
    let outcome = run.out(folder.path().join("results")).finish();
    assert_eq!(outcome.status.code(), Some(2), "{outcome}");
    outcome.message.assert_contains(&["built without MPI", "--features mpi", "--ranks 2"]);
    assert_eq!(names(folder.path()), ["scene.toml"]);
}

/// A scene that is right, with a folder that is not.
fn unwritable(out: &Path) -> Outcome {
    let outcome = Run::new(scene("hydrostatic-2d")).threads(1).out(out).finish();
    assert!(matches!(outcome.status.code(), Some(1 | 2)), "{outcome}");
    outcome.message.assert_readable();
    assert_eq!(outcome.message.count("error:"), 1, "{outcome}");
    outcome
}

#[test]
fn a_folder_that_cannot_be_written() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "mine").unwrap();
    unwritable(&file).message.assert_contains(&[file.to_str().unwrap()]);
    let below = file.join("results");
    unwritable(&below).message.assert_contains(&[below.to_str().unwrap()]);
    assert_eq!(fs::read_to_string(&file).unwrap(), "mine");
    assert_eq!(names(folder.path()), ["file"]);
    // A file system that nobody can write to, root neither.
    let outcome = unwritable(Path::new("/proc/results"));
    outcome.message.assert_contains(&["/proc/results"]);
}
