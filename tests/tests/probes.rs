//! Probes: their numbers against what is known of the fluid at the start, the same on any ranks.

use sph_tests::{Results, Run, SMALL, write_scene};

/// Water of 0.3 × 0.4 m that moves to the right at 2 m/s, and a drop far above it.
const CHANGES: [&str; 3] = [
    "fluid.water.velocity=[\"2\", \"0\"]",
    "fluid.water.regions=[{ box = { min = [0, 0], max = [0.3, 0.4] } }, \
     { box = { min = [0.14, 0.5], max = [0.18, 0.52] } }]",
    "probe=[\
     { name = \"gauge\", kind = \"level\", at = [0.15, 0.1] }, \
     { name = \"beside\", kind = \"level\", at = [0.7, 0] }, \
     { name = \"right\", kind = \"flow\", at = [0.2, 0], normal = [5, 0] }, \
     { name = \"left\", kind = \"flow\", at = [0.2, 0], normal = [-1, 0] }, \
     { name = \"sensor\", kind = \"patch\", at = [0.15, 0.2], radius = 0.05, fields = [\"pressure\"] }, \
     { name = \"face\", kind = \"patch\", at = [0, 0.3], radius = 0.05, normal = [1, 0], \
       fields = [\"pressure\", \"velocity\"] }, \
     { name = \"half\", kind = \"patch\", at = [0.36, 0.1], radius = 0.05, normal = [0, 1], \
       fields = [\"density\"] }]",
];

fn results(ranks: usize) -> Results {
    let folder = tempfile::tempdir().unwrap();
    let run = Run::new(write_scene(folder.path(), SMALL)).ranks(ranks).threads(1);
    Results::of(CHANGES.iter().fold(run, |run, change| run.set(change)))
}

#[track_caller]
fn assert_near(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance, "{value} is not {expected} ± {tolerance}");
}

#[test]
fn gauges_read_what_is_there() {
    let results = results(1);
    let first = |name: &str| results.table(&format!("probe-{name}")).rows[0].clone();
    assert_eq!(results.table("probe-gauge").titles, ["time [s]", "level [m]"]);
    assert_eq!(results.table("probe-right").titles, ["time [s]", "flow [m2/s]"]);
    // Within a quarter of the spacing; the water is compressed by a thousandth.
    assert_near(first("gauge")[1], 0.4, 0.005);
    assert!(first("beside")[1].is_nan());
    assert_near(first("right")[1], 0.4 * 2.0, 0.002);
    assert_near(first("left")[1], -0.4 * 2.0, 0.002);
    // Depths of 0.2 and 0.1 m; at the wall the interpolation is one-sided.
    assert_near(first("sensor")[1], 9810.0 * 0.2, 9810.0 * 0.001);
    assert_eq!(first("sensor")[2], 1.0);
    assert_near(first("face")[1], 9810.0 * 0.1, 9810.0 * 0.002);
    assert_near(first("face")[2], 2.0, 1e-9);
    // A segment from 0.32 to 0.4, of which the water is within reach of less than half.
    let half = first("half");
    assert!(half[2] > 0.0 && half[2] < 1.0 && half[1] > 900.0, "{half:?}");
    // Then the water comes.
    let beside = results.table("probe-beside").column("level");
    assert!(beside.last().is_some_and(|level| *level > 0.0 && *level < 0.4), "{beside:?}");
}

#[test]
fn on_any_ranks_the_same() {
    let (one, three) = (results(1), results(3));
    for name in ["gauge", "beside", "right", "left", "sensor", "face", "half"] {
        let name = format!("probe-{name}");
        assert_eq!(one.table(&name), three.table(&name), "{name}");
    }
}

#[test]
fn mistakes_are_answered_with_the_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), SMALL);
    for (probe, words) in [
        ("kind = \"level\"", "lacks the key `at`"),
        ("kind = \"level\", at = [0, 0], radius = 1", "is a level probe, which has no `radius`"),
        ("kind = \"flow\", at = [0, 0]", "lacks the key `normal`"),
        ("kind = \"flow\", at = [0, 0], normal = [0, 0]", "has no direction"),
        ("kind = \"patch\", at = [0, 0], fields = [\"pressure\"]", "lacks the key `radius`"),
        (
            "kind = \"patch\", at = [0, 0], radius = 9, fields = [\"pressure\"]",
            "must be at most 50 times numerics.spacing",
        ),
        ("kind = \"flaw\"", "did you mean `flow`?"),
    ] {
        let run = Run::check(&scene).set(&format!("probe=[{{ name = \"p\", {probe} }}]"));
        run.fail(2).message.assert_contains(&[words]);
    }
    let still = Run::check(&scene).set("gravity=[0, 0]").set("fluid.water.pressure=0");
    let run = still.set("probe=[{ name = \"p\", kind = \"level\", at = [0, 0] }]");
    run.fail(2).message.assert_contains(&["looks for a level without gravity", "add `gravity`"]);
}
