//! What the benchmarks share: particle fields of known size.
