//! The text of a file, whatever its encoding, and what else a file may be.

use std::borrow::Cow;

use super::CsvError;
use crate::log::unread::unread;

/// Bytes in which a zero means that this is no text.
const LOOKED_AT: usize = 4096;

/// The text without its byte order mark; UTF-16 becomes UTF-8, everything else stays bytes.
pub(super) fn of_bytes<'a>(file: &str, bytes: &'a [u8]) -> Result<Cow<'a, [u8]>, CsvError> {
    let not_text = |found: String, fix| CsvError::NotText { file: file.to_owned(), found, fix };
    if let Some((what, fix)) = unread(bytes) {
        return Err(not_text(format!("it is {what}"), fix));
    }
    let wide = |rest: &[u8], of: fn([u8; 2]) -> u16| {
        let units = rest.chunks_exact(2).map(|pair| of([pair[0], pair[1]]));
        let text: String =
            char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect();
        text.into_bytes()
    };
    let text = if let Some(rest) = bytes.strip_prefix(b"\xff\xfe") {
        Cow::Owned(wide(rest, u16::from_le_bytes))
    } else if let Some(rest) = bytes.strip_prefix(b"\xfe\xff") {
        Cow::Owned(wide(rest, u16::from_be_bytes))
    } else {
        decoded(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes))
    };
    // A recording that ends in zeros lost its power; one that begins with them is no text.
    if let Some(at) = memchr::memchr(0, text.get(..LOOKED_AT).unwrap_or(&text)) {
        let whole = text.iter().skip(at).all(|byte| *byte == 0);
        if !whole || at == 0 {
            let fix = "give a text file; if it is UTF-16, it needs its byte order mark";
            return Err(not_text(format!("byte {} is zero", at + 1), fix));
        }
    }
    Ok(of_lines(text))
}

/// Text whose lines end as on old Macs, with `\r` alone, as lines that end with `\n`; other text as it is.
pub(in crate::log) fn of_lines(text: Cow<'_, [u8]>) -> Cow<'_, [u8]> {
    let ends = |end: u8| memchr::memchr(end, &text).is_some();
    if ends(b'\n') || !ends(b'\r') {
        return text;
    }
    text.iter().map(|byte| if *byte == b'\r' { b'\n' } else { *byte }).collect::<Vec<u8>>().into()
}

/// Text of an old encoding as UTF-8.
#[cfg(feature = "encodings")]
fn decoded(bytes: &[u8]) -> Cow<'_, [u8]> {
    super::encoding::of(bytes).map_or(Cow::Borrowed(bytes), |one| {
        match one.decode_without_bom_handling(bytes).0 {
            Cow::Borrowed(text) => Cow::Borrowed(text.as_bytes()),
            Cow::Owned(text) => Cow::Owned(text.into_bytes()),
        }
    })
}

#[cfg(not(feature = "encodings"))]
const fn decoded(bytes: &[u8]) -> Cow<'_, [u8]> {
    Cow::Borrowed(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_of_encodings_are_no_text() {
        assert_eq!(of_bytes("a", b"\xef\xbb\xbft;q").unwrap().as_ref(), b"t;q");
        assert_eq!(of_bytes("a", b"\xff\xfet\0;\0\xb0\0").unwrap().as_ref(), "t;°".as_bytes());
        assert_eq!(of_bytes("a", b"\xfe\xff\0t\0;").unwrap().as_ref(), b"t;");
    }

    #[test]
    fn a_binary_file_is_named() {
        let error = of_bytes("a", b"\x89MCAP0\r\nxyz").unwrap_err().to_string();
        assert!(error.contains("an MCAP log"), "{error}");
        assert!(of_bytes("a", b"t;q\0\x01\n").is_err());
        assert!(of_bytes("a", b"t;q\n1;2\n\0\0\0").is_ok());
    }
}
