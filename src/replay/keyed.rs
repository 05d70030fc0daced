//! Rows of tables by their keys: a document holds the key, a program the row.

use std::{fmt, ops::Deref};

use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

/// A row that a key names.
pub trait Keyed: Sized + 'static {
    /// Its key, as in documents.
    fn key(&self) -> &'static str;

    /// Every row of its table that a document may name.
    fn rows() -> Vec<&'static Self>;
}

/// A row of a table; its key in a document.
#[derive(Debug)]
pub struct Row<R: 'static>(pub &'static R);

impl<R: Keyed> Row<R> {
    /// The row of a key.
    pub fn find(key: &str) -> Option<Self> {
        R::rows().into_iter().find(|row| row.key() == key).map(Self)
    }
}

impl<R> Clone for Row<R> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<R> Copy for Row<R> {}

impl<R> Deref for Row<R> {
    type Target = R;

    fn deref(&self) -> &R {
        self.0
    }
}

impl<R: Keyed> PartialEq for Row<R> {
    fn eq(&self, other: &Self) -> bool {
        self.key() == other.key()
    }
}

impl<R: Keyed> fmt::Display for Row<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.key())
    }
}

impl<R: Keyed> Serialize for Row<R> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.key())
    }
}

impl<'de, R: Keyed> Deserialize<'de> for Row<R> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let key = String::deserialize(deserializer)?;
        Self::find(&key).ok_or_else(|| D::Error::custom(format!("no row has the key {key:?}")))
    }
}

/// Schemas do not list the keys, so that a row more changes none of them.
#[cfg(test)]
impl<R> schemars::JsonSchema for Row<R> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Key".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({ "type": "string", "pattern": "^[a-z]+([_-][a-z0-9]+)*$" })
    }
}
