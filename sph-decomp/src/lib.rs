//! Domain decomposition for particles: partition, migration, piecewise overlap zone, overlapped halo exchange
