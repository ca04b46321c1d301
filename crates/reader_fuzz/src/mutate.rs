//! Mutations of files. Some change numbers, brackets, lines and chunks, and others change bytes.

use envgen::{Seed, Stream};

/// The length in bytes to which mutated files are cut.
const LONGEST: usize = 1 << 18;

/// The largest depth of inserted brackets.
const DEEPEST: u64 = 50_000;

/// Numbers that often break readers.
const NUMBERS: &[&str] = &[
    "0",
    "-0",
    "-1",
    "1",
    "2",
    "3",
    "0.5",
    "0.001",
    "1e-9",
    "1e-308",
    "5e-324",
    "1e6",
    "1e7",
    "1e9",
    "1e15",
    "1e18",
    "1e154",
    "1e308",
    "-1e308",
    "1e400",
    "-1e400",
    "NaN",
    "nan",
    "inf",
    "-inf",
    ".nan",
    ".inf",
    "Infinity",
    "255",
    "256",
    "65535",
    "65536",
    "16777217",
    "2147483647",
    "2147483648",
    "4294967295",
    "4294967296",
    "9007199254740993",
    "9223372036854775807",
    "9223372036854775808",
    "18446744073709551615",
    "18446744073709551616",
    "0x10",
    "1_000",
    "007",
    "1e",
    "+1",
    "1.",
    ".5",
    "null",
    "true",
    "\"1\"",
    "[]",
    "()",
    "",
];

/// Opening brackets and markers that readers may nest too deeply.
const OPENINGS: &[&str] =
    &["[", "(", "{", "{\"a\":", "<a>", "Some(", "- ", "[[", "? ", "&a [*a,", "{a: ", "/*", "((("];

/// Texts with a special meaning for some reader.
const WORDS: &[&str] = &[
    "\0",
    "\u{feff}",
    "\r\n",
    "\n",
    "\"",
    "'",
    "\\",
    "\\u0000",
    "\\ud800",
    "<!--",
    "-->",
    "<![CDATA[",
    "&amp;",
    "&#0;",
    "&#x110000;",
    "&lol;",
    "<!DOCTYPE a [<!ENTITY b \"bbbb\">]>",
    "<?xml?>",
    "---",
    "...",
    "*a",
    "&a",
    "!!binary",
    "|",
    ">",
    "#",
    "//",
    "r#\"",
    "#![enable(implicit_some)]",
    "\t",
    "٣",
    "é",
    "🦀",
    ",",
    ":",
    "=",
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    "<",
    ">",
    "none",
    "null",
    "\u{85}",
];

/// Returns mutated file number `case`, made from one of the files of a corpus.
pub fn mutated(corpus: &[Vec<u8>], format: &str, case: u64) -> Vec<u8> {
    let mut draw = Draw(Seed(case).stream(format, 0));
    let Some(mut file) = draw.choice(corpus).cloned() else { return Vec::new() };
    // In half of the files only numbers, words and lines change, so that more of them can be read.
    let gentle = draw.below(2) == 0;
    for _ in 0..1 + draw.below(4) {
        if gentle {
            mutate_gently(&mut file, &mut draw);
        } else {
            mutate(&mut file, corpus, &mut draw);
        }
        file.truncate(LONGEST);
    }
    // Most decoders stop at a wrong checksum of a chunk and never see its contents.
    if file.starts_with(b"\x89PNG") && draw.below(4) > 0 {
        mend_checksums(&mut file);
    }
    file
}

struct Draw(Stream);

impl Draw {
    /// Draws a whole number below `n`, or 0 if `n` is 0.
    fn below(&mut self, n: usize) -> usize {
        if n == 0 { 0 } else { self.0.below(n as u64) as usize }
    }

    fn choice<'a, T>(&mut self, items: &'a [T]) -> Option<&'a T> {
        items.get(self.below(items.len()))
    }

    /// Draws a range of a file of `len` bytes, which is mostly short.
    fn piece(&mut self, len: usize) -> std::ops::Range<usize> {
        let from = self.below(len + 1);
        let most = if self.below(4) > 0 { 16 } else { len };
        from..(from + self.below(most + 1)).min(len)
    }
}

fn mutate(file: &mut Vec<u8>, corpus: &[Vec<u8>], draw: &mut Draw) {
    let len = file.len();
    match draw.below(16) {
        0 if len > 0 => file[draw.below(len)] ^= 1 << draw.below(8),
        1 if len > 0 => file[draw.below(len)] = draw.below(256) as u8,
        2 => file.truncate(draw.below(len + 1)),
        3 => {
            file.drain(draw.piece(len));
        }
        4 => {
            let piece = draw.piece(len);
            let copies = [1, 1, 2, 10, 1000][draw.below(5)];
            let copies = copies.min(LONGEST / piece.len().max(1));
            let text = file[piece.clone()].repeat(copies);
            file.splice(piece.end..piece.end, text);
        }
        5 => {
            if let Some(other) = draw.choice(corpus) {
                let text = other[draw.piece(other.len())].to_vec();
                file.splice(draw.piece(len), text);
            }
        }
        6 => {
            let (opening, depth) = (*draw.choice(OPENINGS).unwrap_or(&"["), draw.0.below(DEEPEST));
            let text = opening.repeat(if draw.below(2) == 0 {
                1 + depth as usize % 300
            } else {
                depth as usize
            });
            let at = draw.below(len + 1);
            file.splice(at..at, text.into_bytes());
        }
        7 => {
            let text = draw.choice(WORDS).map_or(&[][..], |word| word.as_bytes()).to_vec();
            let at = draw.below(len + 1);
            file.splice(at..at, text);
        }
        8 => change_line(file, draw),
        9 => big_endian(file, draw),
        10 => swap_words(file, draw),
        _ => change_number(file, draw),
    }
}

fn mutate_gently(file: &mut Vec<u8>, draw: &mut Draw) {
    match draw.below(8) {
        0 => change_line(file, draw),
        1 => swap_words(file, draw),
        _ => change_number(file, draw),
    }
}

/// Replaces a number that is written in digits.
fn change_number(file: &mut Vec<u8>, draw: &mut Draw) {
    let runs = runs(file, |byte| byte.is_ascii_digit() || b"+-.eE".contains(&byte));
    let numbers: Vec<_> =
        runs.into_iter().filter(|run| file[run.clone()].iter().any(u8::is_ascii_digit)).collect();
    let Some(place) = draw.choice(&numbers).cloned() else { return };
    let old: Option<f64> = String::from_utf8_lossy(&file[place.clone()]).parse().ok();
    let new = match old {
        // Most files remain readable only if a number changes a little.
        Some(old) if draw.below(2) == 0 => {
            let factors = [-1.0, 0.5, 2.0, 10.0, 0.1, 1000.0, 1e-3, 1.0 + 1e-15, 1e6];
            let terms = [1.0, -1.0, 0.1, -0.25, 1e-9, 100.0];
            let changed = if draw.below(2) == 0 {
                old * draw.choice(&factors).unwrap_or(&1.0)
            } else {
                old + draw.choice(&terms).unwrap_or(&0.0)
            };
            changed.to_string()
        }
        _ => (*draw.choice(NUMBERS).unwrap_or(&"0")).to_owned(),
    };
    file.splice(place, new.into_bytes());
}

/// Replaces a word or number of the file by another one from the file.
fn swap_words(file: &mut Vec<u8>, draw: &mut Draw) {
    let words = runs(file, |byte| byte.is_ascii_alphanumeric() || b"_.+-".contains(&byte));
    let (Some(from), Some(to)) = (draw.choice(&words).cloned(), draw.choice(&words).cloned())
    else {
        return;
    };
    let text = file[from].to_vec();
    file.splice(to, text);
}

/// Deletes, duplicates or moves a line.
fn change_line(file: &mut Vec<u8>, draw: &mut Draw) {
    let lines = runs(file, |byte| byte != b'\n');
    let (Some(from), Some(to)) = (draw.choice(&lines).cloned(), draw.choice(&lines).cloned())
    else {
        return;
    };
    let mut text = file[from].to_vec();
    text.push(b'\n');
    match draw.below(3) {
        0 => drop(file.drain(to)),
        1 => drop(file.splice(to.start..to.start, text)),
        _ => drop(file.splice(to, text)),
    }
}

/// Writes a number as four big-endian bytes, as in the headers of binary files.
fn big_endian(file: &mut [u8], draw: &mut Draw) {
    let numbers = [0, 1, 2, 7, 255, 65_535, 65_536, 1 << 24, i32::MAX as u32, 1 << 31, u32::MAX];
    let number = *draw.choice(&numbers).unwrap_or(&0);
    // The width and the height of a PNG are near the beginning.
    let most = if draw.below(2) == 0 { file.len().min(32) } else { file.len() };
    let at = draw.below(most.saturating_sub(3));
    if let Some(place) = file.get_mut(at..at + 4) {
        place.copy_from_slice(&number.to_be_bytes());
    }
}

/// Returns the ranges of successive bytes that satisfy `is`.
fn runs(file: &[u8], is: impl Fn(u8) -> bool) -> Vec<std::ops::Range<usize>> {
    let mut runs = Vec::new();
    let mut start = None;
    for (i, &byte) in file.iter().chain([&b'\n']).enumerate() {
        match (is(byte) && i < file.len(), start) {
            (true, None) => start = Some(i),
            (false, Some(from)) => {
                runs.push(from..i);
                start = None;
            }
            _ => {}
        }
    }
    runs
}

/// Writes the correct checksum after every complete chunk of a PNG.
fn mend_checksums(file: &mut [u8]) {
    let mut at = 8;
    while let Some(header) = file.get(at..at + 4) {
        let length = header.iter().fold(0, |length, &byte| length << 8 | usize::from(byte));
        let end = at + 8 + length;
        let Some(chunk) = file.get(at + 4..end) else { return };
        let sum = crc32fast::hash(chunk).to_be_bytes();
        let Some(place) = file.get_mut(end..end + 4) else { return };
        place.copy_from_slice(&sum);
        at = end + 4;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_case_is_always_the_same_file_and_most_differ() {
        let corpus = [b"width 10\nheight 3\n".to_vec(), b"(a: [1, 2.5e3], b: \"c\")".to_vec()];
        let files: Vec<_> = (0..500).map(|case| mutated(&corpus, "test", case)).collect();
        let again: Vec<_> = (0..500).map(|case| mutated(&corpus, "test", case)).collect();
        assert!(files == again);
        let different: std::collections::BTreeSet<_> = files.iter().collect();
        assert!(different.len() > 450, "{} of 500 files differ", different.len());
        assert!(files.iter().all(|file| file.len() <= LONGEST));
    }

    #[test]
    fn mended_chunks_are_read() {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, 2, 2);
        encoder.set_color(png::ColorType::Grayscale);
        let mut writer = encoder.write_header().expect("a header");
        writer.write_image_data(&[1, 2, 3, 4]).expect("pixels");
        drop(writer);
        let mut broken = file.clone();
        broken[29] ^= 1;
        mend_checksums(&mut broken);
        assert!(broken == file, "the header's checksum is at 29");
    }
}
