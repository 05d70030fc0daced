//! Who sends: one at a time, or rows of two would be woven into one run.

use std::{collections::BTreeSet, net::SocketAddr};

use crate::remark::{Code, Remarks};

/// After so long a silence another program of the same host may go on, s.
const SILENCE_S: f64 = 1.0;
/// So many ports are remembered.
const MOST_PORTS: usize = 1000;

/// The sender that is listened to, and what others sent meanwhile.
#[derive(Debug, Default)]
pub struct Senders {
    first: Option<SocketAddr>,
    heard_s: f64,
    /// Whether it sent more than once: some programs open a port for each packet.
    lasts: bool,
    ports: BTreeSet<u16>,
    /// The one that was listened to when another was refused first, and that one.
    both: Option<[SocketAddr; 2]>,
    refused: u64,
    /// Where another one went on after the first was silent.
    followed: u64,
}

impl Senders {
    /// Whether a packet from here, at a time of any clock, is of the sender that is listened to.
    pub fn takes(&mut self, from: SocketAddr, at_s: f64) -> bool {
        let now = *self.first.get_or_insert(from);
        let may_follow = from.ip() == now.ip() && (!self.lasts || at_s - self.heard_s > SILENCE_S);
        if from != now && !may_follow {
            self.refused += 1;
            self.both.get_or_insert([now, from]);
            return false;
        }
        self.followed += u64::from(from != now && self.lasts);
        if self.ports.len() >= MOST_PORTS {
            self.ports.clear();
        }
        // A port that comes again is none for a single packet.
        self.lasts = !self.ports.insert(from.port());
        (self.first, self.heard_s) = (Some(from), at_s);
        true
    }

    /// What was refused.
    pub fn remarks(&self) -> Remarks {
        let mut remarks = Remarks::default();
        if let Some([first, other]) = self.both {
            let message = format!(
                "packets of another sender than {first}, such as {other}, left out; let each send to a recorder and a port \
                 of its own, or one send all columns"
            );
            remarks.add(Code::Ambiguous, self.refused, message);
        }
        let message = "changes of the sender after a silence: another port of the same host goes on; one program that was begun \
                       anew, or two";
        remarks.add(Code::Ambiguous, self.followed, message);
        remarks
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taken(packets: &[(&str, f64)]) -> Vec<bool> {
        let mut senders = Senders::default();
        packets.iter().map(|(from, at_s)| senders.takes(from.parse().unwrap(), *at_s)).collect()
    }

    #[test]
    fn one_sender_is_listened_to_until_it_is_silent() {
        let [a, b, far] = ["10.0.0.1:1", "10.0.0.1:2", "10.0.0.2:1"];
        assert_eq!(
            taken(&[(a, 0.0), (a, 0.1), (b, 0.1), (far, 0.2), (a, 0.2)]),
            [true, true, false, false, true]
        );
        // Begun anew; another machine does not follow.
        assert_eq!(
            taken(&[(a, 0.0), (a, 0.1), (far, 9.0), (b, 9.0), (b, 9.1)]),
            [true, true, false, true, true]
        );
        // In turn from the start on.
        assert_eq!(taken(&[(a, 0.0), (b, 0.0), (a, 0.1), (b, 0.1)]), [true, true, true, false]);
    }

    #[test]
    fn a_port_for_each_packet_is_one_sender() {
        let packets: Vec<String> = (1..5000).map(|port| format!("10.0.0.1:{port}")).collect();
        let packets: Vec<(&str, f64)> = packets.iter().map(|from| (from.as_str(), 0.0)).collect();
        assert!(taken(&packets).into_iter().all(|taken| taken));
    }
}
