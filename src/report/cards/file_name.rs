//! Names of files as cards hold them.

use super::CardError;

/// Most columns of a file name on cards.
const MAX_NAME: usize = 236;

/// What keeps a deck from including a file of this name, in words after "its name"; `None` if
/// nothing does. A line of a deck that begins with `$` is a comment and with `*` a keyword, and a
/// name that ends with ` +` goes on in the next line.
pub fn file_name_fault(name: &str) -> Option<&'static str> {
    if name.is_empty() {
        Some("is empty")
    } else if name.chars().any(char::is_control) {
        Some("has a line break or another control character")
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
    } else if name.chars().count() > MAX_NAME {
        Some("has more than 236 characters")
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

/// The lines of a deck that a file name takes, of at most 80 columns.
pub fn name_lines(name: &str) -> Vec<String> {
    let characters: Vec<char> = name.chars().collect();
    let (mut rest, mut lines) = (&characters[..], Vec::new());
    // The last line may be full; the others need two columns for the sign that they go on.
    while rest.len() > 80 {
        let (line, after) = rest.split_at(78);
        lines.push(line.iter().collect::<String>() + " +");
        rest = after;
    }
    lines.push(rest.iter().collect());
    lines
}
