//! An ONNX file, walked through in search of weights.

use std::collections::{BTreeMap, BTreeSet};

use super::element::Class;
use super::fault::Fault;
use super::operator::{Packing, Use, roles, weight_use};
use super::tensor::Tensor;
use super::weight::Weight;
use crate::engine::onnx_wire::{Source, Value, Wire};

/// How deep graphs may lie in each other.
const DEPTH_MAX: usize = 16;

/// What is known of a node.
#[derive(Debug, Default)]
struct Node {
    operator: String,
    inputs: Vec<String>,
    outputs: Vec<String>,
    constants: Vec<Tensor>,
    packing: Packing,
}

/// A walk through a file.
pub(super) struct Scan<S> {
    wire: Wire<S>,
    tensors: Vec<Tensor>,
    /// How quantised operators use tensors, by their name.
    uses: BTreeMap<String, Use>,
    has_graph: bool,
}

impl<S: Source> Scan<S> {
    pub(super) fn new(source: S) -> Self {
        let (tensors, uses) = (Vec::new(), BTreeMap::new());
        Self { wire: Wire::new(source), tensors, uses, has_graph: false }
    }

    /// Up to which byte the file has been read.
    pub(super) fn position(&self) -> u64 {
        self.wire.position()
    }

    /// `ModelProto`: the graph is field 7, functions are field 25.
    pub(super) fn model(&mut self, end: u64) -> Result<Vec<Weight>, Fault> {
        while let Some((number, value)) = self.wire.field(end)? {
            match (number, value) {
                (7, Value::Bytes(end)) => {
                    self.has_graph = true;
                    self.graph(end, 0)?;
                }
                (25, Value::Bytes(end)) => self.function(end)?,
                _ => {}
            }
            self.wire.finish(value)?;
        }
        if self.has_graph { self.weights() } else { Err(Fault::Wire) }
    }

    /// `FunctionProto`: nodes are field 7.
    fn function(&mut self, end: u64) -> Result<(), Fault> {
        while let Some((number, value)) = self.wire.field(end)? {
            if let (7, Value::Bytes(end)) = (number, value) {
                self.node(end, 0)?;
            }
            self.wire.finish(value)?;
        }
        Ok(())
    }

    /// `GraphProto`: nodes are field 1, initialisers 5, sparse ones 15.
    fn graph(&mut self, end: u64, depth: usize) -> Result<(), Fault> {
        if depth > DEPTH_MAX {
            let found = format!("expected at most {DEPTH_MAX} graphs in each other, found more");
            return Err(Fault::Found(found));
        }
        while let Some((number, value)) = self.wire.field(end)? {
            match (number, value) {
                (1, Value::Bytes(end)) => self.node(end, depth)?,
                (5, Value::Bytes(end)) => self.tensors.push(Tensor::read(&mut self.wire, end)?),
                (15, Value::Bytes(end)) => {
                    self.tensors.push(Tensor::read_sparse(&mut self.wire, end)?);
                }
                _ => {}
            }
            self.wire.finish(value)?;
        }
        Ok(())
    }

    /// `NodeProto`: inputs are field 1, outputs 2, the operator 4, attributes 5.
    fn node(&mut self, end: u64, depth: usize) -> Result<(), Fault> {
        let mut node = Node::default();
        while let Some((number, value)) = self.wire.field(end)? {
            match (number, value) {
                (1, Value::Bytes(end)) => node.inputs.push(self.wire.text(end)?),
                (2, Value::Bytes(end)) => node.outputs.push(self.wire.text(end)?),
                (4, Value::Bytes(end)) => node.operator = self.wire.text(end)?,
                (5, Value::Bytes(end)) => self.attribute(end, depth, &mut node)?,
                _ => {}
            }
            self.wire.finish(value)?;
        }
        self.note_uses(&node)?;
        if node.operator == "Constant" {
            let name = node.outputs.first().cloned().unwrap_or_default();
            let constants = node.constants.into_iter();
            self.tensors.extend(constants.map(|tensor| tensor.named(&name)));
        }
        Ok(())
    }

    /// `AttributeProto`: the name is field 1, an integer 3, a tensor 5, a graph 6, floats 7, graphs
    /// 11, a sparse tensor 22.
    fn attribute(&mut self, end: u64, depth: usize, node: &mut Node) -> Result<(), Fault> {
        let (mut name, mut int, mut floats) = (String::new(), None, 0);
        while let Some((number, value)) = self.wire.field(end)? {
            match (number, value) {
                (1, Value::Bytes(end)) => name = self.wire.text(end)?,
                (3, Value::Number(number)) => int = Some(number),
                (5, Value::Bytes(end)) => node.constants.push(Tensor::read(&mut self.wire, end)?),
                (6 | 11, Value::Bytes(end)) => self.graph(end, depth + 1)?,
                (7, Value::Bytes(end)) => {
                    floats += (end - self.wire.position()) / size_of::<f32>() as u64;
                }
                (7, Value::Fixed(_)) => floats += 1,
                (22, Value::Bytes(end)) => {
                    node.constants.push(Tensor::read_sparse(&mut self.wire, end)?);
                }
                _ => {}
            }
            self.wire.finish(value)?;
        }
        match name.as_str() {
            "K" => node.packing.rows = int,
            "N" => node.packing.columns = int,
            "bits" => node.packing.bits = int,
            "value_floats" => node.constants.push(Tensor::floats(floats)),
            _ => {}
        }
        Ok(())
    }

    /// Notes how a quantised operator uses its inputs; where uses differ, the greater one counts.
    fn note_uses(&mut self, node: &Node) -> Result<(), Fault> {
        let (weights, auxiliary) = roles(&node.operator);
        let mut note = |inputs: &[usize], used| {
            for name in inputs.iter().filter_map(|&at| node.inputs.get(at)) {
                let known = self.uses.entry(name.clone()).or_insert(used);
                *known = used.max(*known);
            }
        };
        note(auxiliary, Use::Auxiliary);
        if !weights.is_empty() {
            let (operator, inputs) = (&node.operator, &node.inputs);
            let missing = |what: &str| {
                Fault::Found(format!("expected {what} of {operator} on {inputs:?}, found none"))
            };
            note(weights, weight_use(operator, &node.packing).map_err(missing)?);
        }
        Ok(())
    }

    /// The tensors that are weights.
    fn weights(&mut self) -> Result<Vec<Weight>, Fault> {
        let tensors = std::mem::take(&mut self.tensors);
        let names: BTreeSet<&str> = tensors.iter().map(|tensor| tensor.name.as_str()).collect();
        // Dynamic quantisation keeps `w_quantized`, and multiplies with `w_scale` elsewhere.
        let of_quantised = |name: &str| {
            let stems = ["_scale", "_zero_point"].map(|end| name.strip_suffix(end));
            let is_there = |stem| names.contains(format!("{stem}_quantized").as_str());
            stems.into_iter().flatten().any(is_there)
        };
        let is_weight = |tensor: &&Tensor| !of_quantised(&tensor.name);
        let weights = tensors.iter().filter(is_weight).map(|tensor| self.weight(tensor));
        weights.filter_map(Result::transpose).collect()
    }

    /// The weight that a tensor is, if it is one.
    fn weight(&self, tensor: &Tensor) -> Result<Option<Weight>, Fault> {
        let Some(stored) = tensor.element.filter(|_| tensor.numbers() > 1) else { return Ok(None) };
        let (name, numbers) = (&tensor.name, tensor.numbers());
        let used = self.uses.get(name).copied();
        let capacity = |bits: u64| numbers.saturating_mul(stored.bits) / bits.max(1);
        let packed = |bits: u64| format!("{bits}-bit");
        let (parameters, element) = match (used, stored.class) {
            (Some(Use::Auxiliary), _) | (None, Class::Wide) => return Ok(None),
            (Some(Use::Packed { numbers, bits }), _) if numbers > capacity(bits) => {
                return Err(Fault::Found(format!(
                    "expected at least {numbers} numbers of {bits} bits in {name:?}, found {} {:?}",
                    stored.name, tensor.shape
                )));
            }
            (Some(Use::Packed { numbers, bits }), _) => (numbers, packed(bits)),
            (Some(Use::Dense { bits }), Class::Narrow) if bits < stored.bits => {
                (capacity(bits), packed(bits))
            }
            _ => (numbers, stored.name.into()),
        };
        Ok(Some(Weight {
            name: name.clone(),
            element,
            shape: tensor.shape.clone(),
            parameters,
            bytes: stored.bytes(numbers).unwrap_or(u64::MAX),
            stored,
            samples: tensor.samples.clone(),
            external: tensor.external.clone(),
        }))
    }
}
