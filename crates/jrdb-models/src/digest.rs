//! Whether bytes are those that a list says.

use sha2::{Digest, Sha256};

/// The SHA-256 of some bytes, in hexadecimal.
///
/// ```
/// let digest = jrdb_models::sha256_hex(b"abc");
/// assert_eq!(digest, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
/// ```
#[must_use]
pub fn sha256_hex(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}
