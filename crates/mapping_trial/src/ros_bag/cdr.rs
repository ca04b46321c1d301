//! CDR, the encoding of messages in ROS 2: plain CDR (XCDR version 1, OMG DDS-XTypes 1.3, section
//! 7.4.1), little-endian.

/// The encapsulation header: little-endian plain CDR, no options.
const HEADER: [u8; 4] = [0, 1, 0, 0];

/// Writes the fields of one message one after the other. Every number is aligned to its size, counted
/// from the end of the header.
#[derive(Debug, Default)]
pub(super) struct CdrWriter {
    bytes: Vec<u8>,
}

impl CdrWriter {
    /// Begins a message. The bytes of the last one are dropped, and their memory is reused.
    pub(super) fn begin(&mut self) {
        self.bytes.clear();
        self.bytes.extend_from_slice(&HEADER);
    }

    /// Returns the message so far.
    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    fn align(&mut self, size: usize) {
        let len = self.bytes.len() - HEADER.len();
        self.bytes.resize(HEADER.len() + len.next_multiple_of(size), 0);
    }

    /// Writes an `int32`.
    pub(super) fn i32(&mut self, value: i32) {
        self.align(4);
        self.bytes.extend_from_slice(&value.to_le_bytes());
    }

    /// Writes a `uint32`.
    pub(super) fn u32(&mut self, value: u32) {
        self.align(4);
        self.bytes.extend_from_slice(&value.to_le_bytes());
    }

    /// Writes a `float32`.
    pub(super) fn f32(&mut self, value: f32) {
        self.align(4);
        self.bytes.extend_from_slice(&value.to_le_bytes());
    }

    /// Writes a `float64`.
    pub(super) fn f64(&mut self, value: f64) {
        self.align(8);
        self.bytes.extend_from_slice(&value.to_le_bytes());
    }

    /// Writes a `string`: its length with the final NUL, and both. No string here is near 4 GB.
    pub(super) fn string(&mut self, text: &str) {
        self.sequence(text.len() + 1);
        self.bytes.extend_from_slice(text.as_bytes());
        self.bytes.push(0);
    }

    /// Writes the number of elements of a sequence, which precedes them.
    pub(super) fn sequence(&mut self, len: usize) {
        self.u32(u32::try_from(len).unwrap_or(u32::MAX));
    }

    /// Writes the elements of an `int8[]`.
    pub(super) fn i8s(&mut self, values: impl Iterator<Item = i8>) {
        self.bytes.extend(values.map(i8::cast_unsigned));
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn written(write: impl FnOnce(&mut CdrWriter)) -> Vec<u8> {
        let mut writer = CdrWriter::default();
        writer.begin();
        write(&mut writer);
        assert_eq!(writer.bytes()[..4], HEADER);
        writer.bytes()[4..].to_vec()
    }

    #[test]
    fn numbers_are_aligned_to_their_size_from_the_end_of_the_header() {
        let found = written(|w| {
            w.i8s([1].into_iter());
            w.f64(1.0);
            w.i8s([2].into_iter());
            w.u32(3);
            w.f32(1.0);
            w.f64(-2.0);
        });
        let expected = [
            &[1, 0, 0, 0, 0, 0, 0, 0][..],
            &[0, 0, 0, 0, 0, 0, 0xf0, 0x3f],
            &[2, 0, 0, 0, 3, 0, 0, 0],
            // The second of two numbers of 4 bytes ends a multiple of 8: nothing to fill.
            &[0, 0, 0x80, 0x3f, 0, 0, 0, 0],
            &[0, 0, 0, 0, 0, 0, 0, 0xc0],
        ]
        .concat();
        assert_eq!(found, expected);
    }

    #[test]
    fn strings_count_their_end_and_fill_nothing_after_it() {
        let found = written(|w| {
            w.string("map");
            w.i8s([7].into_iter());
            w.string("");
        });
        let expected = [&[4, 0, 0, 0][..], b"map\0", &[7, 0, 0, 0], &[1, 0, 0, 0], &[0]].concat();
        assert_eq!(found, expected);
    }

    #[test]
    fn a_message_forgets_the_one_before() {
        let mut writer = CdrWriter::default();
        writer.begin();
        writer.i32(-1);
        writer.begin();
        assert_eq!(writer.bytes(), HEADER);
    }

    /// A field of any kind.
    #[derive(Clone, Debug)]
    enum Field {
        Byte(i8),
        Int(i32),
        Double(f64),
        Text(String),
    }

    fn field() -> impl Strategy<Value = Field> {
        prop_oneof![
            any::<i8>().prop_map(Field::Byte),
            any::<i32>().prop_map(Field::Int),
            any::<f64>().prop_map(Field::Double),
            "[a-z]{0,9}".prop_map(Field::Text),
        ]
    }

    proptest! {
        /// A reader that knows only the rule of alignment finds every field.
        #[test]
        fn what_was_written_is_read(fields in proptest::collection::vec(field(), 0..40)) {
            let bytes = written(|w| {
                for field in &fields {
                    match field {
                        Field::Byte(value) => w.i8s(std::iter::once(*value)),
                        Field::Int(value) => w.i32(*value),
                        Field::Double(value) => w.f64(*value),
                        Field::Text(text) => w.string(text),
                    }
                }
            });
            let mut at = 0_usize;
            let mut take = |size: usize, len: usize| {
                at = at.div_ceil(size) * size;
                at += len;
                bytes[at - len..at].to_vec()
            };
            for field in fields {
                match field {
                    Field::Byte(value) => prop_assert_eq!(take(1, 1), value.to_le_bytes()),
                    Field::Int(value) => prop_assert_eq!(take(4, 4), value.to_le_bytes()),
                    Field::Double(value) => prop_assert_eq!(take(8, 8), value.to_le_bytes()),
                    Field::Text(text) => {
                        prop_assert_eq!(take(4, 4), (text.len() as u32 + 1).to_le_bytes());
                        prop_assert_eq!(take(1, text.len() + 1), [text.as_bytes(), b"\0"].concat());
                    }
                }
            }
            prop_assert_eq!(at, bytes.len());
        }
    }
}
