//! Networks by name or from a file.

use super::error::StudyError;
use serde::{Deserialize, Serialize};
use sph_decomp::scale::Network;
use std::path::Path;

/// A network and what it is called; the form of a network file.
///
/// ```toml
/// name = "our cluster"     # optional
/// latency = 1.5e-6         # s, L: on the wire
/// overhead = 0.5e-6        # s, o: of a core per message sent or received
/// gap = 0.5e-6             # s, g: between two messages of a rank
/// node_bandwidth = 6.0e9   # bytes/s and direction of the interface of a node
/// ranks_per_node = 32
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NamedNetwork {
    /// What reports call it.
    #[serde(default)]
    pub name: String,
    /// L, s.
    pub latency: f64,
    /// o, s.
    pub overhead: f64,
    /// g, s.
    pub gap: f64,
    /// Bytes per second and direction of the interface of a node.
    pub node_bandwidth: f64,
    /// Ranks that share it.
    pub ranks_per_node: f64,
}

impl NamedNetwork {
    /// The numbers alone.
    pub fn parameters(&self) -> Network {
        let Self { latency, overhead, gap, node_bandwidth, ranks_per_node, .. } = *self;
        Network { latency, overhead, gap, node_bandwidth, ranks_per_node }
    }
}

/// The network of this name, or in this file.
///
/// # Errors
///
/// When there is no such name and no such file, or the file does not hold the five numbers.
pub fn network(name: &str) -> Result<NamedNetwork, StudyError> {
    if let Ok(Network { latency, overhead, gap, node_bandwidth, ranks_per_node }) =
        Network::named(name)
    {
        let name = name.into();
        return Ok(NamedNetwork { name, latency, overhead, gap, node_bandwidth, ranks_per_node });
    }
    let path = Path::new(name);
    let text = std::fs::read_to_string(path)
        .map_err(|source| StudyError::NetworkFile { path: path.into(), source })?;
    let mut network: NamedNetwork = toml::from_str(&text).map_err(|error| {
        let reason = error.to_string().trim_end().to_owned();
        StudyError::NetworkFormat { path: path.into(), reason }
    })?;
    network.parameters().check().map_err(|error| {
        let reason = error.to_string();
        StudyError::NetworkFormat { path: path.into(), reason }
    })?;
    if network.name.is_empty() {
        network.name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    }
    Ok(network)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn networks_are_read_by_name_and_from_files() {
        assert_eq!(network("gemini").unwrap().parameters(), Network::GEMINI);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ours.toml");
        let good = "latency = 1e-6\noverhead = 2e-7\ngap = 3e-7\nnode_bandwidth = 1e10\n\
                    ranks_per_node = 64\n";
        std::fs::write(&path, good).unwrap();
        let read = || network(&path.to_string_lossy());
        let found = read().unwrap();
        assert_eq!((found.name.as_str(), found.gap, found.ranks_per_node), ("ours", 3e-7, 64.0));
        for (text, message) in [
            (good.replace("gap", "gasp"), "unknown field `gasp`"),
            (good.replace("gap = 3e-7\n", ""), "missing field `gap`"),
            (good.replace("3e-7", "-3e-7"), "`gap` is -0.0000003; it must be a positive number"),
        ] {
            std::fs::write(&path, text).unwrap();
            let error = read().unwrap_err().to_string();
            assert!(error.contains(message) && error.contains("ours.toml"), "{error}");
        }
        let error = network("token ring").unwrap_err().to_string();
        assert!(error.contains("token ring") && error.contains("slingshot"), "{error}");
    }
}
