//! A tensor of an ONNX file, without its numbers.

use std::io;

use super::element::Element;
use super::fault::Fault;
use super::samples::Samples;
use super::weight::External;
use crate::engine::onnx_wire::{Source, Value, Wire};

/// Most axes of a tensor that are read.
const AXES_MAX: usize = 64;
/// `TensorProto.DataType.FLOAT`.
const FLOAT: u64 = 1;

/// What is known of a tensor.
#[derive(Debug, Default)]
pub(super) struct Tensor {
    pub(super) name: String,
    pub(super) shape: Vec<u64>,
    /// None for texts and truth values.
    pub(super) element: Option<Element>,
    pub(super) samples: Option<Samples>,
    pub(super) external: Option<External>,
    dims: Vec<i64>,
    kind: u64,
    /// Bytes of its numbers, in this file or another, where they are stated.
    stated_bytes: Option<u64>,
}

impl Tensor {
    /// A list of 32-bit floats that is an attribute.
    pub(super) fn floats(count: u64) -> Self {
        Self { shape: vec![count], element: Element::of(FLOAT), ..Self::default() }
    }

    /// The same tensor, which has no name of its own, under the name of a value.
    pub(super) fn named(mut self, name: &str) -> Self {
        self.name = name.into();
        self
    }

    /// `TensorProto`: the shape is field 1, the type 2, floats 4, the name 8, raw bytes 9, the
    /// place in another file 13.
    pub(super) fn read<S: Source>(wire: &mut Wire<S>, end: u64) -> Result<Self, Fault> {
        let mut tensor = Self::default();
        while let Some((number, value)) = wire.field(end)? {
            match (number, value) {
                (1, value) => wire.numbers(value, &mut tensor.dims, AXES_MAX)?,
                (2, Value::Number(kind)) => tensor.kind = kind,
                (4, Value::Bytes(end)) if tensor.kind == FLOAT => tensor.look_at(wire, end)?,
                (8, Value::Bytes(end)) => tensor.name = wire.text(end)?,
                (9, Value::Bytes(end)) => {
                    tensor.stated_bytes = Some(end - wire.position());
                    tensor.look_at(wire, end)?;
                }
                (13, Value::Bytes(end)) => tensor.place(wire, end)?,
                _ => {}
            }
            wire.finish(value)?;
        }
        tensor.element = Element::of(tensor.kind);
        tensor.shape = tensor.checked_shape()?;
        Ok(tensor)
    }

    /// `SparseTensorProto`: the numbers that are not zero are field 1.
    pub(super) fn read_sparse<S: Source>(wire: &mut Wire<S>, end: u64) -> Result<Self, Fault> {
        let mut values = Self::default();
        while let Some((number, value)) = wire.field(end)? {
            if let (1, Value::Bytes(end)) = (number, value) {
                values = Self::read(wire, end)?;
            }
            wire.finish(value)?;
        }
        Ok(values)
    }

    /// How many numbers it has.
    pub(super) fn numbers(&self) -> u64 {
        self.shape.iter().product()
    }

    /// Looks at some of the numbers up to `end`. A file that states shape and type behind them, as
    /// none does, is not compared.
    fn look_at<S: Source>(&mut self, wire: &mut Wire<S>, end: u64) -> io::Result<()> {
        let start = wire.position();
        let shape: Option<Vec<u64>> = self.dims.iter().map(|&d| u64::try_from(d).ok()).collect();
        let Some((element, shape)) = Element::of(self.kind).zip(shape) else { return Ok(()) };
        let numbers = shape.iter().try_fold(1_u64, |all, &length| all.checked_mul(length));
        if numbers.and_then(|numbers| element.bytes(numbers)) != Some(end - start) {
            return Ok(());
        }
        let read = |place: u64, length: usize| {
            wire.finish(Value::Fixed(start + place))?;
            wire.bytes(start + place + length as u64, length)
        };
        self.samples = Some(Samples::take(element, &shape, read)?);
        Ok(())
    }

    /// `StringStringEntryProto`: the key is field 1, the value 2.
    fn place<S: Source>(&mut self, wire: &mut Wire<S>, end: u64) -> Result<(), Fault> {
        let (mut key, mut text) = (String::new(), String::new());
        while let Some((number, value)) = wire.field(end)? {
            match (number, value) {
                (1, Value::Bytes(end)) => key = wire.text(end)?,
                (2, Value::Bytes(end)) => text = wire.text(end)?,
                _ => {}
            }
            wire.finish(value)?;
        }
        let number = || {
            text.parse().map_err(|_| {
                Fault::Found(format!("expected a number as {key} of a tensor, found {text:?}"))
            })
        };
        let external = self.external.get_or_insert_default();
        match key.as_str() {
            "location" => external.location = text,
            "offset" => external.offset = number()?,
            "length" => self.stated_bytes = Some(number()?),
            _ => {}
        }
        Ok(())
    }

    /// Its shape, when its bytes can have it.
    fn checked_shape(&self) -> Result<Vec<u64>, Fault> {
        let (name, dims) = (&self.name, &self.dims);
        let shape: Option<Vec<u64>> = dims.iter().map(|&d| u64::try_from(d).ok()).collect();
        let numbers = |shape: &[u64]| shape.iter().try_fold(1_u64, |all, &d| all.checked_mul(d));
        let checked = shape.and_then(|shape| Some((numbers(&shape)?, shape)));
        let wrong = || Fault::Found(format!("expected a shape of {name:?}, found {dims:?}"));
        let (numbers, shape) = checked.ok_or_else(wrong)?;
        let Some(element) = self.element.filter(|_| numbers > 0) else { return Ok(shape) };
        let expected = element.bytes(numbers).ok_or_else(wrong)?;
        match self.stated_bytes {
            Some(found) if found != expected => Err(Fault::Found(format!(
                "expected {expected} bytes in {name:?}, {} {dims:?}, found {found}",
                element.name
            ))),
            _ => Ok(shape),
        }
    }
}
