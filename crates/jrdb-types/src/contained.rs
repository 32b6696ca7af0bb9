//! A panic in the code of others, contained where it happens.

use std::any::Any;
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Code that panicked.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{what} panicked: {message}")]
pub struct Panicked {
    /// What was running, for example `the png decoder`.
    pub what: String,
    /// What the panic says.
    pub message: String,
}

/// The name that Rust gives to the thread that a program starts with.
const MAIN_THREAD: &str = "main";

/// How many calls of [`contained`] are running in this process.
static RUNNING: AtomicUsize = AtomicUsize::new(0);

thread_local! {
    /// How many of them are running on this thread.
    static DEPTH: Cell<usize> = const { Cell::new(0) };
}

/// Runs `work`; a panic inside it becomes an error.
///
/// For decoders and models of others, whose panics a hostile file can cause. What `work` borrows must not be used
/// any more after an error, unless it is known to be whole.
///
/// # Errors
/// [`Panicked`], with `what` and the panic's own message.
///
/// ```
/// use jrdb_types::contained;
/// let bytes: &[u8] = &[];
/// let error = contained("the decoder", || bytes[0]).unwrap_err();
/// assert!(error.to_string().starts_with("the decoder panicked: index out of bounds"));
/// ```
pub fn contained<T>(what: &str, work: impl FnOnce() -> T) -> Result<T, Panicked> {
    let _running = Running::start();
    let result = catch_unwind(AssertUnwindSafe(work));
    result.map_err(|payload| Panicked { what: what.into(), message: message(&*payload) })
}

/// Whether a panic of this thread would be contained: a panic hook need not report it.
///
/// A worker thread of [`contained`] work counts, too: its panic is passed on to the thread that waits for it.
#[must_use]
pub fn is_contained() -> bool {
    let is_main = std::thread::current().name() == Some(MAIN_THREAD);
    DEPTH.get() > 0 || (!is_main && RUNNING.load(Ordering::Relaxed) > 0)
}

struct Running;

impl Running {
    fn start() -> Self {
        RUNNING.fetch_add(1, Ordering::Relaxed);
        DEPTH.set(DEPTH.get() + 1);
        Self
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        RUNNING.fetch_sub(1, Ordering::Relaxed);
        DEPTH.set(DEPTH.get() - 1);
    }
}

fn message(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().copied();
    let text = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("no message").into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_an_error_and_a_result_stays_one() {
        assert_eq!(contained("adding", || 1 + 1), Ok(2));
        let number: Result<u8, _> = "x".parse::<u8>();
        let error = contained("reading", || number.clone().expect("a number")).unwrap_err();
        assert!(error.to_string().starts_with("reading panicked: a number"), "{error}");
    }

    #[test]
    fn work_knows_that_it_is_contained_on_its_own_thread() {
        assert_eq!(contained("asking", is_contained), Ok(true));
        assert_eq!(DEPTH.get(), 0);
    }
}
