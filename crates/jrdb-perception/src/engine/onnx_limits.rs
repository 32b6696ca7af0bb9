//! How much memory an ONNX file asks for, found without loading it.
//!
//! Engines evaluate constant parts of a graph while they load it, so a file of 200 bytes can ask for terabytes. What is
//! looked at: the shapes that tensors and inputs state, and the operators whose output is as large as a constant says.

use std::collections::BTreeMap;
use std::io::{self, Read, Seek};

use super::error::EngineError;
use super::onnx_structure::check_structure;
use super::onnx_wire::{Source, Value, Wire};

/// Most elements of a tensor of the file or of an input. The largest table of words in use has 0.3 thousand million.
const TENSOR_MAX: u64 = 1 << 33;
/// Most elements that an operator makes from constants: 1 GB of 32-bit numbers.
const MADE_MAX: u64 = 1 << 28;
/// Most numbers of a constant that are looked at; a shape has a few.
const NUMBERS_MAX: usize = 64;
/// How deep graphs may lie in each other.
const DEPTH_MAX: usize = 16;

/// ONNX's numbers of types.
const FLOAT: u64 = 1;
const INT32: u64 = 6;
const INT64: u64 = 7;

/// Checks an ONNX file of so many bytes before an engine loads it. Reads the file from its
/// beginning, twice.
///
/// # Errors
/// [`EngineError::Broken`] when the file is no ONNX model or breaks off.
/// [`EngineError::TooLarge`] when a tensor states a shape of too many elements, or a constant
/// makes an operator's output too large.
pub fn check_onnx(mut source: impl Read + Seek, bytes: u64) -> Result<(), EngineError> {
    check_structure(&mut source, bytes).map_err(|found| EngineError::Broken { found })?;
    source.rewind().map_err(|error| EngineError::Broken { found: error.to_string() })?;
    check(source, bytes).map_err(|found| EngineError::TooLarge { found })
}

fn check(source: impl Source, bytes: u64) -> Result<(), String> {
    let mut scan = Scan { wire: Wire::new(source), too_large: None };
    // The structure has been checked, so reading only ends early when the disk fails.
    let _ = scan.model(bytes);
    scan.too_large.map_or(Ok(()), Err)
}

/// A constant, as far as it matters: its shape, and its numbers when it may be a shape itself.
#[derive(Debug, Clone, Default)]
struct Constant {
    name: String,
    dims: Vec<i64>,
    kind: u64,
    ints: Vec<i64>,
    floats: Vec<f32>,
    raw: Vec<u8>,
}

impl Constant {
    /// Its numbers, when they are few.
    fn numbers(&self) -> Vec<f64> {
        let of = |bytes: &[u8]| -> Vec<f64> {
            match self.kind {
                INT64 => {
                    bytes.as_chunks().0.iter().map(|b| i64::from_le_bytes(*b) as f64).collect()
                }
                INT32 => {
                    bytes.as_chunks().0.iter().map(|b| i32::from_le_bytes(*b).into()).collect()
                }
                FLOAT => {
                    bytes.as_chunks().0.iter().map(|b| f32::from_le_bytes(*b).into()).collect()
                }
                _ => Vec::new(),
            }
        };
        let ints = self.ints.iter().map(|value| *value as f64);
        let floats = self.floats.iter().map(|value| f64::from(*value));
        of(&self.raw).into_iter().chain(ints).chain(floats).collect()
    }
}

#[derive(Debug, Default)]
struct Node {
    operator: String,
    inputs: Vec<String>,
    outputs: Vec<String>,
    constant: Option<Constant>,
    shape: Vec<i64>,
}

struct Scan<S> {
    wire: Wire<S>,
    too_large: Option<String>,
}

impl<S: Source> Scan<S> {
    fn refuse(&mut self, what: String) {
        self.too_large.get_or_insert(what);
    }

    /// `ModelProto`: the graph is field 7.
    fn model(&mut self, end: u64) -> io::Result<()> {
        while let Some((number, value)) = self.wire.field(end)? {
            if let (7, Value::Bytes(end)) = (number, value) {
                self.graph(end, 0)?;
            }
            self.wire.finish(value)?;
        }
        Ok(())
    }

    /// `GraphProto`: nodes are field 1, initialisers 5, inputs 11. Initialisers may come after the nodes that use them.
    fn graph(&mut self, end: u64, depth: usize) -> io::Result<()> {
        if depth > DEPTH_MAX {
            self.refuse(format!("graphs lie more than {DEPTH_MAX} deep in each other"));
            return Ok(());
        }
        let (mut nodes, mut constants) = (Vec::new(), BTreeMap::new());
        while let Some((number, value)) = self.wire.field(end)? {
            match (number, value) {
                (1, Value::Bytes(end)) => nodes.push(self.node(end, depth)?),
                (5, Value::Bytes(end)) => {
                    let tensor = self.tensor(end)?;
                    constants.insert(tensor.name.clone(), tensor.numbers());
                }
                (11, Value::Bytes(end)) => self.input(end)?,
                _ => {}
            }
            self.wire.finish(value)?;
        }
        for node in &mut nodes {
            if let (Some(constant), Some(name)) = (node.constant.take(), node.outputs.first()) {
                constants.insert(name.clone(), constant.numbers());
            }
        }
        nodes.iter().for_each(|node| self.judge(node, &constants));
        Ok(())
    }

    /// `NodeProto`: inputs are field 1, outputs 2, the operator 4, attributes 5.
    fn node(&mut self, end: u64, depth: usize) -> io::Result<Node> {
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
        Ok(node)
    }

    /// `AttributeProto`: the name is field 1, an integer 3, a tensor 5, a graph 6, integers 8, graphs 11.
    fn attribute(&mut self, end: u64, depth: usize, node: &mut Node) -> io::Result<()> {
        let (mut name, mut ints) = (String::new(), Vec::new());
        while let Some((number, value)) = self.wire.field(end)? {
            match (number, value) {
                (1, Value::Bytes(end)) => name = self.wire.text(end)?,
                (3, Value::Number(int)) => ints.push(int as i64),
                (5, Value::Bytes(end)) => node.constant = Some(self.tensor(end)?),
                (6 | 11, Value::Bytes(end)) => self.graph(end, depth + 1)?,
                (8, value) => self.wire.numbers(value, &mut ints, NUMBERS_MAX)?,
                _ => {}
            }
            self.wire.finish(value)?;
        }
        match name.as_str() {
            "shape" => node.shape = ints,
            "value_int" | "value_ints" => {
                node.constant = Some(Constant { ints, ..Constant::default() });
            }
            _ => {}
        }
        // A filling value is no constant of its own.
        if node.operator == "ConstantOfShape" {
            node.constant = None;
        }
        Ok(())
    }

    /// `TensorProto`: the shape is field 1, the type 2, numbers 4, 5 and 7, the name 8, raw bytes 9.
    fn tensor(&mut self, end: u64) -> io::Result<Constant> {
        let mut found = Constant::default();
        while let Some((number, value)) = self.wire.field(end)? {
            match (number, value) {
                (1, value) => self.wire.numbers(value, &mut found.dims, NUMBERS_MAX)?,
                (2, Value::Number(kind)) => found.kind = kind,
                (4, value) => self.wire.floats(value, &mut found.floats, NUMBERS_MAX)?,
                (5 | 7, value) => self.wire.numbers(value, &mut found.ints, NUMBERS_MAX)?,
                (8, Value::Bytes(end)) => found.name = self.wire.text(end)?,
                (9, Value::Bytes(end)) => found.raw = self.wire.bytes(end, 8 * NUMBERS_MAX)?,
                _ => {}
            }
            self.wire.finish(value)?;
        }
        self.check_dims("the tensor", &found.name, &found.dims);
        Ok(found)
    }

    /// `ValueInfoProto`: the name is field 1, the type 2, its tensor 1, the shape 2, its axes 1, their length 1.
    fn input(&mut self, end: u64) -> io::Result<()> {
        let (mut name, mut dims) = (String::new(), Vec::new());
        while let Some((number, value)) = self.wire.field(end)? {
            match (number, value) {
                (1, Value::Bytes(end)) => name = self.wire.text(end)?,
                (2, Value::Bytes(end)) => self.lengths(end, &[1, 2, 1], &mut dims)?,
                _ => {}
            }
            self.wire.finish(value)?;
        }
        self.check_dims("the input", &name, &dims);
        Ok(())
    }

    /// The numbers of field 1 below a path of fields.
    fn lengths(&mut self, end: u64, path: &[u64], dims: &mut Vec<i64>) -> io::Result<()> {
        while let Some((number, value)) = self.wire.field(end)? {
            match (path, value) {
                ([], Value::Number(length)) if number == 1 => dims.push(length as i64),
                ([first, rest @ ..], Value::Bytes(end)) if number == *first => {
                    self.lengths(end, rest, dims)?;
                }
                _ => {}
            }
            self.wire.finish(value)?;
        }
        Ok(())
    }

    fn check_dims(&mut self, what: &str, name: &str, dims: &[i64]) {
        let mut lengths = dims.iter().map(|length| u64::try_from(*length).unwrap_or(0));
        let elements = lengths.try_fold(1_u64, u64::checked_mul);
        if elements.is_none_or(|elements| elements > TENSOR_MAX) {
            self.refuse(format!(
                "expected at most {TENSOR_MAX} elements in {what} {name:?}, found the shape {dims:?}"
            ));
        }
    }

    /// Whether an operator makes something huge from constants.
    fn judge(&mut self, node: &Node, constants: &BTreeMap<String, Vec<f64>>) {
        let given = |at: usize| node.inputs.get(at).and_then(|name| constants.get(name));
        let product = |numbers: &Vec<f64>| numbers.iter().map(|n| n.abs().max(1.0)).product();
        let made: Option<f64> = match node.operator.as_str() {
            "ConstantOfShape" => given(0).map(product),
            "Expand" | "Tile" | "Reshape" => given(1).map(product),
            "OneHot" => given(1).map(product),
            "Pad" => given(1).map(|pads| pads.iter().copied().fold(0.0, f64::max)),
            "Upsample" => given(1).map(product),
            "Resize" => given(3).or_else(|| given(2)).map(product),
            "Range" => match [given(0), given(1), given(2)].map(|one| one?.first().copied()) {
                [Some(start), Some(end), Some(step)] => Some(((end - start) / step).abs()),
                _ => None,
            },
            _ if node.shape.is_empty() => None,
            _ => Some(node.shape.iter().map(|length| (*length as f64).abs().max(1.0)).product()),
        };
        if let Some(made) = made.filter(|made| !made.is_finite() || *made > MADE_MAX as f64) {
            let operator = &node.operator;
            self.refuse(format!(
                "expected operators that make at most {MADE_MAX} elements from constants, found \
                 {operator} that makes {made:.0}"
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::onnx_wire::written::{bytes, number};
    use super::*;
    use std::io::Cursor;

    fn tensor(name: &str, dims: &[u64], raw: &[i64]) -> Vec<u8> {
        let dims: Vec<u8> = dims.iter().flat_map(|length| number(1, *length)).collect();
        let raw: Vec<u8> = raw.iter().flat_map(|value| value.to_le_bytes()).collect();
        [dims, number(2, INT64), bytes(8, name.as_bytes()), bytes(9, &raw)].concat()
    }

    fn node(operator: &str, inputs: &[&str]) -> Vec<u8> {
        let inputs: Vec<u8> = inputs.iter().flat_map(|name| bytes(1, name.as_bytes())).collect();
        [inputs, bytes(2, b"out"), bytes(4, operator.as_bytes())].concat()
    }

    fn found(graph: &[Vec<u8>]) -> Result<(), String> {
        let model = bytes(7, &graph.concat());
        check(Cursor::new(&model), model.len() as u64)
    }

    #[test]
    fn operators_that_make_terabytes_are_refused_by_name() {
        let huge = 1_000_000_000_000;
        for (operator, inputs) in
            [("ConstantOfShape", &["s"][..]), ("Expand", &["x", "s"]), ("Tile", &["x", "s"])]
        {
            let graph = |shape: &[i64]| {
                [bytes(1, &node(operator, inputs)), bytes(5, &tensor("s", &[1], shape))]
            };
            let error = found(&graph(&[huge])).unwrap_err();
            assert!(error.contains(operator) && error.contains("1000000000000"), "{error}");
            assert!(found(&graph(&[1 << 20, 1 << 20])).is_err());
            assert_eq!(found(&graph(&[1, 1917, 4])), Ok(()));
        }
    }

    #[test]
    fn shapes_that_overflow_are_refused_by_name() {
        let error = found(&[bytes(5, &tensor("w", &[1 << 40, 1 << 40], &[]))]).unwrap_err();
        assert!(error.contains("the tensor \"w\""), "{error}");
        let axis = bytes(1, &number(1, 1 << 40));
        let kind = bytes(1, &bytes(2, &axis));
        let error = found(&[bytes(11, &[bytes(1, b"x"), bytes(2, &kind)].concat())]).unwrap_err();
        assert!(error.contains("the input \"x\""), "{error}");
    }

    #[test]
    fn constants_of_nodes_and_of_inner_graphs_count() {
        let attribute = [bytes(1, b"value"), bytes(5, &tensor("", &[1], &[1 << 50]))].concat();
        let constant = [bytes(2, b"s"), bytes(4, b"Constant"), bytes(5, &attribute)].concat();
        let graph = [bytes(1, &constant), bytes(1, &node("ConstantOfShape", &["s"]))];
        assert!(found(&graph).is_err());
        let branch = [bytes(1, b"then_branch"), bytes(6, &graph.concat())].concat();
        assert!(found(&[bytes(1, &[bytes(4, b"If"), bytes(5, &branch)].concat())]).is_err());
    }

    #[test]
    fn what_is_no_model_is_refused_where_it_breaks() {
        for (junk, at) in [
            (&b""[..], "byte 0"),
            (b"\xff\xff\xff\xff", "byte 4"),
            (b"hello, world", "byte 3"),
            (&[0x3a, 0xff, 0x01], "byte 3"),
        ] {
            let error = check_onnx(Cursor::new(junk), junk.len() as u64).unwrap_err();
            assert!(error.to_string().ends_with(&format!("{at} on")), "{error}");
        }
    }

    #[test]
    fn integers_that_never_end_are_refused_wherever_an_engine_reads_them() {
        let endless = [0xff; 12];
        let graphs = [
            bytes(5, &bytes(7, &endless)),
            bytes(5, &bytes(13, &endless)),
            bytes(1, &bytes(5, &bytes(5, &bytes(5, &endless)))),
            bytes(12, &bytes(2, &bytes(4, &bytes(1, &bytes(1, &bytes(2, &endless)))))),
        ];
        for graph in graphs {
            let model = bytes(7, &graph);
            let checked = check_onnx(Cursor::new(&model), model.len() as u64);
            assert!(matches!(checked, Err(EngineError::Broken { .. })), "{graph:?}");
        }
    }
}
