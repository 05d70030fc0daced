//! A socket that packets wait in, and how many it lost.

use std::{
    io,
    net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, ToSocketAddrs as _, UdpSocket},
    path::Path,
};

use socket2::{Domain, Socket, Type};

use crate::{
    input_file,
    remark::{Code, Remarks},
};

/// Room for packets that wait, bytes; a system gives as much of it as it allows.
const ROOM: usize = 8 << 20;

/// A socket at an address, with room for a burst; of a group of receivers it becomes one.
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
    let (group, mut local) = (address.ip(), address);
    if group.is_multicast() {
        // Others on this computer may listen, too.
        socket.set_reuse_address(true)?;
        // Windows binds to addresses of its own alone.
        if cfg!(windows) {
            local.set_ip(if group.is_ipv4() {
                Ipv4Addr::UNSPECIFIED.into()
            } else {
                Ipv6Addr::UNSPECIFIED.into()
            });
        }
    }
    socket.bind(&local.into())?;
    match group {
        IpAddr::V4(group) if group.is_multicast() => {
            socket.join_multicast_v4(&group, &Ipv4Addr::UNSPECIFIED)?;
        }
        IpAddr::V6(group) if group.is_multicast() => socket.join_multicast_v6(&group, 0)?,
        _ => {}
    }
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

    #[cfg(target_os = "linux")]
    #[test]
    fn packets_to_a_group_come_to_who_listens_at_its_address() {
        let group = Ipv4Addr::new(239, 255, 77, 1);
        // A computer without a network has no way to any group.
        let Ok(socket) = bound(&format!("{group}:0")) else { return };
        socket.set_read_timeout(Some(std::time::Duration::from_secs(5))).unwrap();
        let port = socket.local_addr().unwrap().port();
        let sender = UdpSocket::bind("0.0.0.0:0").unwrap();
        if sender.send_to(b"t_s", (group, port)).is_ok() {
            assert_eq!(socket.recv(&mut [0; 16]).unwrap(), 3);
        }
    }

    #[test]
    fn what_was_lost_is_the_last_number_of_the_port() {
        let line = " 1226: 0100007F:138D 00000000:0000 07 00000000:00000000 00:00000000 00000000  0  0 99421 2 00000000 545";
        assert_eq!(lost_in(line, 0x138d), Some(545));
        assert_eq!(lost_in(line, 0x138e), None);
        assert_eq!(lost_in("  sl  local_address rem_address   st", 1), None);
    }
}
