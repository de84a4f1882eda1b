//! The machine of a measurement.

use serde::Serialize;
use utoipa::ToSchema;

/// The machine of a measurement.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, ToSchema)]
pub struct Machine {
    /// Processor.
    pub cpu: String,
    /// Number of usable cores.
    pub cores: usize,
    /// Operating system.
    pub os: String,
    /// Build profile: `release` or `debug`.
    pub build: &'static str,
}

impl Machine {
    /// This machine; `read` returns the text of a system file if it exists.
    #[must_use]
    pub fn current(read: impl Fn(&str) -> Option<String>) -> Self {
        let read = |path| read(path).unwrap_or_default();
        let cpu = cpu_name(&read("/proc/cpuinfo"));
        Self {
            cpu: cpu.unwrap_or_else(|| std::env::consts::ARCH.to_owned()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            os: os_name(
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

    /// The machine in one line.
    #[must_use]
    pub fn line(&self) -> String {
        let cores = match self.cores {
            1 => "1 core".to_owned(),
            n => format!("{n} cores"),
        };
        format!("{}, {cores}, {}", self.cpu, self.os)
    }
}

/// Name of the processor. ARM kernels report the board instead.
fn cpu_name(cpuinfo: &str) -> Option<String> {
    let of = |key: &str| {
        let mut lines = cpuinfo.lines().filter_map(|line| line.split_once(':'));
        let (_, value) = lines.find(|(name, _)| name.trim() == key)?;
        Some(value.split_whitespace().collect::<Vec<_>>().join(" "))
    };
    of("model name").or_else(|| of("Model"))
}

fn os_name(os_release: &str, kernel: &str) -> String {
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
        assert_eq!(cpu_name(x86).as_deref(), Some("Some CPU @ 3GHz"));
        let arm = "processor\t: 0\nBogoMIPS\t: 108.00\n\nModel\t\t: A Board Rev 1.1\n";
        assert_eq!(cpu_name(arm).as_deref(), Some("A Board Rev 1.1"));
        assert_eq!(cpu_name(""), None);
    }

    #[test]
    fn the_system_is_named_with_its_kernel() {
        let release = "NAME=\"X\"\nPRETTY_NAME=\"X 12 (y)\"\n";
        assert_eq!(os_name(release, "6.1.0\n"), "X 12 (y), kernel 6.1.0");
        assert_eq!(os_name("", ""), std::env::consts::OS);
    }
}
