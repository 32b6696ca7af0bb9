//! How many parameters an ONNX file has, found without loading its weights.
//!
//! Shapes and types are read, and a few numbers of each weight, by which equal weights are known.

mod element;
mod fault;
mod operator;
mod samples;
mod scan;
mod tensor;
mod weight;

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Read, Seek};

use super::error::EngineError;
use scan::Scan;
pub use weight::Weight;

/// The parameters of one or several graphs; a weight that is there twice is listed once.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Parameters {
    weights: Vec<Weight>,
}

impl Parameters {
    fn new(weights: impl IntoIterator<Item = Weight>) -> Self {
        let mut known = BTreeSet::new();
        let is_new = |weight: &Weight| known.insert(weight.identity());
        Self { weights: weights.into_iter().filter(is_new).collect() }
    }

    /// Those of several graphs of one model. A weight that two of them hold is listed once.
    pub fn union<'a>(graphs: impl IntoIterator<Item = &'a Self>) -> Self {
        Self::new(graphs.into_iter().flat_map(|graph| graph.weights.iter().cloned()))
    }

    /// Looks at a few numbers of the weights in files of their own, so that equal ones are found.
    ///
    /// `open` opens a file by the location that the graph states, from the folder of the graph.
    /// A weight whose file cannot be read stays known by its place.
    #[must_use]
    pub fn with_external_files<R: Read + Seek>(
        mut self,
        mut open: impl FnMut(&str) -> io::Result<R>,
    ) -> Self {
        self.weights.iter_mut().for_each(|weight| weight.sample_external(&mut open));
        Self::new(self.weights)
    }

    /// The weights, in the order of the files.
    #[must_use]
    pub fn weights(&self) -> &[Weight] {
        &self.weights
    }

    /// How many parameters they have together.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.weights.iter().map(|weight| weight.parameters).sum()
    }

    /// How many bytes they take in the files.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.weights.iter().map(|weight| weight.bytes).sum()
    }

    /// How many parameters each type of number has: `float32`, `float16`, `int8`, `4-bit` …
    #[must_use]
    pub fn by_type(&self) -> BTreeMap<String, u64> {
        let mut types = BTreeMap::new();
        for weight in &self.weights {
            *types.entry(weight.element.clone()).or_default() += weight.parameters;
        }
        types
    }
}

/// Counts the parameters of an ONNX file of so many bytes, which is read from its beginning.
///
/// A parameter is a number of a weight. Weights are the tensors of initialisers and of `Constant`
/// nodes, in inner graphs and functions too, of these types:
///
/// - floats, except the scales of quantised operators and of `Resize`;
/// - integers of at most 8 bits, except zero points: they are quantised weights;
/// - wider integers where a quantised operator takes them for a weight, as biases are; no others,
///   which are shapes and indices.
///
/// A tensor of a single number is a setting, not a weight. What is packed counts unpacked: the `K`
/// x `N` numbers of `MatMulNBits`. Running means and tables of positions cannot be told from what
/// was learnt, and count.
///
/// A weight counts once, however often it is there. Two matrices are the same weight when shape,
/// type and numbers are equal, also when one is the transpose of the other, as tied embeddings
/// are; other tensors, and matrices of one number repeated, when their names are equal, too.
/// Numbers are compared at a few places. Weights in files of their own are the same when their
/// place is; see [`Parameters::with_external_files`].
///
/// # Errors
/// [`EngineError::Broken`] when the file is no ONNX model, breaks off, or states a shape that its
/// bytes do not have.
pub fn count_parameters(source: impl Read + Seek, bytes: u64) -> Result<Parameters, EngineError> {
    let mut scan = Scan::new(source);
    let weights = scan.model(bytes).map_err(|fault| {
        let found = fault.describe(bytes, scan.position());
        EngineError::Broken { found }
    })?;
    Ok(Parameters::new(weights))
}

#[cfg(test)]
mod tests;
