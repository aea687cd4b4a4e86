//! Where messages go: to the file, here or on another thread, one protobuf channel per topic.

use super::background::Background;
use super::file::{Channel, Entry, McapFile, Written};
use super::{RecordError, RecordOptions};
use foxglove::Encode;
use mcap::records::Metadata;
use std::collections::{BTreeMap, HashMap};
use std::io::{self, Seek, Write};

/// Encodes messages and passes them on. After an error it only repeats it.
pub(super) struct Sink<W: Write + Seek> {
    output: Output<W>,
    /// Indices of the channels by topic.
    channels: HashMap<String, usize>,
    /// The buffer of the last message that was written here.
    spare: Vec<u8>,
    target: String,
    failure: Option<(io::ErrorKind, String)>,
}

enum Output<W: Write + Seek> {
    Here(Box<McapFile<W>>),
    Background(Background),
}

impl<W: Write + Seek> Sink<W> {
    /// Writes on the calling thread.
    pub(super) fn new(writer: W, target: String, options: &RecordOptions) -> Result<Self, RecordError> {
        match McapFile::new(writer, options) {
            Ok(file) => Ok(Self::with_output(Output::Here(Box::new(file)), target)),
            Err(source) => Err(RecordError::Write { target, source }),
        }
    }

    /// Writes on a thread of its own.
    pub(super) fn background(writer: W, target: String, options: &RecordOptions) -> Result<Self, RecordError>
    where
        W: Send + 'static,
    {
        match McapFile::new(writer, options).and_then(Background::spawn) {
            Ok(background) => Ok(Self::with_output(Output::Background(background), target)),
            Err(source) => Err(RecordError::Write { target, source }),
        }
    }

    fn with_output(output: Output<W>, target: String) -> Self {
        Self { output, channels: HashMap::new(), spare: Vec::new(), target, failure: None }
    }

    /// Writes a message at `time` (ns), which must not lie before that of the message before.
    pub(super) fn write<M: Encode>(
        &mut self,
        topic: &str,
        time: u64,
        message: &M,
    ) -> Result<(), RecordError> {
        let channel = match self.channels.get(topic) {
            Some(&channel) => channel,
            None => self.add_channel::<M>(topic, BTreeMap::new())?,
        };
        let mut data = match &self.output {
            Output::Here(_) => std::mem::take(&mut self.spare),
            Output::Background(background) => background.spare_buffer().unwrap_or_default(),
        };
        data.clear();
        if let Err(error) = message.encode(&mut data) {
            return Err(self.fail(&io::Error::other(error.to_string())));
        }
        self.put(Entry::Message { channel, time, data })
    }

    /// Opens the channel of a topic that says more about itself than its messages do.
    pub(super) fn add_channel<M: Encode>(
        &mut self,
        topic: &str,
        metadata: BTreeMap<String, String>,
    ) -> Result<usize, RecordError> {
        let Some(schema) = M::get_schema() else {
            return Err(self.fail(&io::Error::other("a message without schema")));
        };
        let encoding = M::get_message_encoding();
        self.put(Entry::Channel(Channel { topic: topic.to_owned(), schema, encoding, metadata }))?;
        let index = self.channels.len();
        self.channels.insert(topic.to_owned(), index);
        Ok(index)
    }

    pub(super) fn metadata(
        &mut self,
        name: &str,
        metadata: BTreeMap<String, String>,
    ) -> Result<(), RecordError> {
        self.put(Entry::Metadata(Metadata { name: name.to_owned(), metadata }))
    }

    pub(super) fn attach(&mut self, name: String, time: u64, data: Vec<u8>) -> Result<(), RecordError> {
        self.put(Entry::Attachment { name, time, data })
    }

    /// Makes what was written so far survive the end of the process.
    pub(super) fn flush(&mut self) -> Result<(), RecordError> {
        self.put(Entry::Flush)
    }

    /// Writes the summary and hands everything to the operating system.
    pub(super) fn finish(self) -> Result<Written, RecordError> {
        if self.failure.is_some() {
            return Err(self.failure());
        }
        let Self { output, target, .. } = self;
        let written = match output {
            Output::Here(file) => file.finish(),
            Output::Background(mut background) => background.join(),
        };
        written.map_err(|source| RecordError::Write { target, source })
    }

    fn put(&mut self, entry: Entry) -> Result<(), RecordError> {
        if self.failure.is_some() {
            return Err(self.failure());
        }
        let put = match &mut self.output {
            Output::Here(file) => {
                let put = file.put(&entry);
                if let Entry::Message { data, .. } = entry {
                    self.spare = data;
                }
                put
            }
            Output::Background(background) => background.put(entry),
        };
        put.map_err(|error| self.fail(&error))
    }

    /// Remembers an error. A file that lacks something in between must not go on.
    fn fail(&mut self, error: &io::Error) -> RecordError {
        self.failure = Some((error.kind(), error.to_string()));
        self.failure()
    }

    fn failure(&self) -> RecordError {
        let (kind, text) = self.failure.clone().unwrap_or((io::ErrorKind::Other, String::new()));
        RecordError::Write { target: self.target.clone(), source: io::Error::new(kind, text) }
    }
}
