//! The text of a file, whatever its encoding, and what else a file may be.

use std::borrow::Cow;

use encoding_rs::Encoding;

use super::{CsvError, dialect::head, word::foreign_words};

/// The first bytes of other kinds of files.
const OTHERS: [(&[u8], &str, &str); 4] = [
    (b"\x89MCAP0\r\n", "an MCAP log", "`hydrotrace report` reads it as it is"),
    (b"PK\x03\x04", "a spreadsheet or an archive", "save the sheet as CSV"),
    (b"\xd0\xcf\x11\xe0", "an old spreadsheet", "save the sheet as CSV"),
    (
        b"SQLite format 3\0",
        "an SQLite file, such as a ROS 2 bag",
        "`hydrotrace report` reads bags as they are",
    ),
];

/// Encodings of old programs: of China, Japan, Korea, Russia, Poland.
static OLD: [&Encoding; 5] = [
    encoding_rs::GB18030,
    encoding_rs::SHIFT_JIS,
    encoding_rs::EUC_KR,
    encoding_rs::WINDOWS_1251,
    encoding_rs::WINDOWS_1250,
];

/// Bytes in which a zero means that this is no text.
const LOOKED_AT: usize = 4096;

/// The text without its byte order mark; UTF-16 becomes UTF-8, everything else stays bytes.
pub(super) fn of_bytes<'a>(file: &str, bytes: &'a [u8]) -> Result<Cow<'a, [u8]>, CsvError> {
    let not_text = |found: String, fix| CsvError::NotText { file: file.to_owned(), found, fix };
    if let Some((_, what, fix)) = OTHERS.iter().find(|(magic, ..)| bytes.starts_with(magic)) {
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
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        old_encoding(bytes).map_or(Cow::Borrowed(bytes), |one| {
            match one.decode_without_bom_handling(bytes).0 {
                Cow::Borrowed(text) => Cow::Borrowed(text.as_bytes()),
                Cow::Owned(text) => Cow::Owned(text.into_bytes()),
            }
        })
    };
    // A recording that ends in zeros lost its power; one that begins with them is no text.
    if let Some(at) = memchr::memchr(0, text.get(..LOOKED_AT).unwrap_or(&text)) {
        let whole = text.iter().skip(at).all(|byte| *byte == 0);
        if !whole || at == 0 {
            let fix = "give a text file; if it is UTF-16, it needs its byte order mark";
            return Err(not_text(format!("byte {} is zero", at + 1), fix));
        }
    }
    Ok(text)
}

/// The encoding in which the head of a text holds the most words of headers; `None` for UTF-8, and for Western Europe,
/// whose letters are read as they are.
fn old_encoding(bytes: &[u8]) -> Option<&'static Encoding> {
    let head = head(bytes);
    let head = head.get(..LOOKED_AT).unwrap_or(head);
    if std::str::from_utf8(head).map_or_else(|error| error.error_len().is_none(), |_| true) {
        return None;
    }
    let score = |one: &'static Encoding| foreign_words(&one.decode_without_bom_handling(head).0);
    let least = score(encoding_rs::WINDOWS_1252);
    let all = OLD.iter().map(|one| (score(one), *one));
    // Of two that hold as many, the first.
    let best = all.reduce(|best, next| if next.0 > best.0 { next } else { best });
    best.filter(|(words, _)| *words > least).map(|(_, one)| one)
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
    fn headers_of_old_programs_are_told_by_their_words() {
        let texts = [
            (encoding_rs::GB18030, "时间(s),关节1规划角度(°),关节1实际角度(°)\n"),
            (encoding_rs::SHIFT_JIS, "時間[s],軸1 目標角度,軸1 実際角度\n"),
            (encoding_rs::EUC_KR, "시간,관절1 목표 각도,관절1 실제 각도\n"),
            (encoding_rs::WINDOWS_1251, "Время;Ось 1 задание;Ось 1 факт\n"),
        ];
        for (encoding, text) in texts {
            let bytes = encoding.encode(text).0;
            assert_eq!(of_bytes("a", &bytes).unwrap().as_ref(), text.as_bytes(), "{}", encoding.name());
        }
        let western = b"t;J1 Winkel [\xb0];Fl\xe8che mesur\xe9e\n";
        assert_eq!(of_bytes("a", western).unwrap().as_ref(), western);
    }

    #[test]
    fn a_binary_file_is_named() {
        let error = of_bytes("a", b"\x89MCAP0\r\nxyz").unwrap_err().to_string();
        assert!(error.contains("an MCAP log"), "{error}");
        assert!(of_bytes("a", b"t;q\0\x01\n").is_err());
        assert!(of_bytes("a", b"t;q\n1;2\n\0\0\0").is_ok());
    }
}
