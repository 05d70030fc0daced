//! Lines that come on standard input or by UDP.

use std::{
    io::{BufRead, Read as _},
    net::UdpSocket,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel},
    },
    thread,
    time::{Duration, Instant},
};

use super::{CliError, udp};
use crate::{
    log::CsvOptions,
    remark::Remarks,
    workflow::record::{Came, Senders},
};

/// Lines wait for the disk up to this many.
const WAITING: usize = 1 << 16;
const PACKET: usize = 1 << 16;
/// The longest line, bytes.
const LONGEST: u64 = 1 << 20;

/// Lines from a thread that waits for them, a moment without one each tenth of a second, until they end.
pub(super) struct Lines {
    from: Receiver<Came>,
    until: Option<Instant>,
    /// Lines that are still taken after the end: those that wait.
    left: usize,
    /// What was kept back until the end.
    rest: Option<std::vec::IntoIter<Came>>,
    senders: Arc<Mutex<Senders>>,
    /// Where packets come, and how many of any sender had been lost there before.
    port: Option<(u16, u64)>,
}

impl Iterator for Lines {
    type Item = Came;

    fn next(&mut self) -> Option<Self::Item> {
        if super::interrupt::is_asked() || self.until.is_some_and(|until| Instant::now() >= until) {
            let waits = self.left > 0 && self.rest.is_none();
            if let Some(came) = self.from.try_recv().ok().filter(|_| waits) {
                self.left -= 1;
                return Some(came);
            }
            return self.rest.get_or_insert_with(|| held(&self.senders).rest().into_iter()).next();
        }
        match self.from.recv_timeout(Duration::from_millis(100)) {
            Ok(came) => Some(came),
            Err(RecvTimeoutError::Timeout) => Some(Came::Pause),
            Err(RecvTimeoutError::Disconnected) => None,
        }
    }
}

impl Lines {
    /// Those of packets at an address, understood by the options, or of standard input, until an instant.
    pub(super) fn of(
        address: Option<&str>,
        options: &CsvOptions,
        until: Option<Instant>,
    ) -> Result<Self, CliError> {
        let (send, from) = sync_channel(WAITING);
        let senders = Arc::new(Mutex::new(Senders::new(options.clone())));
        let mut lines = Self { from, until, left: WAITING, rest: None, senders, port: None };
        match address {
            Some(address) => {
                let failed = CliError::step(format!("cannot listen at {address}"));
                let socket = udp::bound(address).map_err(|error| failed(error.into()))?;
                let port = socket.local_addr().map(|at| at.port()).unwrap_or_default();
                lines.port = Some((port, udp::lost(port)));
                let senders = lines.senders.clone();
                thread::spawn(move || packets(&socket, &senders, &send));
            }
            None => {
                thread::spawn(move || of_input(&send));
            }
        }
        Ok(lines)
    }

    /// What was refused, and lost.
    pub(super) fn remarks(&self) -> Remarks {
        let mut remarks = held(&self.senders).remarks();
        if let Some((port, before)) = self.port {
            udp::remark_lost(&mut remarks, udp::lost(port).saturating_sub(before));
        }
        remarks
    }
}

fn held(senders: &Mutex<Senders>) -> MutexGuard<'_, Senders> {
    senders.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Sends the lines of packets on, until nobody takes them.
fn packets(socket: &UdpSocket, senders: &Mutex<Senders>, send: &SyncSender<Came>) {
    let begun = Instant::now();
    let mut packet = vec![0; PACKET];
    while let Ok((length, sender)) = socket.recv_from(&mut packet) {
        let lines = held(senders).take(sender, begun.elapsed().as_secs_f64(), &packet[..length]);
        for line in lines {
            if send.send(line).is_err() {
                return;
            }
        }
    }
}

/// Sends the lines of standard input on, until it ends or nobody takes them.
fn of_input(send: &SyncSender<Came>) {
    let empty = |came: &Came| match came {
        Came::Line(line) | Came::Rest(line) => line.trim_ascii().is_empty(),
        Came::Pause | Came::TooLong => false,
    };
    for came in lines_of(std::io::stdin().lock()).filter(|came| !empty(came)) {
        if send.send(came).is_err() {
            return;
        }
    }
}

/// Lines, those in UTF-16 behind its byte order mark as UTF-8.
fn lines_of(mut input: impl BufRead + 'static) -> Box<dyn Iterator<Item = Came>> {
    let unit: fn([u8; 2]) -> u16 = match input.fill_buf() {
        Ok([0xff, 0xfe, ..]) => u16::from_le_bytes,
        Ok([0xfe, 0xff, ..]) => u16::from_be_bytes,
        _ => return Box::new(std::iter::from_fn(move || line_of(&mut input))),
    };
    let mut next = move || {
        let mut pair = [0; 2];
        input.read_exact(&mut pair).ok().map(|()| unit(pair))
    };
    next();
    Box::new(std::iter::from_fn(move || {
        let first = next()?;
        let end = u16::from(b'\n');
        let rest = std::iter::from_fn(&mut next).take_while(|unit| *unit != end);
        let line: Vec<u16> =
            if first == end { Vec::new() } else { std::iter::once(first).chain(rest).collect() };
        Some(Came::Line(String::from_utf16_lossy(&line).into_bytes()))
    }))
}

/// The next line, which holds no more than any row does; `None` at the end.
fn line_of(input: &mut impl BufRead) -> Option<Came> {
    let mut line = Vec::new();
    let count = input.by_ref().take(LONGEST).read_until(b'\n', &mut line).ok()?;
    if line.pop_if(|last| *last == b'\n').is_some() {
        return Some(Came::Line(line));
    }
    if (count as u64) < LONGEST {
        return (count > 0).then_some(Came::Rest(line));
    }
    // The rest of it is of no use, and is not kept.
    loop {
        line.clear();
        let count = input.by_ref().take(LONGEST).read_until(b'\n', &mut line).ok()?;
        if count == 0 || line.last() == Some(&b'\n') {
            return Some(Came::TooLong);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_without_an_end_is_told_and_one_without_bounds_is_not_kept() {
        let long = [vec![b'1'; 3 << 20], b"\n4,5".to_vec()].concat();
        let text: &'static [u8] = Box::leak([b"1,2\n".to_vec(), long].concat().into_boxed_slice());
        let came: Vec<Came> = lines_of(text).collect();
        assert_eq!(came, [Came::Line(b"1,2".to_vec()), Came::TooLong, Came::Rest(b"4,5".to_vec())]);
    }
}
