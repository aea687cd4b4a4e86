//! Recording through writers that are slow, interrupted or broken.

use super::test_scene::{Fall, STEPS};
use super::*;
use crate::replay::{Replay, ReplayEnd};
use std::io::{self, Cursor, Error, ErrorKind, Seek, SeekFrom, Write};
use std::sync::{Arc, Mutex};

/// What a writer does with the next call of `write`.
#[derive(Clone, Copy)]
enum Mood {
    /// Takes one byte.
    OneByte,
    /// Is interrupted by a signal and takes nothing.
    Interrupted,
    /// Takes all.
    Whole,
    /// Fails.
    Fails(ErrorKind),
    /// Takes nothing and says so.
    TakesNothing,
}

/// A writer that goes through its moods, and stays in the last one. Clones are the same writer.
#[derive(Clone)]
struct Moody {
    content: Arc<Mutex<(Cursor<Vec<u8>>, usize)>>,
    moods: Arc<dyn Fn(usize) -> Mood + Send + Sync>,
}

impl Moody {
    fn new(moods: impl Fn(usize) -> Mood + Send + Sync + 'static) -> Self {
        Self { content: Arc::default(), moods: Arc::new(moods) }
    }

    fn bytes(&self) -> Vec<u8> {
        self.content.lock().unwrap().0.get_ref().clone()
    }

    fn calls(&self) -> usize {
        self.content.lock().unwrap().1
    }
}

impl Write for Moody {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let (content, calls) = &mut *self.content.lock().unwrap();
        *calls += 1;
        match (self.moods)(*calls - 1) {
            Mood::OneByte => content.write(&bytes[..bytes.len().min(1)]),
            Mood::Interrupted => Err(ErrorKind::Interrupted.into()),
            Mood::Whole => content.write(bytes),
            Mood::Fails(kind) => Err(Error::new(kind, "broken wire")),
            Mood::TakesNothing => Ok(0),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for Moody {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.content.lock().unwrap().0.seek(to)
    }
}

/// Records the fall through `writer`, and returns the first error.
fn record(writer: &Moody, background: bool) -> Result<(), RecordError> {
    let options = RecordOptions::everything().chunk_size(2000).background(background);
    let mut fall = Fall::new();
    let mut recorder = Recorder::new_send(writer.clone(), options)?;
    fall.describe(&mut recorder)?;
    fall.run(&mut recorder, STEPS)?;
    recorder.finish().map(|_| ())
}

#[test]
fn a_writer_that_takes_a_byte_at_a_time_and_is_interrupted_gets_the_same_file() {
    let whole = Moody::new(|_| Mood::Whole);
    record(&whole, false).unwrap();
    for background in [false, true] {
        let moody = Moody::new(|call| [Mood::OneByte, Mood::Interrupted, Mood::Interrupted][call % 3]);
        record(&moody, background).unwrap();
        assert!(moody.bytes() == whole.bytes(), "background {background}");
    }
}

#[test]
fn whatever_a_writer_fails_with_at_any_call_is_told_and_leaves_a_beginning() {
    let whole = Moody::new(|_| Mood::Whole);
    record(&whole, false).unwrap();
    let bytes = whole.bytes();
    let calls = whole.calls();
    assert!(calls > 10, "the file is written in parts");
    for background in [false, true] {
        for call in 0..calls {
            let failures = [
                Mood::Fails(ErrorKind::PermissionDenied),
                Mood::Fails(ErrorKind::BrokenPipe),
                Mood::Fails(ErrorKind::UnexpectedEof),
                Mood::TakesNothing,
            ];
            let failure = failures[call % failures.len()];
            let writer = Moody::new(move |index| if index < call { Mood::Whole } else { failure });
            let error = record(&writer, background).unwrap_err().to_string();
            assert!(
                error.contains("the given writer") && error.contains("record to another place"),
                "{error}"
            );
            let written = writer.bytes();
            assert!(bytes.starts_with(&written), "call {call}");
            let replay = Replay::from_bytes(&written).unwrap();
            assert!(replay.end() != &ReplayEnd::Complete, "call {call}");
        }
    }
}
