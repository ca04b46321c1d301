//! A driver that writes the lines of a file, one for each line that it receives.

use std::io::{Read, Write};
use std::sync::mpsc::{Receiver, Sender, channel};

/// Returns both ends of a driver that writes the lines of the file. It waits for a line before it writes the
/// next one, as drivers must, so that the result does not depend on the speed of threads.
pub(crate) fn script(file: &[u8]) -> (Input, Output) {
    let (to_output, lines) = channel();
    (Input(to_output), Output { lines, file: file.to_vec(), at: 0, end: 0 })
}

/// The end that the driver reads from.
pub(crate) struct Input(Sender<()>);

/// The end that the driver writes to.
pub(crate) struct Output {
    /// One message for each line that was sent to the driver.
    lines: Receiver<()>,
    file: Vec<u8>,
    /// The number of bytes that are written.
    at: usize,
    /// The number of bytes that may be written before the driver receives another line.
    end: usize,
}

impl Write for Input {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        for _ in bytes.iter().filter(|&&byte| byte == b'\n') {
            // A driver that no longer writes may still receive lines.
            let _ = self.0.send(());
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

impl Read for Output {
    fn read(&mut self, out: &mut [u8]) -> std::io::Result<usize> {
        if self.at == self.end && self.at < self.file.len() {
            // If the sender is dropped, the trial is over.
            if self.lines.recv().is_err() {
                return Ok(0);
            }
            let rest = &self.file[self.at..];
            let line = rest.iter().position(|&byte| byte == b'\n').map(|newline| newline + 1);
            self.end += line.unwrap_or(rest.len());
        }
        let count = (&self.file[self.at..self.end]).read(out)?;
        self.at += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_line_is_written_before_one_is_sent() {
        let (mut input, mut output) = script(b"hello\nanswer\n");
        input.write_all(b"{}\n").unwrap();
        drop(input);
        let mut written = String::new();
        output.read_to_string(&mut written).unwrap();
        assert_eq!(written, "hello\n");
    }

    #[test]
    fn the_file_ends_where_it_ends() {
        // Half a line is not followed by another line sent.
        let (mut input, mut output) = script(b"a\nhalf");
        input.write_all(b"1\n2\n").unwrap();
        let mut written = String::new();
        output.read_to_string(&mut written).unwrap();
        assert_eq!(written, "a\nhalf");
    }
}
