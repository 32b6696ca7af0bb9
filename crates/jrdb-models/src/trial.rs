//! A model loaded and run once on made-up numbers.

use std::path::Path;
use std::time::Instant;

use jrdb_perception::Tensor;

use crate::Error;
use crate::catalogue::Model;
use crate::loader::{EngineOptions, Loader};

/// Runs whose best time counts.
const RUNS: usize = 3;

/// What a model did.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// Which engine ran it, in words.
    pub engine: String,
    /// Inputs and outputs with their shapes, in words.
    pub shapes: String,
    /// Best wall time of a run on one thread, milliseconds.
    pub run_ms: f64,
}

/// Loads a model of the folder and runs it.
///
/// # Errors
/// When it cannot be read, loaded or run.
pub fn run(model: &Model, folder: &Path, options: &EngineOptions) -> Result<Trial, Error> {
    let path = folder.join(&model.file);
    let loader = Loader::new(options)?;
    let (engine, note) = (loader.open(&path)?, loader.note().to_owned());
    let inputs: Vec<(&str, Tensor)> =
        model.inputs.iter().map(|i| (i.name.as_str(), numbers(&i.shape))).collect();
    let given: Vec<(&str, &Tensor)> = inputs.iter().map(|(name, tensor)| (*name, tensor)).collect();
    let wanted: Vec<&str> = model.outputs.iter().map(String::as_str).collect();
    let mut run_ms = f64::INFINITY;
    let mut outputs = Vec::new();
    for _ in 0..RUNS {
        let start = Instant::now();
        let wrap = |source| Error::Engine { what: path.display().to_string(), source };
        outputs = engine.run(&given, &wanted).map_err(wrap)?;
        run_ms = run_ms.min(start.elapsed().as_secs_f64() * 1e3);
    }
    let shape = |name: &str, tensor: &Tensor| format!("{name} {:?}", tensor.shape());
    let ins: Vec<String> = inputs.iter().map(|(name, tensor)| shape(name, tensor)).collect();
    let outs: Vec<String> = wanted.iter().zip(&outputs).map(|(name, t)| shape(name, t)).collect();
    Ok(Trial { engine: note, shapes: format!("{} -> {}", ins.join(", "), outs.join(", ")), run_ms })
}

/// Numbers between -1 and 1 in no order that means anything.
fn numbers(shape: &[usize]) -> Tensor {
    const STEP: usize = 7919;
    const MODULUS: usize = 2001;
    let number = |i: usize| (i.wrapping_mul(STEP) % MODULUS) as f32 / 1000.0 - 1.0;
    let data = (0..shape.iter().product()).map(number).collect();
    Tensor::F32 { shape: shape.to_vec(), data }
}

/// The most memory that this process has had so far, megabytes, where the system tells.
#[must_use]
pub fn peak_memory_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: f64 = line.trim().trim_end_matches("kB").trim().parse().ok()?;
    Some(kilobytes / 1024.0)
}
