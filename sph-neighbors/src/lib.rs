//! Cell lists and neighbour lists over particle positions and radii, in a canonical order
