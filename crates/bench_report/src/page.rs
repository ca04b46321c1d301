//! The page of results.

use std::fmt::Write;

use bench_ratio::{Bound, Ratio};

use crate::benches::Results;
use crate::machine::Machine;

/// Number of bounds that are met, and of all.
pub(crate) fn met(results: &[Results]) -> (usize, usize) {
    let ratios = || results.iter().flat_map(|results| &results.ratios);
    (ratios().filter(|ratio| ratio.is_met()).count(), ratios().count())
}

/// The page in Markdown. `all` is the number of benchmarks of the workspace.
pub(crate) fn page(machine: &Machine, results: &[Results], all: usize) -> String {
    let Machine { processor, cores, system, rustc, load, date } = machine;
    let load = load.as_ref().map_or_else(String::new, |load| {
        format!(" When they began, {load} processes were running on it.")
    });
    let (met, ratios) = met(results);
    let mut page = format!(
        "# Benchmarks\n\nWritten by `cargo run --release -p bench_report`: {} of {all} benchmarks, on {date}, by \
         {rustc}, on {cores} cores of {processor} ({system}).{load}\n\nEach number is a ratio to a bound or a peer that \
         was measured in the same run, so that it means the same on other machines; the best of several rounds of each \
         counts. {met} of {ratios} bounds are met.\n",
        results.len()
    );
    // Writing to a string does not fail.
    for Results { name, ratios, growths, others, failed } in results {
        let _ = write!(page, "\n## `{name}`\n");
        if *failed {
            page += "\nIt ended with an error.\n";
        }
        if !ratios.is_empty() {
            page += "\n| what | ratio | bound | |\n|---|---|---|---|\n";
            for ratio in ratios {
                page += &row(ratio);
            }
        }
        if !growths.is_empty() {
            page += "\n| cost | grows as size to the power of | from | to |\n|---|---|---|---|\n";
            for growth in growths {
                let (from, to) = growth.sizes;
                let what = cell(&growth.what);
                let _ = writeln!(page, "| {what} | {:.2} | {from} | {to} |", growth.exponent);
            }
        }
        if !others.is_empty() {
            let _ = write!(page, "\n```text\n{}\n```\n", others.join("\n"));
        }
    }
    page
}

fn row(ratio: &Ratio) -> String {
    let (value, bound) = match ratio.bound {
        Bound::AtMost(limit) => (format!("{:.2}", ratio.ratio), format!("at most {limit}")),
        Bound::AtLeast(limit) => {
            (format!("{:.1} times as fast", ratio.ratio), format!("at least {limit}"))
        }
    };
    let met = if ratio.is_met() { "met" } else { "**missed**" };
    format!("| {} | {value} | {bound} | {met} |\n", cell(&ratio.what))
}

/// A text that is no Markdown in a table.
fn cell(text: &str) -> String {
    let mut escaped = String::new();
    for c in text.chars() {
        if "|*_`<[\\".contains(c) {
            escaped.push('\\');
        }
        escaped.push(c);
    }
    escaped
}

#[cfg(test)]
mod tests {
    use bench_ratio::Growth;

    use super::*;

    #[test]
    fn a_page_holds_every_result() {
        let machine = Machine {
            processor: "Z80".to_owned(),
            cores: 1,
            system: "cp_m, z80".to_owned(),
            rustc: "rustc 1.95.0".to_owned(),
            load: Some("0.5".to_owned()),
            date: "1976-07-01".to_owned(),
        };
        let ratio = |what: &str, ratio, bound| Ratio { what: what.to_owned(), ratio, bound };
        let results = Results {
            name: "envgen/forest".to_owned(),
            ratios: vec![
                ratio("a | b", 1.5, Bound::AtMost(2.0)),
                ratio("c", 10.0, Bound::AtLeast(20.0)),
            ],
            growths: vec![Growth { what: "trees".to_owned(), exponent: 1.0, sizes: (10.0, 1e4) }],
            others: vec!["  3 ms".to_owned()],
            failed: true,
        };
        let page = page(&machine, &[results], 16);
        for expected in [
            "1 of 16 benchmarks, on 1976-07-01, by rustc 1.95.0, on 1 cores of Z80",
            "1 of 2 bounds are met.",
            "## `envgen/forest`\n\nIt ended with an error.\n\n| what |",
            "| a \\| b | 1.50 | at most 2 | met |\n| c | 10.0 times as fast | at least 20 | **missed** |\n",
            "| trees | 1.00 | 10 | 10000 |\n",
            "```text\n  3 ms\n```\n",
        ] {
            assert!(page.contains(expected), "{expected}\n{page}");
        }
    }
}
