//! Ctrl-C and SIGTERM: no further frame is begun, and what was answered is kept.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

/// Signals that end a run, and their names.
const SIGNALS: [(i32, &str); 2] = [(SIGINT, "Ctrl-C"), (SIGTERM, "SIGTERM")];
/// A program that a signal ends exits with this number and the signal's.
const EXIT_BASE: i32 = 128;

/// Notes the first signal once it listens; the second ends the process at once. Copies share what they note.
#[derive(Debug, Clone, Default)]
pub struct Interrupt {
    signal: Arc<AtomicUsize>,
}

impl Interrupt {
    /// Starts to listen.
    ///
    /// # Errors
    /// When the system does not let the process listen.
    pub fn listen(&self) -> std::io::Result<()> {
        let again = Arc::new(AtomicBool::new(false));
        for (number, _) in SIGNALS {
            // In this order: the first signal finds `again` false and sets it.
            flag::register_conditional_shutdown(number, EXIT_BASE + number, again.clone())?;
            flag::register(number, again.clone())?;
            let value = usize::try_from(number).unwrap_or_default();
            flag::register_usize(number, self.signal.clone(), value)?;
        }
        Ok(())
    }

    /// The name of the signal that came, if one did, and the exit code that it asks for.
    #[must_use]
    pub fn came(&self) -> Option<(&'static str, u8)> {
        let came = i32::try_from(self.signal.load(Ordering::Relaxed)).unwrap_or_default();
        let (number, name) = SIGNALS.into_iter().find(|(number, _)| *number == came)?;
        Some((name, u8::try_from(EXIT_BASE + number).unwrap_or(1)))
    }
}
