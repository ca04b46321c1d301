//! The page of results.

use std::fmt::Write;

use bench_ratio::{Bound, Ratio};

use crate::benches::Results;
use crate::machine::Machine;
use crate::saved::Saved;

/// The word before the baseline in the name of a ratio.
const AGAINST: &str = ", against ";

/// The results of a benchmark.
pub(crate) struct Section {
    name: String,
    /// What it measures.
    summary: String,
    saved: Saved,
    results: Results,
}

impl Section {
    pub(crate) fn new(name: String, summary: String, saved: Saved) -> Self {
        let results = Results::read(&saved.printed);
        Section { name, summary, saved, results }
    }

    fn met(&self) -> (usize, usize) {
        let ratios = &self.results.ratios;
        (ratios.iter().filter(|ratio| ratio.is_met()).count(), ratios.len())
    }
}

/// Number of bounds that are met, and of all.
pub(crate) fn met(sections: &[Section]) -> (usize, usize) {
    let each = sections.iter().map(Section::met);
    each.fold((0, 0), |(met, all), (own_met, own)| (met + own_met, all + own))
}

/// The page in Markdown. `all` is the number of benchmarks of the workspace.
pub(crate) fn page(machine: &Machine, sections: &[Section], all: usize) -> String {
    let Machine { processor, cores, system, rustc, .. } = machine;
    let (met, ratios) = met(sections);
    let mut page = format!(
        "# Benchmarks\n\nWritten by `cargo run --release -p bench_report`: {} of {all} benchmarks, with {rustc} on \
         {cores} cores of {processor} ({system}). {met} of {ratios} bounds are met.\n\nEach number is a ratio to a bound \
         or a peer that was measured in the same run, so that it means the same on other machines: the best of several \
         alternating rounds of each side, or the sum where each round is another task. The spread is the ratio in single \
         rounds, without the lowest and the highest quarter of them; sides that were measured apart have no spread. \
         Since the best rounds of the two sides are rarely the same round, a ratio can be outside of its spread. The load \
         is the mean number of processes that ran in the minute before: where it is more than there are cores, spreads \
         are wide.\n",
        sections.len()
    );
    page += "\n| benchmark | date | load | time | bounds met |\n|---|---|---|---|---|\n";
    // Writing to a string does not fail.
    for section in sections {
        let Section { name, saved, .. } = section;
        let load = saved.machine.load.map_or_else(String::new, |load| format!("{load:.1}"));
        let (met, ratios) = section.met();
        let (date, seconds) = (&saved.machine.date, saved.seconds);
        let anchor = name.replace('/', "");
        let _ = writeln!(
            page,
            "| [`{name}`](#{anchor}) | {date} | {load} | {seconds:.0} s | {met} of {ratios} |"
        );
    }
    for Section { name, summary, results: Results { ratios, growths, others }, .. } in sections {
        let _ = write!(page, "\n## `{name}`\n\n{summary}\n");
        if !ratios.is_empty() {
            page += "\n| what | against | ratio | spread | bound | |\n|---|---|---|---|---|---|\n";
            for ratio in ratios {
                page += &row(ratio);
            }
        }
        if !growths.is_empty() {
            page += "\n| cost | grows as size to the power of | from | to |\n|---|---|---|---|\n";
            for growth in growths {
                let (from, to) = growth.sizes;
                let what = cell(&growth.what);
                let _ = writeln!(page, "| {what} | {:.2} | {from:.0} | {to:.0} |", growth.exponent);
            }
        }
        if !others.is_empty() {
            let _ = write!(page, "\n```text\n{}\n```\n", others.join("\n"));
        }
    }
    page
}

fn row(ratio: &Ratio) -> String {
    let (what, against) = ratio.what.rsplit_once(AGAINST).unwrap_or((&ratio.what, ""));
    let (value, bound) = match ratio.bound {
        Bound::AtMost(limit) => (format!("{:.2}", ratio.ratio), format!("at most {limit}")),
        Bound::AtLeast(limit) => {
            (format!("{:.1} times as fast", ratio.ratio), format!("at least {limit}"))
        }
    };
    let spread = ratio.spread.map_or_else(String::new, |(low, high)| match ratio.bound {
        Bound::AtMost(_) => format!("{low:.2} to {high:.2}"),
        Bound::AtLeast(_) => format!("{low:.1} to {high:.1}"),
    });
    let met = if ratio.is_met() { "met" } else { "**missed**" };
    format!("| {} | {} | {value} | {spread} | {bound} | {met} |\n", cell(what), cell(against))
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
    use super::*;

    #[test]
    fn a_page_holds_every_result() {
        let machine = Machine {
            processor: "Z80".to_owned(),
            cores: 1,
            system: "cp_m, z80".to_owned(),
            rustc: "rustc 1.95.0".to_owned(),
            load: Some(0.52),
            date: "1976-07-01".to_owned(),
        };
        let printed = "a | b, c, against d: 1.50 x (rounds: 1.50 to 1.75) (target: at most 2 x, met)\n  3 ms\n\
            e: 10.0 x as fast (target: at least 20 x, MISSED)\ntrees: grows as size^1.00 from 10 to 1e4\n";
        let saved = Saved { machine: machine.clone(), seconds: 12.3, printed: printed.to_owned() };
        let section = Section::new("envgen/forest".to_owned(), "Trees.".to_owned(), saved);
        let page = page(&machine, &[section], 16);
        for expected in [
            "1 of 16 benchmarks, with rustc 1.95.0 on 1 cores of Z80 (cp_m, z80). 1 of 2 bounds are met.",
            "| [`envgen/forest`](#envgenforest) | 1976-07-01 | 0.5 | 12 s | 1 of 2 |\n",
            "## `envgen/forest`\n\nTrees.\n\n| what | against |",
            "| a \\| b, c | d | 1.50 | 1.50 to 1.75 | at most 2 | met |\n",
            "| e |  | 10.0 times as fast |  | at least 20 | **missed** |\n",
            "| trees | 1.00 | 10 | 10000 |\n",
            "```text\n  3 ms\n```\n",
        ] {
            assert!(page.contains(expected), "{expected}\n{page}");
        }
    }
}
