//! Dates and times of day, as people and machines write them.

use std::borrow::Cow;

use chrono::format::{Item, Parsed, StrftimeItems, parse};

use super::elapsed;

/// A way to write an instant.
#[derive(Debug, Clone)]
pub(super) struct DateForm {
    items: Vec<Item<'static>>,
    /// For a person, such as "dd.mm.yyyy hh:mm:ss".
    pub(super) name: &'static str,
    pub(super) part: Part,
    /// Digits of what stands behind the seconds where that counts ms, us or ns, without zeros before: `10:00:00:5`; else 0.
    pub(super) counts: usize,
}

/// The part of an instant that a text gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    Zoned,
    Local,
    Day,
    TimeOfDay,
    /// A span from a zero that is not said.
    Elapsed,
    /// The same as minutes and seconds alone.
    Minutes,
}

/// Tried in this order: of two that fit, the first is meant more often.
const FORMS: [(&str, &str, Part); 44] = [
    ("%Y-%m-%d %H:%M:%S%.f%#z", "yyyy-mm-dd hh:mm:ss with zone", Part::Zoned),
    ("%Y-%m-%d %H:%M:%S%.f", "yyyy-mm-dd hh:mm:ss", Part::Local),
    ("%Y/%m/%d %H:%M:%S%.f", "yyyy/mm/dd hh:mm:ss", Part::Local),
    ("%Y/%m/%d %H:%M:%S%.f%#z", "yyyy/mm/dd hh:mm:ss with zone", Part::Zoned),
    ("%Y-%m-%d-%H:%M:%S%.f", "yyyy-mm-dd-hh:mm:ss", Part::Local),
    ("%Y%m%d %H%M%S%.f", "yyyymmdd hhmmss", Part::Local),
    ("%Y%m%d %H%M%S%.f%#z", "yyyymmdd hhmmss with zone", Part::Zoned),
    ("%Y%m%d%H%M%S%3f", "yyyymmddhhmmssfff", Part::Local),
    ("%Y%m%d%H%M%S%.f", "yyyymmddhhmmss", Part::Local),
    ("%d.%m.%Y %H:%M:%S%.f", "dd.mm.yyyy hh:mm:ss", Part::Local),
    ("%d.%m.%Y %H:%M:%S%.f%#z", "dd.mm.yyyy hh:mm:ss with zone", Part::Zoned),
    ("%m/%d/%Y %I:%M:%S%.f %p %#z", "mm/dd/yyyy hh:mm:ss am/pm with zone", Part::Zoned),
    ("%d.%m.%y %H:%M:%S%.f", "dd.mm.yy hh:mm:ss", Part::Local),
    ("%a %b %d %H:%M:%S%.f %Y", "day mon dd hh:mm:ss yyyy", Part::Local),
    ("%d-%b-%Y %I:%M:%S%.f %p", "dd-mon-yyyy hh:mm:ss am/pm", Part::Local),
    ("%d-%b-%y %I:%M:%S%.f %p", "dd-mon-yy hh:mm:ss am/pm", Part::Local),
    ("%d-%b-%Y %H:%M:%S%.f", "dd-mon-yyyy hh:mm:ss", Part::Local),
    ("%d-%b-%y %H:%M:%S%.f", "dd-mon-yy hh:mm:ss", Part::Local),
    ("%d %b %Y %H:%M:%S%.f", "dd mon yyyy hh:mm:ss", Part::Local),
    ("%d. %b %Y %H:%M:%S%.f", "dd. mon yyyy hh:mm:ss", Part::Local),
    ("%d-%m-%Y %H:%M:%S%.f", "dd-mm-yyyy hh:mm:ss", Part::Local),
    ("%m/%d/%Y %I:%M:%S%.f %p", "mm/dd/yyyy hh:mm:ss am/pm", Part::Local),
    ("%d/%m/%Y %I:%M:%S%.f %p", "dd/mm/yyyy hh:mm:ss am/pm", Part::Local),
    ("%d/%m/%Y %H:%M:%S%.f", "dd/mm/yyyy hh:mm:ss", Part::Local),
    ("%m/%d/%Y %H:%M:%S%.f", "mm/dd/yyyy hh:mm:ss", Part::Local),
    ("%m/%d/%Y %H:%M:%S%.f%#z", "mm/dd/yyyy hh:mm:ss with zone", Part::Zoned),
    ("%m/%d/%y %I:%M:%S%.f %p", "mm/dd/yy hh:mm:ss am/pm", Part::Local),
    ("%d/%m/%y %I:%M:%S%.f %p", "dd/mm/yy hh:mm:ss am/pm", Part::Local),
    ("%d/%m/%y %H:%M:%S%.f", "dd/mm/yy hh:mm:ss", Part::Local),
    ("%m/%d/%y %H:%M:%S%.f", "mm/dd/yy hh:mm:ss", Part::Local),
    ("%y/%m/%d %H:%M:%S%.f", "yy/mm/dd hh:mm:ss", Part::Local),
    ("%H:%M:%S%.f", "hh:mm:ss", Part::TimeOfDay),
    ("%I:%M:%S%.f %p", "hh:mm:ss am/pm", Part::TimeOfDay),
    ("%Y-%m-%d", "yyyy-mm-dd", Part::Day),
    ("%Y/%m/%d", "yyyy/mm/dd", Part::Day),
    ("%d.%m.%Y", "dd.mm.yyyy", Part::Day),
    ("%d/%m/%Y", "dd/mm/yyyy", Part::Day),
    ("%m/%d/%Y", "mm/dd/yyyy", Part::Day),
    ("%d.%m.%y", "dd.mm.yy", Part::Day),
    ("%d/%m/%y", "dd/mm/yy", Part::Day),
    ("%m/%d/%y", "mm/dd/yy", Part::Day),
    ("%y-%m-%d", "yy-mm-dd", Part::Day),
    ("", elapsed::MINUTES, Part::Minutes),
    ("", elapsed::NAME, Part::Elapsed),
];

impl DateForm {
    /// The forms in which all of these cells are written.
    pub(super) fn fitting<'a>(cells: &(impl Iterator<Item = &'a [u8]> + Clone)) -> Vec<Self> {
        let known = FORMS.iter().map(|(pattern, name, part)| Self {
            items: StrftimeItems::new(pattern).collect(),
            name,
            part: *part,
            counts: 0,
        });
        known
            .filter(|form| {
                let mut cells = cells.clone().filter(|cell| !cell.trim_ascii().is_empty()).peekable();
                cells.peek().is_some() && cells.all(|cell| form.ns(cell).is_some())
            })
            .map(|form| form.counting(cells))
            .collect()
    }

    /// The form that counts ms, us or ns behind the seconds, where only that makes the cells rise.
    fn counting<'a>(self, cells: &(impl Iterator<Item = &'a [u8]> + Clone)) -> Self {
        let rises = |form: &Self| {
            let filled = cells.clone().filter(|cell| !cell.trim_ascii().is_empty());
            let mut ns = filled.map(|cell| form.ns(cell));
            let mut before = ns.next().flatten();
            before.is_some() && ns.all(|next| next >= std::mem::replace(&mut before, next))
        };
        if rises(&self) {
            return self;
        }
        let mut counting = [3, 6, 9].map(|counts| Self { counts, ..self.clone() }).into_iter();
        counting.find(rises).unwrap_or(self)
    }

    /// The instant in a cell, ns since 1970 (UTC where the text gives no zone), or since midnight
    /// for a time of day.
    pub(super) fn ns(&self, cell: &[u8]) -> Option<i64> {
        let text = of_plc(std::str::from_utf8(cell).ok()?.trim());
        let parsed = || {
            let mut parsed = Parsed::new();
            let plain = if self.counts > 0 { padded(&plain(text)?, self.counts)? } else { plain(text)? };
            parse(&mut parsed, &plain, self.items.iter()).ok()?;
            Some(parsed)
        };
        match self.part {
            Part::Zoned => parsed()?.to_datetime().ok()?.timestamp_nanos_opt(),
            Part::Local => parsed()?.to_naive_datetime_with_offset(0).ok()?.and_utc().timestamp_nanos_opt(),
            Part::Day => {
                parsed()?.to_naive_date().ok()?.and_hms_opt(0, 0, 0)?.and_utc().timestamp_nanos_opt()
            }
            Part::TimeOfDay => {
                let time = parsed()?.to_naive_time().ok()?;
                time.signed_duration_since(chrono::NaiveTime::MIN).num_nanoseconds()
            }
            Part::Elapsed => elapsed::elapsed_ns(text).filter(|_| !elapsed::is_minutes(text)),
            Part::Minutes => elapsed::elapsed_ns(text).filter(|_| elapsed::is_minutes(text)),
        }
    }
}

/// A date or a time of day without what IEC 61131-3 writes before it, as in `DT#2025-03-10-14:05:15.020`.
pub(super) fn of_plc(text: &str) -> &str {
    const KINDS: [&str; 8] = ["dt", "ldt", "date_and_time", "tod", "ltod", "time_of_day", "d", "date"];
    let is = |kind: &&(&str, &str)| KINDS.iter().any(|known| kind.0.eq_ignore_ascii_case(known));
    text.split_once('#').as_ref().filter(is).map_or(text, |(_, rest)| rest)
}

/// Whether a text begins as `Sat Aug 31` does.
fn begins_with_day(text: &str) -> bool {
    const DAYS: [&str; 7] = ["Mon ", "Tue ", "Wed ", "Thu ", "Fri ", "Sat ", "Sun "];
    DAYS.iter().any(|day| text.starts_with(day))
}

/// Whether a text has a time of day beside the name of a month, as `31-Aug-2024 10:59:50` does.
pub(super) fn names_month(text: &str) -> bool {
    text.contains(':')
        && text.split(|c: char| !c.is_alphabetic()).any(|word| month(word).is_some())
        && !DateForm::fitting(&std::iter::once(text.as_bytes())).is_empty()
}

/// The same text with a blank between date and time and a point before the fraction, which some
/// write as a comma, a semicolon or a third colon, or behind the half of the day: `2:23:05 PM;120`.
fn plain(text: &str) -> Option<String> {
    const LONGEST: usize = 48;
    let text = &*in_figures(text);
    if let Some((time, ms)) = text.rsplit_once(';')
        && let Some((time, half)) = time.rsplit_once(' ')
        && ["am", "pm"].iter().any(|known| half.eq_ignore_ascii_case(known))
    {
        return plain(&format!("{time}.{ms} {half}"));
    }
    let begins = text.starts_with(|c: char| c.is_ascii_digit()) || begins_with_day(text);
    if text.len() > LONGEST || !begins {
        return None;
    }
    let mut colons = 0;
    let mut zoned = false;
    let plain = text.char_indices().map(|(at, c)| match c {
        'T' | 't' | '_' if at >= 8 && !zoned && colons == 0 => ' ',
        ',' | ';' => '.',
        ':' if !zoned => {
            colons += 1;
            if colons == 3 { '.' } else { ':' }
        }
        '+' | '-' if colons >= 2 => {
            zoned = true;
            c
        }
        _ => c,
    });
    let plain: String = plain.collect();
    let zoned = |zone: &str| {
        let (name, offset) = zone.split_once(' ')?;
        let (time, own) = plain.rsplit_once(' ')?;
        own.eq_ignore_ascii_case(name).then(|| format!("{time}{offset}"))
    };
    Some(ZONES.split(',').find_map(zoned).unwrap_or(plain))
}

/// What clocks call their zones, and how far these are from UTC, each as it is most often meant; of those that are meant as often
/// otherwise (CST, IST, BST) none.
const ZONES: &str = "UTC Z,GMT Z,WET Z,WEST +01:00,CET +01:00,MEZ +01:00,CEST +02:00,MESZ +02:00,EET +02:00,EEST +03:00,MSK +03:00,\
    JST +09:00,KST +09:00,EST -05:00,EDT -04:00,CDT -05:00,MST -07:00,MDT -06:00,PST -08:00,PDT -07:00";

/// With so many digits behind the seconds; `None` if there are more.
fn padded(plain: &str, most: usize) -> Option<String> {
    let Some(at) = plain.rfind('.').filter(|at| plain[*at..].find(':').is_none()) else {
        return Some(plain.to_owned());
    };
    let (whole, behind) = plain.split_at(at + 1);
    let digits = behind.find(|c: char| !c.is_ascii_digit()).unwrap_or(behind.len());
    (digits <= most).then(|| format!("{whole}{:0>most$}{}", &behind[..digits], &behind[digits..]))
}

/// What the months are called, and first how a date form knows them.
const MONTHS: [&str; 12] = [
    "Jan january januar janvier janv enero ene gennaio gen januari",
    "Feb february februar février févr fevrier febrero febbraio februari",
    "Mar march märz mär mrz mars marzo maart mrt",
    "Apr april avril avr abril abr aprile",
    "May mai mayo maggio mag mei maj",
    "Jun june juni juin junio giugno giu",
    "Jul july juli juillet juil julio luglio lug",
    "Aug august août aout agosto ago augustus augusti",
    "Sep sept september septembre septiembre settembre",
    "Oct okt october oktober octobre octubre ottobre ott",
    "Nov november novembre noviembre",
    "Dec dez december dezember décembre déc diciembre dic dicembre",
];

/// The month that a word names, in three letters.
fn month(word: &str) -> Option<&'static str> {
    let word = word.to_lowercase();
    let names = |of: &&&str| of.split(' ').any(|name| name.eq_ignore_ascii_case(&word));
    MONTHS.iter().find(names).map(|of| &of[..3])
}

/// A date with its month in three letters of English, without a point behind, and with the signs of Chinese and Japanese as others write
/// them: `16. Okt. 2025` as `16. Oct 2025`.
fn in_figures(text: &str) -> Cow<'_, str> {
    if text.contains('年') {
        let sign = |c: char| match c {
            '年' | '月' => Some('-'),
            '時' | '时' | '分' => Some(':'),
            '日' | '秒' => None,
            other => Some(other),
        };
        return Cow::Owned(text.chars().filter_map(sign).collect());
    }
    let Some(begins) = text.find(char::is_alphabetic) else { return Cow::Borrowed(text) };
    let (before, rest) = text.split_at(begins);
    let (word, after) = rest.split_at(rest.find(|c: char| !c.is_alphabetic()).unwrap_or(rest.len()));
    let name = if word.len() > 2 { month(word) } else { None };
    let Some(name) = name else { return Cow::Borrowed(text) };
    let after = after.strip_prefix('.').filter(|after| after.starts_with(' ')).unwrap_or(after);
    Cow::Owned(format!("{before}{name}{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ns(text: &str) -> (i64, &'static str) {
        let forms = DateForm::fitting(&std::iter::once(text.as_bytes()));
        let form = forms.first().unwrap_or_else(|| panic!("{text}"));
        (form.ns(text.as_bytes()).unwrap(), form.name)
    }

    #[test]
    fn one_instant_in_every_spelling_is_one_instant() {
        const NOON_NS: i64 = 1_750_000_000_020_000_000;
        for text in [
            "2025-06-15T15:06:40.020Z",
            "2025-06-15 15:06:40,020",
            "2025-06-15T17:06:40.02+02:00",
            "2025-06-15T17:06:40.02+0200",
            "2025-06-15 15:06:40.020 UTC",
            "2025-06-15 17:06:40.020 CEST",
            "2025-06-15T11:06:40.020 EDT",
            "15.06.2025 17:06:40,020 MESZ",
            "2025/06/15 15:06:40.020",
            "15.06.2025 15:06:40,020",
            "15.06.2025 15:06:40:020",
            "15/06/2025 15:06:40.020",
            "06/15/2025 15:06:40.020",
            "06/15/2025 03:06:40.020 PM",
            "2025-06-15-15:06:40.020",
            "DT#2025-06-15-15:06:40.020",
            "LDT#2025-06-15-15:06:40.020",
            "20250615 150640.020",
            "20250615T150640.020Z",
            "15.06.25 15:06:40.020",
            "15-Jun-2025 15:06:40.020",
            "15-Jun-2025 03:06:40.020 PM",
            "15-Jun-25 3:06:40.020 pm",
            "15/06/25 15:06:40.020",
            "06/15/25 15:06:40.020",
            "06/15/25 03:06:40.020 PM",
            "Sun Jun 15 15:06:40.020 2025",
            "15-JUN-25 15:06:40,020",
            "20250615150640020",
            "20250615150640.02",
            "15 Jun 2025 15:06:40.020",
            "15. Juni 2025 15:06:40,020",
            "15 juin 2025 15:06:40.020",
            "2025年06月15日 15時06分40.020000秒",
        ] {
            assert_eq!(ns(text).0, NOON_NS, "{text}");
        }
    }

    #[test]
    fn ms_without_zeros_before_are_told_by_that_only_they_rise() {
        let ms = |cells: &[&'static str]| {
            let cells = || cells.iter().map(|cell| cell.as_bytes());
            let form = DateForm::fitting(&cells()).remove(0);
            let ms = cells().map(|cell| form.ns(cell).unwrap() % 1_000_000_000 / 1_000_000);
            (form.counts > 0, ms.collect::<Vec<_>>())
        };
        let rising = ["12.03.2024 10:00:00:0", "12.03.2024 10:00:00:5", "12.03.2024 10:00:00:10"];
        assert_eq!(ms(&rising), (true, vec![0, 5, 10]));
        assert_eq!(ms(&["10:00:00.98", "10:00:00.100", "10:00:01"]), (true, vec![98, 100, 0]));
        assert_eq!(ms(&["10:00:00.1", "10:00:00.15", "10:00:00.2"]), (false, vec![100, 150, 200]));
        let us = ["10:00:00.90000", "10:00:00.100000", "10:00:00.110000"];
        assert_eq!(ms(&us), (true, vec![90, 100, 110]));
        assert_eq!(ms(&["23:59:59.98", "00:00:00.1"]), (false, vec![980, 100]));
    }

    #[test]
    fn a_time_of_day_counts_from_midnight() {
        assert_eq!(ns("00:01:00,5"), (60_500_000_000, "hh:mm:ss"));
        assert_eq!(ns("00:01:00;500"), (60_500_000_000, "hh:mm:ss"));
        assert_eq!(ns("12:01:00.5 AM"), (60_500_000_000, "hh:mm:ss am/pm"));
        assert_eq!(ns("12:01:00 AM;500"), (60_500_000_000, "hh:mm:ss am/pm"));
    }

    #[test]
    fn what_is_no_date_has_no_form() {
        for text in [
            "", "12", "1.5", "20251315150640020", "1750000000020", "17500000000200000",
            "99.99.2025 10:00:00", "25:00:00", "zwei", "Sun Jun 16 15:06:40 2025", "15/13/25 15:06:40",
        ] {
            assert!(DateForm::fitting(&std::iter::once(text.as_bytes())).is_empty(), "{text}");
        }
    }
}
