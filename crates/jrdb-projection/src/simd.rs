//! Loops compiled for the widest registers that the machine has.

/// A loop over columns of numbers that the compiler vectorises.
///
/// [`Loop::run`] and what it calls must be `#[inline(always)]`: only what is inlined is compiled anew. The result
/// does not depend on the machine: Rust neither reorders nor fuses floating-point operations.
pub(crate) trait Loop {
    /// Does the work.
    fn run(self);
}

/// Runs a loop in the version compiled for this machine's vector registers, found at run time.
#[inline(always)]
pub(crate) fn vectorised(work: impl Loop) {
    pulp::Arch::new().dispatch(Dispatched(work));
}

struct Dispatched<W>(W);

impl<W: Loop> pulp::NullaryFnOnce for Dispatched<W> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.0.run();
    }
}
