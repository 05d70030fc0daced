//! Who sends: of several hosts the one is listened to whose lines tell columns.

use std::{
    collections::{BTreeMap, BTreeSet},
    net::{IpAddr, SocketAddr},
};

use super::{Came, host::Host, told};
use crate::{
    log::CsvOptions,
    remark::{Code, Remarks},
};

/// So many packets, and bytes of them, wait until it is told who is listened to.
const MOST_WAITING: usize = 4096;
const MOST_BYTES: usize = 16 << 20;

/// The sender that is listened to, and what others sent.
#[derive(Debug, Default)]
pub struct Senders {
    options: CsvOptions,
    chosen: Option<(IpAddr, Host)>,
    /// What came before one was chosen.
    waiting: Vec<Packet>,
    bytes: usize,
    /// Where what was refused came from first, and how much of it.
    other: Option<SocketAddr>,
    refused: u64,
    ended: bool,
}

#[derive(Debug)]
struct Packet {
    from: SocketAddr,
    at_s: f64,
    bytes: Vec<u8>,
}

impl Senders {
    /// Nobody yet; the options are those that columns are understood by.
    pub fn new(options: CsvOptions) -> Self {
        Self { options, ..Self::default() }
    }

    /// The lines that a packet brings, at a time of any clock: none until it is told who is listened to, and then all since
    /// the first of that sender.
    pub fn take(&mut self, from: SocketAddr, at_s: f64, packet: &[u8]) -> Vec<Came> {
        if self.ended {
            return Vec::new();
        }
        match &mut self.chosen {
            Some((ip, host)) if *ip == from.ip() => host.take(from.port(), at_s, packet),
            Some(_) => {
                self.refuse(from);
                Vec::new()
            }
            None => {
                self.bytes += packet.len();
                self.waiting.push(Packet { from, at_s, bytes: packet.to_vec() });
                let host = self.told_by(from);
                let lines = host.map(|host| self.choose(from.ip(), host));
                while self.waiting.len() > MOST_WAITING || self.bytes > MOST_BYTES {
                    let first = self.waiting.remove(0);
                    self.bytes -= first.bytes.len();
                    self.refuse(first.from);
                }
                lines.unwrap_or_default()
            }
        }
    }

    /// At the end: what is still kept back; where nobody was told, of the host that sent most.
    pub fn rest(&mut self) -> Vec<Came> {
        self.ended = true;
        let mut counts: BTreeMap<IpAddr, usize> = BTreeMap::new();
        for packet in self.waiting.iter().filter(|packet| !packet.bytes.trim_ascii().is_empty()) {
            *counts.entry(packet.from.ip()).or_default() += 1;
        }
        let most = counts.into_iter().max_by_key(|(_, count)| *count);
        let mut lines = most.map(|(ip, _)| self.choose(ip, Host::default())).unwrap_or_default();
        if let Some((_, host)) = &mut self.chosen {
            lines.extend(host.rest());
        }
        lines
    }

    /// Listens to a host, from its first packet on.
    fn choose(&mut self, ip: IpAddr, mut host: Host) -> Vec<Came> {
        let mut lines = Vec::new();
        for Packet { from, at_s, bytes } in std::mem::take(&mut self.waiting) {
            if from.ip() == ip {
                lines.extend(host.take(from.port(), at_s, &bytes));
            } else {
                self.refuse(from);
            }
        }
        self.chosen = Some((ip, host));
        lines
    }

    fn refuse(&mut self, from: SocketAddr) {
        self.refused += 1;
        self.other.get_or_insert(from);
    }

    /// How to listen to a host, if what it sent so far tells columns: to the port alone, or to a host that opens a port for each
    /// packet.
    fn told_by(&self, from: SocketAddr) -> Option<Host> {
        let of_host = || self.waiting.iter().filter(|packet| packet.from.ip() == from.ip());
        let of_port = of_host().filter(|packet| packet.from == from).count();
        let ports = of_host().map(|packet| packet.from).collect::<BTreeSet<_>>().len();
        let of_all = of_host().count();
        let is_fleeting = 2 * ports > of_all;
        let count = if is_fleeting { of_all } else { of_port };
        if count > told::FIRST_LINES && !count.is_multiple_of(told::FIRST_LINES) {
            return None;
        }
        let own = of_host().filter(|packet| is_fleeting || packet.from == from);
        let mut heard = Host::default();
        let came: Vec<Came> =
            own.flat_map(|packet| heard.take(packet.from.port(), packet.at_s, &packet.bytes)).collect();
        let lines: Vec<&[u8]> = came
            .iter()
            .filter_map(|came| if let Came::Line(line) = came { Some(line.as_slice()) } else { None })
            .collect();
        let sole = of_all == self.waiting.len();
        let tells = told::tells(&lines, &self.options, sole);
        tells.then(|| if is_fleeting { Host::default() } else { Host::at(from.port()) })
    }

    /// What was refused.
    pub fn remarks(&self) -> Remarks {
        let mut remarks = Remarks::default();
        let Some((ip, host)) = &self.chosen else { return remarks };
        let first = SocketAddr::new(*ip, host.port());
        let beside = host.beside().map(|port| SocketAddr::new(*ip, port));
        if let Some(other) = self.other.or(beside) {
            let message = format!(
                "packets of another sender than {first}, such as {other}, left out; let each send to a recorder and a port \
                 of its own, or one send all columns"
            );
            remarks.add(Code::Ambiguous, self.refused + host.refused, message);
        }
        let message = "changes of the sender after a silence: another port of the same host goes on; one program that was begun \
                       anew, or two";
        remarks.add(Code::Ambiguous, host.followed, message);
        remarks
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(k: usize) -> String {
        if k == 0 { "t_s,boom_set_mm,boom_act_mm\n".into() } else { format!("0.{k:02},{k},{k}\n") }
    }

    #[test]
    fn a_host_whose_lines_say_nothing_keeps_out_none_that_is_understood() {
        let [stray, good]: [SocketAddr; 2] = ["10.0.0.9:7", "10.0.0.1:1"].map(|one| one.parse().unwrap());
        for noise in ["", "hello", "{\"temp\": 20.5}", "7,8,9\n"] {
            let mut senders = Senders::default();
            let mut lines = senders.take(stray, 0.0, noise.as_bytes());
            for k in 0..20 {
                lines.extend(senders.take(good, 0.1, row(k).as_bytes()));
                lines.extend(senders.take(stray, 0.1, noise.as_bytes()));
            }
            lines.extend(senders.rest());
            assert_eq!(
                lines,
                (0..20).map(|k| Came::Line(row(k).trim().into())).collect::<Vec<_>>(),
                "{noise}"
            );
            assert_eq!(senders.remarks().as_slice()[0].count, 21, "{noise}");
        }
    }

    #[test]
    fn another_program_of_the_host_that_says_nothing_keeps_out_none() {
        let [stray, good]: [SocketAddr; 2] = ["10.0.0.1:7", "10.0.0.1:1"].map(|one| one.parse().unwrap());
        let mut senders = Senders::default();
        let mut lines = Vec::new();
        for k in 0..20 {
            lines.extend(senders.take(stray, 0.0, b"ready"));
            lines.extend(senders.take(good, 0.0, row(k).as_bytes()));
        }
        lines.extend(senders.rest());
        assert_eq!(lines.len(), 20, "{lines:?}");
        assert!(!senders.remarks().is_empty());
    }

    #[test]
    fn what_is_not_understood_comes_at_the_end() {
        let from = "10.0.0.1:1".parse().unwrap();
        let mut senders = Senders::default();
        assert!(senders.take(from, 0.0, b"t_s,q").is_empty());
        assert_eq!(senders.rest(), [Came::Line(b"t_s,q".to_vec())]);
    }
}
