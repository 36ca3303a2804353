//! The `sph` program.
fn main() {}
