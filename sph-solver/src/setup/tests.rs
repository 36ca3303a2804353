//! Scenes that become particles, and scenes that cannot.

use super::*;
use crate::scene::SoundSpeed;
use miette::Diagnostic;
use sph_geometry::TriangleMesh;
use std::path::Path;

const TANK: &str = r#"dimension = 2
end_time = 1.0
gravity = [0.0, -10.0]
numerics = { spacing = 0.1 }

[fluid.water]
density = 1000.0
pressure = "hydrostatic"
regions = [
    { box = { min = [0, 0], max = [1, 2] } },
]

[[solid]]
name = "tank"
box = { min = [0, 0], max = [4, 3] }
fluid_side = "inside"
"#;

fn scene(text: &str, overrides: &[&str]) -> Result<Scene, SceneError> {
    let overrides: Vec<String> = overrides.iter().map(ToString::to_string).collect();
    Scene::parse("test.toml", text.into(), &overrides)
}

fn tank(overrides: &[&str]) -> Result<Setup<2>, SceneError> {
    Setup::new(&scene(TANK, overrides).unwrap())
}

/// Line of the mistake, its message and the way out.
#[track_caller]
fn assert_error<T: std::fmt::Debug>(
    result: Result<T, SceneError>,
    place: (&str, usize),
    message: &str,
    help: &str,
) {
    let error = result.unwrap_err();
    let text = error.to_string();
    let way_out = error.help().map(|help| help.to_string()).unwrap_or_default();
    assert!(text.contains(message), "message: {text}");
    assert!(way_out.contains(help), "help: {way_out}");
    let line = error.line_and_column().unwrap().0;
    assert_eq!((error.source_name().unwrap(), line), place, "{text}");
}

#[test]
fn a_tank_becomes_a_lattice() {
    let setup = tank(&[]).unwrap();
    let particles = &setup.particles;
    assert_eq!(particles.of_kind(0), 0..200);
    // Three layers of wall around the inside of the tank; of its corners, only what is within reach.
    assert_eq!(particles.of_kind(1), 200..200 + 46 * 36 - 40 * 30 - 4);
    assert_eq!(particles.len(), 652);
    let close = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-12;
    assert!(close(particles.position[0], [0.05, 0.05]));
    assert!(close(particles.position[1], [0.15, 0.05]));
    assert!(close(particles.position[199], [0.95, 1.95]));
    assert!(particles.mass[..200].iter().all(|mass| (mass - 10.0).abs() < 1e-12));
    assert!(particles.volume.iter().all(|volume| (volume - 0.01).abs() < 1e-15));
    assert!(particles.velocity.iter().all(|v| *v == [0.0; 2]));
    let constants = &setup.constants;
    assert!((constants.support_radius - 0.3).abs() < 1e-15);
    assert!((constants.smoothing_length - 0.15).abs() < 1e-15);
    assert!((constants.skin - 0.045).abs() < 1e-15);
    assert!((constants.sound_speed - 20.0 * 20.0_f64.sqrt()).abs() < 1e-12);
    assert!((constants.domain.0[0] + 0.6).abs() < 1e-12);
    assert!((constants.domain.1[1] - 3.6).abs() < 1e-12);
    let pressure = |i: usize| constants.equation_of_state.pressure(particles.density[i]);
    assert!((pressure(0) - 19_500.0).abs() < 1e-6, "{}", pressure(0));
    assert!((pressure(199) - 500.0).abs() < 1e-6, "{}", pressure(199));
    assert_eq!(pressure(200), 0.0);
}

#[test]
fn regions_have_fields_of_their_own_and_share_nothing() {
    let regions = "fluid.water.regions=[{ box = { min = [0, 0], max = [1, 2] }, pressure = \"y\" }, \
                   { box = { min = [0, 0], max = [2, 1] }, velocity = [\"x\", 2] }]";
    let setup = tank(&[regions, "fluid.water.pressure=7", "fluid.water.velocity=[0, 1]"]).unwrap();
    let particles = &setup.particles;
    assert_eq!(particles.of_kind(0).len(), 300);
    let pressure = |i: usize| setup.constants.equation_of_state.pressure(particles.density[i]);
    for i in 0..300 {
        let x = particles.position[i];
        let (velocity, expected) = if i < 200 { ([0.0, 1.0], x[1]) } else { ([x[0], 2.0], 7.0) };
        assert_eq!(particles.velocity[i], velocity);
        assert!((pressure(i) - expected).abs() < 1e-6);
    }
    assert!(setup.initial_speed > 2.75 && setup.initial_speed < 2.8);
}

#[test]
fn numerics_become_constants() {
    let setup = tank(&[
        "numerics.sound_speed=50",
        "numerics.equation_of_state=tait",
        "numerics.support=4",
        "fluid.water.viscosity=0.5",
        "domain={ min = [-1, -1], max = [5, 5] }",
    ])
    .unwrap();
    let constants = &setup.constants;
    assert_eq!(
        constants.equation_of_state,
        EquationOfState::Tait { density0: 1000.0, sound_speed: 50.0, gamma: 7.0 }
    );
    assert_eq!(constants.step_limits().kinematic_viscosity, 0.0005);
    assert_eq!((constants.viscosity, constants.artificial_viscosity), (Some(0.5), 0.0));
    assert_eq!(constants.domain, ([-1.0, -1.0], [5.0, 5.0]));
    assert_eq!(constants.smoothing_length, 0.2);
}

#[test]
fn a_scene_without_walls_gets_room() {
    let setup = tank(&["solid=[]"]).unwrap();
    assert_eq!(setup.particles.len(), 200);
    assert_eq!(setup.constants.domain, ([-2.0, -2.0], [3.0, 4.0]));
}

#[test]
fn a_floor_ends_at_the_domain() {
    let floor = "solid=[{ name = \"floor\", plane = { point = [0, 0], normal = [0, 1] } }]";
    let setup = tank(&[floor, "domain={ min = [-1, -1], max = [3, 3] }"]).unwrap();
    let walls = setup.particles.of_kind(1);
    assert!(walls.len() >= 3 * 40 && walls.len() <= 3 * 46, "{}", walls.len());
    for x in &setup.particles.position[walls] {
        assert!(x[1] < 0.0 && x[1] > -0.3 && x[0] > -1.3 && x[0] < 3.3, "{x:?}");
    }
}

#[test]
fn fluid_gives_way_to_solids() {
    let region = "fluid.water.regions.0.box.max=[1, 3.2]";
    let setup = tank(&[region]).unwrap();
    assert_eq!(setup.particles.of_kind(0).len(), 300);
    let note = "20 particles of region 0 of water would lie inside solid tank, the first at [0.05";
    assert!(setup.notes().iter().any(|found| found.starts_with(note)), "{:?}", setup.notes());
    // What the solid takes is not missing.
    assert!((setup.volume_of_regions / 3.0 - 1.0).abs() < 2e-3, "{}", setup.volume_of_regions);
    let solid = "[[solid]]\nname = \"pillar\"\nsphere = { center = [1, 1], radius = 0.12 }\n\
                 fluid_side = \"outside\"\n";
    let scene = scene(&format!("{TANK}{solid}"), &[]).unwrap();
    let setup = Setup::<2>::new(&scene).unwrap();
    assert_eq!(setup.particles.of_kind(0).len(), 198);
    assert!(setup.notes().iter().any(|note| note.contains("2 particles of region 0")));
    let positions = Positions::new(&scene, &Geometry::<2>::read(&scene, None).unwrap()).unwrap();
    assert_eq!(positions.fluid, 198);
    assert!(positions.position[..198] == setup.particles.position[..198]);
    let all = "region 0 of fluid `water` overlaps solid `tank`: 200 particles";
    assert_error(tank(&["solid.0.fluid_side=outside"]), ("test.toml", 10), all, "fluid_side");
}

#[test]
fn solids_that_the_fluid_cannot_meet_are_refused() {
    let beside = |shape: &str| {
        let solid = format!("[[solid]]\nname = \"post\"\n{shape}\nfluid_side = \"outside\"\n");
        Setup::<2>::new(&scene(&format!("{TANK}{solid}"), &[]).unwrap())
    };
    let far = beside("box = { min = [900, 0], max = [950, 300] }").unwrap_err();
    assert!(far.to_string().contains("solid `post`, from [900.0, 0.0]"), "{far}");
    let small = beside("box = { min = [2.001, 0.1], max = [2.0011, 0.101] }").unwrap_err();
    assert!(small.to_string().contains("is lost between particles"), "{small}");
    let scaled =
        beside("box = { min = [900, 0], max = [950, 300] }\nscale = 0.001\ntranslate = [1.1, 0]");
    assert!(!scaled.unwrap().particles.of_kind(2).is_empty());
}

#[test]
fn thin_walls_are_named_with_their_place() {
    let solid = "[[solid]]\nname = \"gate\"\nbox = { min = [2, 0], max = [2.12, 1] }\n\
                 fluid_side = \"outside\"\n";
    let scene = scene(&format!("{TANK}{solid}"), &[]).unwrap();
    let notes = Setup::<2>::new(&scene).unwrap().notes();
    let note = notes.iter().find(|note| note.starts_with("solid gate")).expect("a note");
    for words in ["0.1200 m thick at [2.", "1.2 spacings", "each of its sides is a wall of its own"]
    {
        assert!(note.contains(words), "{note}");
    }
    assert!(!notes.iter().any(|note| note.starts_with("solid tank")), "{notes:?}");
}

#[test]
fn a_solid_thinner_than_the_support_has_two_sides() {
    let with = |width: f64| {
        let solid = format!(
            "[[solid]]\nname = \"gate\"\nbox = {{ min = [2, 0], max = [{}, 1] }}\n\
             fluid_side = \"outside\"\n",
            2.0 + width
        );
        Setup::<2>::new(&scene(&format!("{TANK}{solid}"), &[]).unwrap()).unwrap()
    };
    // The spacing is 0.1 m, the support three times that.
    for (width, below) in [(0.05, Some(0.025)), (0.1, Some(0.05)), (0.25, Some(0.05)), (0.4, None)]
    {
        let setup = with(width);
        let found = setup.solids[1].thin.map(|thin| thin.below);
        let same = match (found, below) {
            (Some(found), Some(below)) => (found - below).abs() < 1e-9,
            (found, below) => found == below,
        };
        assert!(same, "{width}: {found:?}");
        assert_eq!(setup.solids[0].thin, None);
    }
    // What is pressed that far into so thin a wall is on its other side.
    let notes = with(0.02).notes();
    let words = "may leak there: numerics.spacing = 0.066 or less would do";
    assert!(notes.iter().any(|note| note.contains(words)), "{notes:?}");
}

#[test]
fn nothing_to_simulate_is_refused() {
    let tiny = "fluid.water.regions=[{ box = { min = [0, 0], max = [0.04, 1] } }]";
    let message = "no particle fits into the regions";
    assert_error(tank(&[tiny]), ("--set", 1), message, "smaller numerics.spacing");
}

#[test]
fn sizes_beyond_reason_are_refused() {
    let message = "`numerics.spacing` must be larger, found 0.000001";
    assert_error(tank(&["numerics.spacing=1e-6"]), ("--set", 1), message, "2.0e12 particles");
    let message = "`numerics.spacing` must be larger, found 0.00003";
    if memory::available().is_some_and(|free| free < 1.5e11) {
        assert_error(tank(&["numerics.spacing=3e-5"]), ("--set", 1), message, "free here");
    }
    let endless = "fluid.water.regions=[{ plane = { point = [0, 0], normal = [0, 1] } }]";
    assert_error(tank(&[endless]), ("--set", 1), "a region of fluid has no end", "difference");
    let huge = "domain={ min = [-1, -1e12], max = [5, 5] }";
    assert_error(tank(&[huge]), ("--set", 1), "is too large for a spacing", "smaller [domain]");
    let long = "domain={ min = [-1, -1], max = [1e9, 5] }";
    assert_error(tank(&[long]), ("--set", 1), "is too large for a spacing", "smaller [domain]");
}

#[test]
fn sound_needs_a_speed() {
    let still = ["gravity=[0, 0]", "fluid.water.pressure=0"];
    let result = scene(TANK, &still).and_then(|scene| Setup::<2>::new(&scene));
    assert!(result.unwrap_err().to_string().contains("no gravity and its fluid is at rest"));
    let given = [still[0], still[1], "numerics.sound_speed=3"];
    assert_eq!(tank(&given).unwrap().constants.sound_speed, 3.0);
    assert_eq!(*scene(TANK, &given).unwrap().numerics.sound_speed, SoundSpeed::Given(3.0));
}

#[test]
fn formulas_that_fail_somewhere_name_the_particle() {
    let message = "\"1/(x - 0.05)\" cannot be used: it gives";
    let velocity = "fluid.water.velocity=[0, \"1/(x - 0.05)\"]";
    assert_error(tank(&[velocity]), ("--set", 1), message, "defined everywhere");
    let vacuum = "fluid.water.pressure=\"-1e9\"";
    assert_error(tank(&[vacuum]), ("--set", 1), "which no density belongs to", "sound_speed");
    let outside = "domain={ min = [0, 0], max = [4, 1] }";
    let message = "100 particles of the fluid would be outside of the domain";
    assert_error(tank(&[outside]), ("--set", 1), message, "enlarge [domain]");
}

#[test]
fn the_report_counts_and_warns() {
    let scene = scene(TANK, &["numerics.sound_speed=20", "end_time=2"]).unwrap();
    let setup = Setup::<2>::new(&scene).unwrap();
    let report = setup.report(&scene, 4).unwrap();
    assert_eq!((report.particles.total, report.particles.fluid), (652, 200));
    assert_eq!((report.particles.solids[0].kind, report.particles.solids[0].particles), (1, 452));
    assert_eq!((report.neighbours, report.ranks), (24, 4));
    let step = 0.15 / (20.0 + 2.0 * 20.0_f64.sqrt());
    assert!((report.time_step - step).abs() < 1e-12);
    assert_eq!(report.steps, (2.0 / step).ceil() as u64);
    assert_eq!(report.step_limit, StepLimit::Sound);
    assert_eq!(
        report.memory_bytes,
        200.0 * BYTES_PER_FLUID_PARTICLE + 452.0 * BYTES_PER_WALL_PARTICLE
    );
    assert!(report.notes[0].contains("only 2.2 times"), "{:?}", report.notes);
    let text = report.to_string();
    for part in ["solid tank", "452", "limited by sound", "note "] {
        assert!(text.contains(part), "{text}");
    }
    assert!(serde_json::to_string(&report).unwrap().contains("\"step_limit\":\"sound\""));
    let error = setup.report(&scene, 653).unwrap_err();
    assert_eq!(error.to_string(), "653 ranks are more than the 652 particles of the scene");
}

const MESHES: &str = r#"dimension = 3
end_time = 1.0
gravity = [0.0, 0.0, -10.0]
numerics = { spacing = 0.1 }
[fluid.water]
density = 1000.0
regions = [{ box = { min = [0, 0, 0], max = [1, 1, 1] } }]
[[solid]]
name = "tank"
mesh = "tank.stl"
fluid_side = "inside"
"#;

fn with_mesh(folder: &Path, mesh: &TriangleMesh) -> Result<Setup<3>, SceneError> {
    std::fs::write(folder.join("scene.toml"), MESHES).unwrap();
    mesh.write_stl(folder.join("tank.stl")).unwrap();
    Setup::new(&Scene::read(&folder.join("scene.toml"), &[])?)
}

#[test]
fn a_mesh_makes_the_walls_of_a_box() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = TriangleMesh::cuboid([0.0; 3], [2.0, 1.0, 1.5]);
    let setup = with_mesh(folder.path(), &mesh).unwrap();
    assert_eq!(setup.particles.of_kind(0).len(), 1000);
    let scene = Scene::read(&folder.path().join("scene.toml"), &[]).unwrap();
    let report = setup.report(&scene, 1).unwrap();
    assert_eq!((report.meshes[0].triangles, report.meshes[0].defects.as_str()), (12, "closed"));
    let mesh = "solid=[{ name = \"tank\", box = { min = [0, 0, 0], max = [2, 1, 1.5] }, \
                fluid_side = \"inside\" }]";
    let plain = Scene::parse("test.toml", MESHES.into(), &[mesh.into()]).unwrap();
    let plain = Setup::<3>::new(&plain).unwrap().particles;
    assert_eq!((&plain.position, &plain.kind), (&setup.particles.position, &setup.particles.kind));
    // The distances of a mesh and of a box round differently.
    for (a, b) in plain.depth.iter().zip(&setup.particles.depth) {
        assert!((a - b).abs() < 1e-12, "{a} {b}");
    }
}

#[test]
fn broken_meshes_are_refused_with_the_place() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = TriangleMesh::cuboid([0.0; 3], [2.0, 1.0, 1.5]);
    let mut open = mesh.clone();
    open.triangles.pop();
    let error = with_mesh(folder.path(), &open);
    assert_error(error, (&name(folder.path()), 10), "the mesh is open: 3 edges", "fill the holes");
    assert!(with_mesh(folder.path(), &mesh.flipped()).is_ok());
}

#[test]
fn what_is_safe_is_repaired_and_told() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = TriangleMesh::cuboid([0.0; 3], [2.0, 1.0, 1.5]);
    let mut broken = mesh.clone();
    broken.triangles[3].swap(0, 1);
    broken.triangles.push(broken.triangles[7]);
    let whole = with_mesh(folder.path(), &mesh).unwrap();
    let mended = with_mesh(folder.path(), &broken).unwrap();
    assert!(whole.particles.position == mended.particles.position);
    assert!(whole.notes_on_geometry.is_empty());
    let words = format!("{:?} {:?}", mended.notes_on_geometry, mended.meshes[0].defects);
    assert_eq!(words.matches("removed copies: 1 triangle at").count(), 2, "{words}");
    assert_eq!(words.matches("turned over 1 triangle at").count(), 2, "{words}");
}

#[test]
fn missing_meshes_are_refused_with_a_suggestion() {
    let folder = tempfile::tempdir().unwrap();
    with_mesh(folder.path(), &TriangleMesh::cuboid([0.0; 3], [2.0, 1.0, 1.5])).unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, MESHES.replace("tank.stl", "tnk.stl")).unwrap();
    let setup = |path: &Path| Setup::<3>::new(&Scene::read(path, &[]).unwrap());
    let help = "did you mean `tank.stl`? mesh paths are relative";
    assert_error(setup(&path), (&name(folder.path()), 10), "tnk.stl cannot be used", help);
    std::fs::write(folder.path().join("tank.stl"), "solid nonsense").unwrap();
    std::fs::write(&path, MESHES).unwrap();
    assert_error(setup(&path), (&name(folder.path()), 10), "cannot be used", "");
}

fn name(folder: &Path) -> String {
    folder.join("scene.toml").display().to_string()
}

#[test]
fn a_scene_of_another_dimension_is_refused() {
    assert!(Setup::<3>::new(&scene(TANK, &[]).unwrap()).is_err());
}
