//! Memory of this process.

/// Largest resident memory of this process so far in bytes, from `VmHWM` of `/proc/self/status`;
/// `None` where there is no such file.
pub fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes * 1024)
}

#[cfg(test)]
mod tests {
    #[test]
    #[cfg(target_os = "linux")]
    fn touched_memory_counts() {
        let before = super::peak_memory().expect("Linux tells");
        let memory = std::hint::black_box(vec![1_u8; 64 << 20]);
        assert!(super::peak_memory().expect("Linux tells") >= before.min(memory.len() as u64));
        assert!(super::peak_memory().expect("Linux tells") >= memory.len() as u64);
    }
}
