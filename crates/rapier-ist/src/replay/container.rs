//! The records of an MCAP file, each checked before it is handed out.
//!
//! The walk over the file is written here and not left to the mcap crate's readers: those tell no places, parse
//! attachments that a flipped bit has made too short, and hand out records of a chunk before its checksum is known.

use super::ReplayEnd;
use crc32fast::hash;
use mcap::records::{ChunkHeader, Record, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

/// Opcode and length in front of every record.
const PREFIX: usize = 1 + 8;
/// A chunk that claims to unpack to more than this is taken for damaged (bytes).
const MAX_UNPACKED: usize = 1 << 30;

/// Whether `bytes` begin as an MCAP file does, as far as they go.
pub(super) fn begins_as_mcap(bytes: &[u8]) -> bool {
    bytes.iter().zip(mcap::MAGIC).all(|(a, b)| a == b)
}

/// Hands the records to `visit`, those in chunks like those outside, until the data end; tells how far it came.
pub(super) fn walk(bytes: &[u8], mut visit: impl FnMut(Record)) -> ReplayEnd {
    let mut position = mcap::MAGIC.len();
    loop {
        let truncated = ReplayEnd::Truncated { at: position.min(bytes.len()) as u64 };
        let Some((opcode, body)) = record_at(bytes, position) else { return truncated };
        let damaged = |what: String| ReplayEnd::Damaged { at: position as u64, what };
        let visited = match opcode {
            op::CHUNK => chunk(bytes, position, body, &mut visit),
            op::ATTACHMENT => attachment(body, &mut visit),
            op::DATA_END => {
                let whole = bytes.get(..position).is_some_and(|data| data_end_agrees(body, data));
                let finished = bytes.ends_with(mcap::MAGIC);
                return match (whole, finished) {
                    (false, _) => damaged("the checksum of the whole file does not agree".into()),
                    (true, true) => ReplayEnd::Complete,
                    (true, false) => truncated,
                };
            }
            op::METADATA => parse(opcode, body, &mut visit),
            // Anywhere else it is another record whose kind is damaged.
            op::HEADER if position == mcap::MAGIC.len() => Ok(()),
            op::MESSAGE_INDEX if is_message_index(body) => Ok(()),
            // Other records would be skipped by the format's rules. A recorder writes none, and were they skipped, a
            // chunk whose kind is damaged would be missing in the middle.
            _ => Err(format!("a record of kind {opcode:#04x} makes no sense here")),
        };
        if let Err(what) = visited {
            return damaged(what);
        }
        position += PREFIX + body.len();
    }
}

/// Opcode and body of the record at `position`; `None` where it does not fit into the bytes.
fn record_at(bytes: &[u8], position: usize) -> Option<(u8, &[u8])> {
    let (prefix, rest) = bytes.get(position..)?.split_at_checked(PREFIX)?;
    let (&opcode, length) = prefix.split_first()?;
    let length = u64::from_le_bytes(length.try_into().ok()?);
    Some((opcode, rest.get(..usize::try_from(length).ok()?)?))
}

fn parse(opcode: u8, body: &[u8], visit: &mut impl FnMut(Record)) -> Result<(), String> {
    visit(mcap::parse_record(opcode, body).map_err(|error| error.to_string())?);
    Ok(())
}

/// Whether the body of an index is as long as it says: a channel, a length in bytes, and entries of 16 bytes.
fn is_message_index(body: &[u8]) -> bool {
    let length = body.get(2..).and_then(|rest| rest.first_chunk()).map(|length| u32::from_le_bytes(*length));
    length.is_some_and(|length| length % 16 == 0 && body.len() as u64 == 6 + u64::from(length))
}

/// A checksum of zero says that there is none.
fn agrees(saved: u32, data: &[u8]) -> bool {
    saved == 0 || saved == hash(data)
}

fn data_end_agrees(body: &[u8], data: &[u8]) -> bool {
    <[u8; 4]>::try_from(body).is_ok_and(|crc| agrees(u32::from_le_bytes(crc), data))
}

/// The checksum at the end of an attachment's record covers all that comes before.
fn attachment(body: &[u8], visit: &mut impl FnMut(Record)) -> Result<(), String> {
    let checked = body.split_last_chunk().is_some_and(|(data, crc)| {
        let saved = u32::from_le_bytes(*crc);
        saved != 0 && agrees(saved, data)
    });
    if !checked {
        return Err("the checksum of an attachment does not agree".into());
    }
    if !is_attachment(body) {
        return Err("an attachment's lengths do not agree".into());
    }
    parse(op::ATTACHMENT, body, visit)
}

/// What follows a string in a record.
fn after_string(rest: &[u8]) -> Option<&[u8]> {
    let (length, rest) = rest.split_first_chunk()?;
    rest.get(usize::try_from(u32::from_le_bytes(*length)).ok()?..)
}

/// Whether the parts of an attachment fill its record: two times, name, media type, data and checksum. The crate's parser
/// panics where the names reach into the checksum.
fn is_attachment(body: &[u8]) -> bool {
    let data = body.get(16..).and_then(after_string).and_then(after_string);
    data.and_then(|rest| rest.split_first_chunk())
        .is_some_and(|(length, rest)| u64::from_le_bytes(*length).checked_add(4) == Some(rest.len() as u64))
}

/// The chunk whose record begins at `position` and has the given body.
fn chunk(bytes: &[u8], position: usize, body: &[u8], visit: &mut impl FnMut(Record)) -> Result<(), String> {
    let Ok(Record::Chunk { header, data }) = mcap::parse_record(op::CHUNK, body) else {
        return Err("a chunk's header makes no sense".into());
    };
    if header.compression.is_empty() {
        return plain_chunk(&header, &data, visit);
    }
    let record = bytes.get(position..position + PREFIX + body.len()).unwrap_or_default();
    let options = LinearReaderOptions::default()
        .with_skip_start_magic(true)
        .with_skip_end_magic(true)
        .with_prevalidate_chunk_crcs(true)
        .with_record_length_limit(MAX_UNPACKED);
    let mut reader = LinearReader::new_with_options(options);
    let mut rest = record;
    while let Some(event) = reader.next_event() {
        match event.map_err(|error| error.to_string())? {
            LinearReadEvent::ReadRequest(_) if rest.is_empty() => return Ok(()),
            LinearReadEvent::ReadRequest(wanted) => {
                let (now, later) = rest.split_at(wanted.min(rest.len()));
                reader.insert(now.len()).copy_from_slice(now);
                reader.notify_read(now.len());
                rest = later;
            }
            LinearReadEvent::Record { opcode, data } => chunk_record(opcode, data, visit)?,
        }
    }
    Ok(())
}

fn plain_chunk(header: &ChunkHeader, data: &[u8], visit: &mut impl FnMut(Record)) -> Result<(), String> {
    if !agrees(header.uncompressed_crc, data) {
        return Err("the checksum of a chunk does not agree".into());
    }
    let mut position = 0;
    while position < data.len() {
        let Some((opcode, body)) = record_at(data, position) else {
            return Err("a chunk ends in the middle of a record".into());
        };
        chunk_record(opcode, body, visit)?;
        position += PREFIX + body.len();
    }
    Ok(())
}

/// Chunks hold schemas, channels and messages; a schema says nothing new about a recording.
fn chunk_record(opcode: u8, body: &[u8], visit: &mut impl FnMut(Record)) -> Result<(), String> {
    match opcode {
        op::CHANNEL | op::MESSAGE => parse(opcode, body, visit),
        _ => Ok(()),
    }
}
