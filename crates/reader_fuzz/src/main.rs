//! Reads many mutated files of every format, in processes of limited memory and time.
//!
//! Cases that panic, abort, hang or take more than two seconds of computing time are counted, and the first
//! ones of each kind are kept. A run resumes where the previous one stopped.

use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::io::{BufRead, BufReader, IsTerminal, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use clap::{Parser, Subcommand};
use indicatif::{ProgressBar, ProgressStyle};
use reader_fuzz::mutate::mutated;
use reader_fuzz::{FORMATS, Format, work};

/// The number of cases per process.
const BATCH: u64 = 2000;

/// The time without output after which a process is killed. It is much longer than a case may compute,
/// because other programs may use the machine.
const SILENCE: Duration = Duration::from_secs(300);

/// The number of files that are kept per kind of finding.
const KEPT: u64 = 5;

#[derive(Parser)]
struct Arguments {
    /// Cases of each format.
    #[arg(long, default_value_t = 100_000)]
    cases: u64,
    /// The formats [default: all].
    #[arg(long)]
    format: Vec<String>,
    /// Memory limit of each process, in MiB.
    #[arg(long, default_value_t = 1024)]
    memory: u64,
    /// The folder for findings and progress.
    #[arg(long, default_value = "target/reader_fuzz")]
    out: PathBuf,
    #[command(subcommand)]
    other: Option<Other>,
}

#[derive(Subcommand)]
enum Other {
    /// Reads the cases of a range in this process.
    Work {
        /// The format.
        format: String,
        /// The first case.
        from: u64,
        /// The case after the last.
        to: u64,
    },
    /// Reads one file.
    File {
        /// The format.
        format: String,
        /// The file.
        path: PathBuf,
    },
}

/// The results so far of the cases of a format.
#[derive(Default)]
struct Progress {
    next: u64,
    read: u64,
    /// The number of findings of each kind.
    found: BTreeMap<String, u64>,
}

#[expect(clippy::print_stdout, reason = "the result of the program")]
fn main() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::parse();
    match &arguments.other {
        Some(Other::Work { format, from, to }) => {
            let ended = work::work(named(format)?, *from..*to);
            return ended.map_err(|_| "the reading thread has ended".into());
        }
        Some(Other::File { format, path }) => {
            let file = fs::read(path)?;
            let before = work::seconds();
            let read = (named(format)?.read)(&file);
            println!("read: {read}, in {:.2} s", work::seconds() - before);
            return Ok(());
        }
        None => {}
    }
    let mut formats: Vec<&Format> =
        arguments.format.iter().map(|name| named(name)).collect::<Result<_, _>>()?;
    if formats.is_empty() {
        formats = FORMATS.iter().collect();
    }
    fs::create_dir_all(&arguments.out)?;
    let mut findings = 0;
    for format in formats {
        let progress = format_cases(format, &arguments)?;
        let Progress { next, read, found } = &progress;
        println!("{}: {next} files, of which {read} were read; findings: {found:?}", format.name);
        findings += found.values().sum::<u64>();
    }
    if findings > 0 { Err(format!("{findings} findings").into()) } else { Ok(()) }
}

fn named(name: &str) -> Result<&'static Format, String> {
    FORMATS.iter().find(|format| format.name == name).ok_or_else(|| {
        let names: Vec<_> = FORMATS.iter().map(|format| format.name).collect();
        format!("unknown format `{name}`; expected one of {}", names.join(", "))
    })
}

fn format_cases(format: &Format, arguments: &Arguments) -> Result<Progress, Box<dyn Error>> {
    let file = arguments.out.join(format!("{}.progress.json", format.name));
    let mut progress = Progress::load(&file)?;
    let corpus = (format.corpus)();
    let bar = bar(format.name, arguments.cases, progress.next);
    while progress.next < arguments.cases {
        let to = (progress.next + BATCH).min(arguments.cases);
        let batch = Batch::run(format, progress.next..to, arguments.memory)?;
        for (case, kind, details) in &batch.findings {
            let count = progress.found.entry(kind.clone()).or_default();
            *count += 1;
            if *count <= KEPT {
                let name = format!("{}-{case}", format.name);
                let input = arguments.out.join(format!("{name}.{}", format.ending));
                fs::write(input, mutated(&corpus, format.name, *case))?;
                let text = format!("{kind}\n{details}\n");
                fs::write(arguments.out.join(format!("{name}.finding.txt")), text)?;
            }
        }
        progress.next = batch.next;
        progress.read += batch.read;
        progress.save(&file)?;
        bar.set_position(progress.next);
    }
    bar.finish_and_clear();
    Ok(progress)
}

/// Creates a progress bar on stderr that starts with the files that were read before, or a hidden one if
/// stderr is not a terminal.
fn bar(format: &'static str, cases: u64, done: u64) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(cases).with_message(format);
    bar.set_position(done);
    bar.reset_eta();
    bar.enable_steady_tick(Duration::from_millis(500));
    match ProgressStyle::with_template("{msg} {bar:40} {pos}/{len} files, {per_sec}, {eta} left") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

/// The output of one process.
struct Batch {
    next: u64,
    read: u64,
    /// Case, kind and details.
    findings: Vec<(u64, String, String)>,
}

impl Batch {
    fn run(
        format: &Format,
        cases: std::ops::Range<u64>,
        memory: u64,
    ) -> Result<Batch, Box<dyn Error>> {
        let mut child = spawn(format, &cases, memory)?;
        let Some(output) = child.stdout.take() else { return Err("no output".into()) };
        let (sender, lines) = mpsc::channel();
        std::thread::spawn(move || {
            for line in BufReader::new(output).lines().map_while(Result::ok) {
                if sender.send(line).is_err() {
                    return;
                }
            }
        });
        let mut batch = Batch { next: cases.start, read: 0, findings: Vec::new() };
        let mut case = cases.start;
        loop {
            match lines.recv_timeout(SILENCE) {
                Ok(line) => batch.take(&line, &mut case),
                Err(RecvTimeoutError::Timeout) => {
                    child.kill()?;
                    child.wait()?;
                    batch.findings.push((case, "no end".to_owned(), String::new()));
                    batch.next = case + 1;
                    return Ok(batch);
                }
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        let mut words = String::new();
        if let Some(errors) = &mut child.stderr {
            errors.take(2000).read_to_string(&mut words)?;
        }
        let status = child.wait()?;
        if status.success() {
            batch.next = cases.end;
        } else {
            let what = words.lines().next().unwrap_or_default();
            let digit = |c: char| c.is_ascii_digit();
            let kind = format!("{status}: {}", what.replace(digit, "#"));
            batch.findings.push((case, kind, words.clone()));
            batch.next = case + 1;
        }
        Ok(batch)
    }

    fn take(&mut self, line: &str, case: &mut u64) {
        let mut words = line.splitn(3, ' ');
        let (Some(word), Some(Ok(number))) = (words.next(), words.next().map(str::parse)) else {
            return;
        };
        let rest = words.next().unwrap_or_default();
        match word {
            "case" => *case = number,
            "read" => self.read = number,
            "slow" => self.findings.push((number, "slow".to_owned(), rest.to_owned())),
            "panic" => {
                let place = rest.split(": ").next().unwrap_or_default();
                self.findings.push((number, format!("panic at {place}"), rest.to_owned()));
            }
            _ => {}
        }
    }
}

/// Starts a process with limited memory that reads cases.
fn spawn(format: &Format, cases: &std::ops::Range<u64>, memory: u64) -> std::io::Result<Child> {
    let script = format!("ulimit -v {} && exec \"$0\" \"$@\"", memory * 1024);
    Command::new("sh")
        .args(["-c", &script])
        .arg(std::env::current_exe()?)
        .args(["work", format.name, &cases.start.to_string(), &cases.end.to_string()])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
}

impl Progress {
    fn load(path: &Path) -> Result<Self, Box<dyn Error>> {
        let Ok(text) = fs::read(path) else { return Ok(Progress::default()) };
        let value: serde_json::Value = serde_json::from_slice(&text)?;
        let (next, read, found) = serde_json::from_value(value)?;
        Ok(Progress { next, read, found })
    }

    fn save(&self, path: &Path) -> Result<(), Box<dyn Error>> {
        Ok(fs::write(path, serde_json::to_vec(&(self.next, self.read, &self.found))?)?)
    }
}
