//! Whether a file has the structure of an ONNX model, found without loading it.
//!
//! Engines trust the lengths that a file states. One of them reads a broken integer forever, so
//! every message that engines read is read here first.

use std::io;

use super::onnx_wire::{Source, Value, Wire};

/// How deep messages may lie in each other. A node in a graph in a node takes three levels.
const DEPTH_MAX: usize = 64;

/// The messages of an ONNX file that engines read.
#[derive(Debug, Clone, Copy)]
enum Message {
    Model,
    Graph,
    Node,
    Attribute,
    Tensor,
    ValueInfo,
    Type,
    TensorType,
    SequenceType,
    Shape,
    /// One that holds numbers and texts only.
    Flat,
}

/// What a field of bytes holds.
enum Content {
    Message(Message),
    Integers,
    /// Texts, raw data, and whatever engines pass over.
    Bytes,
}

/// What a field holds. Source: `onnx.proto` of ONNX 1.17.
fn content(message: Message, field: u64) -> Content {
    use Message::{
        Attribute, Flat, Graph, Model, Node, SequenceType, Shape, Tensor, TensorType, Type,
        ValueInfo,
    };
    let inner = match (message, field) {
        (Model, 7) | (Attribute, 6 | 11) => Graph,
        (Model, 8 | 14) | (Tensor, 13) | (Shape, 1) => Flat,
        (Graph, 1) => Node,
        (Graph, 5) | (Attribute, 5 | 10) => Tensor,
        (Graph, 11..=13) => ValueInfo,
        (Node, 5) => Attribute,
        (ValueInfo, 2) | (SequenceType, 1) => Type,
        (Type, 1) => TensorType,
        (Type, 4) => SequenceType,
        (TensorType, 2) => Shape,
        (Tensor, 1 | 5 | 7 | 11) | (Attribute, 8) => return Content::Integers,
        _ => return Content::Bytes,
    };
    Content::Message(inner)
}

/// Checks a file of so many bytes.
///
/// # Errors
/// Where the file breaks off or stops being a model.
pub(super) fn check_structure(source: impl Source, bytes: u64) -> Result<(), String> {
    let mut wire = Wire::new(source);
    match check_message(&mut wire, Message::Model, bytes, 0) {
        Ok(()) if bytes > 0 => Ok(()),
        _ => Err(format!(
            "expected an ONNX model, found a file of {bytes} bytes that is none from byte {} on",
            wire.position()
        )),
    }
}

fn check_message<S: Source>(
    wire: &mut Wire<S>,
    message: Message,
    end: u64,
    depth: usize,
) -> io::Result<()> {
    if depth > DEPTH_MAX {
        return Err(io::ErrorKind::InvalidData.into());
    }
    while let Some((field, value)) = wire.field(end)? {
        match (content(message, field), value) {
            (Content::Message(inner), Value::Bytes(end)) => {
                check_message(wire, inner, end, depth + 1)?;
            }
            (Content::Integers, Value::Bytes(end)) => wire.pass_integers(end)?,
            _ => {}
        }
        wire.finish(value)?;
    }
    Ok(())
}
