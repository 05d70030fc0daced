//! Work on all threads of the process, or on the calling thread alone.
//!
//! Many logs at once are analysed one a thread. Inside [`alone`] nothing touches the pool of threads that the process
//! shares: a pool that a parent process has used hangs in its forked child.

use std::cell::Cell;

use rayon::prelude::*;

thread_local! {
    static ALONE: Cell<bool> = const { Cell::new(false) };
}

/// Puts back what held before, also after a panic.
struct Restore(bool);

impl Drop for Restore {
    fn drop(&mut self) {
        ALONE.set(self.0);
    }
}

/// Does some work on the calling thread alone. Its result is the same as on all threads.
pub fn alone<T>(work: impl FnOnce() -> T) -> T {
    let _restore = Restore(ALONE.replace(true));
    work()
}

/// How many threads work at once.
pub(crate) fn count() -> usize {
    if ALONE.get() { 1 } else { rayon::current_num_threads() }
}

/// Runs the same work on every thread.
pub(crate) fn everywhere(work: impl Fn() + Sync) {
    if ALONE.get() {
        work();
    } else {
        rayon::broadcast(|_| work());
    }
}

/// Two pieces of work at once.
pub(crate) fn both<A: Send, B: Send>(
    one: impl FnOnce() -> A + Send,
    other: impl FnOnce() -> B + Send,
) -> (A, B) {
    if ALONE.get() { (one(), other()) } else { rayon::join(one, other) }
}

/// What `of` makes of every item, in the order of the items; each thread begins with a value of its own.
pub(crate) fn mapped<'a, T: Sync, S, R: Send>(
    items: &'a [T],
    begin: impl Fn() -> S + Sync + Send,
    of: impl Fn(&mut S, &'a T) -> R + Sync + Send,
) -> Vec<R> {
    if ALONE.get() {
        let mut own = begin();
        items.iter().map(|item| of(&mut own, item)).collect()
    } else {
        items.par_iter().map_init(begin, of).collect()
    }
}

/// What `of` makes of every number below `count`, in order.
pub(crate) fn numbered<R: Send>(count: usize, of: impl Fn(usize) -> R + Sync + Send) -> Vec<R> {
    if ALONE.get() { (0..count).map(of).collect() } else { (0..count).into_par_iter().map(of).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alone_everything_runs_on_the_calling_thread_and_gives_the_same() {
        let here = || std::thread::current().id();
        let own = here();
        let square = |k: usize| k * k;
        let apart = alone(|| {
            assert!(numbered(100, |_| here()).iter().all(|id| *id == own));
            assert!(mapped(&[1; 100], || (), |(), _| here()).iter().all(|id| *id == own));
            assert_eq!((both(here, here), count()), ((own, own), 1));
            everywhere(|| assert_eq!(here(), own));
            numbered(100, square)
        });
        assert_eq!(apart, numbered(100, square));
    }

    #[test]
    fn a_panic_leaves_the_thread_as_it_was() {
        let _ = std::panic::catch_unwind(|| alone(|| std::panic::resume_unwind(Box::new(()))));
        assert!(!ALONE.get());
    }
}
