//! Tensors in the memory of the engine that computed them.

use std::any::Any;
use std::borrow::Cow;
use std::fmt;

use super::error::EngineError;
use super::tensor::Tensor;

/// A tensor in the memory of one kind of engine.
///
/// An engine recognises its own tensors with [`Input::on_device`] and reads all others with
/// [`Input::to_tensor`].
pub trait DeviceValue: Any + Send + Sync + fmt::Debug {
    /// A copy in the memory of this process. `name` is the tensor's name, for errors.
    ///
    /// # Errors
    /// [`EngineError::Type`] if it holds neither 32-bit floats nor integers, or has more axes than
    /// the engine returns.
    fn to_tensor(&self, name: &str) -> Result<Tensor, EngineError>;

    /// Shape and numbers, without a copy where the engine has them in one piece.
    ///
    /// # Errors
    /// [`EngineError::Type`] if it does not hold 32-bit floats.
    fn floats(&self, name: &str) -> Result<(Vec<usize>, Cow<'_, [f32]>), EngineError>;

    /// The value in the memory of this process. Engines that can give their memory away avoid a
    /// copy here.
    ///
    /// # Errors
    /// As [`DeviceValue::to_tensor`].
    fn into_tensor(self: Box<Self>, name: &str) -> Result<Tensor, EngineError> {
        self.to_tensor(name)
    }

    /// The given rows along the first axis, in this order; a row may occur several times. Engines
    /// that can do so gather the rows on their device; this implementation copies them to the host.
    ///
    /// # Errors
    /// [`EngineError::Type`] if it does not hold 32-bit floats, or has no such row.
    fn gather_rows(&self, name: &str, rows: &[usize]) -> Result<DeviceTensor, EngineError> {
        let (mut shape, data) = self.floats(name)?;
        let missing = |row: usize| {
            EngineError::wrong_type(name, format!("expected a row {row}, found {shape:?}"))
        };
        let len = shape.iter().skip(1).product::<usize>();
        let mut gathered = Vec::with_capacity(rows.len() * len);
        for &row in rows {
            let part = data.get(row * len..(row + 1) * len).ok_or_else(|| missing(row))?;
            gathered.extend_from_slice(part);
        }
        if let Some(first) = shape.first_mut() {
            *first = rows.len();
        }
        Ok(Tensor::F32 { shape, data: gathered }.into())
    }
}

impl DeviceValue for Tensor {
    fn to_tensor(&self, _: &str) -> Result<Tensor, EngineError> {
        Ok(self.clone())
    }

    fn floats(&self, name: &str) -> Result<(Vec<usize>, Cow<'_, [f32]>), EngineError> {
        let Self::F32 { shape, data } = self else {
            let found = format!("expected f32, found {}", self.describe());
            return Err(EngineError::wrong_type(name, found));
        };
        Ok((shape.clone(), Cow::Borrowed(data.as_slice())))
    }

    fn into_tensor(self: Box<Self>, _: &str) -> Result<Tensor, EngineError> {
        Ok(*self)
    }
}

/// Checks that an output holds numbers: a score that is not one would be taken for "nothing there". Negative infinity is
/// the logarithm of 0 and is allowed.
fn check_numbers(name: &str, data: &[f32]) -> Result<(), EngineError> {
    let is_odd = |number: &&f32| number.is_nan() || **number == f32::INFINITY;
    let found = data.iter().filter(is_odd).count();
    if found == 0 {
        return Ok(());
    }
    Err(EngineError::NotANumber { name: name.into(), found, of: data.len() })
}

/// A tensor in the memory of any engine, or of this process.
#[derive(Debug)]
pub struct DeviceTensor(Box<dyn DeviceValue>);

impl From<Tensor> for DeviceTensor {
    fn from(tensor: Tensor) -> Self {
        Self::new(tensor)
    }
}

impl DeviceTensor {
    /// Wraps a value of an engine.
    #[must_use]
    pub fn new(value: impl DeviceValue) -> Self {
        Self(Box::new(value))
    }

    /// The value, if it is of this type.
    #[must_use]
    pub fn downcast_ref<T: DeviceValue>(&self) -> Option<&T> {
        let value: &dyn Any = &*self.0;
        value.downcast_ref()
    }

    /// A copy in the memory of this process. `name` is the tensor's name, for errors.
    ///
    /// # Errors
    /// As [`DeviceValue::to_tensor`].
    pub fn to_tensor(&self, name: &str) -> Result<Tensor, EngineError> {
        self.0.to_tensor(name)
    }

    /// The tensor in the memory of this process, without a copy where the engine allows it.
    ///
    /// # Errors
    /// As [`DeviceValue::to_tensor`]; [`EngineError::NotANumber`] when the model has computed nonsense.
    pub fn into_tensor(self, name: &str) -> Result<Tensor, EngineError> {
        let tensor = self.0.into_tensor(name)?;
        if let Tensor::F32 { data, .. } = &tensor {
            check_numbers(name, data)?;
        }
        Ok(tensor)
    }

    /// Shape and numbers, without a copy where the engine has them in one piece.
    ///
    /// # Errors
    /// As [`DeviceValue::floats`]; [`EngineError::NotANumber`] when the model has computed nonsense.
    pub fn floats(&self, name: &str) -> Result<(Vec<usize>, Cow<'_, [f32]>), EngineError> {
        let (shape, data) = self.0.floats(name)?;
        check_numbers(name, &data)?;
        Ok((shape, data))
    }

    /// The given rows along the first axis, in this order; a row may occur several times.
    ///
    /// # Errors
    /// As [`DeviceValue::gather_rows`].
    pub fn gather_rows(&self, name: &str, rows: &[usize]) -> Result<Self, EngineError> {
        self.0.gather_rows(name, rows)
    }
}

/// An input of a model: a tensor in the memory of this process, or one on a device.
#[derive(Debug, Clone, Copy)]
pub enum Input<'a> {
    /// In the memory of this process.
    Host(&'a Tensor),
    /// In the memory of an engine, which need not be the one that runs the model.
    Device(&'a DeviceTensor),
}

impl<'a> From<&'a Tensor> for Input<'a> {
    fn from(tensor: &'a Tensor) -> Self {
        Self::Host(tensor)
    }
}

impl<'a> From<&'a DeviceTensor> for Input<'a> {
    fn from(tensor: &'a DeviceTensor) -> Self {
        tensor.downcast_ref().map_or(Self::Device(tensor), Self::Host)
    }
}

impl<'a> Input<'a> {
    /// The value, if it is an engine's value of this type.
    #[must_use]
    pub fn on_device<T: DeviceValue>(self) -> Option<&'a T> {
        match self {
            Self::Host(_) => None,
            Self::Device(tensor) => tensor.downcast_ref(),
        }
    }

    /// The tensor in the memory of this process; copied if it is on a device. Its length is
    /// checked.
    ///
    /// # Errors
    /// As [`DeviceValue::to_tensor`], and [`EngineError::Length`].
    pub fn to_tensor(self, name: &str) -> Result<Cow<'a, Tensor>, EngineError> {
        let tensor = match self {
            Self::Host(tensor) => Cow::Borrowed(tensor),
            Self::Device(tensor) => Cow::Owned(tensor.to_tensor(name)?),
        };
        tensor.check(name)?;
        Ok(tensor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_number_is_an_error_and_the_logarithm_of_zero_is_one() {
        let read = |data: Vec<f32>| {
            let tensor = Tensor::F32 { shape: vec![data.len()], data };
            DeviceTensor::from(tensor).into_tensor("scores")
        };
        assert!(read(vec![0.5, f32::NEG_INFINITY]).is_ok());
        let message = read(vec![0.5, f32::NAN, f32::INFINITY]).unwrap_err().to_string();
        let wanted = "expected numbers in output \"scores\", found NaN or infinity in 2 of 3";
        assert_eq!(message, wanted);
    }

    #[test]
    fn rows_are_gathered_in_any_order_and_more_than_once() {
        let rows = DeviceTensor::from(Tensor::F32 {
            shape: vec![3, 2],
            data: vec![0., 1., 2., 3., 4., 5.],
        });
        let gathered = rows.gather_rows("x", &[2, 0, 2]).unwrap();
        let (shape, data) = gathered.floats("x").unwrap();
        assert_eq!((shape, data.as_ref()), (vec![3, 2], [4., 5., 0., 1., 4., 5.].as_slice()));
        let message = rows.gather_rows("x", &[3]).unwrap_err().to_string();
        assert!(message.starts_with(r#"expected output "x""#), "{message}");
    }
}
