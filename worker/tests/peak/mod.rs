//! The peak of the resident set. Of the whole process, and it never falls: one measurement a test program.

/// Most memory the process has had so far [bytes].
pub fn peak_resident() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("Linux says how much memory is used");
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).expect("a line for the peak");
    let kilobytes = line.trim().strip_suffix(" kB").expect("in kB");
    1024 * kilobytes.trim().parse::<u64>().expect("a number")
}
