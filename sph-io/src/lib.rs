//! Particle files: VTK snapshots, VTKHDF checkpoints, probe tables, all written whole or not at all
