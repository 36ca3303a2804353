//! `scheme = "auto"`: what it chooses, that it says so, and that it runs what it says.

use serde_json::Value;
use sph_tests::{Results, Run, scene};

const AUTO: &str = "numerics.scheme=auto";

fn note(value: &Value) -> String {
    let notes = value["notes"].as_array().expect("notes").iter().filter_map(Value::as_str);
    let mut found = notes.filter(|note| note.starts_with("scheme \"auto\" is"));
    found.next().unwrap_or_else(|| panic!("no word of the choice: {value:#}")).to_owned()
}

#[test]
fn check_says_what_suits_a_scene_and_why() {
    for (name, kind, scheme, words) in [
        ("taylor-green-2d", "closed", "delta-plus", "no free surface"),
        ("dam-break-front-2d", "violent", "delta", "sides that nothing holds"),
        ("block-impact-2d", "violent", "delta", "nothing holds it"),
        ("wedge-entry-2d", "violent", "delta", "Froude number"),
        ("standing-wave-2d", "gentle", "delta", "rests on its ground"),
    ] {
        let check = Run::check(scene(name)).set(AUTO).set("numerics.spacing=0.04").arg("--json");
        let report: Value = serde_json::from_str(&check.succeed().output).unwrap();
        assert_eq!(report["scheme"]["kind"], kind, "{name}");
        assert_eq!(report["scheme"]["scheme"], scheme, "{name}");
        assert!(note(&report).contains(words), "{name}: {}", note(&report));
    }
}

#[test]
fn a_run_is_the_one_that_it_names() {
    for name in ["gresho-2d", "block-impact-2d"] {
        let run = || Run::new(scene(name)).set("numerics.spacing=0.05").end_time(0.1).threads(1);
        let auto = Results::of(run().set(AUTO).set("numerics.artificial_viscosity=0"));
        let summary = auto.summary();
        let scheme = summary["scheme"]["scheme"].as_str().expect("a scheme").to_owned();
        assert!(note(&summary).contains(&scheme));
        let given =
            run().set(&format!("numerics.scheme={scheme}")).set("numerics.artificial_viscosity=0");
        let given = Results::of(given);
        assert_eq!(given.digest(), auto.digest(), "{name}");
        assert!(given.summary()["scheme"].get("reason").is_none());
    }
}

#[test]
fn the_artificial_viscosity_follows_unless_it_is_given() {
    let front = || Run::new(scene("dam-break-front-2d")).set("numerics.spacing=0.1").threads(1);
    let alpha = |run: Run| {
        let summary = Results::of(run.end_time(0.05)).summary();
        summary["scheme"]["artificial_viscosity"].as_f64().expect("a number")
    };
    assert_eq!(alpha(front()), 0.02);
    assert_eq!(alpha(front().set(AUTO)), 0.0);
    assert_eq!(alpha(front().set(AUTO).set("numerics.artificial_viscosity=0.01")), 0.01);
}
