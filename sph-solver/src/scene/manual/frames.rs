//! The scenes in which the examples are tried.

/// What every frame begins with, in two dimensions.
pub const PLANE: &str = r#"dimension = 2
end_time = 1
gravity = [0, -9.81]
numerics = { spacing = 0.02 }

[fluid.water]
density = 1000
regions = [{ box = { min = [0, 0], max = [0.5, 0.5] } }]
"#;

/// In three.
pub const SPACE: &str = r#"dimension = 3
end_time = 1
gravity = [0, 0, -9.81]
numerics = { spacing = 0.02 }

[fluid.water]
density = 1000
regions = [{ box = { min = [0, 0, 0], max = [0.5, 0.5, 0.5] } }]
"#;

const DOMAIN: &str = "domain={ min = [0, 0], max = [2, 1] }";
const HULL: &str = "solid=[{ name = \"hull\", fluid_side = \"outside\", sphere = { center = [1, 1], radius = 0.2 } }]";
const SPACE_HULL: &str =
    "solid=[{ name = \"hull\", fluid_side = \"outside\", mesh = \"hull.stl\" }]";
const BARE: &str = "solid=[{ name = \"hull\", fluid_side = \"outside\" }]";
const REFINED: &str = "refine=[{ factor = 2, sphere = { center = [0, 0], radius = 0.1 } }]";
const VISCOUS: &str = "fluid.water.viscosity=0.001";

/// Where a table is in a scene, with "3:" before it in three dimensions, and what the scene says there without
/// the example: an example suits one of these.
pub fn frames(definition: &str) -> &'static [(&'static str, &'static [&'static str])] {
    match definition {
        "" => &[("", &[]), ("", &[DOMAIN])],
        "Numerics" => &[("numerics", &[])],
        "Fluid" => &[("fluid.water", &[]), ("fluid.water", &["fluid.water.jitter=0.1"])],
        "Refine" => &[("refine.0", &[REFINED]), ("refine.0", &[HULL, "refine=[{ factor = 2 }]"])],
        "Region" => &[("fluid.water.regions.0", &[])],
        "Solid" => &[("solid.0", &[HULL]), ("solid.0", &[HULL, VISCOUS])],
        "ShapeKeys" => &[
            ("solid.0", &[BARE]),
            ("solid.0", &[HULL]),
            ("3:solid.0", &[SPACE_HULL]),
            ("3:solid.0", &[BARE]),
            ("solid.0", &["solid=[{ name = \"floor\" }]"]),
        ],
        "BoxKeys" => &[("solid.0.box", &[BARE, "solid.0.box={ min = [-1, -1], max = [2, 2] }"])],
        "SphereKeys" => &[("solid.0.sphere", &[HULL])],
        "AxisKeys" => &[(
            "solid.0.capsule",
            &[BARE, "solid.0.capsule={ from = [1, 1], to = [2, 1], radius = 0.3 }"],
        )],
        "PlaneKeys" => &[(
            "solid.0.plane",
            &["solid=[{ name = \"floor\", plane = { point = [0, 0], normal = [0, 1] } }]"],
        )],
        "RotationKeys" => &[(
            "3:solid.0.rotate",
            &[SPACE_HULL, "solid.0.rotate={ axis = [1, 0, 0], degrees = 10 }"],
        )],
        "Motion" => &[
            ("solid.0.motion", &[HULL, "solid.0.motion={}"]),
            ("solid.0.motion", &[HULL, "solid.0.motion={ spin = 1 }"]),
            ("3:solid.0.motion", &[SPACE_HULL, "solid.0.motion={ spin = 1 }"]),
        ],
        "Body" => &[
            ("solid.0.body", &[HULL, "solid.0.body={}"]),
            ("solid.0.body", &[HULL, "solid.0.body={ density = 500 }"]),
            ("3:solid.0.body", &[SPACE_HULL, "solid.0.body={ density = 500, spin = 1 }"]),
        ],
        "Spring" => &[(
            "solid.0.body.springs.0",
            &[
                HULL,
                "solid.0.body={ density = 500, springs = [{ anchor = [1, 0], stiffness = 1 }] }",
            ],
        )],
        "Domain" => &[("domain", &[DOMAIN])],
        "Probe" => &[
            ("probe.0", &["probe=[{ name = \"P\", at = [0, 0], fields = [\"pressure\"] }]"]),
            (
                "probe.0",
                &[
                    "probe=[{ name = \"P\", kind = \"patch\", at = [0, 0], radius = 0.1, fields = [\"pressure\"] }]",
                ],
            ),
            ("probe.0", &["probe=[{ name = \"P\", kind = \"front\" }]"]),
        ],
        "Output" => &[("output", &["output={ snapshots = 0.1 }"])],
        "Reference" => &[
            ("reference", &["reference={}"]),
            ("reference", &["reference={ velocity = [\"0\", \"0\"] }"]),
            (
                "reference",
                &[
                    "reference={ table = \"energies\", column = \"kinetic\" }",
                    "output={ energies = 0.1 }",
                ],
            ),
            (
                "reference",
                &[
                    "reference={ table = \"energies\", column = \"kinetic\", formula = \"0\" }",
                    "output={ energies = 0.1 }",
                    "probe=[{ name = \"front\", kind = \"front\", axis = \"x\" }]",
                ],
            ),
            (
                "reference",
                &[
                    "reference={ table = \"energies\", column = \"kinetic\", file = \"a.csv\" }",
                    "output={ energies = 0.1 }",
                ],
            ),
        ],
        "StudyKeys" => &[("study", &["fluid.water.jitter=0.1"])],
        _ => &[],
    }
}
