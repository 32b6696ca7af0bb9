//! Which inputs of quantised operators are weights, and which only belong to them.

/// How an operator uses a tensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Use {
    /// A scale, a zero point, or a size.
    Auxiliary,
    /// A weight, whatever its type.
    Weight,
    /// So many numbers of so many bits, packed into bytes.
    Packed { numbers: u64, bits: u64 },
    /// Numbers of so many bits, packed into the bytes of the tensor without a gap.
    Dense { bits: u64 },
}

/// Bits of packed numbers where the operator does not state them.
const DEFAULT_BITS: u64 = 4;

/// Attributes of an operator that say how weights are packed.
#[derive(Debug, Default)]
pub(super) struct Packing {
    pub(super) rows: Option<u64>,
    pub(super) columns: Option<u64>,
    pub(super) bits: Option<u64>,
}

/// The inputs of an operator that are quantised weights, and those that only belong to weights.
///
/// Sources: the operators of ONNX 1.19 and the contributed operators of ONNX Runtime 1.23.
pub(super) fn roles(operator: &str) -> (&'static [usize], &'static [usize]) {
    match operator {
        "DequantizeLinear" | "QuantizeLinear" => (&[0], &[1, 2]),
        "MatMulInteger" | "ConvInteger" => (&[0, 1], &[2, 3]),
        "MatMulIntegerToFloat" => (&[0, 1], &[2, 3, 4, 5]),
        "DynamicQuantizeMatMul" => (&[1], &[2, 3]),
        "QLinearMatMul" => (&[0, 3], &[1, 2, 4, 5, 6, 7]),
        "QLinearConv" => (&[0, 3, 8], &[1, 2, 4, 5, 6, 7]),
        "QGemm" => (&[0, 3, 6], &[1, 2, 4, 5, 7, 8]),
        "QAttention" => (&[1], &[3, 4, 6, 7]),
        "MatMulNBits" => (&[1], &[2, 3, 4]),
        "MatMulBnb4" => (&[1], &[2]),
        "GatherBlockQuantized" => (&[0], &[2, 3]),
        "Resize" => (&[], &[1, 2, 3]),
        "Upsample" => (&[], &[1]),
        _ => (&[], &[]),
    }
}

/// How an operator uses the weight of [`roles`]; what is missing where it is packed in an unknown
/// way.
pub(super) fn weight_use(operator: &str, packing: &Packing) -> Result<Use, &'static str> {
    let bits = packing.bits.unwrap_or(DEFAULT_BITS);
    match operator {
        "MatMulNBits" | "MatMulBnb4" => {
            let sides = packing.rows.zip(packing.columns);
            let numbers = sides.and_then(|(rows, columns)| rows.checked_mul(columns));
            let numbers = numbers.ok_or("the attributes K and N")?;
            Ok(Use::Packed { numbers, bits })
        }
        "GatherBlockQuantized" => Ok(Use::Dense { bits }),
        _ => Ok(Use::Weight),
    }
}
