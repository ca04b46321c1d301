//! Warnings on stderr.

#[expect(clippy::print_stderr, reason = "where warnings belong")]
pub(crate) fn warn(text: &str) {
    eprintln!("warning: {text}");
}
