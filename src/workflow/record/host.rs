//! The programs of one host: one is listened to at a time, or rows of two would be woven into one run.

use std::collections::{BTreeSet, VecDeque};

use super::{Came, packets::Packets};

/// After so long a silence another program of the same host may go on, s.
const SILENCE_S: f64 = 1.0;
/// So many of the last ports tell whether a port lasts.
const RECENT: usize = 16;
/// So many packets wait for the silence of the program that is listened to.
const MOST_WAITING: usize = 4096;

/// The program that is listened to, by its port. Some programs open a port for each packet.
#[derive(Debug, Default)]
pub(super) struct Host {
    port: Option<u16>,
    heard_s: f64,
    recent: VecDeque<u16>,
    /// Ports of other programs, which sent while this one did.
    beside: BTreeSet<u16>,
    /// Packets of a port that is new: of another program if the old one goes on, and of its successor if not.
    waiting: Vec<(u16, Vec<u8>)>,
    packets: Packets,
    pub(super) refused: u64,
    /// Where another one went on after the first was silent.
    pub(super) followed: u64,
}

impl Host {
    /// Listens to a port.
    pub(super) fn at(port: u16) -> Self {
        Self { port: Some(port), recent: [port, port].into(), ..Self::default() }
    }

    pub(super) fn port(&self) -> u16 {
        self.port.unwrap_or_default()
    }

    /// The port of a program that was refused.
    pub(super) fn beside(&self) -> Option<u16> {
        self.beside.first().copied()
    }

    /// The lines of a packet, if its program is listened to; `at_s` is a time of any clock.
    pub(super) fn take(&mut self, port: u16, at_s: f64, packet: &[u8]) -> Vec<Came> {
        let own = *self.port.get_or_insert(port);
        if port != own && self.lasts() {
            if at_s - self.heard_s <= SILENCE_S {
                self.wait(port, packet);
                return Vec::new();
            }
            self.followed += 1;
            self.recent.clear();
            self.beside.clear();
        }
        let waiting = std::mem::take(&mut self.waiting);
        let mut lines = Vec::new();
        if port == own {
            self.refused += waiting.len() as u64;
            self.beside.extend(waiting.iter().map(|(port, _)| *port));
        } else {
            for (port, packet) in &waiting {
                self.listen(*port, packet, &mut lines);
            }
        }
        self.listen(port, packet, &mut lines);
        (self.port, self.heard_s) = (Some(port), at_s);
        lines
    }

    /// At the end: what nobody claimed, and a last line without an end.
    pub(super) fn rest(&mut self) -> Vec<Came> {
        let mut lines = Vec::new();
        for (port, packet) in std::mem::take(&mut self.waiting) {
            self.listen(port, &packet, &mut lines);
        }
        lines.extend(
            self.packets.rest().map(|(line, cut)| if cut { Came::Rest(line) } else { Came::Line(line) }),
        );
        lines
    }

    fn wait(&mut self, port: u16, packet: &[u8]) {
        if self.beside.contains(&port) || self.waiting.len() >= MOST_WAITING {
            self.refused += 1;
        } else {
            self.waiting.push((port, packet.to_vec()));
        }
    }

    fn listen(&mut self, port: u16, packet: &[u8], lines: &mut Vec<Came>) {
        if self.recent.len() == RECENT {
            self.recent.pop_front();
        }
        self.recent.push_back(port);
        lines.extend(self.packets.lines(packet).into_iter().map(Came::Line));
    }

    /// Whether packets come from a port that stays; one that comes again now and then does not.
    fn lasts(&self) -> bool {
        let ports = self.recent.iter().collect::<BTreeSet<_>>().len();
        let count = self.recent.len();
        if count < RECENT / 2 { ports < count } else { 2 * ports < count }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The packets that became lines.
    fn taken(packets: &[(u16, f64)]) -> Vec<String> {
        let mut host = Host::default();
        let mut lines = Vec::new();
        for (port, at_s) in packets {
            lines.extend(host.take(*port, *at_s, format!("{at_s},{port}\n").as_bytes()));
        }
        lines.extend(host.rest());
        let text = |came: Came| match came {
            Came::Line(line) => String::from_utf8(line).unwrap(),
            other => panic!("{other:?}"),
        };
        lines.into_iter().map(text).collect()
    }

    #[test]
    fn one_program_is_listened_to_until_it_is_silent() {
        assert_eq!(taken(&[(1, 0.0), (1, 0.1), (2, 0.1), (1, 0.2), (2, 0.2)]), ["0,1", "0.1,1", "0.2,1"]);
        // Begun anew, at once and after a while: nothing of it is lost.
        assert_eq!(taken(&[(1, 0.0), (1, 0.1), (2, 0.2), (2, 9.0)]), ["0,1", "0.1,1", "0.2,2", "9,2"]);
        assert_eq!(taken(&[(1, 0.0), (1, 0.1), (2, 0.2)]), ["0,1", "0.1,1", "0.2,2"]);
        // In turn from the start on.
        assert_eq!(
            taken(&[(1, 0.0), (2, 0.0), (1, 0.1), (2, 0.1), (1, 0.2)]),
            ["0,1", "0,2", "0.1,1", "0.2,1"]
        );
    }

    #[test]
    fn a_port_for_each_packet_or_few_is_one_program() {
        let mut rng = 1_u32;
        let mut port = || {
            rng = rng.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            32_768 + u16::try_from(rng >> 17).unwrap() % 28_000
        };
        for each in [1, 2, 3] {
            let ports: Vec<u16> = (0..2000).map(|_| port()).collect();
            let packets: Vec<(u16, f64)> =
                (0..2000_u32).map(|k| (ports[k as usize / each], 0.01 * f64::from(k))).collect();
            assert_eq!(taken(&packets).len(), 2000, "{each}");
        }
    }
}
