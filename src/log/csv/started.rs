//! Instants of rows that count from one that stands above the table.

use super::{
    date::{DateForm, Part},
    number::nanoseconds,
    unit::FILETIME,
};

/// When a recording began, ns since 1970, and the zone of that.
#[derive(Debug, Clone, Copy)]
pub(super) struct Started {
    ns: i64,
    zone: &'static str,
}

impl Started {
    /// By a count of 100 ns since 1601, which is UTC.
    pub(super) fn of_filetime(cell: &[u8]) -> Option<Self> {
        let after = nanoseconds(cell, false, 1).map(i128::from)?.checked_mul(100)?;
        let ns = i64::try_from(FILETIME.zero_ns() + after).ok().filter(|ns| *ns > 0)?;
        Some(Self { ns, zone: "Z" })
    }

    /// By a day and a time of day, of no zone.
    pub(super) fn of_day(day: &str, time: &str) -> Option<Self> {
        // Digits beyond nanoseconds say nothing.
        let digits = time.find(['.', ',']).map_or(time.len(), |at| time.len().min(at + 10));
        let text = format!("{day} {}", time.get(..digits)?);
        let forms = DateForm::fitting(&std::iter::once(text.as_bytes()));
        let form = forms.iter().find(|form| form.part == Part::Local)?;
        Some(Self { ns: form.ns(text.as_bytes())?, zone: "" })
    }

    /// The instant that a time counts to from there, as a cell; `None` where it is no number, or is one from elsewhere on.
    pub(super) fn at(self, cell: &[u8], decimal_comma: bool, unit_ns: i64) -> Option<Vec<u8>> {
        const LONGEST_NS: i64 = 1_000_000_000_000_000_000;
        let after_ns = nanoseconds(cell, decimal_comma, unit_ns)?;
        let at = chrono::DateTime::from_timestamp_nanos(self.ns.saturating_add(after_ns));
        let text = at.format("%Y-%m-%d %H:%M:%S%.9f").to_string() + self.zone;
        (after_ns.abs() < LONGEST_NS).then(|| text.into_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_count_from_the_instant_above_them() {
        let text = |started: Option<Started>, cell: &str, comma, unit_ns| {
            String::from_utf8(started.unwrap().at(cell.as_bytes(), comma, unit_ns).unwrap()).unwrap()
        };
        let utc = Started::of_filetime(b"133944808000000000");
        assert_eq!(text(utc, "20", false, 1_000_000), "2025-06-15 17:06:40.020000000Z");
        let local = Started::of_day("2025/06/15", "15:06:40,5000000000000000000");
        assert_eq!(text(local, "0,25", true, 1_000_000_000), "2025-06-15 15:06:40.750000000");
        assert!(Started::of_day("soon", "now").is_none() && Started::of_filetime(b"7").is_none());
        assert_eq!(local.unwrap().at(b"3800000000", false, 1_000_000_000), None);
    }
}
