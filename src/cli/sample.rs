//! `shapematch sample`: writes a generated pair of parts.

use std::process::ExitCode;

use anyhow::Context as _;

use super::args::SampleArgs;
use super::{UsageError, print};
use crate::pipeline::write_file::write_file_in_new_folder;
use crate::samples::{self, SamplePart, SampleSettings, SampleVariant};

/// Generates the pair and writes its files.
pub fn run(args: &SampleArgs) -> anyhow::Result<ExitCode> {
    if args.list {
        print(&list())?;
        return Ok(ExitCode::SUCCESS);
    }
    let folder = args.folder.as_deref().context("no folder was given")?;
    let files = if args.bundled {
        samples::bundled()
    } else if args.realistic {
        samples::realistic()
    } else {
        samples::files(&pair(args)?)
    };
    for file in files {
        let path = folder.join(file.name);
        write_file_in_new_folder(&path, &file.bytes)?;
        print(&format!("{}\n", path.display()))?;
    }
    Ok(ExitCode::SUCCESS)
}

fn pair(args: &SampleArgs) -> anyhow::Result<samples::SamplePair> {
    let Some(part) = SamplePart::from_name(&args.part) else {
        return unknown("sample part", &args.part);
    };
    let Some(variant) = SampleVariant::from_name(&args.variant) else {
        return unknown("variant", &args.variant);
    };
    let settings = SampleSettings {
        part,
        variant,
        seed: args.seed,
        ..SampleSettings::default()
    };
    Ok(samples::generate(&settings))
}

fn unknown<T>(what: &str, name: &str) -> anyhow::Result<T> {
    let text = format!("unknown {what} {name:?}; `shapematch sample --list` lists them");
    Err(UsageError(text).into())
}

fn list() -> String {
    let mut text = String::from("Parts:\n");
    for part in SamplePart::ALL {
        text.push_str(&format!("  {:<17} {}\n", part.name(), part.title()));
    }
    text.push_str("Variants:\n");
    for variant in SampleVariant::ALL {
        text.push_str(&format!("  {:<17} {}\n", variant.name(), variant.help()));
    }
    text
}
