//! How much memory the process has.

/// Memory of this process (MiB) that lies in the machine's memory, from `/proc/self/statm`; `None` where the system does not
/// tell.
pub(super) fn resident_mebibytes() -> Option<f64> {
    // "size resident shared …", in pages; 4 KiB each but where the kernel was built with larger ones, which changes no ratio.
    const PAGE: f64 = 4096.0 / 1_048_576.0;
    let text = std::fs::read_to_string("/proc/self/statm").ok()?;
    let pages: u64 = text.split_whitespace().nth(1)?.parse().ok()?;
    Some(pages as f64 * PAGE)
}
