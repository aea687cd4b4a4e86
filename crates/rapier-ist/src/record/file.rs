//! The MCAP file: entries in, chunks out.

use super::{ChunkCompression, RecordOptions};
use mcap::records::{MessageHeader, Metadata};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Seek, Write};

/// Written into the header instead of the mcap crate's own version, so that updating it does not change files.
const LIBRARY: &str = concat!("rapier-ist ", env!("CARGO_PKG_VERSION"));
/// Level of compression. Recording everything takes 2.9 to 3.2 % of a step of the pile with 1, and 5.0 to 6.4 % with 3, Zstd's own
/// choice, whose files are 20 % smaller (`cargo bench -p rapier-ist-benches --bench recording`).
const LEVEL: u32 = 1;
/// Bytes of a message record besides its data: opcode, length, channel, sequence and two times.
const MESSAGE_OVERHEAD: u64 = 1 + 8 + 2 + 4 + 8 + 8;

/// What can be put into the file, in the order in which it will stand there.
pub(super) enum Entry {
    /// A channel; its index is the number of channels put before.
    Channel(Channel),
    /// A message on channel `channel` at `time` (ns).
    Message {
        channel: usize,
        time: u64,
        data: Vec<u8>,
    },
    Metadata(Metadata),
    Attachment {
        name: String,
        time: u64,
        data: Vec<u8>,
    },
    /// Everything before shall survive the end of the process.
    Flush,
}

/// A topic and what its messages are.
pub(super) struct Channel {
    pub(super) topic: String,
    pub(super) schema: foxglove::Schema,
    pub(super) encoding: String,
    pub(super) metadata: BTreeMap<String, String>,
}

/// What a finished file holds.
#[derive(Clone, Copy)]
pub(super) struct Written {
    pub(super) messages: u64,
    pub(super) bytes: u64,
}

/// An MCAP file being written.
///
/// Chunks are made in memory and leave the process whole, when they are full: whatever ends the process, the file
/// has only whole chunks and perhaps the beginning of one more.
pub(super) struct McapFile<W: Write + Seek> {
    writer: mcap::Writer<W>,
    /// Identifiers in the file of the channels, in the order in which they were put.
    channels: Vec<u16>,
    chunk_size: u64,
    /// Bytes in the open chunk.
    pending: u64,
}

impl<W: Write + Seek> McapFile<W> {
    pub(super) fn new(writer: W, options: &RecordOptions) -> io::Result<Self> {
        let write_options = mcap::WriteOptions::new()
            .library(LIBRARY)
            // Chunks end where `put` says, which then also empties the buffers below.
            .chunk_size(None)
            .disable_seeking(true)
            // Compression on threads of its own would cut the stream where the threads happen to be.
            .compression_threads(0)
            .compression_level(LEVEL)
            .compression(match options.compression {
                ChunkCompression::None => None,
                ChunkCompression::Lz4 => Some(mcap::Compression::Lz4),
                ChunkCompression::Zstd => Some(mcap::Compression::Zstd),
            });
        let writer = write_options.create(writer).map_err(io_error)?;
        Ok(Self { writer, channels: Vec::new(), chunk_size: options.chunk_size, pending: 0 })
    }

    pub(super) fn put(&mut self, entry: &Entry) -> io::Result<()> {
        match entry {
            Entry::Channel(channel) => self.add_channel(channel),
            Entry::Message { channel, time, data } => self.write(*channel, *time, data),
            Entry::Metadata(metadata) => self.writer.write_metadata(metadata).map_err(io_error),
            Entry::Attachment { name, time, data } => {
                let attachment = mcap::Attachment {
                    log_time: *time,
                    create_time: *time,
                    name: name.clone(),
                    media_type: "application/octet-stream".into(),
                    data: Cow::Borrowed(data),
                };
                self.writer.attach(&attachment).map_err(io_error)
            }
            Entry::Flush => self.flush(),
        }
    }

    fn add_channel(&mut self, channel: &Channel) -> io::Result<()> {
        let Channel { topic, schema, encoding, metadata } = channel;
        let schema =
            self.writer.add_schema(&schema.name, &schema.encoding, &schema.data).map_err(io_error)?;
        let id = self.writer.add_channel(schema, topic, encoding, metadata).map_err(io_error)?;
        self.channels.push(id);
        Ok(())
    }

    fn write(&mut self, channel: usize, time: u64, data: &[u8]) -> io::Result<()> {
        let unknown = || io::Error::other("a message on a channel that was not put");
        let channel_id = *self.channels.get(channel).ok_or_else(unknown)?;
        let header = MessageHeader { channel_id, sequence: 0, log_time: time, publish_time: time };
        self.writer.write_to_known_channel(&header, data).map_err(io_error)?;
        self.pending += data.len() as u64 + MESSAGE_OVERHEAD;
        if self.pending >= self.chunk_size { self.flush() } else { Ok(()) }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.pending = 0;
        self.writer.flush().map_err(io_error)
    }

    /// Writes the summary and hands everything to the operating system.
    pub(super) fn finish(mut self) -> io::Result<Written> {
        let summary = self.writer.finish().map_err(io_error)?;
        let mut inner = self.writer.into_inner();
        inner.flush()?;
        let bytes = inner.stream_position()?;
        Ok(Written { messages: summary.stats.map_or(0, |stats| stats.message_count), bytes })
    }
}

/// The mcap crate stays out of the public errors: what remains of its own are I/O errors and states that this
/// module does not get into.
fn io_error(error: mcap::McapError) -> io::Error {
    match error {
        mcap::McapError::Io(error) => error,
        other => io::Error::other(other.to_string()),
    }
}
