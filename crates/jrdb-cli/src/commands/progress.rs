//! How far long work is: a bar on a terminal, a line now and then elsewhere.

use std::cell::Cell;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// Time between two lines where standard error is not a terminal.
const LINE_EVERY: Duration = Duration::from_secs(10);

/// Progress of work whose amount is known, on standard error.
pub(crate) struct Progress {
    bar: ProgressBar,
    what: &'static str,
    started: Instant,
    last_line: Cell<Instant>,
}

impl Progress {
    /// Work on so many things.
    pub(crate) fn new(what: &'static str, total: usize) -> Self {
        let style = ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}, {eta} left")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        let bar = ProgressBar::new(total as u64).with_style(style).with_message(what);
        let now = Instant::now();
        Self { bar, what, started: now, last_line: Cell::new(now) }
    }

    /// What is being done now.
    pub(crate) fn now_at(&self, what: String) {
        self.bar.set_message(what);
    }

    /// One more thing is done.
    pub(crate) fn advance(&self) {
        self.bar.inc(1);
        let is_over = self.bar.length() == Some(self.bar.position());
        if self.bar.is_hidden() && !is_over && self.last_line.get().elapsed() >= LINE_EVERY {
            self.last_line.set(Instant::now());
            eprintln!("{}", self.line());
        }
    }

    /// `120 of 1000 frames, 45 s left`.
    fn line(&self) -> String {
        let (done, total) = (self.bar.position(), self.bar.length().unwrap_or_default());
        let left = total.saturating_sub(done) as f64 / done.max(1) as f64;
        let left_s = self.started.elapsed().as_secs_f64() * left;
        format!("{done} of {total} {}, {left_s:.0} s left", self.what)
    }

    /// Prints something without the bar in between.
    pub(crate) fn suspend<T>(&self, print: impl FnOnce() -> T) -> T {
        self.bar.suspend(print)
    }

    /// Takes the bar away.
    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_tells_what_is_done_and_how_much_there_is() {
        let progress = Progress::new("frames", 4);
        progress.advance();
        assert!(progress.line().starts_with("1 of 4 frames, "), "{}", progress.line());
    }
}
