//! Finds the column of the time.

use ::csv::ByteRecord;

use super::{
    CsvError, CsvOptions,
    column::{find, pasted, present},
    date::{DateForm, Part},
    dialect::Dialect,
    guess::{SINCE_1899_DAYS, guess_unit, typical_step},
    head::Head,
    label::Label,
    number::{nanoseconds, number},
    order::{code, doubt},
    rows::Rows,
    time::{FIRST_ABSOLUTE_NS, TimeSource, with_unit},
    unit::{ARCHIVE_DAY, Measure, parse_unit},
};
use crate::{
    math::range,
    remark::{Code, Remarks},
    units::NS_PER_S,
};

/// Finds the time among the columns.
pub(super) fn choose(
    text: &[u8],
    head: &Head,
    labels: &[Label],
    dialect: Dialect,
    options: &CsvOptions,
    remarks: &mut Remarks,
) -> Result<TimeSource, CsvError> {
    let look = Look { head, labels, dialect, options };
    if let Some(hz) = options.rate_hz {
        let times = |column: &usize| {
            labels[*column].is_time
                && look
                    .column(*column)
                    .is_ok_and(|found| found.steady() && found.resolves && found.doubt.is_none())
        };
        if let Some(column) = (0..labels.len()).find(times) {
            let message = format!(
                "column {:?} is a time, and --rate counts rows instead; without --rate it is read",
                head.names[column]
            );
            remarks.add(Code::Ambiguous, 1, message);
        }
        return Ok(TimeSource::Rate { hz });
    }
    if let Some(name) = &options.time {
        let column = find(name, "--time", &head.names)?;
        return Ok(look.spread(text, look.column(column)?).tell(head, remarks));
    }
    let (mut usable, mut unsteady) = (Vec::new(), Vec::new());
    let mut failure = None;
    for column in (0..labels.len()).filter(|&column| labels[column].is_time) {
        let is_span = look.is_span(column);
        match look.column(column) {
            Ok(found) if is_span && !(found.steady() && found.resolves) => {}
            Ok(found) => if found.steady() { &mut usable } else { &mut unsteady }.push(found),
            Err(error) => failure = failure.or(Some(error).filter(|_| !is_span)),
        }
    }
    if usable.is_empty() && failure.is_none() {
        usable.extend(look.dates());
    }
    if usable.is_empty() && failure.is_none() {
        usable.extend(look.index().or_else(|| look.by_unit()).or_else(|| look.unnamed_stamp()));
    }
    if usable.is_empty() {
        usable = unsteady;
    }
    // Beside a clock that rises, one that falls says what is left.
    if !usable.iter().all(Found::falls) {
        usable.retain(|found| !found.falls());
    }
    look.join_day_and_time(&mut usable);
    look.join_parts(&mut usable);
    // What resolves the rows is better than what does not, then an instant than a span, then the source's clock than the
    // receiver's, then what has a date.
    let spans = |found: &Found| found.source.columns().iter().any(|column| look.is_span(*column));
    usable.sort_by_key(|found| (!found.resolves, spans(found), look.is_of_receipt(found), !found.absolute));
    look.remark_other(text, &usable, remarks);
    let best = usable.into_iter().next().map(|best| look.spread(text, best));
    match (best, failure) {
        (Some(best), _) if best.resolves => Ok(best.tell(head, remarks)),
        (Some(best), _) => {
            let columns: Vec<&str> = best.source.columns().iter().map(|&c| head.names[c].as_str()).collect();
            let why =
                format!(" that tells the rows apart ({} repeats itself in most)", columns.join(" with "));
            Err(CsvError::NoTime { why, present: present(&head.names), by_number: look.by_number(text) })
        }
        (None, Some(error)) => Err(error),
        (None, None) => {
            let (why, by_number) = (String::new(), look.by_number(text));
            Err(CsvError::NoTime { why, present: present(&head.names), by_number })
        }
    }
}

/// The times of a column by itself; `None` if it holds none.
pub(super) fn of_column(
    head: &Head,
    labels: &[Label],
    dialect: Dialect,
    options: &CsvOptions,
    column: usize,
) -> Option<Found> {
    Look { head, labels, dialect, options }.column(column).ok()
}

/// How a column goes from row to row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Course {
    Rises,
    /// As what is left of a time does, and tables whose newest row stands first.
    Falls,
    /// No more often one than the other: what only measures something does.
    Neither,
}

/// A column of times.
pub(super) struct Found {
    pub(super) source: TimeSource,
    /// Whether most rows have a stamp of their own.
    pub(super) resolves: bool,
    pub(super) course: Course,
    pub(super) absolute: bool,
    /// The guesses.
    pub(super) doubt: Option<String>,
}

impl Found {
    pub(super) fn steady(&self) -> bool {
        self.course != Course::Neither
    }

    pub(super) fn falls(&self) -> bool {
        self.course == Course::Falls
    }

    fn tell(self, head: &Head, remarks: &mut Remarks) -> TimeSource {
        let column = self.source.columns().first().map_or("", |&column| head.names[column].as_str());
        if let Some(doubt) = self.doubt {
            remarks.add(code(&doubt), 1, format!("time column {column:?} {doubt}"));
        }
        self.source
    }
}

/// Two clocks go apart by so much at least, s: below, they are written with fewer digits.
const LEAST_APART_S: f64 = 0.02;
/// Steps that thousandths tell well enough; days and minutes have more digits.
const FINEST_OF_THOUSANDTHS: f64 = 0.01;
/// Fewer rows may rise by chance.
const LEAST_ROWS: usize = 12;
/// A table in which times are looked for.
pub(super) struct Look<'a> {
    pub(super) head: &'a Head,
    pub(super) labels: &'a [Label],
    pub(super) dialect: Dialect,
    pub(super) options: &'a CsvOptions,
}

impl Look<'_> {
    pub(super) fn cells(&self, column: usize) -> impl Iterator<Item = &[u8]> + Clone {
        self.head.sample.iter().map(move |row| row.get(column).map_or(&[][..], Vec::as_slice))
    }

    pub(super) fn found(&self, source: TimeSource, doubt: Option<String>) -> Found {
        let ns: Vec<i64> = self.ns(&source).flatten().collect();
        let count = |is: fn(&i64, &i64) -> bool| ns.windows(2).filter(|w| is(&w[0], &w[1])).count();
        let (rises, falls) = (count(i64::lt), count(i64::gt));
        let is_span = source.columns().iter().any(|column| self.is_span(*column));
        Found {
            resolves: !ns.is_empty() && 2 * (rises + falls) + 1 >= ns.len(),
            course: match ns.len() < LEAST_ROWS && !is_span || 4 * rises.min(falls) <= rises + falls {
                false => Course::Neither,
                true if falls > rises => Course::Falls,
                true => Course::Rises,
            },
            absolute: ns.first().is_some_and(|first| *first >= FIRST_ABSOLUTE_NS),
            source,
            doubt,
        }
    }

    pub(super) fn column(&self, column: usize) -> Result<Found, CsvError> {
        let comma = self.dialect.decimal_comma;
        let name = || self.head.names[column].clone();
        let forms = self.forms(column);
        if let Some(form) = forms.first() {
            let doubt = doubt(&forms);
            return Ok(self.found(TimeSource::Date { column, form: form.clone() }, doubt));
        }
        let given = self.options.time_unit.as_deref().and_then(parse_unit);
        if given.is_none() && self.is_of_archive(column) {
            return Ok(self.found(TimeSource::Number { column, unit: ARCHIVE_DAY }, None));
        }
        let stated = self.labels.get(column).and_then(|label| label.stated);
        if let Some(other) = stated.filter(|unit| given.is_none() && unit.measure != Measure::Time) {
            return Err(CsvError::WrongUnit {
                column: name(),
                unit: other.name.to_owned(),
                expected: "time",
            });
        }
        let mut behind = self.cells(column).filter(|cell| !cell.is_empty()).map(|cell| with_unit(cell).1);
        let first = behind.next().flatten();
        let written = first.filter(|_| behind.all(|unit| unit == first));
        if let Some(unit) = given.or(written).or(stated) {
            return Ok(self.found(TimeSource::Number { column, unit }, None));
        }
        // More digits than a thousandth, as days have.
        let fine: Vec<f64> = self.cells(column).filter_map(|cell| number(cell, comma)).collect();
        let milli: Vec<i64> = self.cells(column).filter_map(|cell| nanoseconds(cell, comma, 1_000)).collect();
        let values: Vec<f64> = milli.iter().map(|value| *value as f64 / 1e3).collect();
        let whole =
            milli.iter().all(|value| value % 1_000 == 0) && fine.iter().all(|value| value.fract() == 0.0);
        // Stamps of 19 digits are nanoseconds; times 1000 they fit no i64.
        let huge = milli.is_empty() && self.cells(column).any(|cell| nanoseconds(cell, comma, 1).is_some());
        let step = match typical_step(&values) {
            step if step < FINEST_OF_THOUSANDTHS => typical_step(&fine),
            step => step,
        };
        let (unit, doubt) = if huge && fine.first().is_none_or(|first| *first > 1e18) {
            (parse_unit("ns"), None)
        } else {
            let counts = whole && milli.windows(2).all(|two| two[1].checked_sub(two[0]) == Some(1_000));
            guess_unit(fine.first().copied().unwrap_or(0.0), step, whole, counts)
        };
        let Some(unit) = unit else { return Err(CsvError::TimeUnit { column: name(), step }) };
        Ok(self.found(TimeSource::Number { column, unit }, doubt))
    }

    /// Whether a column counts as archives do: it is named as a time in ms, is of days, and stands beside a date.
    fn is_of_archive(&self, column: usize) -> bool {
        const MILLIONTHS: [f64; 2] = [1e6 * SINCE_1899_DAYS[0], 1e6 * SINCE_1899_DAYS[1]];
        let value = |cell: &[u8]| number(cell, self.dialect.decimal_comma);
        let dated = |other: usize| {
            DateForm::fitting(&self.cells(other)).first().is_some_and(|form| form.part == Part::Local)
        };
        self.head.names[column].eq_ignore_ascii_case("time_ms")
            && self
                .cells(column)
                .filter_map(value)
                .all(|value| (MILLIONTHS[0]..MILLIONTHS[1]).contains(&value))
            && (0..self.labels.len()).any(dated)
    }

    pub(super) fn ns<'a>(&'a self, source: &'a TimeSource) -> impl Iterator<Item = Option<i64>> + 'a {
        self.head.sample.iter().map(move |row| {
            source.ns(0, |column| row.get(column).map_or(&[][..], Vec::as_slice), self.dialect.decimal_comma)
        })
    }

    /// Whether a column is named as how long something took, which is no instant.
    fn is_span(&self, column: usize) -> bool {
        const SPANS: [&str; 17] = [
            "exec", "execution", "cycle", "scan", "task", "loop", "jitter", "latency", "period", "interval",
            "dt", "delta", "age", "processing", "compute", "zyklus", "laufzeit",
        ];
        let says = |label: &Label| label.words.iter().any(|word| SPANS.contains(&word.as_str()));
        self.labels.get(column).is_some_and(says)
    }

    /// Whether a time is that of who received or wrote the row, not of who measured.
    fn is_of_receipt(&self, found: &Found) -> bool {
        const RECEIPT: [&str; 9] =
            ["receive", "received", "recv", "receipt", "rx", "server", "servertimestamp", "arrival", "log"];
        let says = |column: &usize| {
            let words = &self.labels[*column].words;
            words.iter().any(|word| RECEIPT.contains(&word.as_str())) || self.head.names[*column] == "%time"
        };
        found.source.columns().iter().any(says)
    }

    /// Remarks on another clock that goes otherwise than the best one, by all rows.
    fn remark_other(&self, text: &[u8], usable: &[Found], remarks: &mut Remarks) {
        let Some((best, others)) = usable.split_first().filter(|(best, _)| best.resolves) else { return };
        let column = |found: &Found| found.source.columns().first().copied().unwrap_or_default();
        let others = others.iter().filter(|other| {
            let apart =
                |other: &Found| other.source.columns().iter().all(|c| !best.source.columns().contains(c));
            other.resolves && apart(other) && !self.is_of_receipt(other)
        });
        for other in others {
            let [own, ns] = self.both(text, [&best.source, &other.source]);
            let off = own.iter().zip(&ns).filter_map(|(a, b)| Some(b.checked_sub(*a)? as f64 / NS_PER_S));
            let [least, most] = range(off);
            let s: Vec<f64> = own.iter().map(|ns| *ns as f64 / NS_PER_S).collect();
            if most - least > LEAST_APART_S.max(2.0 * typical_step(&s)) {
                let names = &self.head.names;
                let message = format!(
                    "times are read from {:?}; {:?} goes {:.3} s away from it: --time {} reads that one",
                    names[column(best)],
                    names[column(other)],
                    most - least,
                    pasted(column(other), names)
                );
                remarks.add(Code::Guessed, 1, message);
            }
        }
    }

    /// The stamps of two clocks, ns, in the rows that have both; a time of day goes on after midnight.
    pub(super) fn both(&self, text: &[u8], sources: [&TimeSource; 2]) -> [Vec<i64>; 2] {
        let mut stamps = [Vec::new(), Vec::new()];
        let mut rows = Rows::new(text, self.dialect.separator);
        let mut record = ByteRecord::new();
        while let Some(line) = rows.next(&mut record) {
            let cell = |column: usize| record.get(column).unwrap_or_default();
            let ns = sources.map(|source| source.ns(0, cell, self.dialect.decimal_comma));
            if let ([Some(a), Some(b)], true) = (ns, line >= self.head.first_line) {
                stamps[0].push(a);
                stamps[1].push(b);
            }
        }
        for (source, stamps) in sources.iter().zip(&mut stamps) {
            source.settle(stamps);
        }
        stamps
    }

    /// A column that rises from row to row.
    pub(super) fn rising(&self, column: usize) -> Option<Found> {
        let found = self.column(column).ok()?;
        let ns: Vec<i64> = self.ns(&found.source).collect::<Option<_>>()?;
        (ns.len() >= LEAST_ROWS && ns.windows(2).all(|two| two[0] < two[1])).then_some(found)
    }

    /// The column that is the index of a data frame, which has no name of its own, where it rises as a time does. Whole
    /// numbers that are no instants count rows, perhaps every tenth of them.
    fn index(&self) -> Option<Found> {
        const NAMES: [&str; 3] = ["unnamed: 0", "index", "__index_level_0__"];
        let named = |name: &String| NAMES.contains(&name.to_lowercase().as_str());
        let unnamed =
            self.head.names.first().filter(|name| self.head.named && *name == "column_1").map(|_| 0);
        let column = unnamed.or_else(|| self.head.names.iter().position(named))?;
        let comma = self.dialect.decimal_comma;
        let found = self.column(column).ok()?;
        let cells = || self.cells(column).map(|cell| found.source.ns(0, |_| cell, comma));
        let rises = cells().zip(cells().skip(1)).all(|(a, b)| a.is_some() && a < b);
        let whole = |cell: &[u8]| number(cell, comma).is_some_and(|value| value.fract() == 0.0);
        let counts = !found.absolute && self.cells(column).all(whole);
        (rises && !counts).then(|| {
            let said = "has no name, and rises from row to row as a time does; else say --time or --rate";
            Found { doubt: Some(found.doubt.unwrap_or_else(|| said.to_owned())), ..found }
        })
    }

    /// The only column in a unit of time that rises as a time does, or the only one that is called no span.
    fn by_unit(&self) -> Option<Found> {
        let in_time = |column: &usize| {
            let label = &self.labels[*column];
            let alone = |other: &Label| std::ptr::eq(label, other) || other.key != label.key;
            let is_joint = label.is_joint && !(label.is_weak && self.labels.iter().all(alone));
            !is_joint && label.stated.is_some_and(|unit| unit.measure == Measure::Time)
        };
        let rises = |column: usize| Some((column, self.rising(column)?));
        let mut all: Vec<_> = (0..self.labels.len()).filter(in_time).filter_map(rises).collect();
        if all.len() > 1 {
            all.retain(|(column, _)| !self.is_span(*column));
        }
        let (Some((_, found)), true) = (all.pop(), all.is_empty()) else { return None };
        let said = "is the only one in a unit of time that rises from row to row; else say --time or --rate";
        Some(Found { doubt: Some(said.to_owned()), ..found })
    }
}
