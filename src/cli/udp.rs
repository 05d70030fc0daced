//! A socket that packets wait in, and how many it lost.

use std::{
    io,
    net::{SocketAddr, ToSocketAddrs as _, UdpSocket},
    path::Path,
};

use socket2::{Domain, Socket, Type};

use crate::{
    input_file,
    remark::{Code, Remarks},
};

/// Room for packets that wait, bytes; a system gives as much of it as it allows.
const ROOM: usize = 8 << 20;

/// A socket at an address, with room for a burst.
pub(super) fn bound(address: &str) -> io::Result<UdpSocket> {
    let mut refused = io::Error::new(io::ErrorKind::InvalidInput, "the name leads to no address");
    for address in address.to_socket_addrs()? {
        match at(address) {
            Ok(socket) => return Ok(socket),
            Err(error) => refused = error,
        }
    }
    Err(refused)
}

fn at(address: SocketAddr) -> io::Result<UdpSocket> {
    let socket = Socket::new(Domain::for_address(address), Type::DGRAM, None)?;
    // Less room than asked for is no reason to record nothing.
    let _ = socket.set_recv_buffer_size(ROOM);
    socket.bind(&address.into())?;
    Ok(socket.into())
}

/// Packets that the system has thrown away at a port because nobody took them in time; 0 where it does not tell.
pub(super) fn lost(port: u16) -> u64 {
    ["/proc/net/udp", "/proc/net/udp6"]
        .iter()
        .filter_map(|table| input_file::read_to_string(Path::new(table)).ok())
        .flat_map(|table| table.lines().filter_map(|line| lost_in(line, port)).collect::<Vec<_>>())
        .sum()
}

/// The last number of a line of the system's table, if it is of this port.
fn lost_in(line: &str, port: u16) -> Option<u64> {
    let own = line.split_whitespace().nth(1)?.rsplit_once(':')?.1;
    let is_own = u16::from_str_radix(own, 16) == Ok(port);
    line.split_whitespace().next_back().filter(|_| is_own)?.parse().ok()
}

/// Says that packets were lost.
pub(super) fn remark_lost(remarks: &mut Remarks, count: u64) {
    let message = "packets that came faster than they were taken, and that the system threw away; send fewer rows at once, or \
                   raise the limit of the system (on Linux net.core.rmem_max)";
    remarks.add(Code::Gap, count, message);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_lost_is_the_last_number_of_the_port() {
        let line = " 1226: 0100007F:138D 00000000:0000 07 00000000:00000000 00:00000000 00000000  0  0 99421 2 00000000 545";
        assert_eq!(lost_in(line, 0x138d), Some(545));
        assert_eq!(lost_in(line, 0x138e), None);
        assert_eq!(lost_in("  sl  local_address rem_address   st", 1), None);
    }
}
