//! A weight, and when two are the same.

use std::io::{self, Read, Seek, SeekFrom};

use super::element::Element;
use super::samples::Samples;

/// A tensor of parameters.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Weight {
    /// Name of the tensor.
    pub name: String,
    /// Type of its numbers, as `float32`; `4-bit` and the like for packed ones.
    pub element: String,
    /// Length of each axis, as the file states it.
    pub shape: Vec<u64>,
    /// How many parameters it has.
    pub parameters: u64,
    /// How many bytes it takes in the file.
    pub bytes: u64,
    pub(super) stored: Element,
    /// Some of its numbers, where they could be looked at.
    pub(super) samples: Option<Samples>,
    /// Where it is, when it is in a file of its own.
    pub(super) external: Option<External>,
}

/// A place in a file beside the graph.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Default)]
pub(super) struct External {
    pub(super) location: String,
    pub(super) offset: u64,
}

/// What two weights have in common when they are the same.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Identity {
    name: Option<String>,
    element: &'static str,
    shape: Vec<u64>,
    samples: Option<Samples>,
    external: Option<External>,
}

impl Weight {
    /// What makes it the weight that it is.
    pub(super) fn identity(&self) -> Identity {
        let (samples, mut shape) = (self.samples.clone(), self.shape.clone());
        // Without numbers to compare, a place or a name is all there is.
        let external = self.external.clone().filter(|_| samples.is_none());
        let is_known = match &samples {
            Some(samples) => self.is_matrix() && !samples.is_uniform(),
            None => external.is_some(),
        };
        // A matrix is the same as its transpose.
        if is_known && shape.len() == 2 {
            shape.sort_unstable();
        }
        let name = (!is_known).then(|| self.name.clone());
        Identity { name, element: self.stored.name, shape, samples, external }
    }

    fn is_matrix(&self) -> bool {
        self.shape.iter().filter(|&&length| length > 1).count() > 1
    }

    /// Looks at some of its numbers in a file of its own, if that can be opened and read.
    pub(super) fn sample_external<R: Read + Seek>(
        &mut self,
        open: &mut impl FnMut(&str) -> io::Result<R>,
    ) {
        if let Some(external) = &self.external {
            let file = open(&external.location);
            let samples = file.and_then(|file| external.samples(file, self.stored, &self.shape));
            self.samples = samples.ok();
        }
    }
}

impl External {
    fn samples(
        &self,
        mut file: impl Read + Seek,
        element: Element,
        shape: &[u64],
    ) -> io::Result<Samples> {
        Samples::take(element, shape, |place, length| {
            let mut bytes = vec![0; length];
            file.seek(SeekFrom::Start(self.offset.saturating_add(place)))?;
            file.read_exact(&mut bytes)?;
            Ok(bytes)
        })
    }
}
