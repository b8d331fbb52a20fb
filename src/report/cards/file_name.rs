//! Names of files as cards hold them.

use super::CardError;
use crate::formats::keyword::rename::name_lines;

/// What keeps a deck from including a file of this name, in words after "its name"; `None` if
/// nothing does. A line of a deck that begins with `$` is a comment and with `*` a keyword, and a
/// name that ends with ` +` goes on in the next line.
pub fn file_name_fault(name: &str) -> Option<&'static str> {
    if name.is_empty() {
        Some("is empty")
    } else if name.chars().any(char::is_control) {
        Some("has a line break or another control character")
    } else if name.contains(char::REPLACEMENT_CHARACTER) {
        Some("is no Unicode text")
    } else if name.starts_with('$') {
        Some("begins with $, which makes a comment of it")
    } else if name.starts_with('*') {
        Some("begins with *, which makes a keyword of it")
    } else if name.starts_with('&') {
        Some("begins with &, which makes a parameter of it")
    } else if name.trim() != name {
        Some("begins or ends with a blank")
    } else if name.ends_with(" +") {
        Some("ends with \" +\", which continues it in the next line")
    } else if name_lines(name).is_none() {
        Some("has no room in three lines of 80 columns, which hold 236 characters")
    } else {
        None
    }
}

/// [`file_name_fault`] as an error.
pub fn check_file_name(name: &str) -> Result<(), CardError> {
    match file_name_fault(name) {
        None => Ok(()),
        Some(fault) => Err(CardError::FileName {
            name: name.to_owned(),
            fault,
        }),
    }
}
