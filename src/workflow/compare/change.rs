//! Metrics before and after.

use std::collections::BTreeMap;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::replay::{Keyed, Row};

/// A quantity before and after, in its SI unit; `None` if it could not be measured.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Change {
    /// Mean over the runs before.
    pub before: Option<f64>,
    /// Mean over the runs after.
    pub after: Option<f64>,
    /// After minus before.
    pub difference: Option<f64>,
    /// After over before; 1 if both are zero, `None` if only the one before is, but for rounding.
    pub ratio: Option<f64>,
}

/// What is smaller than another by this factor is nothing beside it.
const ROUNDING: f64 = 1e-6;

impl Change {
    /// From both values.
    pub fn new(before: Option<f64>, after: Option<f64>) -> Self {
        let both = before.zip(after);
        let ratio = both.and_then(|(before, after)| {
            match (before.abs() > ROUNDING * after.abs(), after.abs() > 0.0) {
                (true, _) => Some(after / before),
                (false, false) => Some(1.0),
                (false, true) => None,
            }
        });
        Self { before, after, difference: both.map(|(before, after)| after - before), ratio }
    }

    /// From the values of the runs on each side.
    pub(super) fn of_runs(before: &[Option<f64>], after: &[Option<f64>]) -> Self {
        Self::new(mean(before), mean(after))
    }
}

/// The mean, if every value is there.
fn mean(values: &[Option<f64>]) -> Option<f64> {
    let all: Vec<f64> = values.iter().copied().collect::<Option<_>>()?;
    (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64)
}

/// The change of every row of a table that is compared; in documents a key each.
#[derive(Debug)]
pub struct Changes<R: Keyed>(Vec<(Row<R>, Change)>);

impl<R: Keyed> Changes<R> {
    /// From the change of each row.
    pub(super) fn of(change: impl Fn(&'static R) -> Change) -> Self {
        Self(R::rows().into_iter().map(|row| (Row(row), change(row))).collect())
    }

    /// That of a key; an unknown change for a key that is not compared.
    pub fn get(&self, key: &str) -> Change {
        self.0.iter().find(|(row, _)| row.key() == key).map(|(_, change)| *change).unwrap_or_default()
    }

    /// Every row with its change, in the order of the table.
    pub fn iter(&self) -> impl Iterator<Item = (&'static R, &Change)> {
        self.0.iter().map(|(row, change)| (row.0, change))
    }
}

impl<R: Keyed> Clone for Changes<R> {
    fn clone(&self) -> Self {
        Self(self.0.clone())
    }
}

impl<R: Keyed> PartialEq for Changes<R> {
    fn eq(&self, other: &Self) -> bool {
        self.0 == other.0
    }
}

impl<R: Keyed> Serialize for Changes<R> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(row, change)| (row.key(), change)))
    }
}

impl<'de, R: Keyed> Deserialize<'de> for Changes<R> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let changes = BTreeMap::<String, Change>::deserialize(deserializer)?;
        Ok(Self::of(|row| changes.get(row.key()).copied().unwrap_or_default()))
    }
}

/// Any key, so that a row more changes no schema.
#[cfg(test)]
impl<R: Keyed> schemars::JsonSchema for Changes<R> {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Changes".into()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let change = generator.subschema_for::<Change>();
        schemars::json_schema!({ "type": "object", "additionalProperties": change })
    }
}
