//! Memory: what particles need and what this machine has.

/// Bytes that setting up so many particles in D dimensions takes.
pub fn to_set_up<const D: usize>(particles: f64) -> f64 {
    // Position, velocity, density, mass and kind; the columns grow by doubling.
    let columns = 8 * (2 * D + 2) + 2;
    particles * 1.5 * columns as f64
}

/// Bytes that new processes can still have, where the system says (Linux).
pub fn available() -> Option<f64> {
    from_meminfo(&std::fs::read_to_string("/proc/meminfo").ok()?)
}

fn from_meminfo(text: &str) -> Option<f64> {
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kibibytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024.0 * kibibytes)
}

/// A number of bytes in GiB, as text.
pub fn gibibytes(bytes: f64) -> String {
    format!("{:.1} GiB", bytes / (1u64 << 30) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_what_linux_says() {
        let text = "MemTotal:       16000000 kB\nMemAvailable:    2097152 kB\nBuffers: 1 kB\n";
        assert_eq!(from_meminfo(text), Some(2147483648.0));
        assert_eq!(from_meminfo("MemTotal: 1 kB"), None);
        assert_eq!(gibibytes(2147483648.0), "2.0 GiB");
    }
}
