//! Solids for particle methods: mesh import and repair checks, signed distance, boundary particles
