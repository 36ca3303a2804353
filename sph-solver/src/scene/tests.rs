//! Every class of mistake: its line, its message and the way out.

use super::*;
use miette::Diagnostic;
use proptest::prelude::*;

const SCENE: &str = r#"name = "test"
dimension = 2
end_time = 1.0
gravity = [0.0, -9.81]

[numerics]
spacing = 0.02

[fluid.water]
density = 1000.0
viscosity = 0.001
pressure = "hydrostatic"
velocity = ["0", "-x^2"]
regions = [
    { box = { min = [0, 0], max = [1, 2] } },
    { difference = [{ sphere = { center = [2, 1], radius = 0.5 } }, { polygon = [[2, 1], [3, 1], [3, 2]] }] },
]

[[solid]]
name = "tank"
box = { min = [0, 0], max = [4, 3] }
fluid_side = "inside"

[[probe]]
name = "P1"
at = [4.0, 0.1]
fields = ["pressure", "velocity"]

[[probe]]
name = "front"
kind = "front"
axis = "x"

[output]
snapshots = 0.1
"#;

fn read(text: &str) -> Result<Scene, SceneError> {
    Scene::parse("test.toml", text.into(), &[])
}

fn set(arguments: &[&str]) -> Result<Scene, SceneError> {
    let arguments: Vec<String> = arguments.iter().map(ToString::to_string).collect();
    Scene::parse("test.toml", SCENE.into(), &arguments)
}

/// Asserts the place, a part of the message and a part of the help.
#[track_caller]
fn assert_error(
    result: Result<Scene, SceneError>,
    place: (&str, usize, usize),
    message: &str,
    help: &str,
) {
    let error = result.unwrap_err();
    let text = error.to_string();
    let way_out = error.help().map(|help| help.to_string()).unwrap_or_default();
    assert!(text.contains(message), "message: {text}");
    assert!(way_out.contains(help), "help: {way_out}");
    let found = (error.source_name().unwrap(), error.line_and_column().unwrap());
    assert_eq!(found, (place.0, (place.1, place.2)), "{text}");
}

/// Asserts the error after the first occurrence of `old` in the scene became `new`.
#[track_caller]
fn assert_edit(old: &str, new: &str, place: (usize, usize), message: &str, help: &str) {
    assert!(SCENE.contains(old), "{old}");
    let place = ("test.toml", place.0, place.1);
    assert_error(read(&SCENE.replacen(old, new, 1)), place, message, help);
}

#[test]
fn a_whole_scene_is_read() {
    let scene = read(SCENE).unwrap();
    assert_eq!(scene.name(), "test");
    assert_eq!((scene.dimension(), *scene.end_time), (2, 1.0));
    assert_eq!(**scene.gravity.as_ref().unwrap(), [0.0, -9.81]);
    let numerics = &scene.numerics;
    assert_eq!((*numerics.spacing, *numerics.support, *numerics.cfl), (0.02, 3.0, 1.0));
    assert_eq!(*numerics.density_diffusion, 0.1);
    assert_eq!((scene.viscosity(), scene.artificial_viscosity()), (Some(0.001), 0.0));
    assert_eq!(set(&["fluid.water.viscosity=0"]).unwrap().artificial_viscosity(), 0.02);
    assert_eq!(scene.gravity(), [0.0, -9.81]);
    assert_eq!((*numerics.sound_speed, numerics.on_lost), (SoundSpeed::Auto, OnLost::Stop));
    assert_eq!((numerics.scheme, numerics.kernel), (Scheme::Delta, Kernel::WendlandC2));
    assert_eq!(
        (numerics.precision, numerics.equation_of_state),
        (Precision::Mixed, Equation::Linear)
    );
    let (name, fluid) = scene.fluid().unwrap();
    assert_eq!((name, *fluid.density), ("water", 1000.0));
    assert_eq!(fluid.pressure.value, Pressure::Hydrostatic);
    assert_eq!(fluid.regions[1].shapes()[0].key(), "difference");
    assert_eq!(*scene.solid[0].fluid_side.unwrap(), FluidSide::Inside);
    assert_eq!(**scene.probe[0].fields.as_ref().unwrap(), [Field::Pressure, Field::Velocity]);
    assert_eq!(*scene.output.snapshots.unwrap(), 0.1);
}

#[test]
fn unknown_keys_show_the_nearest_one() {
    assert_edit(
        "spacing",
        "spacng",
        (7, 1),
        "unknown key `spacng` in [numerics]",
        "did you mean `spacing`?",
    );
    assert_edit(
        "end_time",
        "endtime",
        (3, 1),
        "unknown key `endtime` in the scene",
        "did you mean `end_time`?",
    );
    assert_edit(
        "radius",
        "raduis",
        (16, 51),
        "[fluid.water.regions.1.difference.0.sphere]",
        "did you mean `radius`?",
    );
    assert_edit("axis =", "axes =", (32, 1), "in [probe.1]", "did you mean `axis`?");
    assert_edit(
        "dimension",
        "surface_tension = 1\ndimension",
        (2, 1),
        "unknown key `surface_tension`",
        "keys here: `name`",
    );
}

#[test]
fn a_periodic_scene_needs_a_domain_and_axes_that_exist() {
    let periodic = |axes: &str| format!("periodic = {axes}\ndimension");
    for (axes, column, message) in [
        ("[\"x\"]", 12, "a periodic scene needs a domain that repeats"),
        ("[\"z\"]", 13, "there is no axis z in 2 dimensions"),
        ("[\"x\", \"x\"]", 18, "the axis x is named twice"),
    ] {
        assert_edit("dimension", &periodic(axes), (2, column), message, "");
    }
}

#[test]
fn a_wall_without_slip_needs_a_viscosity() {
    let no_slip = "fluid_side = \"inside\"\nwall_friction = \"no-slip\"";
    let text = SCENE.replace("fluid_side = \"inside\"", no_slip);
    assert!(read(&text).is_ok());
    let error = read(&text.replace("viscosity = 0.001", "viscosity = 0"));
    let message = "a wall without slip needs a fluid with a viscosity";
    assert_error(error, ("test.toml", 23, 17), message, "wall_friction = \"slip\"");
}

#[test]
fn wrong_types_name_both_types() {
    assert_edit(
        "0.02",
        "\"fine\"",
        (7, 11),
        "`numerics.spacing` must be a number, found the string \"fine\"",
        "without quotes",
    );
    assert_edit(
        "[0.0, -9.81]",
        "-9.81",
        (4, 11),
        "`gravity` must be an array, found the number -9.81",
        "in brackets",
    );
    assert_edit(
        "-9.81",
        "true",
        (4, 17),
        "`gravity.1` must be a number, found the truth value true",
        "",
    );
    assert_edit("dimension = 2", "dimension = 2.5", (2, 13), "a whole number", "");
    assert_edit("\"inside\"", "1", (22, 14), "one of the choices", "");
    assert_edit("\"tank\"", "1979-05-27", (20, 8), "found the date 1979-05-27", "");
    assert_edit("0.02", "0.02\nsound_speed = \"fast\"", (8, 15), "\"auto\" or a number in m/s", "");
    assert_edit(
        "{ min = [0, 0], max = [4, 3] }",
        "3",
        (21, 7),
        "`solid.0.box` must be a table",
        "",
    );
}

#[test]
fn unknown_choices_show_the_nearest_one() {
    assert_edit(
        "\"inside\"",
        "\"insid\"",
        (22, 14),
        "`solid.0.fluid_side` cannot be \"insid\"",
        "did you mean `inside`?",
    );
    assert_edit(
        "\"velocity\"]",
        "\"temperature\"]",
        (27, 23),
        "cannot be \"temperature\"",
        "choices: `pressure`, `velocity`, `density`",
    );
    assert_edit("0.02", "0.02\nscheme = \"riemann\"", (8, 10), "`numerics.scheme`", "`delta`");
}

#[test]
fn missing_keys_show_the_table() {
    assert_edit(
        "spacing = 0.02",
        "",
        (6, 1),
        "[numerics] lacks the key `spacing`",
        "add `spacing`",
    );
    assert_edit("end_time = 1.0", "", (1, 1), "the scene lacks the key `end_time`", "");
    assert_edit(", max = [1, 2]", "", (15, 13), "lacks the key `max`", "");
    assert_edit(
        "fluid_side = \"inside\"",
        "",
        (19, 1),
        "solid `tank` lacks the key `fluid_side`",
        "\"inside\" for a tank",
    );
    assert_edit("axis = \"x\"", "", (29, 1), "probe `front` lacks the key `axis`", "axis = \"x\"");
}

#[test]
fn values_out_of_range_are_refused_with_a_reason() {
    assert_edit(
        "0.02",
        "-0.02",
        (7, 11),
        "`numerics.spacing` must be positive, found -0.02",
        "0.02",
    );
    assert_edit("0.02", "nan", (7, 11), "infinite, undefined or too large", "");
    assert_edit("0.02", "1e999", (7, 11), "infinite, undefined or too large", "");
    assert_edit(
        "0.02",
        "0.02\ncfl = 1.71",
        (8, 7),
        "at most 1.7, found 1.71",
        "1.72, the linear stability limit",
    );
    assert_edit("0.02", "0.02\ncfl = 0", (8, 7), "must be positive", "");
    assert_edit("0.02", "0.02\nsupport = 30", (8, 11), "between 2 and 6", "3 suits most scenes");
    assert_edit("0.02", "0.02\nsound_speed = -30.0", (8, 15), "must be positive", "auto");
    assert_edit(
        "0.001",
        "-0.001",
        (11, 13),
        "`fluid.water.viscosity` must be 0 or more",
        "inviscid",
    );
    let negative = "0.02\nartificial_viscosity = -1";
    assert_edit("0.02", negative, (8, 24), "between 0 and 1", "usual is 0.02");
    let both = "0.02\nartificial_viscosity = 0.1";
    assert_edit("0.02", both, (8, 24), "cannot act together", "remove one");
    assert_edit("1.0\n", "0\n", (3, 12), "`end_time` must be positive", "");
    assert_edit(
        "dimension = 2",
        "dimension = 4",
        (2, 13),
        "`dimension` must be 2 or 3, found 4",
        "",
    );
    assert_edit(
        "snapshots = 0.1",
        "snapshots = 0",
        (35, 13),
        "`output.snapshots` must be positive",
        "leave the key out",
    );
}

#[test]
fn dimensions_must_agree() {
    assert_edit(
        "[0.0, -9.81]",
        "[0.0, 0.0, -9.81]",
        (4, 11),
        "`gravity` has 3 components",
        "give 2 numbers",
    );
    assert_edit("[1, 2]", "[1, 2, 1]", (15, 35), "box.max` has 3 components", "");
    assert_edit(
        "[\"0\", \"-x^2\"]",
        "[\"0\"]",
        (13, 12),
        "`fluid.water.velocity` has 1 components",
        "",
    );
    assert_edit("-x^2", "-z^2", (13, 18), "it uses z", "use x and y");
    assert_edit("[4.0, 0.1]", "[4.0]", (26, 6), "`probe.0.at` has 1 components", "");
    assert_edit("axis = \"x\"", "axis = \"z\"", (32, 8), "looks along z", "");
    assert_edit(
        "box = { min = [0, 0], max = [4, 3] }",
        "mesh = \"a.stl\"",
        (21, 8),
        "a mesh exists in 3 dimensions only",
        "polygon",
    );
}

#[test]
fn contradictions_are_found() {
    assert_edit(
        "name = \"tank\"",
        "name = \"tank\"\nsphere = { center = [0, 0], radius = 1 }",
        (21, 10),
        "has two shapes: box and sphere",
        "union",
    );
    assert_edit(
        "box = { min = [0, 0], max = [4, 3] }\n",
        "",
        (19, 1),
        "`solid.0` has no shape",
        "box, sphere",
    );
    assert_edit("max = [4, 3]", "max = [4, 0]", (21, 29), "empty along y", "larger than its min");
    assert_edit("name = \"front\"", "name = \"P1\"", (30, 8), "two probes with the name `P1`", "");
    assert_edit("name = \"P1\"", "name = \"a/b\"", (25, 8), "files are named after it", "letters");
    assert_edit(
        "gravity = [0.0, -9.81]",
        "",
        (12, 12),
        "is hydrostatic, but the scene has no gravity",
        "add `gravity`",
    );
    assert_edit(
        "kind = \"front\"",
        "kind = \"front\"\nat = [0, 0]",
        (32, 6),
        "a front probe, which has no `at`",
        "",
    );
    assert_edit(
        "[[solid]]",
        "[fluid.oil]\ndensity = 900\nregions = []\n[[solid]]",
        (19, 1),
        "more than one fluid: `oil` and `water`",
        "keep one",
    );
    let plane = "plane = { point = [0, 0], normal = [0, 0] }";
    assert_edit(
        "box = { min = [0, 0], max = [4, 3] }",
        plane,
        (21, 36),
        "has no direction",
        "[0, 1]",
    );
}

#[test]
fn a_scene_without_fluid_has_nothing_to_simulate() {
    let none = "dimension = 2\nend_time = 1\nnumerics = { spacing = 0.1 }\n";
    assert_error(read(none), ("test.toml", 1, 1), "the scene has no fluid", "[fluid.water]");
    let empty = format!("{none}[fluid.water]\ndensity = 1\nregions = []\n");
    assert_error(
        read(&empty),
        ("test.toml", 6, 11),
        "fluid `water` has no regions",
        "regions = [{ box",
    );
}

#[test]
fn formulas_point_at_their_string() {
    assert_edit(
        "-x^2",
        "sinn(x)",
        (13, 18),
        "the formula \"sinn(x)\" cannot be used: unknown function `sinn`",
        "did you mean `sin`?",
    );
    assert_edit("\"hydrostatic\"", "\"1000*(2 - y\"", (12, 12), "a parenthesis is not closed", "");
    let region = "max = [1, 2] }, velocity = [1, \"t\"] }";
    assert_edit("max = [1, 2] } }", region, (15, 60), "unknown name `t`", "`x`, `y`, `z`");
}

#[test]
fn broken_toml_shows_the_place() {
    assert_edit("= 0.02", "= = 0.02", (7, 11), "not valid TOML", "");
    assert_edit(
        "spacing = 0.02",
        "spacing = 0.02\nspacing = 0.03",
        (8, 1),
        "not valid TOML: duplicate key",
        "",
    );
    assert_edit("[[solid]]", "[[solid]", (19, 9), "not valid TOML", "");
}

#[test]
fn overrides_replace_add_and_create() {
    let scene = set(&[
        "numerics.spacing=0.01",
        "numerics.on_lost=remove",
        "output.energies = 0.005",
        "fluid.water.regions.0.box.max=[2, 1]",
        "name=other name",
        "domain.min=[0,0]",
        "domain.max=[9,9]",
    ])
    .unwrap();
    assert_eq!(*scene.numerics.spacing, 0.01);
    assert_eq!(scene.numerics.on_lost, OnLost::Remove);
    assert_eq!(*scene.output.energies.unwrap(), 0.005);
    assert_eq!(*scene.output.snapshots.unwrap(), 0.1);
    assert_eq!(*scene.fluid["water"].regions[0].r#box.as_ref().unwrap().max.value, [2.0, 1.0]);
    assert_eq!(scene.name(), "other name");
    assert_eq!(*scene.domain.as_ref().unwrap().max.value, [9.0, 9.0]);
    assert_eq!(scene.overrides().count(), 7);
    assert_eq!(scene.text(), SCENE);
}

#[test]
fn mistakes_in_overrides_point_at_the_argument() {
    let here = |column| ("--set", 1, column);
    assert_error(set(&["numerics.spacing=-1"]), here(18), "must be positive, found -1", "");
    assert_error(set(&["numerics.spacng=1"]), here(10), "unknown key `spacng`", "`spacing`");
    assert_error(set(&["numerics.spacing=fine"]), here(18), "found the string \"fine\"", "");
    assert_error(
        set(&["numerics.spacing"]),
        here(1),
        "key.path=value",
        "--set numerics.spacing=0.01",
    );
    assert_error(set(&["numerics..spacing=1"]), here(1), "key.path=value", "");
    assert_error(set(&["gravity=[1, 2"]), here(14), "not valid TOML", "");
    assert_error(
        set(&["numerics.spacing.fine=1"]),
        here(18),
        "the path leads through the number 0.02",
        "",
    );
    assert_error(set(&["solid.1.name=a"]), here(7), "`1` is no index into an array of 1", "0 to 0");
    assert_error(set(&["fluid.water.velocity=[\"0\", \"q\"]"]), here(28), "unknown name `q`", "");
}

#[test]
fn missing_files_and_binary_files_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    let error = Scene::read(&path, &[]).unwrap_err();
    assert!(error.to_string().contains("scene.toml"), "{error}");
    assert!(matches!(error.kind(), ErrorKind::Unreadable { .. }));
    std::fs::write(&path, [b'a', 0xff, 0xfe]).unwrap();
    let error = Scene::read(&path, &[]).unwrap_err();
    assert!(error.to_string().contains("byte 1 is no UTF-8"), "{error}");
    std::fs::write(&path, SCENE.replacen("name = \"test\"", "", 1)).unwrap();
    let scene = Scene::read(&path, &[]).unwrap();
    assert_eq!(scene.name(), "scene");
    assert_eq!(scene.resolve("a.stl".as_ref()), folder.path().join("a.stl"));
}

/// Shows an error as the program does; must not panic whatever the places are.
fn render(error: &SceneError) -> String {
    let mut text = String::new();
    let handler = miette::GraphicalReportHandler::new_themed(miette::GraphicalTheme::none());
    handler.render_report(&mut text, error).unwrap();
    text
}

proptest! {
    #[test]
    fn garbage_never_panics(text in "\\PC{0,200}") {
        if let Err(error) = read(&text) {
            render(&error);
        }
    }

    #[test]
    fn damaged_scenes_never_panic(
        at in 0..SCENE.len(),
        cut in 0..40usize,
        patch in "[ -~\\n\u{e4}\u{2713}]{0,12}",
    ) {
        // The scene is ASCII, so every byte is a character.
        let end = (at + cut).min(SCENE.len());
        let text = format!("{}{patch}{}", &SCENE[..at], &SCENE[end..]);
        if let Err(error) = read(&text) {
            prop_assert!(error.line_and_column().is_some());
            prop_assert!(render(&error).contains("help:"), "{}", render(&error));
        }
    }

    #[test]
    fn any_override_never_panics(argument in "[a-z_.0-9]{0,20}=?\\PC{0,20}") {
        if let Err(error) = set(&[&argument]) {
            render(&error);
        }
    }
}
