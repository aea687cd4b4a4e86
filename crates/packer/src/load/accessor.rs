//! Numbers in the buffers of glTF files.
//!
//! The `gltf` crate has readers too. They rely on files that are valid in every respect and panic at some that are
//! not, such as strides of zero and fewer sparse values than indices; here every access is checked.

use glam::DVec3;
use gltf::Accessor;
use gltf::accessor::sparse::IndexType;
use gltf::accessor::{DataType, Dimensions};
use gltf::buffer::View;

/// Elements of a view, some bytes each.
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
    count: usize,
}

impl<'a> Elements<'a> {
    /// `count` elements of `size` bytes, the first one `offset` bytes into the view.
    fn new(
        view: &View,
        offset: usize,
        size: usize,
        count: usize,
        buffers: &'a [Vec<u8>],
    ) -> Result<Self, String> {
        let outside = "values lie outside their buffer";
        let end = view.offset().checked_add(view.length()).ok_or(outside)?;
        let buffer = buffers.get(view.buffer().index()).ok_or(outside)?;
        let bytes = buffer.get(view.offset()..end).and_then(|view| view.get(offset..)).ok_or(outside)?;
        let stride = view.stride().unwrap_or(size).max(1);
        let length = count.checked_sub(1).map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(size));
        if length.is_none_or(|length| length > bytes.len()) {
            return Err(outside.to_owned());
        }
        Ok(Self { bytes, stride, size, count })
    }

    fn iter(&self) -> impl Iterator<Item = &'a [u8]> + '_ {
        (0..self.count).map(|i| &self.bytes[i * self.stride..i * self.stride + self.size])
    }
}

/// Positions, which are three floats each.
pub(super) fn positions(accessor: &Accessor, buffers: &[Vec<u8>]) -> Result<Vec<DVec3>, String> {
    if accessor.data_type() != DataType::F32 || accessor.dimensions() != Dimensions::Vec3 {
        return Err("the positions of a primitive are not three floats each".to_owned());
    }
    let float = |bytes: &[u8]| f64::from(f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]));
    read(accessor, buffers, |bytes| DVec3::new(float(bytes), float(&bytes[4..]), float(&bytes[8..])))
}

/// Indices of one, two or four bytes.
pub(super) fn indices(accessor: &Accessor, buffers: &[Vec<u8>]) -> Result<Vec<u32>, String> {
    let is_index = matches!(accessor.data_type(), DataType::U8 | DataType::U16 | DataType::U32);
    if !is_index || accessor.dimensions() != Dimensions::Scalar {
        return Err("the indices of a primitive are not unsigned numbers".to_owned());
    }
    read(accessor, buffers, unsigned)
}

/// A little-endian number of up to four bytes.
fn unsigned(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |number, byte| number << 8 | u32::from(*byte))
}

/// All elements of an accessor: those of its view, or zeros, with its sparse ones put in.
fn read<T: Default + Clone>(
    accessor: &Accessor,
    buffers: &[Vec<u8>],
    parse: impl Fn(&[u8]) -> T,
) -> Result<Vec<T>, String> {
    let (count, size) = (accessor.count(), accessor.size());
    let mut values: Vec<T> = match accessor.view() {
        Some(view) => {
            Elements::new(&view, accessor.offset(), size, count, buffers)?.iter().map(&parse).collect()
        }
        // Zeros need no bytes, so their number has to be believed; but not more than the file may mean.
        None if count > buffers.iter().map(Vec::len).sum() => {
            return Err(format!("{count} values announced, more than there are bytes"));
        }
        None => vec![T::default(); count],
    };
    if let Some(sparse) = accessor.sparse() {
        let (places, fill) = (sparse.indices(), sparse.values());
        let place_size = match places.index_type() {
            IndexType::U8 => 1,
            IndexType::U16 => 2,
            IndexType::U32 => 4,
        };
        let places = Elements::new(&places.view(), places.offset(), place_size, sparse.count(), buffers)?;
        let fill = Elements::new(&fill.view(), fill.offset(), size, sparse.count(), buffers)?;
        for (place, value) in places.iter().zip(fill.iter()) {
            let place = unsigned(place) as usize;
            *values.get_mut(place).ok_or("a sparse value has no place")? = parse(value);
        }
    }
    Ok(values)
}
