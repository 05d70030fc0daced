//! The encoding of a table that is not in UTF-8.

use encoding_rs::Encoding;

use super::{dialect::head, word::foreign_words};

/// Encodings of old programs: of China, Japan, Korea, Russia, Poland.
static OLD: [&Encoding; 5] = [
    encoding_rs::GB18030,
    encoding_rs::SHIFT_JIS,
    encoding_rs::EUC_KR,
    encoding_rs::WINDOWS_1251,
    encoding_rs::WINDOWS_1250,
];

/// Bytes that are looked at.
const LOOKED_AT: usize = 4096;

/// The encoding in which the head of a text holds the most words of headers; `None` for UTF-8, and for Western Europe,
/// whose letters are read as they are.
pub(super) fn of(bytes: &[u8]) -> Option<&'static Encoding> {
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
    fn headers_of_old_programs_are_told_by_their_words() {
        let texts = [
            (encoding_rs::GB18030, "时间(s),关节1规划角度(°),关节1实际角度(°)\n"),
            (encoding_rs::SHIFT_JIS, "時間[s],軸1 目標角度,軸1 実際角度\n"),
            (encoding_rs::EUC_KR, "시간,관절1 목표 각도,관절1 실제 각도\n"),
            (encoding_rs::WINDOWS_1251, "Время;Ось 1 задание;Ось 1 факт\n"),
        ];
        for (encoding, text) in texts {
            let bytes = encoding.encode(text).0;
            assert_eq!(of(&bytes).map(Encoding::name), Some(encoding.name()), "{}", encoding.name());
        }
        let western = b"t;J1 Winkel [\xb0];Fl\xe8che mesur\xe9e\n";
        assert_eq!(of(western), None);
    }
}
