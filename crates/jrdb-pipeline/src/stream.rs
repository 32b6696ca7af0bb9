//! Work on many items at once, with the results in order and bounded memory.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError, mpsc};

/// Items that may be in work, or wait for an earlier one, per thread.
const AHEAD_PER_THREAD: usize = 2;

/// Runs `work` on every item, on so many threads, and gives the results to `each` in the order of the items, as soon as
/// they are ready.
///
/// Items are taken from the iterator only a few ahead of the result that is due, so memory does not grow with
/// their number. `each` runs on the caller's thread; when it breaks, no further item is taken.
pub fn in_order<T: Send, R: Send>(
    items: impl Iterator<Item = T> + Send,
    threads: NonZeroUsize,
    work: impl Fn(T) -> R + Sync,
    mut each: impl FnMut(R) -> ControlFlow<()>,
) {
    let intake = Intake::new(items, AHEAD_PER_THREAD * threads.get());
    let (send, results) = mpsc::channel();
    std::thread::scope(|scope| {
        for _ in 0..threads.get() {
            let (send, intake, work) = (send.clone(), &intake, &work);
            scope.spawn(move || {
                // Should `work` panic, the others must not wait for its result.
                let _close = CloseOnDrop(intake);
                while let Some((place, item)) = intake.take() {
                    if send.send((place, work(item))).is_err() {
                        break;
                    }
                }
            });
        }
        drop(send);
        let mut waiting = BTreeMap::new();
        let mut due = 0;
        for (place, result) in results {
            waiting.insert(place, result);
            while let Some(result) = waiting.remove(&due) {
                if each(result).is_break() {
                    intake.close();
                    return;
                }
                due += 1;
                intake.is_due(due);
            }
        }
    });
}

/// The items that have not been taken, and how far they may be.
struct Intake<I> {
    state: Mutex<State<I>>,
    changed: Condvar,
    ahead: usize,
}

struct State<I> {
    items: I,
    /// Place of the next item.
    next: usize,
    /// Place of the result that is due.
    due: usize,
    closed: bool,
}

impl<I: Iterator> Intake<I> {
    fn new(items: I, ahead: usize) -> Self {
        let state = Mutex::new(State { items, next: 0, due: 0, closed: false });
        Self { state, changed: Condvar::new(), ahead }
    }

    /// The next item with its place, once it is near enough to the result that is due.
    fn take(&self) -> Option<(usize, I::Item)> {
        let wait = |state: &mut State<I>| !state.closed && state.next >= state.due + self.ahead;
        let state = self.changed.wait_while(self.state(), wait);
        let mut state = state.unwrap_or_else(PoisonError::into_inner);
        if state.closed {
            return None;
        }
        match state.items.next() {
            Some(item) => {
                state.next += 1;
                Some((state.next - 1, item))
            }
            None => {
                state.closed = true;
                self.changed.notify_all();
                None
            }
        }
    }
}

impl<I> Intake<I> {
    fn state(&self) -> MutexGuard<'_, State<I>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn is_due(&self, place: usize) {
        self.state().due = place;
        self.changed.notify_all();
    }

    fn close(&self) {
        self.state().closed = true;
        self.changed.notify_all();
    }
}

struct CloseOnDrop<'a, I>(&'a Intake<I>);

impl<I> Drop for CloseOnDrop<'_, I> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.close();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    const THREADS: NonZeroUsize = NonZeroUsize::new(3).unwrap();

    #[test]
    fn results_come_in_order_whatever_takes_longest() {
        let mut found = Vec::new();
        let slow = |n: u64| {
            std::thread::sleep(std::time::Duration::from_millis(7 * (n % 3)));
            n * n
        };
        in_order(0..40, THREADS, slow, |square| {
            found.push(square);
            ControlFlow::Continue(())
        });
        assert_eq!(found, (0..40).map(|n| n * n).collect::<Vec<_>>());
    }

    #[test]
    fn few_items_are_taken_before_the_first_result_is_given_out() {
        let taken = AtomicUsize::new(0);
        let items = (0..1000).inspect(|_| {
            taken.fetch_add(1, Ordering::SeqCst);
        });
        in_order(items, THREADS, |n| n, |_| ControlFlow::Break(()));
        assert!(taken.load(Ordering::SeqCst) <= AHEAD_PER_THREAD * THREADS.get());
    }

    #[test]
    fn a_panic_of_the_work_reaches_the_caller_instead_of_a_deadlock() {
        let run = || in_order(0..50, THREADS, |n| assert!(n != 20), |()| ControlFlow::Continue(()));
        assert!(std::panic::catch_unwind(run).is_err());
    }
}
