//! Smoothed particle hydrodynamics: scenes, schemes, time integration and the sph program
