//! The container format MCAP, <https://mcap.dev/spec>, with LZ4-compressed and indexed chunks, and a
//! summary.
//!
//! The crate `mcap` compresses by LZ4 only with the C library, and does not accept chunks that are
//! already compressed. This writer only needs Rust. `tests/outside` has other programs read its output.

use std::collections::BTreeMap;
use std::io::{self, Write};

/// The bytes with which a file begins and ends.
const MAGIC: [u8; 8] = [0x89, b'M', b'C', b'A', b'P', 0x30, b'\r', b'\n'];

/// Least number of bytes of messages in a chunk, except for the last one.
const CHUNK: usize = 1 << 20;

/// Name of the compression in chunks.
const LZ4: &str = "lz4";

/// The kinds of records.
#[derive(Clone, Copy)]
#[repr(u8)]
enum Op {
    Header = 0x01,
    Footer = 0x02,
    Schema = 0x03,
    Channel = 0x04,
    Message = 0x05,
    Chunk = 0x06,
    MessageIndex = 0x07,
    ChunkIndex = 0x08,
    Attachment = 0x09,
    AttachmentIndex = 0x0a,
    Statistics = 0x0b,
    SummaryOffset = 0x0e,
    DataEnd = 0x0f,
}

/// The number of a schema, from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SchemaId(u16);

/// The number of a channel, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct ChannelId(u16);

impl ChannelId {
    /// Its index among all channels.
    pub(super) fn index(self) -> usize {
        usize::from(self.0)
    }
}

/// A file that is attached to an MCAP.
#[derive(Clone, Copy, Debug)]
pub(super) struct Attachment<'a> {
    pub(super) name: &'a str,
    pub(super) media_type: &'a str,
    pub(super) data: &'a [u8],
}

/// Number of messages in all and per channel, and the times of the first and the last in nanoseconds.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Totals {
    pub(super) channels: Vec<u64>,
    pub(super) times: Option<(u64, u64)>,
}

impl Totals {
    pub(super) fn messages(&self) -> u64 {
        self.channels.iter().sum()
    }
}

/// The parts of a record.
#[derive(Default)]
struct Fields(Vec<u8>);

impl Fields {
    fn u16(&mut self, value: u16) -> &mut Self {
        self.0.extend_from_slice(&value.to_le_bytes());
        self
    }

    fn u32(&mut self, value: u32) -> &mut Self {
        self.0.extend_from_slice(&value.to_le_bytes());
        self
    }

    fn u64(&mut self, value: u64) -> &mut Self {
        self.0.extend_from_slice(&value.to_le_bytes());
        self
    }

    fn text(&mut self, text: &str) -> &mut Self {
        self.bytes(text.as_bytes())
    }

    /// Appends bytes after their number.
    fn bytes(&mut self, bytes: &[u8]) -> &mut Self {
        self.u32(bytes.len() as u32);
        self.0.extend_from_slice(bytes);
        self
    }

    /// Appends a map from channels.
    fn by_channel(&mut self, values: impl Iterator<Item = (u16, u64)>) -> &mut Self {
        let mut entries = Fields::default();
        for (channel, value) in values {
            entries.u16(channel).u64(value);
        }
        self.bytes(&entries.0)
    }
}

/// A writer that counts bytes and computes their checksum.
struct Counter<W> {
    out: W,
    offset: u64,
    crc: crc32fast::Hasher,
}

impl<W: Write> Counter<W> {
    fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.out.write_all(bytes)?;
        self.offset += bytes.len() as u64;
        self.crc.update(bytes);
        Ok(())
    }

    /// Writes a record.
    fn record(&mut self, op: Op, fields: &Fields) -> io::Result<()> {
        self.begin(op, fields.0.len() as u64)?;
        self.put(&fields.0)
    }

    /// Writes the beginning of a record: its kind and its length.
    fn begin(&mut self, op: Op, len: u64) -> io::Result<()> {
        let mut start = [op as u8; 9];
        start[1..].copy_from_slice(&len.to_le_bytes());
        self.put(&start)
    }
}

/// Writes an MCAP to any stream.
pub(super) struct McapWriter<W> {
    out: Counter<W>,
    schemas: Vec<Fields>,
    channels: Vec<Fields>,
    /// The records of the current chunk, which is not written yet.
    chunk: Vec<u8>,
    chunk_times: (u64, u64),
    /// Time and offset of each message of the chunk.
    chunk_messages: BTreeMap<ChannelId, Vec<(u64, u64)>>,
    chunk_indexes: Vec<Fields>,
    attachment_indexes: Vec<Fields>,
    totals: Totals,
}

impl<W: Write> McapWriter<W> {
    /// Begins a file with the name of a profile.
    pub(super) fn new(out: W, profile: &str) -> io::Result<Self> {
        let mut out = Counter { out, offset: 0, crc: crc32fast::Hasher::new() };
        out.put(&MAGIC)?;
        let library = concat!("mapping_trial ", env!("CARGO_PKG_VERSION"));
        out.record(Op::Header, Fields::default().text(profile).text(library))?;
        Ok(McapWriter {
            out,
            schemas: Vec::new(),
            channels: Vec::new(),
            chunk: Vec::new(),
            chunk_times: (u64::MAX, 0),
            chunk_messages: BTreeMap::new(),
            chunk_indexes: Vec::new(),
            attachment_indexes: Vec::new(),
            totals: Totals::default(),
        })
    }

    /// Adds a schema.
    pub(super) fn schema(
        &mut self,
        name: &str,
        encoding: &str,
        text: &str,
    ) -> io::Result<SchemaId> {
        let id = SchemaId(self.schemas.len() as u16 + 1);
        let mut fields = Fields::default();
        fields.u16(id.0).text(name).text(encoding).text(text);
        self.out.record(Op::Schema, &fields)?;
        self.schemas.push(fields);
        Ok(id)
    }

    /// Adds a channel.
    pub(super) fn channel(
        &mut self,
        schema: SchemaId,
        topic: &str,
        encoding: &str,
        metadata: &[(&str, &str)],
    ) -> io::Result<ChannelId> {
        let id = ChannelId(self.channels.len() as u16);
        let mut entries = Fields::default();
        for (key, value) in metadata {
            entries.text(key).text(value);
        }
        let mut fields = Fields::default();
        fields.u16(id.0).u16(schema.0).text(topic).text(encoding).bytes(&entries.0);
        self.out.record(Op::Channel, &fields)?;
        self.channels.push(fields);
        self.totals.channels.push(0);
        Ok(id)
    }

    /// Adds a message at a time in nanoseconds.
    pub(super) fn message(&mut self, channel: ChannelId, time: u64, data: &[u8]) -> io::Result<()> {
        let count = &mut self.totals.channels[channel.index()];
        // Messages of a channel are numbered. No trial has more than the number can hold.
        let sequence = *count as u32;
        *count += 1;
        let (first, last) = self.totals.times.unwrap_or((time, time));
        self.totals.times = Some((first.min(time), last.max(time)));
        self.chunk_times = (self.chunk_times.0.min(time), self.chunk_times.1.max(time));
        let messages = self.chunk_messages.entry(channel).or_default();
        messages.push((time, self.chunk.len() as u64));
        let mut head = Fields::default();
        head.u16(channel.0).u32(sequence).u64(time).u64(time);
        self.chunk.push(Op::Message as u8);
        self.chunk.extend_from_slice(&((head.0.len() + data.len()) as u64).to_le_bytes());
        self.chunk.extend_from_slice(&head.0);
        self.chunk.extend_from_slice(data);
        if self.chunk.len() >= CHUNK { self.end_chunk() } else { Ok(()) }
    }

    /// Writes the current chunk and the indexes of its messages.
    fn end_chunk(&mut self) -> io::Result<()> {
        if self.chunk.is_empty() {
            return Ok(());
        }
        let compressed = compressed(&self.chunk);
        let (len, compressed_len) = (self.chunk.len() as u64, compressed.len() as u64);
        let times = std::mem::replace(&mut self.chunk_times, (u64::MAX, 0));
        let mut fields = Fields::default();
        fields.u64(times.0).u64(times.1).u64(len).u32(crc32fast::hash(&self.chunk));
        fields.text(LZ4).u64(compressed_len);
        let start = self.out.offset;
        self.out.begin(Op::Chunk, fields.0.len() as u64 + compressed_len)?;
        self.out.put(&fields.0)?;
        self.out.put(&compressed)?;
        let end = self.out.offset;

        let mut offsets = Vec::new();
        for (channel, messages) in std::mem::take(&mut self.chunk_messages) {
            offsets.push((channel.0, self.out.offset));
            let mut entries = Fields::default();
            for (time, offset) in messages {
                entries.u64(time).u64(offset);
            }
            let mut fields = Fields::default();
            fields.u16(channel.0).bytes(&entries.0);
            self.out.record(Op::MessageIndex, &fields)?;
        }
        let mut fields = Fields::default();
        fields.u64(times.0).u64(times.1).u64(start).u64(end - start);
        fields.by_channel(offsets.into_iter()).u64(self.out.offset - end);
        fields.text(LZ4).u64(compressed_len).u64(len);
        self.chunk_indexes.push(fields);
        self.chunk.clear();
        Ok(())
    }

    /// Adds a file at a time in nanoseconds, after the messages so far.
    pub(super) fn attach(&mut self, time: u64, file: Attachment<'_>) -> io::Result<()> {
        self.end_chunk()?;
        // The creation time of the file is 0, which means unknown, so that the same trial gives the
        // same bytes.
        let mut fields = Fields::default();
        fields.u64(time).u64(0).text(file.name).text(file.media_type);
        fields.u64(file.data.len() as u64);
        let mut crc = crc32fast::Hasher::new();
        crc.update(&fields.0);
        crc.update(file.data);
        let start = self.out.offset;
        self.out.begin(Op::Attachment, (fields.0.len() + file.data.len() + 4) as u64)?;
        self.out.put(&fields.0)?;
        self.out.put(file.data)?;
        self.out.put(&crc.finalize().to_le_bytes())?;
        let mut index = Fields::default();
        index.u64(start).u64(self.out.offset - start).u64(time).u64(0);
        index.u64(file.data.len() as u64).text(file.name).text(file.media_type);
        self.attachment_indexes.push(index);
        Ok(())
    }

    /// Ends the file with its summary.
    pub(super) fn finish(mut self) -> io::Result<(W, Totals)> {
        self.end_chunk()?;
        let crc = std::mem::replace(&mut self.out.crc, crc32fast::Hasher::new()).finalize();
        self.out.record(Op::DataEnd, Fields::default().u32(crc))?;
        let (first, last) = self.totals.times.unwrap_or((0, 0));
        let mut statistics = Fields::default();
        statistics.u64(self.totals.messages()).u16(self.schemas.len() as u16);
        statistics.u32(self.channels.len() as u32).u32(self.attachment_indexes.len() as u32);
        // There are no records of metadata.
        statistics.u32(0).u32(self.chunk_indexes.len() as u32).u64(first).u64(last);
        let counts = self.totals.channels.iter().enumerate();
        statistics.by_channel(counts.map(|(channel, count)| (channel as u16, *count)));

        self.out.crc = crc32fast::Hasher::new();
        let summary = self.out.offset;
        let mut offsets = Vec::new();
        for (op, records) in [
            (Op::Schema, &self.schemas[..]),
            (Op::Channel, &self.channels),
            (Op::Statistics, &[statistics]),
            (Op::ChunkIndex, &self.chunk_indexes),
            (Op::AttachmentIndex, &self.attachment_indexes),
        ] {
            let start = self.out.offset;
            records.iter().try_for_each(|fields| self.out.record(op, fields))?;
            if !records.is_empty() {
                offsets.push((op, start, self.out.offset - start));
            }
        }
        let summary_offsets = self.out.offset;
        for (op, start, len) in offsets {
            let mut fields = Fields(vec![op as u8]);
            self.out.record(Op::SummaryOffset, fields.u64(start).u64(len))?;
        }
        // The checksum covers the footer up to itself.
        self.out.begin(Op::Footer, 20)?;
        self.out.put(&Fields::default().u64(summary).u64(summary_offsets).0)?;
        let crc = self.out.crc.clone().finalize();
        self.out.put(&crc.to_le_bytes())?;
        self.out.put(&MAGIC)?;
        self.out.out.flush()?;
        Ok((self.out.out, self.totals))
    }
}

/// The beginning of an LZ4 frame (<https://github.com/lz4/lz4/blob/dev/doc/lz4_Frame_format.md>): its
/// magic number, version 1 with independent blocks of at most 4 MiB and no checksums, since chunks have
/// their own, and the checksum of this header.
const LZ4_FRAME: [u8; 7] = [0x04, 0x22, 0x4d, 0x18, 0x60, 0x70, 0x73];

/// Greatest number of bytes of a block in such a frame.
const LZ4_BLOCK: usize = 4 << 20;

/// Marks a block that is not compressed, since compression would make it longer.
const LZ4_PLAIN: u32 = 1 << 31;

/// Returns bytes as an LZ4 frame.
fn compressed(bytes: &[u8]) -> Vec<u8> {
    let mut frame = LZ4_FRAME.to_vec();
    for block in bytes.chunks(LZ4_BLOCK) {
        let small = lz4_flex::block::compress(block);
        let (data, mark) =
            if small.len() < block.len() { (&small[..], 0) } else { (block, LZ4_PLAIN) };
        frame.extend_from_slice(&(data.len() as u32 | mark).to_le_bytes());
        frame.extend_from_slice(data);
    }
    // No further block.
    frame.extend_from_slice(&[0; 4]);
    frame
}

#[cfg(test)]
pub(super) mod tests;
