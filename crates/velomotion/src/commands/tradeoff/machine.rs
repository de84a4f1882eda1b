//! What this machine is, as the system tells it.

use std::fs::read_to_string;

use analysis::tradeoff::Machine;

/// This machine. What the system does not tell is said by the architecture's name.
pub(super) fn this() -> Machine {
    let read = |path: &str| read_to_string(path).unwrap_or_default();
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    Machine {
        cpu: cpu(&read("/proc/cpuinfo")).unwrap_or_else(|| std::env::consts::ARCH.to_owned()),
        cores,
        os: os(
            &read("/etc/os-release"),
            &read("/proc/sys/kernel/osrelease"),
        ),
        build: if cfg!(debug_assertions) {
            "debug"
        } else {
            "release"
        },
    }
}

/// The processor's name; ARM kernels give the whole board's instead.
fn cpu(cpuinfo: &str) -> Option<String> {
    let of = |key: &str| {
        let mut lines = cpuinfo.lines().filter_map(|line| line.split_once(':'));
        let (_, value) = lines.find(|(name, _)| name.trim() == key)?;
        Some(value.split_whitespace().collect::<Vec<_>>().join(" "))
    };
    of("model name").or_else(|| of("Model"))
}

fn os(os_release: &str, kernel: &str) -> String {
    let mut lines = os_release.lines();
    let name = lines.find_map(|line| line.strip_prefix("PRETTY_NAME="));
    let name = name.map_or(std::env::consts::OS, |name| name.trim_matches('"'));
    match kernel.trim() {
        "" => name.to_owned(),
        kernel => format!("{name}, kernel {kernel}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn processors_are_named_on_both_architectures() {
        let x86 = "processor\t: 0\nmodel\t\t: 17\nmodel name\t: Some  CPU @ 3GHz\n";
        assert_eq!(cpu(x86).as_deref(), Some("Some CPU @ 3GHz"));
        let arm = "processor\t: 0\nBogoMIPS\t: 108.00\n\nModel\t\t: A Board Rev 1.1\n";
        assert_eq!(cpu(arm).as_deref(), Some("A Board Rev 1.1"));
        assert_eq!(cpu(""), None);
    }

    #[test]
    fn the_system_is_named_with_its_kernel() {
        let release = "NAME=\"X\"\nPRETTY_NAME=\"X 12 (y)\"\n";
        assert_eq!(os(release, "6.1.0\n"), "X 12 (y), kernel 6.1.0");
        assert_eq!(os("", ""), std::env::consts::OS);
    }
}
