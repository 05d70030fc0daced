//! Lines out of the packets of one sender, which may end anywhere in a line.

/// Longer lines are no rows; bytes.
const LONGEST: usize = 1 << 20;

/// What the last packet left, and how a whole line looks.
#[derive(Debug, Default)]
pub(super) struct Packets {
    rest: Vec<u8>,
    /// What separates cells, and how many there are of them.
    shape: Option<(u8, usize)>,
    /// Whether lines end with a line end at all: a packet without one is a line otherwise.
    ends: bool,
}

impl Packets {
    /// The whole lines that a packet brings. A last one without an end waits for the next packet, where lines have ends, or
    /// where it is the first.
    pub(super) fn lines(&mut self, packet: &[u8]) -> Vec<Vec<u8>> {
        let mut lines = Vec::new();
        self.ends |= packet.contains(&b'\n');
        let begin = packet.split(|byte| *byte == b'\n').next().unwrap_or_default();
        if !self.rest.is_empty() && self.is_whole(begin) {
            self.push(&mut lines, &[]);
        }
        let mut pieces = packet.split(|byte| *byte == b'\n').peekable();
        while let Some(piece) = pieces.next() {
            if pieces.peek().is_some() {
                self.push(&mut lines, piece);
            } else {
                self.rest.extend_from_slice(piece);
            }
        }
        let is_line = is_object(&self.rest) || !self.ends && self.shape.is_some();
        if is_line || self.rest.len() > LONGEST {
            self.push(&mut lines, &[]);
        }
        lines
    }

    /// What waits for an end that does not come, and whether it may be a part of a line.
    pub(super) fn rest(&mut self) -> Option<(Vec<u8>, bool)> {
        let rest = std::mem::take(&mut self.rest);
        (!rest.trim_ascii().is_empty()).then_some((rest, self.ends))
    }

    /// Whether what waits is a line of its own before a packet that begins so.
    fn is_whole(&self, begin: &[u8]) -> bool {
        match self.shape {
            _ if is_object(&self.rest) => true,
            Some((separator, count)) => {
                [self.rest.as_slice(), begin].iter().all(|line| cells(line, separator) == count)
            }
            None => !self.ends,
        }
    }

    fn push(&mut self, lines: &mut Vec<Vec<u8>>, piece: &[u8]) {
        let mut line = std::mem::take(&mut self.rest);
        line.extend_from_slice(piece);
        if !line.trim_ascii().is_empty() {
            let separator = b";\t,| ".iter().find(|mark| line.contains(mark)).copied();
            self.shape = separator.map(|mark| (mark, cells(&line, mark))).or(self.shape);
            lines.push(line);
        }
    }
}

fn cells(line: &[u8], separator: u8) -> usize {
    line.split(|byte| *byte == separator).count()
}

/// Whether a line is an object that is closed.
fn is_object(line: &[u8]) -> bool {
    let line = line.trim_ascii();
    let count = |mark: u8| cells(line, mark);
    line.starts_with(b"{") && line.ends_with(b"}") && count(b'{') == count(b'}')
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lines of packets, with what is left at the end.
    fn lines<'a>(packets: impl IntoIterator<Item = &'a [u8]>) -> Vec<String> {
        let mut of = Packets::default();
        let mut lines: Vec<Vec<u8>> = packets.into_iter().flat_map(|packet| of.lines(packet)).collect();
        lines.extend(of.rest().map(|(line, _)| line));
        lines.into_iter().map(|line| String::from_utf8(line).unwrap()).collect()
    }

    #[test]
    fn a_packet_may_end_anywhere() {
        let text = "t_s,boom_set_deg\n0.01,17.1887\n0.02,17.19\n0.03,17.2\n";
        let whole: Vec<&str> = text.lines().collect();
        // A packet before any line end is a line.
        for size in whole[0].len() + 1..text.len() {
            assert_eq!(lines(text.as_bytes().chunks(size)), whole, "{size}");
        }
        let objects = "{\"t\": 0.5, \"in\": {\"q\": 1}}\n{\"t\": 0.6, \"in\": {\"q\": 2}}";
        let whole: Vec<&str> = objects.lines().collect();
        for size in whole[0].len() + 1..objects.len() {
            assert_eq!(lines(objects.as_bytes().chunks(size)), whole, "{size}");
        }
    }

    #[test]
    fn a_packet_without_a_line_end_is_a_line_where_lines_have_none() {
        let whole = ["t_s;q_deg", "0,01;17,1887", "0,02;17,19", "0,03;17,2"];
        assert_eq!(lines(whole.map(str::as_bytes)), whole);
        // Lines that end within packets alone, and after the header alone.
        assert_eq!(lines([&b"t_s;q_deg\n0,01;17,1887"[..], b"0,02;17,19\n0,03;17,2"]), whole);
        assert_eq!(lines([&b"t_s;q_deg\n"[..], b"0,01;17,1887", b"0,02;17,19", b"0,03;17,2"]), whole);
        let objects = ["{\"t\":1}", "{\"t\":2}"];
        assert_eq!(lines(objects.map(str::as_bytes)), objects);
        // A first packet is written once the second tells that it was whole.
        let mut of = Packets::default();
        assert!(of.lines(b"t_s,q_deg").is_empty());
        assert_eq!((of.lines(b"0,1").len(), of.lines(b"1,1").len()), (2, 1));
    }
}
