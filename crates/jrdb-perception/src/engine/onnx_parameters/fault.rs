//! Why a file cannot be counted.

use std::io;

/// Why a file cannot be counted.
#[derive(Debug)]
pub(super) enum Fault {
    /// It breaks off, or is no protocol buffer.
    Wire,
    /// What is wrong with it.
    Found(String),
}

impl From<io::Error> for Fault {
    fn from(_: io::Error) -> Self {
        Self::Wire
    }
}

impl Fault {
    /// What was expected and what was found, in a file of so many bytes, read up to a byte.
    pub(super) fn describe(self, bytes: u64, position: u64) -> String {
        match self {
            Self::Found(found) => found,
            Self::Wire => format!(
                "expected an ONNX model, found a file of {bytes} bytes that is none from byte \
                 {position} on"
            ),
        }
    }
}
