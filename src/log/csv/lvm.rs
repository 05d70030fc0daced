//! Measurements of `LabVIEW` as text: properties of the file, then segments of properties, names and rows.

use super::{
    Separator,
    number::{nanoseconds, number},
    rows::{cell_text, writer},
    scale::unit_named,
    started::Started,
};

/// The header of times.
const SECONDS: &str = "X_Value [s]";

const END: &[u8] = b"***End_of_Header***";

/// The rows of all segments below one header, each with its time; `None` unless the text is such a measurement whose segments
/// have the same columns.
pub(super) fn as_table(text: &[u8]) -> Option<Vec<u8>> {
    let mut lines = text.split(|byte| *byte == b'\n').map(|line| line.strip_suffix(b"\r").unwrap_or(line));
    if !lines.next()?.trim_ascii().starts_with(b"LabVIEW Measurement") {
        return None;
    }
    let above: Vec<&[u8]> = lines.by_ref().take_while(|line| !line.starts_with(END)).collect();
    let separator = above.iter().find_map(|line| line.strip_prefix(b"Separator")?.first().copied())?;
    let mut segment = Segment::default();
    let cell = |line: &[u8], at: usize| line.split(|byte| *byte == separator).nth(at).map(cell_text);
    let says = |key: &str| {
        above.iter().find(|line| cell(line, 0).as_deref() == Some(key)).and_then(|line| cell(line, 1))
    };
    let untimed = says("X_Columns").as_deref() == Some("No");
    let comma = says("Decimal_Separator").as_deref() == Some(",");
    let started = says("Date").zip(says("Time")).and_then(|(day, time)| Started::of_day(&day, &time));
    let mut clocks: Vec<usize> = Vec::new();
    let mut out = writer(Separator::Byte(b'\t'));
    let mut header: Option<Vec<String>> = None;
    for line in lines.filter(|line| !line.trim_ascii().is_empty() && !line.starts_with(END)) {
        let cells: Vec<&[u8]> = line.split(|byte| *byte == separator).collect();
        if cells[0] == b"X_Value" {
            let mut names = segment.names(&cells);
            clocks = (0..names.len()).filter(|at| started.is_some() && names[*at] == SECONDS).collect();
            for clock in &clocks {
                "X_Value".clone_into(&mut names[*clock]);
            }
            match &header {
                Some(before) if *before != names => return None,
                Some(_) => {}
                None => out.write_record(&names).ok()?,
            }
            header = Some(names);
            segment.rows = 0;
        } else if !segment.takes(&cells) {
            let width = header.as_ref()?.len();
            let time = if untimed { segment.time(comma)? } else { cells[0].to_vec() };
            let rest = cells[1..].iter().copied().chain(std::iter::repeat(&[][..]));
            for (at, cell) in std::iter::once(time.as_slice()).chain(rest).take(width).enumerate() {
                let started = started.filter(|_| clocks.contains(&at));
                let instant = started.and_then(|started| started.at(cell, comma, 1_000_000_000));
                out.write_field(instant.as_deref().unwrap_or(cell)).ok()?;
            }
            out.write_record(None::<&[u8]>).ok()?;
            segment.rows += 1;
        }
    }
    header.and(out.into_inner().ok())
}

/// The properties of the channels of a segment.
#[derive(Debug, Default)]
struct Segment {
    /// Instant of the first row and step, as they are written.
    first: Vec<String>,
    step: Vec<String>,
    units: Vec<String>,
    dimensions: Vec<String>,
    rows: i64,
}

impl Segment {
    /// Whether a row is one of properties.
    fn takes(&mut self, cells: &[&[u8]]) -> bool {
        const KEYS: [&[u8]; 8] =
            [b"Channels", b"Samples", b"Date", b"Time", b"X_Dimension", b"Y_Unit_Label", b"X0", b"Delta_X"];
        let text = || cells[1..].iter().map(|cell| cell_text(cell)).collect();
        match cells[0] {
            b"X0" => self.first = text(),
            b"Delta_X" => self.step = text(),
            b"Y_Unit_Label" => self.units = text(),
            b"X_Dimension" => self.dimensions = text(),
            key if KEYS.contains(&key) || key.starts_with(b"Y_Dimension") || key.starts_with(b"Special") => {}
            _ => return false,
        }
        true
    }

    /// The names of the columns with their units; comments stand behind them.
    fn names(&self, cells: &[&[u8]]) -> Vec<String> {
        let of_time = self.dimensions.iter().all(|one| one.is_empty() || one == "Time");
        // Units stand above their columns, the first above none.
        let unit = |at: usize| self.units.get(at.checked_sub(1)?).filter(|unit| unit_named(unit).is_some());
        let names = cells.iter().map(|cell| cell_text(cell)).enumerate();
        let names = names.filter(|(_, name)| name != "Comment").map(|(at, name)| match name.as_str() {
            "X_Value" if of_time => SECONDS.to_owned(),
            "X_Value" => name,
            _ => match unit(at) {
                Some(unit) => format!("{name} [{unit}]"),
                None => name,
            },
        });
        let mut names: Vec<String> = names.collect();
        while names.last().is_some_and(String::is_empty) {
            names.pop();
        }
        names
    }

    /// When a row of a segment without times was taken, s; `None` if channels differ in that.
    fn time(&self, comma: bool) -> Option<Vec<u8>> {
        let one = |all: &[String]| -> Option<String> {
            let mut given = all.iter().filter(|text| !text.is_empty());
            let first = given.next()?;
            given.all(|other| other == first).then(|| first.clone())
        };
        let (first, step) = (one(&self.first)?, one(&self.step)?);
        let step_s = number(step.as_bytes(), comma).filter(|step| step.is_finite() && *step > 0.0)?;
        let first_ns = nanoseconds(first.as_bytes(), comma, 1_000_000_000)?;
        let at_s = first_ns as f64 / 1e9 + step_s * self.rows as f64;
        let text = format!("{at_s:.9}");
        Some(if comma { text.replace('.', ",") } else { text }.into_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Option<String> {
        as_table(text.as_bytes()).map(|text| String::from_utf8(text).unwrap())
    }

    const ABOVE: &str = "LabVIEW Measurement\t\r\nSeparator\tTab\r\nDecimal_Separator\t,\r\nX_Columns\tNo\r\n\
                         ***End_of_Header***\t\r\n\t\r\n";

    fn segment(first: &str, names: &str) -> String {
        format!(
            "Channels\t2\t\t\r\nSamples\t2\t2\t\r\nY_Unit_Label\tmm\tVolts\t\r\nX_Dimension\tTime\tTime\t\r\n\
             X0\t{first}\t{first}\t\r\nDelta_X\t0,5\t0,5\t\r\n***End_of_Header***\t\t\t\r\nX_Value\t{names}\tComment\r\n\
             \t1,5\t2\tbegins\r\n\t2,5\t3\r\n\r\n"
        )
    }

    #[test]
    fn segments_follow_each_other_with_times_by_their_first_instant_and_step() {
        let text = format!("{ABOVE}{}{}", segment("0", "boom set\tvalve"), segment("1", "boom set\tvalve"));
        let rows =
            ["0,000000000\t1,5\t2", "0,500000000\t2,5\t3", "1,000000000\t1,5\t2", "1,500000000\t2,5\t3"];
        let expected = format!("X_Value [s]\tboom set [mm]\tvalve\n{}\n", rows.join("\n"));
        assert_eq!(of(&text), Some(expected));
        let dated = ABOVE.replace("X_Columns", "Date\t2025/06/15\r\nTime\t15:06:40,5\r\nX_Columns");
        let table = of(&format!("{dated}{}", segment("1", "boom set\tvalve"))).unwrap();
        assert!(
            table.starts_with("X_Value\tboom set [mm]\tvalve\n2025-06-15 15:06:41.500000000\t1,5"),
            "{table}"
        );
    }

    #[test]
    fn each_of_several_times_has_its_signal_with_its_unit() {
        let text = "LabVIEW Measurement\t\nSeparator\tTab\nX_Columns\tMulti\n***End_of_Header***\t\nChannels\t2\t\t\n\
                    Y_Unit_Label\tdeg\t\tmm\nX_Dimension\tTime\t\tTime\n***End_of_Header***\t\t\t\nX_Value\tboom set\tX_Value\ttele set\tComment\n\
                    0.0\t1.5\t0.0\t2\n";
        let header = "X_Value [s]\tboom set [deg]\tX_Value [s]\ttele set [mm]";
        assert_eq!(of(text).unwrap().lines().next(), Some(header));
    }

    #[test]
    fn other_texts_and_segments_of_other_columns_are_left() {
        let text = format!("{ABOVE}{}{}", segment("0", "boom set\tvalve"), segment("1", "boom set\tspool"));
        assert_eq!(of(&text), None);
        assert_eq!(of(ABOVE), None);
        assert_eq!(of("t,q\n0,1\n"), None);
        assert_eq!(of("LabVIEW Measurement\nSeparator\tTab\n***End_of_Header***\n1\t2\n"), None);
        let uneven = format!("{ABOVE}{}", segment("0", "a\tb").replace("0,5\t0,5", "0,5\t0,25"));
        assert_eq!(of(&uneven), None);
    }
}
