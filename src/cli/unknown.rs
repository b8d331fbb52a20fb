//! A first word that is neither a file nor a command.

use std::ffi::OsStr;
use std::path::Path;

use clap::CommandFactory as _;
use clap::error::ErrorKind;

use super::Cli;

/// A command that differs by more letters was not meant; two that changed places are one.
const MOST_TYPOS: usize = 3;

/// Ends the program with wrong usage if a word is neither an existing file nor a command and looks like no file:
/// the window would open for it. A word with an extension or a folder is a file that is missing, which is told where
/// it is read.
pub fn refuse_unknown(word: Option<&OsStr>) {
    if let Some(text) = word.and_then(unknown) {
        Cli::command()
            .error(ErrorKind::InvalidSubcommand, text)
            .exit();
    }
}

/// Ends the program with wrong usage if a command is named beside an option of the window, which would be ignored.
pub fn refuse_window_options(cli: &Cli) {
    let options = [(cli.example, "--example"), (cli.realistic, "--realistic")];
    let given = options.into_iter().find(|(is_given, _)| *is_given);
    if let Some((_, option)) = given.filter(|_| cli.command.is_some()) {
        let text = format!("{option} opens the window and goes with no command");
        Cli::command()
            .error(ErrorKind::ArgumentConflict, text)
            .exit();
    }
}

fn unknown(word: &OsStr) -> Option<String> {
    let path = Path::new(word);
    let command = Cli::command();
    let mut names: Vec<&str> = command
        .get_subcommands()
        .map(|task| task.get_name())
        .collect();
    names.push("help");
    let is_file = path.exists() || path.extension().is_some() || path.components().count() != 1;
    let is_option = word.as_encoded_bytes().starts_with(b"-");
    if is_file || is_option || names.iter().any(|name| word == *name) {
        return None;
    }
    let word = word.to_string_lossy();
    let nearest = names
        .into_iter()
        .map(|name| (strsim::osa_distance(&word, name), name));
    let nearest = nearest
        .min()
        .filter(|(n, name)| *n <= MOST_TYPOS && *n < name.len());
    let meant = nearest.map_or_else(
        || "; shapematch help lists the commands".to_owned(),
        |(_, name)| format!("; did you mean {name}?"),
    );
    Some(format!("no such file or command: {word}{meant}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_that_are_no_file_and_no_command_are_refused_with_the_nearest_one() {
        let told = |word: &str| unknown(OsStr::new(word));
        assert_eq!(
            told("mapp").as_deref(),
            Some("no such file or command: mapp; did you mean map?")
        );
        assert!(told("mathc").is_some_and(|text| text.ends_with("did you mean match?")));
        assert!(told("frobnicate").is_some_and(|text| text.ends_with("lists the commands")));
        for known in [
            "map",
            "help",
            "--version",
            "missing.k",
            "folder/part",
            "src",
        ] {
            assert_eq!(told(known), None, "{known}");
        }
    }
}
