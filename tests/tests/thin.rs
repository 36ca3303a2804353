//! Solids thinner than the support: nothing passes, and their two sides do not feel each other.

use sph_tests::{Results, Run, read_vtu, write_scene};

const SPACING: f64 = 0.02;

/// Turns points of a plane by an angle.
fn turned(degrees: f64, points: &[[f64; 2]]) -> String {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let turned =
        points.iter().map(|[x, y]| format!("[{:.9}, {:.9}]", x * cos - y * sin, x * sin + y * cos));
    format!("[{}]", turned.collect::<Vec<_>>().join(", "))
}

fn rectangle(low: [f64; 2], high: [f64; 2]) -> [[f64; 2]; 4] {
    [low, [high[0], low[1]], high, [low[0], high[1]]]
}

fn run(text: &str) -> Results {
    let folder = tempfile::tempdir().expect("a scratch folder");
    Results::of(Run::new(write_scene(folder.path(), text)).threads(1))
}

/// Positions of the fluid in the last snapshot, turned back.
fn last(results: &Results, degrees: f64) -> Vec<[f64; 2]> {
    let series = results.series();
    let entry = series.iter().rev().find(|entry| entry.part == 0).expect("a snapshot");
    let points = read_vtu(&results.path().join(&entry.file)).array("Points").values.clone();
    let (sin, cos) = degrees.to_radians().sin_cos();
    points.chunks(3).map(|x| [x[0] * cos + x[1] * sin, x[1] * cos - x[0] * sin]).collect()
}

/// A jet 20 spacings wide comes down at 1 m/s on a plate so many spacings thick; all is turned, the lattice
/// is not.
fn jet(mach: f64, degrees: f64, thickness: f64) -> String {
    let (sin, cos) = degrees.to_radians().sin_cos();
    format!(
        r#"name = "jet"
dimension = 2
end_time = 0.5
domain = {{ min = [-3, -3], max = [3, 3] }}
[numerics]
spacing = {SPACING}
sound_speed = {}
[fluid.water]
density = 1000.0
velocity = ["{sin:.9}", "{:.9}"]
regions = [{{ polygon = {} }}]
[[solid]]
name = "plate"
fluid_side = "outside"
polygon = {}
[output]
snapshots = 0.5
"#,
        1.0 / mach,
        -cos,
        turned(degrees, &rectangle([-0.2, 0.0], [0.2, 0.6])),
        turned(degrees, &rectangle([-0.8, -thickness * SPACING], [0.8, 0.0])),
    )
}

#[test]
fn no_jet_passes_a_plate() {
    for (mach, degrees, thickness) in [
        (0.1, 0.0, 1.0),
        (0.1, 17.0, 1.0),
        (0.5, 0.0, 1.0),
        (0.5, 17.0, 1.0),
        (0.5, 10.0, 0.5),
        (0.5, 60.0, 2.0),
    ] {
        let results = run(&jet(mach, degrees, thickness));
        let fluid = last(&results, degrees);
        assert!(fluid.len() > 500);
        let beyond = fluid.iter().filter(|x| x[1] < 0.0).count();
        assert_eq!(beyond, 0, "Mach {mach}, {degrees}°, {thickness} spacings");
    }
}

/// Two pools with a plate between them that does not lie on the lattice.
fn pools(degrees: f64, thickness: f64, heights: [f64; 2], end: f64) -> String {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let [left, right] = [-0.5, 0.5].map(|side| 0.5 + side * thickness * SPACING);
    format!(
        r#"name = "pools"
dimension = 2
end_time = {end}
gravity = [{:.9}, {:.9}]
[numerics]
spacing = {SPACING}
[fluid.water]
density = 1000.0
pressure = "hydrostatic"
regions = [{{ polygon = {} }}, {{ polygon = {} }}]
[[solid]]
name = "tank"
fluid_side = "inside"
polygon = {}
[[solid]]
name = "plate"
fluid_side = "outside"
polygon = {}
[output]
energies = 0.05
snapshots = {end}
"#,
        9.81 * sin,
        -9.81 * cos,
        turned(degrees, &rectangle([0.0, 0.0], [left, heights[0]])),
        turned(degrees, &rectangle([right, 0.0], [1.0, heights[1]])),
        turned(degrees, &rectangle([0.0, 0.0], [1.0, 0.7])),
        turned(degrees, &rectangle([left, -0.1], [right, 0.7])),
    )
}

#[test]
fn two_pools_beside_a_plate_keep_their_levels() {
    for (degrees, thickness) in [(0.0, 1.0), (17.0, 1.0), (0.0, 0.5)] {
        let heights = [0.5, 0.25];
        let results = run(&pools(degrees, thickness, heights, 3.0));
        let fluid = last(&results, degrees);
        let side = |left: bool| fluid.iter().filter(move |x| (x[0] < 0.5) == left);
        let width = 0.5 - 0.5 * thickness * SPACING;
        for (left, height) in [(true, heights[0]), (false, heights[1])] {
            let count = side(left).count() as f64 * SPACING * SPACING;
            assert!((count / (width * height) - 1.0).abs() < 0.06, "{degrees}°: {count} m²");
            let mut levels: Vec<f64> = side(left).map(|x| x[1]).collect();
            levels.sort_by(f64::total_cmp);
            let level = levels[levels.len() * 99 / 100] + 0.5 * SPACING;
            assert!((level - height).abs() < SPACING, "{degrees}°, {thickness}: {level} m");
        }
        let within = fluid.iter().filter(|x| (x[0] - 0.5).abs() < 0.25 * thickness * SPACING);
        assert_eq!(within.count(), 0, "{degrees}°, {thickness} spacings");
        // The plate carries the difference of both pressures.
        let force = results.table("solid-plate");
        let (x, y) = (force.column("mean_force_x"), force.column("mean_force_y"));
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let late = x.len() / 2..;
        let sum = x[late.clone()].iter().zip(&y[late.clone()]).map(|(x, y)| x * cos + y * sin);
        let mean = sum.sum::<f64>() / x[late].len() as f64;
        let expected = 0.5 * 9810.0 * (heights[0] * heights[0] - heights[1] * heights[1]);
        assert!((mean / expected - 1.0).abs() < 0.05, "{degrees}°, {thickness}: {mean} N/m");
    }
}

#[test]
fn thin_solids_give_the_same_bits_on_any_ranks() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let still = pools(17.0, 1.0, [0.5, 0.25], 0.2);
    let moves = "motion = { displacement = [\"0.05*sin(6*t)\", \"0\"] }\n";
    for text in [still.clone(), still.replace("[output]", &format!("{moves}[output]"))] {
        let scene = write_scene(folder.path(), &text);
        let alone = Results::of(Run::new(&scene).threads(2)).digest();
        for ranks in [2, 3] {
            let several = Results::of(Run::new(&scene).ranks(ranks).threads(1)).digest();
            assert_eq!(several, alone, "{ranks} ranks");
        }
    }
}

#[test]
fn a_plate_that_moves_along_a_floor_does_not_leak() {
    let text = format!(
        r#"name = "piston"
dimension = 2
end_time = 3.0
gravity = [0, -9.81]
[numerics]
spacing = {SPACING}
[fluid.water]
density = 1000.0
pressure = "hydrostatic"
regions = [{{ box = {{ min = [0, 0], max = [1, 0.3] }} }}]
[[solid]]
name = "tank"
fluid_side = "inside"
box = {{ min = [-0.4, 0], max = [1, 0.8] }}
[[solid]]
name = "piston"
fluid_side = "outside"
box = {{ min = [{}, 0], max = [0, 0.7] }}
motion = {{ displacement = ["0.05*sin(2*pi*t)", "0"] }}
[output]
snapshots = 3.0
"#,
        -SPACING
    );
    let fluid = last(&run(&text), 0.0);
    // After whole periods it is back at x = 0.
    assert_eq!(fluid.iter().filter(|x| x[0] < 0.0).count(), 0);
}
