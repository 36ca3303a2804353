//! Prints the page about scene files of the documentation:
//!
//! ```text
//! cargo run -p sph-solver --example scene_manual > docs/scene.md
//! ```

fn main() {
    print!("{}", sph_solver::scene::manual());
}
