//! Two-dimensional arrays of whole numbers in NumPy files.
//!
//! The header is a Python literal. Only literals as NumPy writes them are read, because a parser of any literal can
//! be made to exhaust the stack.

use super::PlanError;

const FORMAT: &str = "a NumPy file of a two-dimensional array";

/// The greatest number of elements that are read.
const MAX_ELEMENTS: u64 = 1 << 20;

/// An array, row by row.
pub(super) struct Array {
    pub(super) cols: usize,
    pub(super) values: Vec<i64>,
}

/// Reads an array of whole numbers, which may be stored as integers, booleans or floats.
pub(super) fn read(bytes: &[u8]) -> Result<Array, PlanError> {
    let wrong = |reason: &str| PlanError::syntax(FORMAT, reason);
    let rest =
        bytes.strip_prefix(b"\x93NUMPY").ok_or_else(|| wrong("it has another first line"))?;
    let (length, rest) = match *rest {
        [1, _, a, b, ref rest @ ..] => (u32::from(u16::from_le_bytes([a, b])), rest),
        [2 | 3, _, a, b, c, d, ref rest @ ..] => (u32::from_le_bytes([a, b, c, d]), rest),
        _ => return Err(wrong("its version must be 1, 2 or 3")),
    };
    let (header, data) =
        rest.split_at_checked(length as usize).ok_or_else(|| wrong("its header ends early"))?;
    let header = str::from_utf8(header).map_err(|_| wrong("its header is not text"))?;
    let entry = |name: &str| {
        let (_, rest) = header.split_once(&format!("'{name}':"))?;
        Some(rest.trim_start())
    };
    let missing = |name: &str| wrong(&format!("its header has no `{name}`"));
    let descr = entry("descr").ok_or_else(|| missing("descr"))?;
    let descr = descr.split('\'').nth(1).filter(|_| descr.starts_with('\''));
    let descr =
        descr.ok_or_else(|| PlanError::value("descr", "a structure", "the name of a type"))?;
    let element = Element::of(descr)?;
    let order = entry("fortran_order").ok_or_else(|| missing("fortran_order"))?;
    let by_columns = order.starts_with("True");
    let shape = entry("shape").ok_or_else(|| missing("shape"))?;
    let (rows, cols) = sides(shape).ok_or_else(|| {
        let text: String = shape.split_inclusive(')').take(1).collect();
        let text: String = text.chars().take(40).collect();
        let allowed = format!("two numbers from 1 on, of a product up to {MAX_ELEMENTS}");
        PlanError::value("shape", text, allowed)
    })?;
    let wanted = rows * cols * element.size;
    if data.len() != wanted {
        let allowed = format!("{wanted} bytes of data after the header");
        return Err(PlanError::value("length", data.len(), allowed));
    }
    let mut values = Vec::with_capacity(rows * cols);
    for i in 0..rows * cols {
        let place = if by_columns { (i % cols) * rows + i / cols } else { i };
        let bytes = &data[place * element.size..][..element.size];
        values.push(element.value(bytes).ok_or_else(|| {
            let field = format!("element ({}, {})", i / cols, i % cols);
            PlanError::value(&field, element.float(bytes), "a whole number")
        })?);
    }
    Ok(Array { cols, values })
}

/// Reads the two sides of a shape such as `(30, 30)`.
fn sides(shape: &str) -> Option<(usize, usize)> {
    let inner = shape.strip_prefix('(')?.split(')').next()?;
    let mut sides = inner.split(',').map(|side| side.trim().parse::<u64>().ok());
    let (rows, cols) = (sides.next()??, sides.next()??);
    let fits = rows.checked_mul(cols).is_some_and(|count| (1..=MAX_ELEMENTS).contains(&count));
    (fits && sides.next().is_none()).then_some((rows as usize, cols as usize))
}

/// The storage format of an element.
struct Element {
    kind: u8,
    size: usize,
    is_big_endian: bool,
}

impl Element {
    fn of(descr: &str) -> Result<Self, PlanError> {
        let allowed = "a boolean, integer or float of up to 8 bytes, such as <i8";
        let wrong =
            || PlanError::value("descr", descr.chars().take(20).collect::<String>(), allowed);
        let &[order, kind, size] = descr.as_bytes() else { return Err(wrong()) };
        let size = usize::from(size.wrapping_sub(b'0'));
        let is_known = match kind {
            b'i' | b'u' => [1, 2, 4, 8].contains(&size),
            b'b' => size == 1,
            b'f' => [4, 8].contains(&size),
            _ => false,
        };
        if !is_known || !b"<>|=".contains(&order) {
            return Err(wrong());
        }
        Ok(Element { kind, size, is_big_endian: order == b'>' })
    }

    fn bits(&self, bytes: &[u8]) -> u64 {
        let mut word = [0; 8];
        word[..self.size].copy_from_slice(bytes);
        if self.is_big_endian {
            word[..self.size].reverse();
        }
        u64::from_le_bytes(word)
    }

    /// Returns a float, or an unsigned integer.
    fn float(&self, bytes: &[u8]) -> f64 {
        let bits = self.bits(bytes);
        match (self.kind, self.size) {
            (b'f', 4) => f64::from(f32::from_bits(bits as u32)),
            (b'f', _) => f64::from_bits(bits),
            _ => bits as f64,
        }
    }

    /// Returns the whole number of an element.
    fn value(&self, bytes: &[u8]) -> Option<i64> {
        match self.kind {
            b'f' => {
                let value = self.float(bytes);
                (value.trunc() == value && value.abs() < 9e15).then_some(value as i64)
            }
            b'i' => {
                let unused = 64 - 8 * self.size as u32;
                Some((self.bits(bytes) << unused) as i64 >> unused)
            }
            _ => i64::try_from(self.bits(bytes)).ok(),
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A file as NumPy writes it.
    pub(in super::super) fn file(header: &str, data: &[u8]) -> Vec<u8> {
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }

    #[test]
    fn arrays_of_all_types_are_read() {
        let header = |descr: &str, f: &str| {
            format!("{{'descr': '{descr}', 'fortran_order': {f}, 'shape': (2, 3), }}")
        };
        let numbers = [0_i64, 1, -2, 3, 4, 5];
        let bytes =
            |of: &dyn Fn(i64) -> Vec<u8>| numbers.iter().flat_map(|&n| of(n)).collect::<Vec<_>>();
        let files = [
            ("<i8", bytes(&|n| n.to_le_bytes().to_vec())),
            (">i4", bytes(&|n| (n as i32).to_be_bytes().to_vec())),
            ("|i1", bytes(&|n| (n as i8).to_le_bytes().to_vec())),
            ("<f8", bytes(&|n| (n as f64).to_le_bytes().to_vec())),
            ("<f4", bytes(&|n| (n as f32).to_le_bytes().to_vec())),
        ];
        for (descr, data) in files {
            let array = read(&file(&header(descr, "False"), &data)).unwrap();
            assert_eq!(array.cols, 3);
            assert_eq!(array.values, numbers, "{descr}");
            let array = read(&file(&header(descr, "True"), &data)).unwrap();
            assert_eq!(array.values, [0, -2, 4, 1, 3, 5], "{descr} by columns");
        }
    }

    #[test]
    fn what_is_wrong_is_named() {
        let good = "{'descr': '|b1', 'fortran_order': False, 'shape': (1, 2), }";
        assert!(read(&file(good, &[0, 1])).is_ok());
        for (from, to, what) in [
            ("|b1", "|O8", "`descr` must be a boolean, integer or float"),
            ("'|b1'", "[('a', '<i8')]", "`descr` must be the name of a type"),
            ("'shape'", "'form'", "has no `shape`"),
            ("(1, 2)", "(2,)", "of a product up to 1048576, got (2,)"),
            ("(1, 2)", "(0, 2)", "`shape` must be two numbers"),
            ("(1, 2)", "(4294967296, 4294967296)", "of a product up to 1048576"),
            ("(1, 2)", "(1, 3)", "`length` must be 3 bytes of data after the header, got 2"),
        ] {
            let Err(error) = read(&file(&good.replace(from, to), &[0, 1])) else { panic!("{to}") };
            let error = error.to_string();
            assert!(error.contains(what) && !error.contains('}'), "{to}: {error}");
        }
        for bytes in
            [&b""[..], b"\x93NUMPY", b"\x93NUMPY\x09\x00aaaaaaaa", b"\x93NUMPY\x01\x00\xff\xff{}"]
        {
            assert!(read(bytes).is_err());
        }
        let half = "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1), }";
        let Err(error) = read(&file(half, &0.5_f32.to_le_bytes())) else { panic!("a half") };
        assert!(error.to_string() == "`element (0, 0)` must be a whole number, got 0.5", "{error}");
    }
}
