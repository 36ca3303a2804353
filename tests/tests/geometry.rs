//! Meshes as users have them: several bodies, other units, holes, seams, thin walls, obstacles in water.

use serde_json::Value;
use sph_tests::{BoxMesh, Run, write_scene};
use std::path::Path;

fn scene(solids: &str, region: &str) -> String {
    format!(
        r#"dimension = 3
end_time = 0.01
gravity = [0.0, 0.0, -9.81]
[numerics]
spacing = 0.02
[domain]
min = [-0.5, -0.5, -0.5]
max = [1.5, 1.5, 1.5]
[fluid.water]
density = 1000.0
regions = [{{ {region} }}]
{solids}
"#
    )
}

fn checked(folder: &Path, text: &str) -> Value {
    let scene = write_scene(folder, text);
    serde_json::from_str(&Run::check(scene).arg("--json").succeed().output).expect("a report")
}

fn notes(report: &Value) -> Vec<&str> {
    report["notes"].as_array().expect("notes").iter().filter_map(Value::as_str).collect()
}

/// Two boxes that cross at right angles, as drawn by one hand and by another.
fn cross(turned: bool) -> BoxMesh {
    let other = BoxMesh::new([0.4, 0.0, 0.0], [0.6, 0.8, 0.2]);
    let other = if turned { other.inside_out() } else { other };
    BoxMesh::new([0.0, 0.3, 0.0], [1.0, 0.5, 0.2]).and(&other)
}

#[test]
fn bodies_that_cross_are_one_region_and_one_duct() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    for turned in [false, true] {
        cross(turned).write(&folder.path().join("cross.stl"));
        // 0.04 m³ and 0.032 m³, of which 0.008 m³ are in both.
        let full = checked(folder.path(), &scene("", "mesh = \"cross.stl\""));
        assert_eq!(full["particles"]["fluid"], 8000);
        let volume = full["meshes"][0]["volume"].as_f64().expect("a volume");
        assert!((volume / 0.064 - 1.0).abs() < 5e-3, "{volume}");
        let defects = full["meshes"][0]["defects"].as_str().expect("words");
        assert!(defects.contains("2 bodies, united where they overlap"), "{defects}");
        assert_eq!(defects.contains("1 turned right side out"), turned, "{defects}");

        let duct = "[[solid]]\nname = \"duct\"\nmesh = \"cross.stl\"\nfluid_side = \"inside\"\n";
        let inside = checked(folder.path(), &scene(duct, "mesh = \"cross.stl\""));
        assert_eq!(inside["particles"]["fluid"], 8000);
        assert!(!notes(&inside).iter().any(|note| note.contains("gives way")), "{inside:#}");
    }
}

#[test]
fn bodies_beside_each_other_and_cavities() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let path = folder.path().join("bodies.stl");
    let region = "mesh = \"bodies.stl\"";
    let [left, right] = [0.0, 0.6].map(|x| BoxMesh::new([x, 0.0, 0.0], [x + 0.4, 0.4, 0.4]));
    left.and(&right.inside_out()).write(&path);
    let report = checked(folder.path(), &scene("", region));
    assert_eq!(report["particles"]["fluid"], 2 * 8000);
    assert_eq!(report["meshes"][0]["volume"].as_f64().map(|v| (v * 1e9).round()), Some(128e6));

    let hollow = BoxMesh::new([0.1, 0.1, 0.1], [0.3, 0.3, 0.3]);
    left.and(&hollow.clone().inside_out()).write(&path);
    let report = checked(folder.path(), &scene("", region));
    assert_eq!(report["particles"]["fluid"], 8000 - 1000);
    let defects = report["meshes"][0]["defects"].as_str().expect("words");
    assert!(defects.contains("1 around cavities"), "{defects}");

    left.and(&hollow).write(&path);
    let report = checked(folder.path(), &scene("", region));
    assert_eq!(report["particles"]["fluid"], 8000);
    let words = "has to face the other way";
    assert!(notes(&report).iter().any(|note| note.contains(words)), "{report:#}");
}

#[test]
fn millimetres_are_told_and_scaled() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    BoxMesh::new([400.0, 400.0, 0.0], [600.0, 600.0, 200.0]).write(&folder.path().join("post.stl"));
    let tank = "[[solid]]\nname = \"tank\"\nbox = { min = [0, 0, 0], max = [1, 1, 0.4] }\n\
                fluid_side = \"inside\"\n";
    let post = "[[solid]]\nname = \"post\"\nmesh = \"post.stl\"\nfluid_side = \"outside\"\n";
    let water = "box = { min = [0, 0, 0], max = [0.3, 1, 0.2] }";
    let both = format!("{tank}{post}");
    let path = write_scene(folder.path(), &scene(&both, water));
    for run in [Run::check(&path), Run::new(&path).out(folder.path().join("results"))] {
        let message = run.fail(2).message;
        message.assert_contains(&["post.stl", "solid post", "200", "scale = 0.001", "help:"]);
    }
    for key in ["units = \"mm\"", "scale = 0.001", "scale = [0.001, 0.001, 0.001]"] {
        let report = checked(folder.path(), &scene(&format!("{both}{key}\n"), water));
        assert!(report["particles"]["solids"][1]["particles"].as_u64() > Some(500), "{report:#}");
        let low = &report["meshes"][0]["bounding_box"][0];
        assert_eq!(low[0].as_f64().map(|x| (x * 1e9).round()), Some(4e8), "{key}");
    }
    // The same for a mesh of fluid.
    let path = write_scene(folder.path(), &scene(tank, "mesh = \"post.stl\""));
    Run::check(path).fail(2).message.assert_contains(&["post.stl", "scale = 0.001"]);
    let scaled = "mesh = \"post.stl\", units = \"mm\", translate = [0, -0.4, 0]";
    assert_eq!(checked(folder.path(), &scene(tank, scaled))["particles"]["fluid"], 1000);
}

#[test]
fn every_shape_can_be_placed() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let count = |region: &str| {
        checked(folder.path(), &scene("", region))["particles"]["fluid"].as_f64().expect("a count")
    };
    let cuboid = "box = { min = [0, 0, 0], max = [0.4, 0.2, 0.2] }";
    assert_eq!(count(&format!("{cuboid}, scale = [2, 1, 0.5]")), 2000.0);
    let turn = "rotate = { axis = [0, 0, 1], degrees = 90 }";
    assert_eq!(count(&format!("{cuboid}, {turn}, translate = [0.5, 0.5, 0.5]")), 2000.0);
    let tilted = count(&format!("{cuboid}, rotate = {{ axis = [1, 2, 3], degrees = 33 }}"));
    assert!((tilted / 2000.0 - 1.0).abs() < 0.03, "{tilted}");
    for shape in [
        "sphere = { center = [0, 0, 0], radius = 100 }",
        "cylinder = { from = [0, 0, -100], to = [0, 0, 100], radius = 80 }",
        "capsule = { from = [0, 0, -50], to = [0, 0, 50], radius = 80 }",
        "union = [{ box = { min = [0, 0, 0], max = [100, 100, 100] } }, \
         { box = { min = [50, 50, 50], max = [150, 150, 150] } }]",
    ] {
        let metres = shape.replace("00", "@").replace("50", "0.05").replace("80", "0.08");
        let metres = metres.replace("10.05", "0.15").replace("1@", "0.1");
        let (scaled, plain) = (count(&format!("{shape}, scale = 0.001")), count(&metres));
        assert!((scaled / plain - 1.0).abs() < 0.02, "{shape}: {scaled} {plain}");
    }
    let refused = |region: &str, words: &[&str]| {
        let path = write_scene(folder.path(), &scene("", region));
        Run::check(path).fail(2).message.assert_contains(words);
    };
    let sphere = "sphere = { center = [0, 0, 0], radius = 0.1 }";
    let words = ["a sphere cannot be scaled differently", "help:"];
    refused(&format!("{sphere}, scale = [1, 2, 1]"), &words);
    refused(&format!("{sphere}, scale = 0"), &["is 0"]);
    refused(&format!("{sphere}, scale = [1, 2]"), &["scale"]);
    refused(&format!("{sphere}, units = \"mm\""), &["belongs to a mesh"]);
    refused(&format!("{sphere}, rotate = 30"), &["needs an axis", "degrees = 30"]);
    refused(&format!("{sphere}, rotate = {{ axis = [0, 0, 1], degres = 3 }}"), &["degrees"]);
    refused(&format!("{sphere}, translate = [1]"), &["translate"]);
    refused(&format!("{cuboid}, units = \"furlong\""), &["furlong"]);
}

#[test]
fn an_obstacle_needs_no_difference() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let post = "[[solid]]\nname = \"post\"\nbox = { min = [0.2, 0.2, -0.1], max = [0.3, 0.3, 0.5] }\n\
                fluid_side = \"outside\"\n";
    let text = scene(post, "box = { min = [0, 0, 0], max = [0.4, 0.4, 0.4] }");
    let report = checked(folder.path(), &text);
    assert_eq!(report["particles"]["fluid"], 8000 - 5 * 5 * 20);
    let words = "500 particles of region 0 of water would lie inside solid post";
    assert!(notes(&report).iter().any(|note| note.contains(words)), "{report:#}");
    assert!(!notes(&report).iter().any(|note| note.contains("less fluid")), "{report:#}");
    let results = sph_tests::Results::of(Run::new(write_scene(folder.path(), &text)).threads(1));
    assert_eq!(results.summary()["notes"], report["notes"]);
}

#[test]
fn thin_walls_and_open_surfaces() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let path = folder.path().join("vessel.stl");
    let outer = BoxMesh::new([-0.03, -0.03, -0.03], [0.43, 0.43, 0.43]);
    outer.and(&BoxMesh::new([0.0; 3], [0.4; 3]).inside_out()).write(&path);
    let vessel = "[[solid]]\nname = \"vessel\"\nmesh = \"vessel.stl\"\nfluid_side = \"outside\"\n";
    let water = "box = { min = [0, 0, 0], max = [0.4, 0.4, 0.2] }";
    let report = checked(folder.path(), &scene(vessel, water));
    let of_vessel: Vec<&str> =
        notes(&report).into_iter().filter(|note| note.starts_with("solid vessel")).collect();
    let [note] = of_vessel[..] else { panic!("{report:#}") };
    for words in ["only 0.0300 m thick at [", "each of its sides is a wall of its own"] {
        assert!(note.contains(words), "{note}");
    }
    let finer = scene(vessel, water).replace("spacing = 0.02", "spacing = 0.01");
    let report = checked(folder.path(), &finer);
    assert!(!notes(&report).iter().any(|note| note.contains("thick")), "{report:#}");

    // A hole: refused, unless the surface has a thickness. Then nothing is filled that should not be.
    BoxMesh::new([-0.02, -0.02, -0.02], [0.42, 0.42, 0.42]).open().write(&path);
    let scene_file = write_scene(folder.path(), &scene(vessel, water));
    Run::check(scene_file).fail(2).message.assert_contains(&["open", "thickness", "vessel.stl"]);
    let report = checked(folder.path(), &scene(&format!("{vessel}thickness = 0.04\n"), water));
    assert_eq!(report["particles"]["fluid"], 20 * 20 * 10);
    let report = checked(
        folder.path(),
        &scene(
            &format!("{vessel}convex_hull = true\n"),
            "box = \
        { min = [0, 0, 0], max = [0.6, 0.4, 0.4] }",
        ),
    );
    assert_eq!(report["particles"]["fluid"], 9 * 20 * 20);
}
