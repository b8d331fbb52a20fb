//! Text of any encoding: UTF-8, UTF-16 and the Windows code page of western Europe; line ends of
//! any system.

use std::borrow::Cow;

use memchr::memchr;

use super::FileBytes;

/// Bytes at the start of a file that tell its encoding and its line ends.
const HEAD: usize = 1 << 16;

/// What bytes 0x80 to 0x9F stand for in Windows-1252. The five that it leaves open stand for the
/// control characters of the same number, as in the WHATWG encoding standard.
const WINDOWS_1252: [char; 32] = [
    '€', '\u{81}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{8d}', 'Ž', '\u{8f}',
    '\u{90}', '‘', '’', '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{9d}', 'ž', 'Ÿ',
];

/// The text of some bytes: UTF-8 if they are that, else Windows-1252, which holds Latin-1. Never
/// fails and loses nothing.
pub(crate) fn decoded(bytes: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => Cow::Owned(bytes.iter().map(|&byte| windows_1252(byte)).collect()),
    }
}

fn windows_1252(byte: u8) -> char {
    match byte {
        0x80..=0x9f => WINDOWS_1252[usize::from(byte - 0x80)],
        _ => char::from(byte),
    }
}

/// A title or name for people: decoded, without blanks around it, and with every control
/// character as its visible picture, so that no title can steer a terminal.
pub(crate) fn shown(bytes: &[u8]) -> String {
    let text = decoded(bytes);
    text.trim().chars().map(visible).collect()
}

fn visible(c: char) -> char {
    match c {
        '\t' => ' ',
        '\0'..='\x1f' => char::from_u32(0x2400 + u32::from(c)).unwrap_or('\u{fffd}'),
        '\x7f' => '␡',
        _ if c.is_control() => '\u{fffd}',
        // Marks that turn the direction of what follows.
        '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => '\u{fffd}',
        _ => c,
    }
}

/// A text file as UTF-8 or single bytes with a newline at each line's end: UTF-16 is decoded, a
/// byte order mark dropped, and a carriage return alone (old Mac) becomes a newline. Other bytes,
/// also those of binary files, stay as they are. O(1) for an ordinary deck.
pub(crate) fn normalised(bytes: FileBytes) -> FileBytes {
    let mut bytes = match utf16_order(&bytes) {
        Some(order) => from_utf16(&bytes, order).into(),
        None => bytes,
    };
    if bytes.starts_with(b"\xef\xbb\xbf") {
        bytes = bytes[3..].into();
    }
    let head = &bytes[..bytes.len().min(HEAD)];
    let has_lone_returns = memchr(b'\r', head).is_some() && !head.contains(&0) && {
        let lone = |pair: &[u8]| pair[0] == b'\r' && pair[1] != b'\n';
        let n_lone = head.windows(2).filter(|pair| lone(pair)).count();
        n_lone > memchr::memchr_iter(b'\n', head).count()
    };
    if has_lone_returns {
        for at in 0..bytes.len() {
            if bytes[at] == b'\r' && bytes.get(at + 1) != Some(&b'\n') {
                bytes[at] = b'\n';
            }
        }
    }
    bytes
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum ByteOrder {
    Little,
    Big,
}

/// By the byte order mark; without one by the zero in every other byte that Latin text has.
fn utf16_order(bytes: &[u8]) -> Option<ByteOrder> {
    match bytes {
        // UTF-32 has the same mark and two zeros.
        [0xff, 0xfe, rest @ ..] if !rest.starts_with(&[0, 0]) => return Some(ByteOrder::Little),
        [0xfe, 0xff, ..] => return Some(ByteOrder::Big),
        _ => {}
    }
    let head = &bytes[..bytes.len().min(256) & !1];
    if head.len() < 8 {
        return None;
    }
    let is_text = |byte: u8| byte >= b'\t';
    let all = |zero: usize| {
        let mut pairs = head.chunks_exact(2);
        pairs.all(|pair| pair[zero] == 0 && is_text(pair[1 - zero]))
    };
    if all(1) {
        Some(ByteOrder::Little)
    } else {
        all(0).then_some(ByteOrder::Big)
    }
}

fn from_utf16(bytes: &[u8], order: ByteOrder) -> Vec<u8> {
    let units = bytes.chunks_exact(2).map(|pair| match order {
        ByteOrder::Little => u16::from_le_bytes([pair[0], pair[1]]),
        ByteOrder::Big => u16::from_be_bytes([pair[0], pair[1]]),
    });
    let mut text = String::with_capacity(bytes.len() / 2);
    text.extend(char::decode_utf16(units).map(|c| c.unwrap_or('\u{fffd}')));
    text.into_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_that_are_not_utf_8_are_windows_1252() {
        assert_eq!(decoded("Blech größer".as_bytes()), "Blech größer");
        assert_eq!(decoded(b"Blech gr\xf6\xdfer \x80\x96"), "Blech größer €–");
        // Every byte has a character of its own, so nothing is lost.
        let all: Vec<u8> = (0..=255).collect();
        let text: std::collections::BTreeSet<char> = decoded(&all).chars().collect();
        assert_eq!(text.len(), 256);
    }

    #[test]
    fn control_characters_are_shown_and_not_obeyed() {
        assert_eq!(shown(b"  \x1b[31mred\x07 "), "␛[31mred␇");
        assert_eq!(shown("a\u{202e}b".as_bytes()), "a\u{fffd}b");
    }

    #[test]
    fn utf_16_is_decoded_with_and_without_its_mark() {
        let text = "*KEYWORD\n*TITLE\nTür\n*NODE\n";
        let units = || text.encode_utf16();
        let little: Vec<u8> = units().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = units().flat_map(u16::to_be_bytes).collect();
        let marked = |mark: &[u8], bytes: &[u8]| normalised([mark, bytes].concat().into()).to_vec();
        assert_eq!(marked(b"\xff\xfe", &little), text.as_bytes());
        assert_eq!(marked(b"\xfe\xff", &big), text.as_bytes());
        let plain = |bytes: &[u8]| normalised(bytes[..40].into()).to_vec();
        // Twenty units, one of which takes two bytes.
        assert_eq!(plain(&little), &text.as_bytes()[..21]);
        assert_eq!(plain(&big), &text.as_bytes()[..21]);
        assert_eq!(marked(b"\xef\xbb\xbf", b"v 0 0 0\n"), b"v 0 0 0\n");
    }

    #[test]
    fn carriage_returns_alone_end_lines() {
        let done = |text: &str| String::from_utf8(normalised(text.into()).to_vec()).unwrap();
        assert_eq!(done("*NODE\r1,2\r*END\r"), "*NODE\n1,2\n*END\n");
        assert_eq!(done("*NODE\r\n1,2\r\n"), "*NODE\r\n1,2\r\n");
        assert_eq!(done("*NODE\n1,2\rx\n3\n"), "*NODE\n1,2\rx\n3\n");
        let binary = [0u8, 13, 1, 13, 2, 13, 3];
        assert_eq!(normalised(binary.to_vec().into())[..], binary);
    }
}
