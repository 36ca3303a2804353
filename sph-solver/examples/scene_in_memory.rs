//! A scene from a text instead of a file, run as `sph run` does, with the summary at hand: for programs that make
//! their own scenes.
//!
//! `cargo run --release -p sph-solver --example scene_in_memory`

use sph_solver::run::{RunOptions, World, run};
use sph_solver::scene::Scene;

const SCENE: &str = r#"
name = "column"
dimension = 2
end_time = 0.3
gravity = [0, -9.81]

[numerics]
spacing = 0.025

[fluid.water]
density = 1000
pressure = "hydrostatic"
regions = [{ box = { min = [0, 0], max = [0.5, 1] } }]

[[solid]]
name = "tank"
box = { min = [0, 0], max = [2, 1.5] }
fluid_side = "inside"
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let out = std::env::temp_dir().join(format!("sph-column-{}", std::process::id()));
    for height in [0.5, 1.0] {
        let change = format!("fluid.water.regions.0.box.max=[0.5, {height}]");
        let scene = Scene::parse("column.toml", SCENE.into(), &[change])?;
        let options = RunOptions { out: out.join(height.to_string()), ..RunOptions::default() };
        let summary = run(&World::start()?, &scene, &options, &|_| ())?;
        let load = summary.solids.iter().map(|solid| solid.largest_force).fold(0.0, f64::max);
        println!(
            "{height} m: {} particles, {} steps, largest force on the tank {load:.0} N/m, results in {}",
            summary.particles.fluid,
            summary.steps,
            options.out.display()
        );
    }
    Ok(())
}
