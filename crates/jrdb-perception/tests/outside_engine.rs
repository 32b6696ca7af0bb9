//! An engine outside the crate keeps tensors on its own device and mixes with the other engines.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]
#![allow(clippy::print_stdout, reason = "reports a missing onnxruntime")]

mod onnxruntime;

use std::borrow::Cow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use jrdb_perception::engine::check_call;
use jrdb_perception::{
    DeviceTensor, DeviceValue, Engine, EngineError, Input, OrtEngine, RtenEngine, Tensor,
};

const TINY: &[u8] = include_bytes!("../testdata/tiny.onnx");

/// Numbers on a device that counts how often they are copied to the host.
#[derive(Debug)]
struct CountedValue {
    shape: Vec<usize>,
    data: Arc<Vec<f32>>,
    copies: Arc<AtomicUsize>,
}

impl DeviceValue for CountedValue {
    fn to_tensor(&self, _: &str) -> Result<Tensor, EngineError> {
        self.copies.fetch_add(1, Ordering::Relaxed);
        Ok(Tensor::F32 { shape: self.shape.clone(), data: self.data.to_vec() })
    }

    fn floats(&self, _: &str) -> Result<(Vec<usize>, Cow<'_, [f32]>), EngineError> {
        self.copies.fetch_add(1, Ordering::Relaxed);
        Ok((self.shape.clone(), Cow::Owned(self.data.to_vec())))
    }

    fn gather_rows(&self, name: &str, rows: &[usize]) -> Result<DeviceTensor, EngineError> {
        let missing = || EngineError::wrong_type(name, "expected another row");
        let mut data = Vec::new();
        for &row in rows {
            data.push(*self.data.get(row).ok_or_else(missing)?);
        }
        let (data, copies) = (Arc::new(data), Arc::clone(&self.copies));
        Ok(DeviceTensor::new(Self { shape: vec![rows.len()], data, copies }))
    }
}

/// Adds 1 to its input `x`.
#[derive(Debug)]
struct CountingEngine {
    names: [Vec<String>; 2],
    copies: Arc<AtomicUsize>,
}

impl CountingEngine {
    fn new() -> Self {
        Self { names: [vec!["x".into()], vec!["y".into()]], copies: Arc::default() }
    }

    fn copies(&self) -> usize {
        self.copies.load(Ordering::Relaxed)
    }
}

impl Engine for CountingEngine {
    fn name(&self) -> &str {
        "counting"
    }

    fn inputs(&self) -> &[String] {
        &self.names[0]
    }

    fn outputs(&self) -> &[String] {
        &self.names[1]
    }

    fn run_on_device(
        &self,
        inputs: &[(&str, Input<'_>)],
        outputs: &[&str],
    ) -> Result<Vec<DeviceTensor>, EngineError> {
        check_call(self, inputs, outputs)?;
        let (name, input) = inputs[0];
        let (shape, data) = if let Some(value) = input.on_device::<CountedValue>() {
            (value.shape.clone(), value.data.iter().map(|x| x + 1.0).collect())
        } else if let Tensor::F32 { shape, data } = &*input.to_tensor(name)? {
            (shape.clone(), data.iter().map(|x| x + 1.0).collect())
        } else {
            return Err(EngineError::wrong_type(name, "expected f32"));
        };
        let (data, copies) = (Arc::new(data), Arc::clone(&self.copies));
        Ok(vec![DeviceTensor::new(CountedValue { shape, data, copies })])
    }
}

fn floats(shape: &[usize], data: &[f32]) -> Tensor {
    Tensor::F32 { shape: shape.to_vec(), data: data.to_vec() }
}

#[test]
fn tensors_stay_on_the_device_of_an_outside_engine_until_they_are_read() {
    let engine = CountingEngine::new();
    let start = floats(&[3], &[0.0, 10.0, 20.0]);
    let mut value = engine.run_on_device(&[("x", (&start).into())], &["y"]).unwrap().remove(0);
    for _ in 0..4 {
        value = value.gather_rows("x", &[1, 0, 2]).unwrap();
        value = engine.run_on_device(&[("x", (&value).into())], &["y"]).unwrap().remove(0);
    }
    assert_eq!(engine.copies(), 0);
    assert_eq!(value.to_tensor("y").unwrap(), floats(&[3], &[5.0, 15.0, 25.0]));
    assert_eq!(engine.copies(), 1);
}

#[test]
fn run_returns_tensors_of_the_host_and_refuses_unknown_names() {
    let engine = CountingEngine::new();
    let x = floats(&[1], &[1.0]);
    assert_eq!(engine.run(&[("x", &x)], &["y"]).unwrap(), [floats(&[1], &[2.0])]);
    let error = engine.run(&[("z", &x)], &["y"]).unwrap_err();
    assert_eq!(error.to_string(), r#"the model has no input "z"; it has ["x"]"#);
}

/// From the outside engine through another one and back: y = relu(2 (x + 1) - 1) + 1.
fn there_and_back(other: &dyn Engine) {
    let outside = CountingEngine::new();
    let (x, k) = (floats(&[1, 3], &[0.0; 3]), Tensor::I64 { shape: vec![2], data: vec![0, 0] });
    let value = outside.run_on_device(&[("x", (&x).into())], &["y"]).unwrap().remove(0);
    let inputs = [("x", (&value).into()), ("k", (&k).into())];
    let y = other.run_on_device(&inputs, &["y"]).unwrap().remove(0);
    assert_eq!(outside.copies(), 1);
    let back = outside.run_on_device(&[("x", (&y).into())], &["y"]).unwrap().remove(0);
    assert_eq!(back.into_tensor("y").unwrap(), floats(&[1, 3], &[2.0; 3]), "{}", other.name());
}

#[test]
fn engines_copy_the_tensors_of_other_engines() {
    there_and_back(&RtenEngine::from_onnx(TINY).unwrap());
    if let Some(library) = onnxruntime::find() {
        there_and_back(&OrtEngine::from_onnx(&library, TINY, 1).unwrap());
    }
}
