use super::*;
use sph_decomp::scale::RankLoad;

const TANK: &str = r#"dimension = 3
end_time = 1.0
gravity = [0.0, 0.0, -10.0]
numerics = { spacing = 0.02 }
[fluid.water]
density = 1000.0
regions = [{ box = { min = [0, 0, 0], max = [1.0, 0.6, 0.5] } }]
[[solid]]
name = "tank"
box = { min = [0, 0, 0], max = [1.6, 0.6, 0.6] }
fluid_side = "inside"
"#;

fn scene(overrides: &[&str]) -> Scene {
    let overrides: Vec<String> = overrides.iter().map(ToString::to_string).collect();
    Scene::parse("test.toml", TANK.into(), &overrides).unwrap()
}

/// Sampled counts agree with those of the particles themselves.
#[track_caller]
fn agree(scene: &Scene, side: i32, tolerance: f64) {
    let geometry = Geometry::<3>::read(scene, None).unwrap();
    let sample = Sample::with_side(scene, &geometry, side).unwrap();
    for costs in [Costs::First, Costs::Lists] {
        let mut sampled = Field::of_blocks(scene, &sample, costs);
        let mut real = Field::<3>::read(scene, costs, false).unwrap();
        assert!(real.block_side.is_none() && sampled.block_side == Some(side));
        let close = |what: &str, a: f64, b: f64, tolerance: f64| {
            assert!((a - b).abs() <= tolerance * b, "{what}: sampled {a}, real {b}");
        };
        close("fluid", sampled.fluid, real.fluid, 0.02);
        close("walls", sampled.walls, real.walls, 0.25);
        for ranks in [2, 8, 27, 64] {
            let (a, b) = (sampled.layout(ranks).unwrap(), real.layout(ranks).unwrap());
            let name = |what: &str| format!("{what} on {ranks} ranks, {costs:?}");
            close(&name("active"), a.sum(RankLoad::active), b.sum(RankLoad::active), 0.02);
            close(&name("inner"), a.sum(|r| r.inner), b.sum(|r| r.inner), tolerance);
            close(&name("outer"), a.sum(|r| r.outer), b.sum(|r| r.outer), tolerance);
            close(&name("largest"), a.max(RankLoad::active), b.max(RankLoad::active), 0.1);
            close(&name("most outer"), a.max(|r| r.outer), b.max(|r| r.outer), 0.15);
            close(&name("pairs"), a.sum(RankLoad::pairs), b.sum(RankLoad::pairs), 0.12);
        }
    }
}

#[test]
fn blocks_agree_with_particles_in_a_tank() {
    agree(&scene(&[]), 4, 0.03);
    agree(&scene(&["numerics.spacing=0.017"]), 3, 0.03);
}

#[test]
fn blocks_agree_with_particles_in_a_ball() {
    let ball = "fluid.water.regions=[{ sphere = { center = [0.5, 0.3, 0.3], radius = 0.29 } }]";
    agree(&scene(&[ball, "numerics.spacing=0.01"]), 3, 0.03);
}

#[test]
fn blocks_of_one_particle_are_the_particles() {
    let scene = scene(&["numerics.spacing=0.05"]);
    let geometry = Geometry::<3>::read(&scene, None).unwrap();
    let sample = Sample::with_side(&scene, &geometry, 1).unwrap();
    let positions = Positions::new(&scene, &geometry).unwrap();
    assert_eq!(sample.fluid(), positions.fluid as f64);
    assert_eq!(sample.walls(), (positions.position.len() - positions.fluid) as f64);
}

#[test]
fn a_number_of_particles_has_a_spacing() {
    let coarse = scene(&[]);
    let spacing = spacing_for::<3>(&coarse, 1e8).unwrap();
    assert!((spacing - (0.3_f64 / 1e8).cbrt()).abs() < 0.01 * spacing);
    let mut field =
        Field::<3>::read(&scene(&[&format!("numerics.spacing={spacing}")]), Costs::Lists, false);
    let field = field.as_mut().unwrap();
    assert!((field.fluid / 1e8 - 1.0).abs() < 0.02, "{}", field.fluid);
    let layout = field.layout(512).unwrap();
    // 200 000 particles per rank: straight cuts between layers would leave some per cent.
    assert!(layout.imbalance(|rank| rank.cost).ratio() < 1.001);
}

#[test]
fn sizes_beyond_reason_are_refused() {
    let tiny = scene(&["numerics.spacing=1e-9"]);
    let error = Field::<3>::read(&tiny, Costs::Lists, false).unwrap_err();
    assert!(error.to_string().contains("`numerics.spacing` must be larger"), "{error}");
}
