//! Scenes that `sph new` writes: they pass the check and run.

use sph_tests::{Results, Run};
use std::fs;

#[test]
fn every_kind_passes_the_check_and_runs() {
    let folder = tempfile::tempdir().unwrap();
    for kind in ["dam-break", "tank", "impact"] {
        for dimension in ["2", "3"] {
            let name = format!("{kind}-in-{dimension}");
            let scene = folder.path().join(format!("{name}.toml"));
            Run::new_scene(folder.path().join(&name))
                .arg("--kind")
                .arg(kind)
                .arg("--dimension")
                .arg(dimension)
                .succeed();
            let text = fs::read_to_string(&scene).unwrap();
            assert!(
                text.contains(&format!("name = \"{name}\"")) && text.contains("# m/s²"),
                "{text}"
            );
            Run::check(&scene).succeed();
            // In the plane to their ends, in space for as long as a test may take.
            let run = Run::new(&scene).threads(1);
            let results = Results::of(if dimension == "2" { run } else { run.end_time(0.02) });
            assert_eq!(results.summary()["name"], name);
            if kind != "impact" {
                assert_eq!(results.summary()["lost_particles"], 0);
            }
            Run::report(&[results.path()]).succeed();
        }
    }
}

#[test]
fn nothing_is_overwritten_and_names_must_be_names() {
    let folder = tempfile::tempdir().unwrap();
    let new = |name: &str| Run::new_scene(name).within(folder.path());
    let said = new("wave.toml").succeed().output;
    assert!(said.contains("sph run wave.toml"), "{said}");
    let path = folder.path().join("wave.toml");
    let before = fs::read_to_string(&path).unwrap();
    assert!(before.contains("name = \"wave\""));
    new("wave")
        .arg("--kind")
        .arg("tank")
        .fail(2)
        .message
        .assert_contains(&["wave.toml is there already", "choose another name"]);
    assert_eq!(fs::read_to_string(&path).unwrap(), before);
    for name in ["a\"b", "a#b", ".."] {
        new(name).fail(2).message.assert_contains(&["cannot be the name of a scene"]);
    }
    new("no/folder").fail(1).message.assert_contains(&["cannot write"]);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}
