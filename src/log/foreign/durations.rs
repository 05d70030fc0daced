//! Columns of durations. Parquet has whole numbers for them; what one counts stands in the schema of Arrow that its writers
//! put beside the table.

use std::collections::BTreeMap;

use base64::{Engine as _, engine::general_purpose::STANDARD};

/// Key of that schema in the metadata of a table.
pub(super) const SCHEMA: &str = "ARROW:schema";

/// A union says by this number that a type is one of durations.
const DURATION: u8 = 18;
/// What its units are, ns: s, ms, us, ns. One that is not written is the second.
const UNITS_NS: [i64; 4] = [1_000_000_000, 1_000_000, 1_000, 1];
const USUAL_UNIT: u16 = 1;

/// Nanoseconds of one, by the names of columns of durations; none of a schema that is not understood.
pub(super) fn units_ns(schema: &str) -> BTreeMap<String, i64> {
    let bytes = STANDARD.decode(schema).unwrap_or_default();
    // The length of the message stands before it, since some version behind a mark.
    let start = if bytes.starts_with(&[0xFF; 4]) { 8 } else { 4 };
    Flat(bytes.get(start..).unwrap_or_default()).durations().unwrap_or_default()
}

/// A message in the layout of flatbuffers. Places lie in the bytes; who points elsewhere points at nothing.
struct Flat<'a>(&'a [u8]);

impl Flat<'_> {
    fn durations(&self) -> Option<BTreeMap<String, i64>> {
        let message = self.pointed(0)?;
        let schema = self.pointed(self.field(message, 2)?)?;
        let fields = self.pointed(self.field(schema, 1)?)?;
        let count = usize::try_from(self.u32(fields)?).ok()?;
        let places = (0..count.min(self.0.len() / 4)).map(|at| self.pointed(fields + 4 + 4 * at));
        let mut found = BTreeMap::new();
        for field in places {
            found.extend(field.and_then(|field| self.duration(field)));
        }
        Some(found)
    }

    /// The name and the unit of a column, if it is one of durations.
    fn duration(&self, field: usize) -> Option<(String, i64)> {
        let kind = self.0.get(self.field(field, 2)?)?;
        let of = self.pointed(self.field(field, 3)?).filter(|_| *kind == DURATION)?;
        let unit = self.field(of, 0).map_or(Some(USUAL_UNIT), |at| self.u16(at))?;
        let name = self.pointed(self.field(field, 0)?)?;
        let length = usize::try_from(self.u32(name)?).ok()?;
        let name = self.0.get(name + 4..)?.get(..length)?;
        Some((String::from_utf8(name.to_vec()).ok()?, *UNITS_NS.get(usize::from(unit))?))
    }

    /// Where a field of a table lies; `None` if the table has none.
    fn field(&self, table: usize, number: usize) -> Option<usize> {
        let back = i64::from(self.u32(table)?.cast_signed());
        let places =
            usize::try_from(i64::try_from(table).ok()? - back).ok().filter(|at| *at < self.0.len())?;
        let at = 4 + 2 * number;
        let written = at + 2 <= usize::from(self.u16(places)?);
        let place = self.u16(places + at).filter(|place| written && *place > 0)?;
        Some(table + usize::from(place))
    }

    /// What a place points at, which says how far away that is.
    fn pointed(&self, at: usize) -> Option<usize> {
        at.checked_add(usize::try_from(self.u32(at)?).ok()?).filter(|at| *at < self.0.len())
    }

    fn u32(&self, at: usize) -> Option<u32> {
        Some(u32::from_le_bytes(*self.0.get(at..)?.first_chunk()?))
    }

    fn u16(&self, at: usize) -> Option<u16> {
        Some(u16::from_le_bytes(*self.0.get(at..)?.first_chunk()?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As pyarrow writes it for `time: duration[us]`, `boom_set_deg: halffloat`, `boom_act_deg: halffloat`.
    const OF_THREE: &str = "/////+AAAAAQAAAAAAAKAAwABgAFAAgACgAAAAABBAAMAAAACAAIAAAABAAIAAAABAAAAAMAAACAAAAAOAAAAAQAAACc////AAABAxAAAAAgAAAABAAAA\
         AAAAAAMAAAAYm9vbV9hY3RfZGVnAAAAAND////M////AAABAxAAAAAkAAAABAAAAAAAAAAMAAAAYm9vbV9zZXRfZGVnAAAAAAQABAAEAAAAEAAUAAgABg\
         AHAAwAAAAQABAAAAAAAAESEAAAABwAAAAEAAAAAAAAAAQAAAB0aW1lAAAGAAgABgAGAAAAAAACAA==";

    #[test]
    fn a_schema_names_its_durations_and_a_broken_one_none() {
        assert_eq!(units_ns(OF_THREE), BTreeMap::from([("time".to_owned(), 1_000)]));
        let whole = STANDARD.decode(OF_THREE).unwrap();
        for at in 0..whole.len() {
            assert!(units_ns(&STANDARD.encode(&whole[..at])).len() <= 1);
            for byte in [0, 1, 0x7F, 0xFF] {
                let mut broken = whole.clone();
                broken[at] = byte;
                let _ = units_ns(&STANDARD.encode(&broken));
            }
        }
        assert!(units_ns("no base64").is_empty() && units_ns("").is_empty());
    }
}
