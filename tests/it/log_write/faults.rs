//! An output that fails at one of its writes, each in turn and in every way: what was flushed before reads back, what
//! comes after is refused, and no log is called whole that is not. `cargo test --test it faults -- --nocapture` counts.

use std::{
    cell::RefCell,
    io::{self, Seek, SeekFrom, Write},
    rc::Rc,
};

use hydrotrace::log::{LogWriter, WriteError, WriteOptions};

use super::{JOINTS, kill::readable, kill::sample, messages};

/// What happens at the write that fails.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Fault {
    /// An error once; later writes are taken.
    Once,
    /// Half is taken, then an error once.
    Torn,
    /// No room from there on: what fits is taken.
    Full,
    /// The process is gone: half is taken, and nothing ever comes again.
    Killed,
    /// Nothing is taken, without an error.
    Nothing,
    /// Interrupted once, as by a signal.
    Interrupted,
    /// From there on a byte at a time.
    Short,
}

const FAULTS: [Fault; 7] =
    [Fault::Once, Fault::Torn, Fault::Full, Fault::Killed, Fault::Nothing, Fault::Interrupted, Fault::Short];

#[derive(Default)]
struct State {
    bytes: Vec<u8>,
    writes: usize,
    flushes: usize,
}

/// An output in memory that outlives its writer.
#[derive(Clone)]
struct Faulty {
    state: Rc<RefCell<State>>,
    fault: Option<Fault>,
    at: usize,
    /// Flushes fail instead of writes.
    flush: bool,
}

impl Write for Faulty {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let state = &mut *self.state.borrow_mut();
        let number = state.writes;
        state.writes += 1;
        let take = |state: &mut State, count: usize| {
            state.bytes.extend(&bytes[..count]);
            Ok(count)
        };
        let Some(fault) = self.fault.filter(|_| !self.flush && number >= self.at) else {
            return take(state, bytes.len());
        };
        match (fault, number - self.at) {
            (Fault::Short, _) => take(state, bytes.len().min(1)),
            (Fault::Torn | Fault::Killed | Fault::Full, 0) => take(state, bytes.len() / 2),
            (Fault::Once, 0) | (Fault::Torn, 1) => Err(io::Error::other("a disk that stutters")),
            (Fault::Interrupted, 0) => Err(io::ErrorKind::Interrupted.into()),
            (Fault::Nothing, 0) => Ok(0),
            (Fault::Full, _) => Err(io::ErrorKind::StorageFull.into()),
            (Fault::Killed, _) => Err(io::ErrorKind::BrokenPipe.into()),
            _ => take(state, bytes.len()),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        let mut state = self.state.borrow_mut();
        state.flushes += 1;
        if self.flush && state.flushes == self.at + 1 { Err(io::ErrorKind::Other.into()) } else { Ok(()) }
    }
}

impl Seek for Faulty {
    fn seek(&mut self, _: SeekFrom) -> io::Result<u64> {
        Err(io::ErrorKind::Unsupported.into())
    }
}

/// Samples that were written without an error, of these flushed, and whether the log was closed.
#[derive(Debug, Clone, Copy, Default)]
struct Run {
    written: usize,
    flushed: usize,
    failed: bool,
    closed: bool,
}

fn run(output: Faulty) -> Run {
    let mut run = Run::default();
    let Ok(mut log) = LogWriter::new(output, &JOINTS, WriteOptions::default()) else {
        return Run { failed: true, ..run };
    };
    for k in 0..24 {
        let done = sample(&mut log, k);
        if k == 10 && !run.failed {
            run.failed = log.attach("task.json", "application/json", b"{}", super::START_NS).is_err();
        }
        run.written += usize::from(done.is_ok());
        run.failed |= done.is_err();
        if k % 6 == 5 {
            match log.flush() {
                Ok(()) => run.flushed = run.written,
                Err(error) => {
                    assert!(matches!(error, WriteError::Output(_)));
                    run.failed = true;
                }
            }
        }
    }
    run.closed = log.finish().is_ok();
    run
}

#[test]
fn whatever_an_output_does_at_any_write_what_was_flushed_reads_back_and_no_loss_is_silent() {
    let sound = Faulty { state: Rc::default(), fault: None, at: 0, flush: false };
    let whole = run(sound.clone());
    assert!(whole.closed && whole.written == 24 && !whole.failed);
    let (writes, flushes) = (sound.state.borrow().writes, sound.state.borrow().flushes);
    let mut tried = 0;
    let at_writes = FAULTS.iter().flat_map(|fault| (0..writes).map(move |at| (*fault, at, false)));
    for (fault, at, flush) in at_writes.chain((0..flushes).map(|at| (Fault::Once, at, true))) {
        let state = Rc::default();
        let run = run(Faulty { state: Rc::clone(&state), fault: Some(fault), at, flush });
        let bytes = &state.borrow().bytes;
        let case = format!("{fault:?} at {} {at}: {run:?}", if flush { "flush" } else { "write" });
        assert!(readable(bytes) >= run.flushed, "{} messages read, {case}", readable(bytes));
        if run.closed {
            assert_eq!(messages(bytes).len(), run.written, "{case}");
        }
        let harmless = [Fault::Interrupted, Fault::Short].contains(&fault);
        assert_eq!(run.closed && !run.failed && run.written == 24, harmless, "{case}");
        tried += 1;
    }
    println!("{tried} faults at {writes} writes and {flushes} flushes");
}
