//! Smoothing kernels for SPH with variable support radii, for scalars and SIMD lanes
