//! Prints the JSON schema of scene files, which editors use to check and complete them:
//!
//! ```text
//! cargo run -p sph-solver --example scene_schema > sph-solver/scene.schema.json
//! ```

fn main() {
    print!("{}", sph_solver::scene::json_schema());
}
