//! The committed JSON Schemas are those of the types that they describe.

use schemars::{JsonSchema, generate::SchemaSettings};

/// Holds a file in `schemas/` to a type; with `UPDATE_SCHEMA` in the environment it is written anew.
pub(crate) fn is_committed<T: JsonSchema>(file: &str, title: &str) {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("schemas").join(file);
    let mut schema = SchemaSettings::draft2020_12().into_generator().into_root_schema_for::<T>();
    schema.insert("title".to_owned(), title.into());
    let text = serde_json::to_string_pretty(&schema).unwrap() + "\n";
    if std::env::var_os("UPDATE_SCHEMA").is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        committed == text,
        "run `UPDATE_SCHEMA=1 cargo test the_committed_schema` and look at the change of {file}"
    );
}
