//! Contents that are not read here, by their first bytes, and what makes a log or a table of them.

use std::path::Path;

use crate::text::shell_argument;

/// What a file is, and what to do with it: `FILE` stands there for it, `STEM` for its name without the ending.
pub(super) type Unread = (&'static str, &'static str);

/// The first bytes of each.
const BINARY: [(&[u8], Unread); 20] = [
    (b"\x89MCAP0\r\n", ("an MCAP log", "`hydrotrace report` reads it as it is")),
    (
        b"SQLite format 3\0",
        (
            "an SQLite file, such as a ROS 2 bag",
            "bags are read as they are (feature sqlite), others by `sqlite3 -csv -header FILE 'SELECT * FROM TABLE' > STEM.csv`",
        ),
    ),
    (
        b"#ROSBAG",
        (
            "a ROS 1 bag",
            "`pip install rosbags`, then `rosbags-convert --src FILE --dst STEM --dst-storage mcap`",
        ),
    ),
    (b"MDF ", ("an MF4 recording", "`pip install asammdf`, then `asammdf` exports its channels as CSV")),
    (b"ULog", ("a PX4 ULog", "`pip install pyulog`, then `ulog2csv FILE` makes CSV of it")),
    (b"PK\x03\x04", ("a spreadsheet or an archive", "save the sheet as CSV, or unpack the archive")),
    (b"\xd0\xcf\x11\xe0", ("an old spreadsheet", "save the sheet as CSV")),
    (b"MATLAB 5.0 MAT-file", MATLAB),
    (b"MATLAB 7.3 MAT-file", MATLAB),
    (
        b"\x89HDF\r\n",
        (
            "an HDF5 file, such as a MATLAB file of version 7.3",
            "export the signals as CSV, in Python by `h5py` and `numpy.savetxt`",
        ),
    ),
    (
        b"\x93NUMPY",
        (
            "an array of NumPy",
            "`numpy.savetxt` makes CSV of what `numpy.load` reads, with names of its columns as `header`",
        ),
    ),
    (b"\x80\x02", PICKLE),
    (b"\x80\x03", PICKLE),
    (b"\x80\x04\x95", PICKLE),
    (b"\x80\x05\x95", PICKLE),
    (
        b"TDSm",
        (
            "a LabVIEW TDMS file",
            "`pip install npTDMS pandas`, then `as_dataframe().to_csv()` makes CSV of it",
        ),
    ),
    (b"LOGG", CAN),
    (b";$FILEVERSION=", CAN),
    (b"RRF2", ("a Rerun recording", "give the log that it was made of")),
    (
        b"version https://git-lfs.github.com/spec/v1",
        ("what git-LFS keeps in place of the file", "`git lfs pull` in its folder fetches the file itself"),
    ),
];

const MATLAB: Unread = ("a MATLAB file", "`writetimetable` or `writetable` makes CSV of its variables");

const CAN: Unread = (
    "a trace of a CAN bus",
    "what its frames hold stands in their DBC: `pip install python-can cantools`, then a line of Python each reads it (`can.LogReader`), \
     decodes it (`decode_message`) and writes CSV with a column a signal",
);

const PICKLE: Unread = (
    "a pickle of Python",
    "`pandas.read_pickle` and `to_csv` make CSV of a data frame, if you trust who sent it",
);

/// What begins with a mark such as `<?xml`, or has tags that end, is a page or a document, not a header in angle brackets.
const MARKUP: Unread = (
    "a page or a document of tags (HTML, XML)",
    "export what it shows as CSV, or save the file itself that a page links",
);

/// What a file is that is not read here; `None` of what may be a log or a table.
pub(super) fn unread(bytes: &[u8]) -> Option<Unread> {
    let binary = BINARY.iter().find(|(begins, _)| bytes.starts_with(begins)).map(|(_, unread)| *unread);
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    let has = |tag: &[u8]| text.windows(tag.len()).take(LOOKED_AT).any(|part| part == tag);
    let opens = text.strip_prefix(b"<").and_then(<[u8]>::first);
    let markup = match opens {
        Some(b'?' | b'!') => true,
        Some(byte) => byte.is_ascii_alphabetic() && (has(b"</") || has(b"/>")),
        None => false,
    };
    // As Vector and `candump` write it.
    let frames = text.starts_with(b"date ") && (has(b"\nbase hex") || has(b"\nbase dec"))
        || text.starts_with(b"(") && (has(b") can") || has(b") vcan"));
    binary.or(markup.then_some(MARKUP)).or(frames.then_some(CAN))
}

/// As many bytes tell whether tags end.
const LOOKED_AT: usize = 4096;

/// What to do with a file, with its path in the lines to type.
pub(super) fn with_path(fix: &str, path: impl AsRef<Path>) -> String {
    let path = path.as_ref();
    fix.replace("FILE", &shell_argument(path)).replace("STEM", &shell_argument(path.with_extension("")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contents_are_told_with_what_to_do_next() {
        for (bytes, fix) in [
            (&b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 92\n"[..], "git lfs pull"),
            (b"MATLAB 7.3 MAT-file, Platform", "writetimetable"),
            (b"\x93NUMPY\x01\0", "numpy.savetxt"),
            (b"\x80\x04\x95\xd4", "read_pickle"),
            (b"\x89HDF\r\n\x1a\n", "h5py"),
            (b"<!DOCTYPE html>\n", "as CSV"),
            (b"(1710253385.120000) can0 1A0#D0070000\n", "DBC"),
            (b"date Tue Mar 12 02:23:05.120 pm 2024\nbase hex  timestamps absolute\n", "DBC"),
            (b"<Rob TYPE=\"KUKA\"><AIPos A1=\"1\"/></Rob>\n", "as CSV"),
        ] {
            assert!(unread(bytes).is_some_and(|(_, said)| said.contains(fix)), "{fix}");
        }
        for bytes in [&b""[..], b"t;q\n0;1\n", b"<DATE>;<TIME>;<q>\n1;2;3\n", b"\x80\x04", b"<"] {
            assert_eq!(unread(bytes), None);
        }
        let line = with_path("a --src FILE --dst STEM", "my run/joint.bag");
        assert_eq!(line, "a --src 'my run/joint.bag' --dst 'my run/joint'");
    }
}
