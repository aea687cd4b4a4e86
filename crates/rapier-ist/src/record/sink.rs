//! The MCAP file: channels, metadata and attachments.

use super::{ChunkCompression, RecordError, RecordOptions};
use foxglove::Encode;
use mcap::records::{MessageHeader, Metadata};
use std::collections::{BTreeMap, HashMap};
use std::io::{self, Seek, Write};

/// Written into the header instead of the mcap crate's own version, so that updating it does not change files.
const LIBRARY: &str = concat!("rapier-ist ", env!("CARGO_PKG_VERSION"));

/// An MCAP file being written, one protobuf channel per topic.
pub(super) struct Sink<W: Write + Seek> {
    writer: mcap::Writer<W>,
    channels: HashMap<String, u16>,
    message: Vec<u8>,
    target: String,
}

/// What a finished file holds.
pub(super) struct Written {
    pub(super) messages: u64,
    pub(super) bytes: u64,
}

impl<W: Write + Seek> Sink<W> {
    pub(super) fn new(writer: W, target: String, options: &RecordOptions) -> Result<Self, RecordError> {
        let write_options = mcap::WriteOptions::new()
            .library(LIBRARY)
            .chunk_size(Some(options.chunk_size))
            // Compression on threads of its own would cut the stream where the threads happen to be.
            .compression_threads(0)
            .compression(match options.compression {
                ChunkCompression::None => None,
                ChunkCompression::Lz4 => Some(mcap::Compression::Lz4),
                ChunkCompression::Zstd => Some(mcap::Compression::Zstd),
            });
        match write_options.create(writer) {
            Ok(writer) => Ok(Self { writer, channels: HashMap::new(), message: Vec::new(), target }),
            Err(error) => Err(RecordError::Write { target, source: io_error(error) }),
        }
    }

    /// Writes a message at `time` (ns), which must not lie before that of the message before.
    pub(super) fn write<M: Encode>(
        &mut self,
        topic: &str,
        time: u64,
        message: &M,
    ) -> Result<(), RecordError> {
        self.try_write(topic, time, message)
            .map_err(|source| RecordError::Write { target: self.target.clone(), source })
    }

    fn try_write<M: Encode>(&mut self, topic: &str, time: u64, message: &M) -> io::Result<()> {
        let channel_id = match self.channels.get(topic) {
            Some(&id) => id,
            None => self.add_channel::<M>(topic)?,
        };
        self.message.clear();
        message.encode(&mut self.message).map_err(|error| io::Error::other(error.to_string()))?;
        let header = MessageHeader { channel_id, sequence: 0, log_time: time, publish_time: time };
        self.writer.write_to_known_channel(&header, &self.message).map_err(io_error)
    }

    fn add_channel<M: Encode>(&mut self, topic: &str) -> io::Result<u16> {
        let schema = M::get_schema().ok_or_else(|| io::Error::other("a message without schema"))?;
        let schema =
            self.writer.add_schema(&schema.name, &schema.encoding, &schema.data).map_err(io_error)?;
        let encoding = M::get_message_encoding();
        let id = self.writer.add_channel(schema, topic, &encoding, &BTreeMap::new()).map_err(io_error)?;
        self.channels.insert(topic.to_owned(), id);
        Ok(id)
    }

    pub(super) fn metadata(
        &mut self,
        name: &str,
        metadata: BTreeMap<String, String>,
    ) -> Result<(), RecordError> {
        let record = Metadata { name: name.to_owned(), metadata };
        self.writer.write_metadata(&record).map_err(|error| self.error(error))
    }

    pub(super) fn attach(&mut self, name: String, time: u64, data: &[u8]) -> Result<(), RecordError> {
        let attachment = mcap::Attachment {
            log_time: time,
            create_time: time,
            name,
            media_type: "application/octet-stream".into(),
            data: data.into(),
        };
        self.writer.attach(&attachment).map_err(|error| self.error(error))
    }

    /// Writes the summary and hands everything to the operating system.
    pub(super) fn finish(mut self) -> Result<Written, RecordError> {
        let summary = self.writer.finish().map_err(|error| self.error(error))?;
        let mut inner = self.writer.into_inner();
        let flushed = inner.flush().and_then(|()| inner.stream_position());
        let bytes = flushed.map_err(|source| RecordError::Write { target: self.target, source })?;
        Ok(Written { messages: summary.stats.map_or(0, |stats| stats.message_count), bytes })
    }

    fn error(&self, error: mcap::McapError) -> RecordError {
        RecordError::Write { target: self.target.clone(), source: io_error(error) }
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
