//! The process of a driver, which is always ended and waited for.

use std::collections::VecDeque;
use std::io::{Read, Write};
use std::process::{Child, ChildStderr, ChildStdin, ChildStdout, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// Number of bytes from the end of a driver's standard error that are kept for error messages.
const TAIL: usize = 1024;

/// How long to wait for the end and the last output of a process that has closed its output.
const ENDING: Duration = Duration::from_millis(500);

/// Time between two checks whether the process has ended.
const LOOK: Duration = Duration::from_millis(5);

/// A process that is ended when it is dropped.
#[derive(Debug)]
pub(super) struct Process {
    child: Child,
    tail: Arc<Mutex<VecDeque<u8>>>,
    /// Closed when the standard error of the process is closed.
    silent: Receiver<()>,
}

impl Process {
    /// Starts a process whose standard error is copied to `errors`.
    pub(super) fn start(
        mut command: Command,
        errors: impl Write + Send + 'static,
    ) -> std::io::Result<(Process, ChildStdin, ChildStdout)> {
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn()?;
        let tail = Arc::default();
        let (speaks, silent) = channel();
        let pipes = (child.stdin.take(), child.stdout.take(), child.stderr.take());
        let process = Process { child, tail: Arc::clone(&tail), silent };
        let (Some(input), Some(output), Some(said)) = pipes else {
            return Err(std::io::Error::other("it has no pipes"));
        };
        thread::spawn(move || listen(said, errors, &tail, speaks));
        Ok((process, input, output))
    }

    /// Returns how the process ended, if it ends within this time.
    pub(super) fn ended(&mut self, within: Duration) -> Option<ExitStatus> {
        let looks = within.div_duration_f64(LOOK).ceil() as u64;
        for _ in 0..looks {
            if let Ok(Some(status)) = self.child.try_wait() {
                return Some(status);
            }
            thread::sleep(LOOK);
        }
        self.child.try_wait().ok().flatten()
    }

    /// Returns how the process ended, if it is about to end, and the last line of its standard error.
    pub(super) fn last_words(&mut self) -> (Option<ExitStatus>, Option<String>) {
        let status = self.ended(ENDING);
        if status.is_some() {
            // Other processes may still hold the standard error open.
            let _ = self.silent.recv_timeout(ENDING);
        }
        let tail = self.tail.lock().unwrap_or_else(PoisonError::into_inner);
        let bytes: Vec<u8> = tail.iter().copied().collect();
        let text = String::from_utf8_lossy(&bytes);
        let line = text.lines().rev().find(|line| !line.trim().is_empty());
        (status, line.map(|line| line.trim().to_owned()))
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // The process may already have ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Copies a process's standard error, and keeps its end.
fn listen(
    mut said: ChildStderr,
    mut errors: impl Write,
    tail: &Mutex<VecDeque<u8>>,
    speaks: Sender<()>,
) {
    let mut buffer = [0; 4096];
    while let Ok(count @ 1..) = said.read(&mut buffer) {
        let part = &buffer[..count];
        // The driver may still write, even if nothing reads our own standard error.
        let _ = errors.write_all(part);
        let mut tail = tail.lock().unwrap_or_else(PoisonError::into_inner);
        tail.extend(part);
        let more = tail.len().saturating_sub(TAIL);
        tail.drain(..more);
    }
    drop(speaks);
}
