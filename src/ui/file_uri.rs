//! Addresses of files as desktops copy them: `file:///home/me/my%20part.k`.

use std::path::PathBuf;

use percent_encoding::percent_decode_str;

/// The path of a `file:` address on this computer, which may also be called `localhost`. `None` for any other
/// text, an address on another computer among them.
pub(super) fn path_of(text: &str) -> Option<PathBuf> {
    let rest = text.strip_prefix("file:")?;
    let path = match rest.strip_prefix("//") {
        Some(rest) => {
            let (host, path) = rest.split_at(rest.find('/')?);
            let is_here = host.is_empty() || host.eq_ignore_ascii_case("localhost");
            is_here.then_some(path)?
        }
        None => rest,
    };
    if !path.starts_with('/') {
        return None;
    }
    of_bytes(percent_decode_str(path).collect())
}

#[cfg(unix)]
fn of_bytes(bytes: Vec<u8>) -> Option<PathBuf> {
    use std::os::unix::ffi::OsStringExt as _;
    Some(std::ffi::OsString::from_vec(bytes).into())
}

/// Before the letter of a drive stands a slash.
#[cfg(not(unix))]
fn of_bytes(bytes: Vec<u8>) -> Option<PathBuf> {
    let path = String::from_utf8(bytes).ok()?;
    let drive = path.strip_prefix('/').filter(|rest| {
        let mut chars = rest.chars();
        chars
            .next()
            .is_some_and(|letter| letter.is_ascii_alphabetic())
            && chars.next() == Some(':')
    });
    Some(drive.unwrap_or(&path).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_of_this_computer_are_paths() {
        let path = |text| path_of(text).map(|path| path.display().to_string());
        for text in [
            "file:///a/my%20part%25.k",
            "file://localhost/a/my%20part%25.k",
            "file://LocalHost/a/my part%25.k",
            "file:/a/my%20part%25.k",
        ] {
            assert_eq!(path(text).as_deref(), Some("/a/my part%.k"), "{text}");
        }
        for text in [
            "file://server/a.k",
            "file://localhost",
            "file:a.k",
            "/file:/a.k",
            "https://localhost/a.k",
            "",
        ] {
            assert_eq!(path(text), None, "{text}");
        }
    }
}
