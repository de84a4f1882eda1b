//! Results per transport, the table of docs/src/kills.md.

use std::collections::BTreeMap;
use std::fmt;
use std::time::Duration;

use firmware_sim::epos2::BrakeState;

use crate::TRANSPORTS;
use crate::bench::Aftermath;

/// Markers around the table in the page.
const MARKS: (&str, &str) = ("<!-- table -->\n", "<!-- end of the table -->");

/// Results, by transport.
#[derive(Default)]
pub struct Table(BTreeMap<&'static str, Kills>);

/// The kills on one transport.
#[derive(Default)]
struct Kills {
    measured: Vec<Aftermath>,
    /// Kills after which a requirement was not met, or that could not be judged.
    failed: usize,
}

impl Table {
    /// Counts one kill.
    pub fn count(&mut self, transport: &'static str, result: Result<&Aftermath, &String>) {
        let kills = self.0.entry(transport).or_default();
        match result {
            Ok(aftermath) => kills.measured.push(*aftermath),
            Err(_) => kills.failed += 1,
        }
    }

    /// Replaces the table in the page.
    pub fn bless(&self) {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/src/kills.md");
        let page = std::fs::read_to_string(path).unwrap();
        let (before, rest) = page.split_once(MARKS.0).unwrap();
        let (_, after) = rest.split_once(MARKS.1).unwrap();
        std::fs::write(path, format!("{before}{}{self}{}{after}", MARKS.0, MARKS.1)).unwrap();
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "| transport | kills | axis moved | powered at rest | power off | standstill: median, longest | power off: median, longest | moving after 1 s | powered after 1 s | brake open after 1 s | failed |"
        )?;
        writeln!(f, "|---|---|---|---|---|---|---|---|---|---|---|")?;
        for transport in TRANSPORTS {
            let Some(Kills {
                measured: all,
                failed,
            }) = self.0.get(transport)
            else {
                continue;
            };
            let count = |is: &dyn Fn(&Aftermath) -> bool| all.iter().filter(|one| is(one)).count();
            let times = |of: &dyn Fn(&Aftermath) -> Duration| {
                let mut times: Vec<Duration> =
                    all.iter().map(of).filter(|t| !t.is_zero()).collect();
                times.sort();
                let ms = |time: Option<&Duration>| {
                    time.map_or("-".to_owned(), |time| format!("{} ms", time.as_millis()))
                };
                format!("{}, {}", ms(times.get(times.len() / 2)), ms(times.last()))
            };
            writeln!(
                f,
                "| {transport} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {failed} |",
                all.len() + failed,
                count(&|one| one.moving_at_signal),
                count(&|one| one.powered_at_signal && !one.moving_at_signal),
                count(&|one| !one.powered_at_signal),
                times(&|one| one.standstill),
                times(&|one| one.power_off),
                count(&|one| one.moves),
                count(&|one| one.powered),
                count(&|one| one.brake == BrakeState::Open),
            )?;
        }
        Ok(())
    }
}
