//! Reads back what is written, by the rules of the format.

use proptest::prelude::*;

use super::*;

/// A message as it is read back.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::ros_bag) struct Found {
    pub(in crate::ros_bag) topic: String,
    pub(in crate::ros_bag) time: u64,
    pub(in crate::ros_bag) data: Vec<u8>,
}

/// A channel as it is read back.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::ros_bag) struct FoundChannel {
    schema: u16,
    topic: String,
    encoding: String,
    metadata: Vec<(String, String)>,
}

/// What a file holds.
#[derive(Debug, Default)]
pub(in crate::ros_bag) struct Contents {
    pub(in crate::ros_bag) profile: String,
    /// Name, encoding and text, from schema 1.
    pub(in crate::ros_bag) schemas: Vec<[String; 3]>,
    /// From channel 0.
    pub(in crate::ros_bag) channels: Vec<FoundChannel>,
    pub(in crate::ros_bag) messages: Vec<Found>,
    /// Time, name and data.
    pub(in crate::ros_bag) attachments: Vec<(u64, String, Vec<u8>)>,
}

/// Takes the parts of a record one after the other.
#[derive(Clone, Copy)]
struct Parts<'a>(&'a [u8]);

impl<'a> Parts<'a> {
    fn take(&mut self, len: usize) -> &'a [u8] {
        let (part, rest) = self.0.split_at(len);
        self.0 = rest;
        part
    }

    fn u16(&mut self) -> u16 {
        u16::from_le_bytes(self.take(2).try_into().unwrap())
    }

    fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.take(4).try_into().unwrap())
    }

    fn u64(&mut self) -> u64 {
        u64::from_le_bytes(self.take(8).try_into().unwrap())
    }

    fn bytes(&mut self) -> &'a [u8] {
        let len = self.u32() as usize;
        self.take(len)
    }

    fn text(&mut self) -> String {
        String::from_utf8(self.bytes().to_vec()).unwrap()
    }

    fn is_empty(self) -> bool {
        self.0.is_empty()
    }

    /// The next record: its kind and its parts.
    fn record(&mut self) -> (u8, Parts<'a>) {
        let op = self.take(1)[0];
        let len = self.u64() as usize;
        (op, Parts(self.take(len)))
    }
}

/// Undoes [`compressed`].
fn decompressed(frame: &[u8], len: usize) -> Vec<u8> {
    let mut parts = Parts(frame);
    assert_eq!(parts.take(7), LZ4_FRAME);
    let mut bytes = Vec::new();
    loop {
        let size = parts.u32();
        let data = parts.take((size & !LZ4_PLAIN) as usize);
        match size {
            0 => break,
            size if size & LZ4_PLAIN != 0 => bytes.extend_from_slice(data),
            _ => {
                let most = LZ4_BLOCK.min(len - bytes.len());
                bytes.extend(lz4_flex::block::decompress(data, most).unwrap());
            }
        }
    }
    assert!(parts.is_empty() && bytes.len() == len);
    bytes
}

/// Reads a file. Every checksum, count, index and offset is checked.
pub(in crate::ros_bag) fn read(bytes: &[u8]) -> Contents {
    let mut contents = Contents::default();
    let mut rest = Parts(bytes);
    assert_eq!(rest.take(8), MAGIC);
    let offset = |rest: Parts<'_>| (bytes.len() - rest.0.len()) as u64;
    let (op, mut head) = rest.record();
    assert_eq!(op, Op::Header as u8);
    contents.profile = head.text();

    let (mut chunk_indexes, mut attachment_indexes) = (Vec::new(), Vec::new());
    let (mut schemas, mut channels) = (Vec::new(), Vec::new());
    let data_end = loop {
        let start = offset(rest);
        let (op, mut parts) = rest.record();
        let whole = parts.0;
        if op == Op::DataEnd as u8 {
            assert_eq!(parts.u32(), crc32fast::hash(&bytes[..start as usize]));
            break offset(rest);
        } else if op == Op::Schema as u8 {
            schemas.push(whole);
            assert_eq!(usize::from(parts.u16()), schemas.len());
            contents.schemas.push([parts.text(), parts.text(), parts.text()]);
        } else if op == Op::Channel as u8 {
            assert_eq!(usize::from(parts.u16()), channels.len());
            channels.push(whole);
            let (schema, topic, encoding) = (parts.u16(), parts.text(), parts.text());
            let mut entries = Parts(parts.bytes());
            let metadata = std::iter::from_fn(|| {
                (!entries.is_empty()).then(|| (entries.text(), entries.text()))
            });
            let metadata = metadata.collect();
            contents.channels.push(FoundChannel { schema, topic, encoding, metadata });
        } else if op == Op::Chunk as u8 {
            chunk_indexes.push(chunk(&mut contents, parts, start, &mut rest, bytes));
        } else {
            assert_eq!(op, Op::Attachment as u8);
            let (crc, crc_at) = (&whole[whole.len() - 4..], whole.len() - 4);
            assert_eq!(crc, crc32fast::hash(&whole[..crc_at]).to_le_bytes());
            let (time, made, name, media) = (parts.u64(), parts.u64(), parts.text(), parts.text());
            let len = parts.u64();
            let mut index = Fields::default();
            index.u64(start).u64(offset(rest) - start).u64(time).u64(made).u64(len);
            attachment_indexes.push(index.text(&name).text(&media).0.clone());
            contents.attachments.push((time, name, parts.take(len as usize).to_vec()));
        }
    };

    // The summary repeats what came before, and ends with where its groups are.
    let mut groups = Vec::new();
    let mut expect = |op: Op, records: &[&[u8]]| {
        let start = offset(rest);
        for record in records {
            let (found, parts) = rest.record();
            assert_eq!((found, parts.0), (op as u8, *record));
        }
        if !records.is_empty() {
            groups.push((op as u8, start, offset(rest) - start));
        }
    };
    expect(Op::Schema, &schemas);
    expect(Op::Channel, &channels);
    let mut statistics = Fields::default();
    let times = || contents.messages.iter().map(|message| message.time);
    let count = |topic: &str| contents.messages.iter().filter(|m| m.topic == topic).count() as u64;
    let counts = contents.channels.iter().map(|channel| count(&channel.topic));
    statistics.u64(contents.messages.len() as u64).u16(schemas.len() as u16);
    statistics.u32(channels.len() as u32).u32(contents.attachments.len() as u32).u32(0);
    statistics.u32(chunk_indexes.len() as u32);
    statistics.u64(times().min().unwrap_or(0)).u64(times().max().unwrap_or(0));
    statistics.by_channel((0..).zip(counts));
    expect(Op::Statistics, &[&statistics.0]);
    expect(Op::ChunkIndex, &chunk_indexes.iter().map(Vec::as_slice).collect::<Vec<_>>());
    expect(Op::AttachmentIndex, &attachment_indexes.iter().map(Vec::as_slice).collect::<Vec<_>>());
    let offsets = offset(rest);
    for group in groups {
        let (op, mut parts) = rest.record();
        assert_eq!(op, Op::SummaryOffset as u8);
        assert_eq!((parts.take(1)[0], parts.u64(), parts.u64()), group);
    }
    let footer = offset(rest) as usize;
    let (op, mut parts) = rest.record();
    assert_eq!(op, Op::Footer as u8);
    assert_eq!((parts.u64(), parts.u64()), (data_end, offsets));
    assert_eq!(parts.u32(), crc32fast::hash(&bytes[data_end as usize..footer + 9 + 16]));
    assert_eq!(rest.0, MAGIC);
    contents
}

/// Reads a chunk and its indexes; returns what the summary has to say of it.
fn chunk(
    contents: &mut Contents,
    mut parts: Parts<'_>,
    start: u64,
    rest: &mut Parts<'_>,
    bytes: &[u8],
) -> Vec<u8> {
    let offset = |rest: &Parts<'_>| (bytes.len() - rest.0.len()) as u64;
    let end = offset(rest);
    let (first, last, len, crc) = (parts.u64(), parts.u64(), parts.u64(), parts.u32());
    let (name, compressed_len) = (parts.text(), parts.u64());
    assert_eq!((name.as_str(), compressed_len), (LZ4, parts.0.len() as u64));
    let records = decompressed(parts.0, len as usize);
    assert_eq!(crc32fast::hash(&records), crc);

    let mut messages = Parts(&records);
    let mut found = Vec::new();
    while !messages.is_empty() {
        let at = (records.len() - messages.0.len()) as u64;
        let (op, mut parts) = messages.record();
        assert_eq!(op, Op::Message as u8);
        let (channel, number, time, published) =
            (parts.u16(), parts.u32(), parts.u64(), parts.u64());
        let topic = contents.channels[usize::from(channel)].topic.clone();
        let before = contents.messages.iter().filter(|m| m.topic == topic).count();
        assert_eq!((number as usize, published), (before, time));
        found.push((channel, time, at));
        contents.messages.push(Found { topic, time, data: parts.0.to_vec() });
    }
    assert_eq!(Some(first), found.iter().map(|f| f.1).min());
    assert_eq!(Some(last), found.iter().map(|f| f.1).max());

    let mut offsets = Vec::new();
    let mut indexed = Vec::new();
    while rest.0[0] == Op::MessageIndex as u8 {
        let at = offset(rest);
        let (_, mut parts) = rest.record();
        let channel = parts.u16();
        offsets.push((channel, at));
        let mut entries = Parts(parts.bytes());
        while !entries.is_empty() {
            indexed.push((channel, entries.u64(), entries.u64()));
        }
    }
    indexed.sort_by_key(|entry| entry.2);
    assert_eq!(indexed, found);
    let mut index = Fields::default();
    index.u64(first).u64(last).u64(start).u64(end - start);
    index.by_channel(offsets.into_iter()).u64(offset(rest) - end);
    index.text(LZ4).u64(compressed_len).u64(len);
    index.0
}

#[test]
fn a_file_without_messages_is_a_file() {
    let (bytes, totals) = McapWriter::new(Vec::new(), "ros2").unwrap().finish().unwrap();
    let contents = read(&bytes);
    assert!(contents.messages.is_empty() && contents.profile == "ros2");
    assert_eq!(totals, Totals::default());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn what_was_written_is_read(
        messages in proptest::collection::vec((0..3_u16, any::<u64>(), 0..200_000_usize), 0..30),
        file in proptest::collection::vec(any::<u8>(), 0..50),
    ) {
        let mut writer = McapWriter::new(Vec::new(), "ros2").unwrap();
        let schemas = ["a", "b"].map(|name| writer.schema(name, "ros2msg", "int8 x\n").unwrap());
        let topics = ["/one", "/two", "/three"];
        let channels = [0, 1, 0].map(|i: usize| schemas[i]);
        let mut ids = Vec::new();
        for (topic, schema) in topics.iter().zip(channels) {
            ids.push(writer.channel(schema, topic, "cdr", &[("key", "a value")]).unwrap());
        }
        let mut expected = Vec::new();
        for (i, (channel, time, len)) in messages.iter().enumerate() {
            let data: Vec<u8> = (0..*len).map(|j| (i * j / 7) as u8).collect();
            writer.message(ids[usize::from(*channel)], *time, &data).unwrap();
            let topic = topics[usize::from(*channel)].to_owned();
            expected.push(Found { topic, time: *time, data });
        }
        writer.attach(7, Attachment { name: "f", media_type: "x/y", data: &file }).unwrap();
        let (bytes, totals) = writer.finish().unwrap();
        let found = read(&bytes);
        prop_assert!(found.messages == expected);
        prop_assert_eq!(totals.messages(), messages.len() as u64);
        let times = || messages.iter().map(|message| message.1);
        prop_assert_eq!(totals.times, times().min().zip(times().max()));
        let metadata = vec![("key".to_owned(), "a value".to_owned())];
        let channel = FoundChannel { schema: 2, topic: "/two".into(), encoding: "cdr".into(), metadata };
        prop_assert_eq!(&found.channels[1], &channel);
        prop_assert_eq!(&found.schemas[1], &["b", "ros2msg", "int8 x\n"]);
        prop_assert_eq!(found.attachments, [(7, "f".to_owned(), file)]);
    }

    #[test]
    fn any_bytes_are_compressed(bytes in proptest::collection::vec(any::<u8>(), 0..3000), zeros in 0..6_000_000_usize) {
        let mut bytes = bytes;
        bytes.resize(bytes.len() + zeros, 0);
        let frame = compressed(&bytes);
        prop_assert_eq!(decompressed(&frame, bytes.len()), bytes);
    }
}

#[test]
fn an_error_of_the_writer_is_reported() {
    struct Full(usize);
    impl Write for Full {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0 = self.0.checked_sub(bytes.len()).ok_or(io::ErrorKind::StorageFull)?;
            Ok(bytes.len())
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    assert!(McapWriter::new(Full(3), "ros2").is_err());
    let mut writer = McapWriter::new(Full(200), "ros2").unwrap();
    let schema = writer.schema("a", "ros2msg", "").unwrap();
    let channel = writer.channel(schema, "/a", "cdr", &[]).unwrap();
    writer.message(channel, 0, &[0; 100]).unwrap();
    assert_eq!(writer.finish().err().map(|e| e.kind()), Some(io::ErrorKind::StorageFull));
}
