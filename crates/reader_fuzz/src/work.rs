//! A process that reads many cases, and reports each before it starts.

use std::panic::{self, AssertUnwindSafe};
use std::sync::atomic::{AtomicU64, Ordering};

use crate::formats::Format;
use crate::mutate::mutated;

/// The limit of the computing time per case, in seconds.
pub const LIMIT: f64 = 2.0;

/// The stack size of the reading thread in bytes, which is the default of Rust's threads.
const STACK: usize = 2 << 20;

/// The case that is being read.
static CASE: AtomicU64 = AtomicU64::new(0);

/// Reads cases of a format. Prints a line `case N` before each, `panic N WHERE: WHAT` and `slow N
/// SECONDS` after a panic or a slow case, and `read COUNT` at the end.
#[expect(clippy::print_stdout, reason = "the parent process reads it")]
pub fn work(format: &'static Format, cases: std::ops::Range<u64>) -> std::thread::Result<()> {
    panic::set_hook(Box::new(|info| {
        let place = info.location().map_or_else(String::new, ToString::to_string);
        let what = info.payload_as_str().unwrap_or_default().replace('\n', " ");
        println!("panic {} {place}: {what}", CASE.load(Ordering::Relaxed));
    }));
    let run = move || {
        let corpus = (format.corpus)();
        let mut read = 0_u64;
        for case in cases {
            println!("case {case}");
            CASE.store(case, Ordering::Relaxed);
            let file = mutated(&corpus, format.name, case);
            let before = seconds();
            let whole = panic::catch_unwind(AssertUnwindSafe(|| (format.read)(&file)));
            let took = seconds() - before;
            if took > LIMIT {
                println!("slow {case} {took:.2}");
            }
            read += u64::from(whole.unwrap_or(false));
        }
        println!("read {read}");
    };
    match std::thread::Builder::new().stack_size(STACK).spawn(run) {
        Ok(thread) => thread.join(),
        Err(error) => Err(Box::new(error)),
    }
}

/// Returns whether a file could be read.
///
/// # Errors
/// Returns the message of a panic.
pub fn attempt(format: &Format, file: &[u8]) -> Result<bool, String> {
    panic::catch_unwind(AssertUnwindSafe(|| (format.read)(file))).map_err(|payload| {
        let text = payload.downcast_ref::<String>().cloned();
        text.or_else(|| payload.downcast_ref::<&str>().map(|&text| text.to_owned()))
            .unwrap_or_default()
    })
}

/// Returns the seconds that all threads of this process have computed, or the elapsed seconds if the system
/// does not report this.
pub fn seconds() -> f64 {
    computed().unwrap_or_else(clock)
}

fn computed() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/stat").ok()?;
    // The name of the program, in brackets, may contain any character.
    let rest = &text[text.rfind(')')? + 2..];
    let field = |n: usize| rest.split(' ').nth(n)?.parse::<f64>().ok();
    // User and system time, in hundredths of a second on every Linux.
    Some((field(11)? + field(12)?) / 100.0)
}

#[expect(clippy::disallowed_methods, reason = "a limit of time needs a clock")]
fn clock() -> f64 {
    use std::time::{SystemTime, UNIX_EPOCH};
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0.0, |time| time.as_secs_f64())
}
