//! The `sph` program.

fn main() -> std::process::ExitCode {
    sph_solver::cli::main()
}
