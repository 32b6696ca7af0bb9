//! Tensors that stay with the engine that made them.

use std::borrow::Cow;

use super::{EngineError, Tensor, ort, rten};

/// A tensor in an engine's memory, to be given to an engine of the same kind again or to be read.
#[derive(Debug)]
pub struct Held(pub(super) Inner);

/// Where the numbers are.
pub(super) enum Inner {
    Host(Tensor),
    Ort(::ort::value::DynValue),
    Rten(::rten::Value),
}

impl std::fmt::Debug for Inner {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Host(_) => "host",
            Self::Ort(_) => "onnxruntime",
            Self::Rten(_) => "rten",
        })
    }
}

impl From<Tensor> for Held {
    fn from(tensor: Tensor) -> Self {
        Self(Inner::Host(tensor))
    }
}

impl Held {
    /// A copy in our own memory.
    ///
    /// # Errors
    /// [`EngineError::Type`] if it holds neither 32-bit floats nor integers, or has more than 6 axes.
    pub fn to_tensor(&self, name: &str) -> Result<Tensor, EngineError> {
        match &self.0 {
            Inner::Host(tensor) => Ok(tensor.clone()),
            Inner::Ort(value) => ort::tensor(value, name),
            Inner::Rten(value) => rten::tensor(name, value.clone()),
        }
    }

    /// Shape and numbers, without a copy where the engine has them in one piece.
    ///
    /// # Errors
    /// [`EngineError::Type`] if it does not hold 32-bit floats.
    pub fn floats(&self, name: &str) -> Result<(Vec<usize>, Cow<'_, [f32]>), EngineError> {
        let not_floats = |found: &str| EngineError::Type {
            name: name.into(),
            source: format!("expected f32, found {found}").into(),
        };
        match &self.0 {
            Inner::Host(Tensor::F32 { shape, data }) => {
                Ok((shape.clone(), Cow::Borrowed(data.as_slice())))
            }
            Inner::Host(other) => Err(not_floats(&other.describe())),
            Inner::Ort(value) => ort::floats(value, name).map(|(s, d)| (s, Cow::Borrowed(d))),
            Inner::Rten(value) => rten::floats(value).ok_or_else(|| not_floats("another type")),
        }
    }

    /// Some of its rows along the first axis, in the order given, a row perhaps more than once.
    ///
    /// # Errors
    /// [`EngineError::Type`] if it does not hold 32-bit floats, or has no such row.
    pub fn pick(&self, name: &str, rows: &[usize]) -> Result<Self, EngineError> {
        let (mut shape, data) = self.floats(name)?;
        let missing = |row: usize| EngineError::Type {
            name: name.into(),
            source: format!("expected a row {row}, found {shape:?}").into(),
        };
        let len = shape.iter().skip(1).product::<usize>();
        let mut picked = Vec::with_capacity(rows.len() * len);
        for &row in rows {
            let part = data.get(row * len..(row + 1) * len).ok_or_else(|| missing(row))?;
            picked.extend_from_slice(part);
        }
        if let Some(first) = shape.first_mut() {
            *first = rows.len();
        }
        Ok(Tensor::F32 { shape, data: picked }.into())
    }
}

/// What a model is given: a tensor of ours, or one that its engine holds.
#[derive(Debug, Clone, Copy)]
pub enum Input<'a> {
    /// Ours.
    Tensor(&'a Tensor),
    /// The engine's.
    Held(&'a Held),
}

impl<'a> From<&'a Tensor> for Input<'a> {
    fn from(tensor: &'a Tensor) -> Self {
        Self::Tensor(tensor)
    }
}

impl<'a> From<&'a Held> for Input<'a> {
    fn from(held: &'a Held) -> Self {
        match &held.0 {
            Inner::Host(tensor) => Self::Tensor(tensor),
            Inner::Ort(_) | Inner::Rten(_) => Self::Held(held),
        }
    }
}

impl<'a> Input<'a> {
    /// In our memory, copied if it is not there yet.
    pub(super) fn to_tensor(self, name: &str) -> Result<Cow<'a, Tensor>, EngineError> {
        match self {
            Self::Tensor(tensor) => Ok(Cow::Borrowed(tensor)),
            Self::Held(held) => held.to_tensor(name).map(Cow::Owned),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_picked_in_any_order_and_more_than_once() {
        let held =
            Held::from(Tensor::F32 { shape: vec![3, 2], data: vec![0., 1., 2., 3., 4., 5.] });
        let picked = held.pick("x", &[2, 0, 2]).unwrap();
        let (shape, data) = picked.floats("x").unwrap();
        assert_eq!((shape, data.as_ref()), (vec![3, 2], [4., 5., 0., 1., 4., 5.].as_slice()));
        let message = held.pick("x", &[3]).unwrap_err().to_string();
        assert!(message.starts_with(r#"expected output "x""#), "{message}");
    }
}
