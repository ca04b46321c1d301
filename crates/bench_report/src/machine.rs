//! The machine that benchmarks run on, and the date.

use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

/// Where and when benchmarks ran.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Machine {
    pub(crate) processor: String,
    pub(crate) cores: usize,
    /// Operating system and architecture.
    pub(crate) system: String,
    pub(crate) rustc: String,
    /// Mean number of running processes in the minute before the benchmark, where the system states it.
    pub(crate) load: Option<f64>,
    /// Day in UTC, as in 2026-11-23.
    pub(crate) date: String,
}

impl Machine {
    /// This machine, now.
    pub(crate) fn here() -> Self {
        let unknown = || "unknown".to_owned();
        let rustc = Command::new("rustc").arg("-V").output().ok();
        let rustc = rustc.map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned());
        let load = std::fs::read_to_string("/proc/loadavg").ok();
        Machine {
            processor: processor().unwrap_or_else(unknown),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            system: format!("{}, {}", std::env::consts::OS, std::env::consts::ARCH),
            rustc: rustc.unwrap_or_else(unknown),
            load: load.and_then(|text| text.split(' ').next()?.parse().ok()),
            date: date(seconds_since_1970() / 86_400),
        }
    }
}

impl Machine {
    /// Whether results of both can be on one page.
    pub(crate) fn is_like(&self, other: &Machine) -> bool {
        let all = |machine: &Machine| {
            let Machine { processor, cores, system, rustc, .. } = machine.clone();
            (processor, cores, system, rustc)
        };
        all(self) == all(other)
    }
}

/// The processor's name, where Linux states it.
fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("model name"))?;
    Some(line.trim_start_matches([' ', '\t', ':']).to_owned())
}

#[expect(clippy::disallowed_methods, reason = "the page states its date")]
fn seconds_since_1970() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_secs())
}

/// The date of a day since 1970-01-01, by Howard Hinnant's `civil_from_days`.
fn date(days: u64) -> String {
    // Days since 0000-03-01, in eras of 400 years.
    let days = days + 719_468;
    let (era, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day_of_year = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month + 2) / 5 + 1;
    let (year, month) = if month < 10 { (year, month + 3) } else { (year + 1, month - 9) };
    format!("{:04}-{month:02}-{day:02}", year + 400 * era)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_have_dates() {
        for (days, expected) in [
            (0, "1970-01-01"),
            (58, "1970-02-28"),
            (59, "1970-03-01"),
            (11_016, "2000-02-29"),
            (19_782, "2024-02-29"),
            (20_780, "2026-11-23"),
            (47_540, "2100-02-28"),
            (47_541, "2100-03-01"),
        ] {
            assert_eq!(date(days), expected);
        }
    }
}
