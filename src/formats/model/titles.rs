//! The original bytes of titles that are shown decoded.

use std::collections::BTreeMap;

use super::super::text;

/// From a title as it is shown to its bytes in the file, for titles that are not UTF-8 or hold
/// control characters. A deck that is written again gets these bytes.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct RawTitles {
    bytes_of: BTreeMap<String, Vec<u8>>,
}

impl RawTitles {
    /// The title as it is shown; its bytes are kept if they are others.
    pub(crate) fn add(&mut self, bytes: &[u8]) -> String {
        let shown = text::shown(bytes);
        if shown.as_bytes() != bytes.trim_ascii() {
            let bytes = bytes.trim_ascii().to_vec();
            self.bytes_of.entry(shown.clone()).or_insert(bytes);
        }
        shown
    }

    /// The bytes of a title in the file.
    pub fn bytes<'a>(&'a self, shown: &'a str) -> &'a [u8] {
        let kept = self.bytes_of.get(shown);
        kept.map_or(shown.as_bytes(), Vec::as_slice)
    }
}
