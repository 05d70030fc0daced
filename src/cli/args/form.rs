//! The form of a result, by option or by the ending of its file.

use std::path::Path;

/// At most one of these.
#[derive(Debug, clap::Args)]
#[group(multiple = false)]
#[expect(clippy::struct_excessive_bools, reason = "flags of a command line, of which one at most is given")]
pub struct ReportFormat {
    /// One JSON document, as schemas/report.v2.schema.json in the repository describes it
    #[arg(long)]
    pub json: bool,

    /// The transitions as comma-separated values
    #[arg(long)]
    pub csv: bool,

    /// The report as Markdown
    #[arg(long)]
    pub markdown: bool,

    /// One page for a browser: verdict, plots that zoom, every table; needs no network
    #[arg(long)]
    pub html: bool,
}

impl ReportFormat {
    /// The form that was asked for, else that of the file's ending.
    #[must_use]
    pub fn or_of(&self, file: Option<&Path>) -> Self {
        let Self { json, csv, markdown, html } = *self;
        let ends = |with: &str| !(json || csv || markdown || html) && ends(file, with);
        Self {
            json: json || ends("json"),
            csv: csv || ends("csv"),
            markdown: markdown || ends("md"),
            html: html || ends("html"),
        }
    }
}

/// Whether the name of a file has an ending.
pub(super) fn ends(file: Option<&Path>, with: &str) -> bool {
    file.and_then(Path::extension).is_some_and(|ending| ending.eq_ignore_ascii_case(with))
}
