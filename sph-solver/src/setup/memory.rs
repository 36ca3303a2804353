//! Memory: what particles need and what this machine has.

/// Bytes that setting up so many particles in D dimensions takes.
pub fn to_set_up<const D: usize>(particles: f64) -> f64 {
    // Position, velocity, density, mass and kind. Columns grow by doubling, and there is what finds
    // the particles and what they are connected with; measured: 140 bytes in two dimensions.
    let columns = 8 * (2 * D + 2) + 2;
    particles * 3.0 * columns as f64
}

/// Bytes that this process can still have, where the system says (Linux): what is free, or what its
/// limit of address space (`ulimit -v`) leaves.
pub fn available() -> Option<f64> {
    let read = |path: &str| std::fs::read_to_string(path).ok();
    let free = read("/proc/meminfo").and_then(|text| from_meminfo(&text));
    let limit = read("/proc/self/limits").and_then(|text| from_limits(&text));
    let taken = read("/proc/self/status").and_then(|text| in_kibibytes(&text, "VmSize:"));
    let left = limit.map(|limit| (limit - taken.unwrap_or(0.0)).max(0.0));
    match (free, left) {
        (Some(free), Some(left)) => Some(free.min(left)),
        (one, other) => one.or(other),
    }
}

/// The soft limit of address space, unless there is none.
fn from_limits(text: &str) -> Option<f64> {
    let line = text.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    line.split_whitespace().next()?.parse().ok()
}

fn from_meminfo(text: &str) -> Option<f64> {
    in_kibibytes(text, "MemAvailable:")
}

/// The number of a line that begins with `title`, in bytes.
fn in_kibibytes(text: &str, title: &str) -> Option<f64> {
    let line = text.lines().find_map(|line| line.strip_prefix(title))?;
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
        let limits = |soft: &str| {
            from_limits(&format!(
                "Limit Soft\nMax address space         {soft}    unlimited  bytes\n"
            ))
        };
        assert_eq!((limits("209715200"), limits("unlimited")), (Some(209_715_200.0), None));
        assert_eq!(gibibytes(2147483648.0), "2.0 GiB");
    }
}
