//! Lines to a driver and back, with limits on time and length. Whatever the driver does, every question
//! ends with an answer or an error.

use std::io::{BufRead, BufReader, Read, Write};
use std::sync::mpsc::{
    Receiver, RecvTimeoutError, SyncSender, TryRecvError, channel, sync_channel,
};
use std::thread;
use std::time::{Duration, Instant};

use super::limits::{Limits, MAX_LINE};

/// Number of bytes that are read at once.
const CHUNK: usize = 1 << 16;

/// An event on the driver's side.
#[derive(Debug)]
enum Event {
    Line {
        line: Vec<u8>,
        /// The next line, if it was read together with this one. Nobody can have asked for it.
        next: Option<Vec<u8>>,
    },
    Broken(LinkError),
}

/// An error for which no line came back.
#[derive(Debug)]
pub(super) enum LinkError {
    /// The driver closed its output, after a number of bytes of an incomplete line.
    Closed { half: usize },
    /// The driver's output cannot be read.
    Read(std::io::Error),
    /// The driver closed its input.
    Write(std::io::Error),
    /// The driver's line is longer than [`MAX_LINE`] bytes.
    TooLong,
    /// The driver answers, but does not read.
    Deaf,
    /// The driver wrote a line before it was asked for one.
    Unasked(Vec<u8>),
    /// The driver's answer did not come in time.
    Late,
    /// All answers of the driver together took longer than allowed.
    Slow,
}

/// Both directions of a connection.
#[derive(Debug)]
pub(super) struct Link {
    limits: Limits,
    /// The lines to be written; `None` after the last line.
    lines: Option<SyncSender<Vec<u8>>>,
    events: Receiver<Event>,
    /// Closed when nothing is left to be written.
    written: Receiver<()>,
    /// How long all answers took so far.
    waited: Duration,
    /// A line that was read together with the last answer.
    unasked: Option<Vec<u8>>,
}

impl Link {
    /// Reads and writes on threads of its own. They end when the driver closes its ends, or with the
    /// program.
    pub(super) fn new(
        input: impl Write + Send + 'static,
        output: impl Read + Send + 'static,
        limits: Limits,
    ) -> Self {
        // A driver that writes without being asked is blocked, so that its lines take no more memory.
        let (to_events, events) = sync_channel(1);
        let (lines, to_write) = sync_channel(1);
        let broken = to_events.clone();
        let (writes, written) = channel::<()>();
        thread::spawn(move || {
            write_lines(input, &to_write, &broken);
            // This signals that everything is written.
            drop(writes);
        });
        thread::spawn(move || read_lines(output, &to_events));
        Link { limits, lines: Some(lines), events, written, waited: Duration::ZERO, unasked: None }
    }

    /// Writes a line and waits for the answer. After an error, no further question is allowed.
    pub(super) fn ask(&mut self, line: Vec<u8>) -> Result<Vec<u8>, LinkError> {
        if let Some(line) = self.unasked.take() {
            return Err(LinkError::Unasked(line));
        }
        match self.events.try_recv() {
            Ok(Event::Line { line, .. }) => return Err(LinkError::Unasked(line)),
            Ok(Event::Broken(error)) => return Err(error),
            Err(TryRecvError::Empty) => {}
            Err(TryRecvError::Disconnected) => return Err(LinkError::Closed { half: 0 }),
        }
        if self.lines.as_ref().is_none_or(|lines| lines.try_send(line).is_err()) {
            return Err(LinkError::Deaf);
        }
        let asked = now();
        let patience = self.limits.reply.min(self.limits.total.saturating_sub(self.waited));
        let event = self.events.recv_timeout(patience);
        self.waited += asked.elapsed();
        match event {
            Ok(Event::Line { line, next }) => {
                self.unasked = next;
                Ok(line)
            }
            Ok(Event::Broken(error)) => Err(error),
            Err(RecvTimeoutError::Disconnected) => Err(LinkError::Closed { half: 0 }),
            Err(RecvTimeoutError::Timeout) if self.waited >= self.limits.total => {
                Err(LinkError::Slow)
            }
            Err(RecvTimeoutError::Timeout) => Err(LinkError::Late),
        }
    }

    /// Writes the last line, which has no answer, and closes the driver's input. If the driver does not
    /// read, only this line is lost.
    pub(super) fn close(&mut self, line: Option<Vec<u8>>) {
        if let Some((lines, line)) = self.lines.take().zip(line) {
            let _ = lines.try_send(line);
        }
    }

    /// Returns a line that nobody asked for, which has come since the last answer or comes within some
    /// time.
    pub(super) fn leftover(&mut self, patience: Duration) -> Option<Vec<u8>> {
        self.unasked.take().or_else(|| match self.events.recv_timeout(patience) {
            Ok(Event::Line { line, .. }) => Some(line),
            _ => None,
        })
    }

    /// Waits until the last line is written, but at most `patience`.
    pub(super) fn finish_writing(&self, patience: Duration) {
        // Nothing is ever sent: the other end is only dropped.
        let _ = self.written.recv_timeout(patience);
    }
}

#[expect(
    clippy::disallowed_methods,
    reason = "another process is waited for; no value depends on it"
)]
fn now() -> Instant {
    Instant::now()
}

fn write_lines(mut input: impl Write, lines: &Receiver<Vec<u8>>, events: &SyncSender<Event>) {
    for mut line in lines {
        line.push(b'\n');
        if let Err(error) = input.write_all(&line).and_then(|()| input.flush()) {
            // The receiver is gone when the trial is over.
            let _ = events.send(Event::Broken(LinkError::Write(error)));
            return;
        }
    }
}

fn read_lines(output: impl Read, events: &SyncSender<Event>) {
    let mut output = BufReader::with_capacity(CHUNK, output);
    loop {
        let event = match read_line(&mut output) {
            Ok(line) => {
                let read = output.buffer();
                let end = read.iter().position(|&byte| byte == b'\n');
                Event::Line { line, next: end.map(|end| read[..end].to_vec()) }
            }
            Err(error) => Event::Broken(error),
        };
        let more = matches!(event, Event::Line { .. });
        if events.send(event).is_err() || !more {
            return;
        }
    }
}

/// The next line without its line end.
fn read_line(output: &mut impl BufRead) -> Result<Vec<u8>, LinkError> {
    let mut line = Vec::new();
    loop {
        let chunk = match output.fill_buf() {
            Ok(chunk) => chunk,
            Err(error) if error.kind() == std::io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(LinkError::Read(error)),
        };
        if chunk.is_empty() {
            return Err(LinkError::Closed { half: line.len() });
        }
        let end = chunk.iter().position(|&byte| byte == b'\n');
        let part = &chunk[..end.unwrap_or(chunk.len())];
        if line.len() + part.len() > MAX_LINE {
            return Err(LinkError::TooLong);
        }
        line.extend_from_slice(part);
        let used = end.map_or(part.len(), |end| end + 1);
        output.consume(used);
        if end.is_some() {
            return Ok(line);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::sync::mpsc::{Sender, channel};
    use std::sync::{Arc, Mutex};

    use super::*;

    /// An endless stream of one byte that counts how much of it is read.
    struct Endless(Arc<AtomicUsize>);

    impl Read for Endless {
        fn read(&mut self, out: &mut [u8]) -> std::io::Result<usize> {
            out.fill(b'x');
            self.0.fetch_add(out.len(), Ordering::Relaxed);
            Ok(out.len())
        }
    }

    fn limits(reply: u64, total: u64) -> Limits {
        Limits { reply: Duration::from_millis(reply), total: Duration::from_millis(total) }
    }

    /// A pipe that takes a while.
    struct SlowPipe(Arc<Mutex<Vec<u8>>>);

    impl Write for SlowPipe {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            thread::sleep(Duration::from_millis(200));
            self.0.lock().unwrap().extend_from_slice(bytes);
            Ok(bytes.len())
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn the_last_line_is_waited_for() {
        let written = Arc::new(Mutex::new(Vec::new()));
        let mut link =
            Link::new(SlowPipe(Arc::clone(&written)), std::io::empty(), limits(1000, 1000));
        link.close(Some(b"the end".to_vec()));
        link.finish_writing(Duration::from_secs(60));
        assert_eq!(*written.lock().unwrap(), b"the end\n");
    }

    #[test]
    fn a_line_without_an_end_is_given_up_at_the_limit() {
        let count = Arc::new(AtomicUsize::new(0));
        let mut output = BufReader::with_capacity(CHUNK, Endless(Arc::clone(&count)));
        assert!(matches!(read_line(&mut output), Err(LinkError::TooLong)));
        assert!(count.load(Ordering::Relaxed) <= MAX_LINE + CHUNK);
    }

    #[test]
    fn lines_end_where_they_end() {
        let mut output = BufReader::with_capacity(3, &b"ab\n\nlonger than that\r\nhalf"[..]);
        assert_eq!(read_line(&mut output).unwrap(), b"ab");
        assert_eq!(read_line(&mut output).unwrap(), b"");
        assert_eq!(read_line(&mut output).unwrap(), b"longer than that\r");
        assert!(matches!(read_line(&mut output), Err(LinkError::Closed { half: 4 })));
        assert!(matches!(read_line(&mut output), Err(LinkError::Closed { half: 0 })));
    }

    #[test]
    fn silence_and_slowness_are_different_errors() {
        let (reader, _writer) = std::io::pipe().unwrap();
        let mut link = Link::new(std::io::sink(), reader, limits(20, 60_000));
        assert!(matches!(link.ask(b"?".to_vec()), Err(LinkError::Late)));
        let (reader, _writer) = std::io::pipe().unwrap();
        let mut link = Link::new(std::io::sink(), reader, limits(60_000, 20));
        assert!(matches!(link.ask(b"?".to_vec()), Err(LinkError::Slow)));
    }

    #[test]
    fn an_answer_before_the_question_is_an_error() {
        let (reads, read) = channel();
        let mut link = Link::new(std::io::sink(), Talker(reads), limits(60_000, 60_000));
        // The first line has arrived when the second one is read.
        read.recv().unwrap();
        read.recv().unwrap();
        let error = link.ask(b"?".to_vec()).unwrap_err();
        assert!(matches!(&error, LinkError::Unasked(line) if line == b"yes"), "{error:?}");
    }

    #[test]
    fn lines_that_come_together_are_one_answer_and_an_error() {
        let (question, input) = std::io::pipe().unwrap();
        let (output, mut answers) = std::io::pipe().unwrap();
        let driver = thread::spawn(move || {
            BufReader::new(question).read_line(&mut String::new()).unwrap();
            answers.write_all(b"yes\nno\n").unwrap();
            answers
        });
        let mut link = Link::new(input, output, limits(60_000, 60_000));
        assert_eq!(link.ask(b"?".to_vec()).unwrap(), b"yes");
        let _answers = driver.join().unwrap();
        let error = link.ask(b"?".to_vec()).unwrap_err();
        assert!(matches!(&error, LinkError::Unasked(line) if line == b"no"), "{error:?}");
    }

    /// Writes "yes" forever, and reports each read.
    struct Talker(Sender<()>);

    impl Read for Talker {
        fn read(&mut self, out: &mut [u8]) -> std::io::Result<usize> {
            // The receiver is gone when the test is over.
            let _ = self.0.send(());
            let count = out.len().min(4);
            out[..count].copy_from_slice(&b"yes\n"[..count]);
            Ok(count)
        }
    }

    /// Accepts nothing, and reports that it was asked to.
    struct Full(SyncSender<()>, Receiver<()>);

    impl Write for Full {
        fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
            self.0.send(()).expect("the test waits for it");
            let _ = self.1.recv();
            Err(std::io::ErrorKind::BrokenPipe.into())
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn who_reads_nothing_does_not_hold_up_the_trial() {
        let (sender, receiver) = sync_channel(1);
        let (release, held) = sync_channel(1);
        let (silence, _writer) = std::io::pipe().unwrap();
        let mut link = Link::new(Full(sender, held), silence, limits(10, 60_000));
        assert!(matches!(link.ask(b"first".to_vec()), Err(LinkError::Late)));
        receiver.recv().unwrap();
        assert!(matches!(link.ask(b"second".to_vec()), Err(LinkError::Late)));
        assert!(matches!(link.ask(b"third".to_vec()), Err(LinkError::Deaf)));
        link.close(Some(b"end".to_vec()));
        release.send(()).unwrap();
    }
}
