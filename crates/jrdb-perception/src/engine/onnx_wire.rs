//! The encoding of ONNX files, protocol buffers, read field by field.

use std::io::{self, BufReader, Read, Seek};

/// Bytes that can be passed over without being read.
pub(super) trait Source: Read + Seek {}

impl<T: Read + Seek> Source for T {}

/// Longest text that is kept, bytes: names of tensors and operators.
const TEXT_MAX: usize = 1 << 12;
/// Bits of a varint's byte.
const VARINT_BITS: u32 = 7;

/// A field's value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Value {
    /// An integer.
    Number(u64),
    /// Bytes that end there: a text, a message, or packed numbers.
    Bytes(u64),
    /// Four or eight bytes that end there.
    Fixed(u64),
}

/// A reader of fields.
pub(super) struct Wire<S> {
    source: BufReader<S>,
    at: u64,
}

fn broken() -> io::Error {
    io::ErrorKind::InvalidData.into()
}

impl<S: Source> Wire<S> {
    pub(super) fn new(source: S) -> Self {
        Self { source: BufReader::new(source), at: 0 }
    }

    /// The next field of the message that ends at `end`: its number and value.
    pub(super) fn field(&mut self, end: u64) -> io::Result<Option<(u64, Value)>> {
        if self.at >= end {
            return Ok(None);
        }
        let key = self.varint()?;
        let value = match key & 7 {
            0 => Value::Number(self.varint()?),
            1 => Value::Fixed(self.at + 8),
            2 => Value::Bytes(self.varint()?.checked_add(self.at).ok_or_else(broken)?),
            5 => Value::Fixed(self.at + 4),
            _ => return Err(broken()),
        };
        let fits = match value {
            Value::Number(_) => true,
            Value::Bytes(last) | Value::Fixed(last) => last <= end,
        };
        if fits { Ok(Some((key >> 3, value))) } else { Err(broken()) }
    }

    /// Passes over what is left of a value.
    pub(super) fn finish(&mut self, value: Value) -> io::Result<()> {
        match value {
            Value::Number(_) => Ok(()),
            Value::Bytes(end) | Value::Fixed(end) => {
                let left = end.checked_sub(self.at).ok_or_else(broken)?;
                self.source.seek_relative(i64::try_from(left).map_err(|_| broken())?)?;
                self.at = end;
                Ok(())
            }
        }
    }

    /// Bytes from the beginning of the file.
    pub(super) fn position(&self) -> u64 {
        self.at
    }

    /// Reads packed integers up to `end` and forgets them.
    pub(super) fn pass_integers(&mut self, end: u64) -> io::Result<()> {
        while self.at < end {
            self.varint()?;
        }
        Ok(())
    }

    /// The text up to `end`, or its beginning.
    pub(super) fn text(&mut self, end: u64) -> io::Result<String> {
        let bytes = self.bytes(end, TEXT_MAX)?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }

    /// The bytes up to `end`, when they are no more than `most`; else none.
    pub(super) fn bytes(&mut self, end: u64, most: usize) -> io::Result<Vec<u8>> {
        let length = usize::try_from(end - self.at).map_err(|_| broken())?;
        if length > most {
            return Ok(Vec::new());
        }
        let mut bytes = vec![0; length];
        self.source.read_exact(&mut bytes)?;
        self.at = end;
        Ok(bytes)
    }

    /// Adds an integer, or packed ones, to a list, as long as it is no longer than `most`.
    pub(super) fn numbers(
        &mut self,
        value: Value,
        list: &mut Vec<i64>,
        most: usize,
    ) -> io::Result<()> {
        match value {
            Value::Number(number) if list.len() < most => list.push(number as i64),
            Value::Bytes(end) => {
                while self.at < end && list.len() < most {
                    list.push(self.varint()? as i64);
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Adds a 32-bit float, or packed ones, to a list, as long as it is no longer than `most`.
    pub(super) fn floats(
        &mut self,
        value: Value,
        list: &mut Vec<f32>,
        most: usize,
    ) -> io::Result<()> {
        let (Value::Bytes(end) | Value::Fixed(end)) = value else { return Ok(()) };
        let packed = self.bytes(end, size_of::<f32>() * most)?;
        let room = most.saturating_sub(list.len());
        list.extend(packed.as_chunks().0.iter().take(room).map(|bytes| f32::from_le_bytes(*bytes)));
        Ok(())
    }

    fn varint(&mut self) -> io::Result<u64> {
        let mut number = 0_u64;
        for shift in (0..u64::BITS).step_by(VARINT_BITS as usize) {
            let mut byte = [0];
            self.source.read_exact(&mut byte)?;
            self.at += 1;
            number |= u64::from(byte[0] & 0x7f) << shift;
            if byte[0] & 0x80 == 0 {
                return Ok(number);
            }
        }
        Err(broken())
    }
}

/// Fields written by hand, for tests.
#[cfg(test)]
pub(super) mod written {
    pub(in crate::engine) fn varint(mut n: u64) -> Vec<u8> {
        let mut bytes = Vec::new();
        while n > 0x7f {
            bytes.push(n as u8 & 0x7f | 0x80);
            n >>= 7;
        }
        bytes.push(n as u8);
        bytes
    }

    pub(in crate::engine) fn number(field: u64, value: u64) -> Vec<u8> {
        [varint(field << 3), varint(value)].concat()
    }

    pub(in crate::engine) fn bytes(field: u64, value: &[u8]) -> Vec<u8> {
        [varint(field << 3 | 2), varint(value.len() as u64), value.to_vec()].concat()
    }
}
