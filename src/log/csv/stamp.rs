//! Times in two columns: seconds, and what is beyond them.

use super::{
    clock::{Found, Look},
    guess::SINCE_1970_S,
    number::number,
    time::TimeSource,
    unit::{Measure, parse_unit},
};

const NS_PER_SECOND: i64 = 1_000_000_000;

impl Look<'_> {
    /// Seconds in one column and what is beyond them in another are one time: `sec` and `nanosec`, a time of day and `ms`.
    pub(super) fn join_parts(&self, usable: &mut Vec<Found>) {
        let last_word = |column: usize| self.labels[column].words.last().map_or("", String::as_str);
        let says_seconds =
            |column: usize| ["s", "sec", "secs", "second", "seconds"].contains(&last_word(column));
        let part = |column: &usize| {
            let name = self.head.names[*column].to_lowercase();
            let spelt = name.rsplit(|c: char| !c.is_alphabetic()).next().filter(|word| !word.is_empty());
            let unit = match spelt? {
                "millitm" => parse_unit("ms"),
                word => parse_unit(word).filter(|unit| unit.measure == Measure::Time && unit.factor < 1e9),
            }?;
            let mut cells = self.cells(*column).filter(|cell| !cell.trim_ascii().is_empty()).peekable();
            let within = |cell: &[u8]| {
                let whole = cell.trim_ascii().iter().all(u8::is_ascii_digit);
                whole && number(cell, false).is_some_and(|value| value * unit.factor < 1e9)
            };
            (!self.labels[*column].is_joint && cells.peek().is_some() && cells.all(within)).then_some(unit)
        };
        let columns = 0..self.labels.len();
        let parts: Vec<_> = columns.filter_map(|column| Some((column, part(&column)?))).collect();
        let seconds = |found: &Found| {
            let source = match &found.source {
                // Counted in seconds, whatever its steps look like.
                TimeSource::Number { column, .. } if says_seconds(*column) => {
                    TimeSource::Number { column: *column, unit: parse_unit("s")? }
                }
                other => other.clone(),
            };
            let whole = self.ns(&source).flatten().all(|ns| ns % NS_PER_SECOND == 0);
            whole.then_some(source)
        };
        // What stands before the unit: a message has more stamps than one.
        let stem = |column: usize| self.head.names[column].trim_end_matches(char::is_alphabetic);
        // Which of a date is the day is as doubtful as without the part.
        let doubt = |found: &Found| {
            found
                .doubt
                .clone()
                .filter(|_| matches!(found.source, TimeSource::Date { .. } | TimeSource::DayAndTime { .. }))
        };
        let wholes: Vec<_> =
            usable.iter().filter_map(|found| Some((seconds(found)?, doubt(found)))).collect();
        let pairs = wholes.iter().flat_map(|whole| parts.iter().map(move |part| (whole, *part)));
        let joined = pairs.filter_map(|((whole, doubt), (part, unit))| {
            let columns = whole.columns();
            let of_another = columns.iter().all(|column| stem(*column) != stem(part));
            let found = self
                .found(TimeSource::WithPart { whole: Box::new(whole.clone()), part, unit }, doubt.clone());
            // The finest counts: others may say the same less finely.
            (!columns.contains(&part)).then_some(((!found.resolves, of_another, unit.factor), found))
        });
        let best = joined.min_by(|a, b| a.0.partial_cmp(&b.0).unwrap_or(std::cmp::Ordering::Equal));
        usable.splice(0..0, best.map(|(_, found)| found));
    }

    /// The first columns of a table without names, if they are seconds since 1970 and nanoseconds beyond them.
    pub(super) fn unnamed_stamp(&self) -> Option<Found> {
        let values = |column: usize| -> Option<Vec<f64>> {
            let whole =
                |cell: &[u8]| number(cell, self.dialect.decimal_comma).filter(|value| value.fract() == 0.0);
            self.cells(column).map(whole).collect()
        };
        let (seconds, beyond) = (values(0)?, values(1)?);
        let is_stamp = !self.head.named
            && seconds.iter().all(|value| (SINCE_1970_S[0]..SINCE_1970_S[1]).contains(value))
            && beyond.iter().all(|value| (0.0..1e9).contains(value));
        let whole = Box::new(TimeSource::Number { column: 0, unit: parse_unit("s")? });
        let source = TimeSource::WithPart { whole, part: 1, unit: parse_unit("ns")? };
        let said = "is taken as seconds since 1970 and the next one as nanoseconds beyond them, which is how \
                    `ros2 topic echo --csv` writes stamps; else say --time or --rate";
        Some(self.found(source, Some(said.to_owned()))).filter(|found| is_stamp && found.resolves)
    }
}
