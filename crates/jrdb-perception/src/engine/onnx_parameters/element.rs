//! Types of numbers in ONNX files.

/// A type of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Element {
    pub(super) name: &'static str,
    /// Bits of a number.
    pub(super) bits: u64,
    pub(super) class: Class,
}

/// What a tensor of some type may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Class {
    Float,
    /// An integer of at most 8 bits: a quantised weight.
    Narrow,
    /// A wider integer: a shape, an index, or a quantised bias.
    Wide,
}

impl Element {
    /// The type of a number in `TensorProto.DataType`; none for texts and truth values.
    /// Source: `onnx.proto` of ONNX 1.19.
    pub(super) fn of(kind: u64) -> Option<Self> {
        use Class::{Float, Narrow, Wide};
        let (name, bits, class) = match kind {
            1 => ("float32", 32, Float),
            2 => ("uint8", 8, Narrow),
            3 => ("int8", 8, Narrow),
            4 => ("uint16", 16, Wide),
            5 => ("int16", 16, Wide),
            6 => ("int32", 32, Wide),
            7 => ("int64", 64, Wide),
            10 => ("float16", 16, Float),
            11 => ("float64", 64, Float),
            12 => ("uint32", 32, Wide),
            13 => ("uint64", 64, Wide),
            14 => ("complex64", 64, Float),
            15 => ("complex128", 128, Float),
            16 => ("bfloat16", 16, Float),
            17..=20 | 24 => ("float8", 8, Float),
            21 => ("uint4", 4, Narrow),
            22 => ("int4", 4, Narrow),
            23 => ("float4", 4, Float),
            25 => ("uint2", 2, Narrow),
            26 => ("int2", 2, Narrow),
            _ => return None,
        };
        Some(Self { name, bits, class })
    }

    /// Bytes of so many numbers; `None` when there are too many to count.
    pub(super) fn bytes(self, numbers: u64) -> Option<u64> {
        numbers.checked_mul(self.bits).map(|bits| bits.div_ceil(8))
    }
}
