//! The command line: files that scenes may name, completions, manual pages.

use sph_tests::{BoxMesh, Results, Run, program, write_scene};
use std::fs;
use std::process::Command;

const SCENE: &str = r#"dimension = 3
end_time = 0.01
gravity = [0, 0, -9.81]
[numerics]
spacing = 0.1
[fluid.water]
density = 1000
regions = [{ box = { min = [0, 0, 0], max = [0.5, 0.5, 0.5] } }]
[[solid]]
name = "tank"
mesh = "MESH"
fluid_side = "inside"
"#;

#[test]
fn a_scene_keeps_to_its_folder_unless_it_is_trusted() {
    let folder = tempfile::tempdir().unwrap();
    let scenes = folder.path().join("scenes");
    fs::create_dir(&scenes).unwrap();
    BoxMesh::new([0.0; 3], [1.0, 0.5, 0.8]).write(&folder.path().join("tank.stl"));
    BoxMesh::new([0.0; 3], [1.0, 0.5, 0.8]).write(&scenes.join("own.stl"));
    std::os::unix::fs::symlink(folder.path().join("tank.stl"), scenes.join("link.stl")).unwrap();
    let absolute = folder.path().join("tank.stl").display().to_string();
    for (mesh, why) in
        [("../tank.stl", "climbs out"), (&absolute, "absolute"), ("link.stl", "symbolic link")]
    {
        let scene = write_scene(&scenes, &SCENE.replace("MESH", mesh));
        for run in [Run::check(&scene), Run::new(&scene), Run::partition(&scene, "1")] {
            let message = run.fail(2).message;
            message.assert_contains(&["leads out of the folder", why, "--allow-paths", "11"]);
        }
        Run::check(&scene).arg("--allow-paths").succeed();
    }
    let scene = write_scene(&scenes, &SCENE.replace("MESH", "own.stl"));
    Run::check(&scene).succeed();
    // From within the folder, where it has no name.
    Run::check("scene.toml").within(&scenes).succeed();
    Results::of(Run::new(&scene).threads(1).set(&format!("solid.0.mesh=\"{absolute}\"")));
}

#[test]
fn shells_and_man_know_the_commands() {
    for (shell, words) in [("bash", "_sph()"), ("zsh", "#compdef sph"), ("fish", "complete -c sph")]
    {
        let output = Command::new(program()).args(["completions", shell]).output().unwrap();
        let script = String::from_utf8(output.stdout).unwrap();
        assert!(output.status.success() && script.contains(words), "{shell}: {script}");
        for command in ["run", "check", "report", "new"] {
            assert!(script.contains(command), "{shell} does not know {command}");
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let pages = folder.path().join("man1");
    let status = Command::new(program()).arg("man").arg(&pages).status().unwrap();
    assert!(status.success());
    for (page, words) in [("sph.1", "sph\\-run(1)"), ("sph-run.1", "\\-\\-checkpoint\\-every")] {
        let text = fs::read_to_string(pages.join(page)).unwrap();
        assert!(text.starts_with(".ie") && text.contains(words), "{page}: {text}");
    }
}
