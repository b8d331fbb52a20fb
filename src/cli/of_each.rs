//! Options that are given once for all stamped files or once for each.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use clap::Args;

use super::UsageError;
use super::numbers::positive;
use crate::pipeline::project::Project;
use crate::settings::exact;
use crate::text::counted;

/// Factors on the lengths of stamped files.
#[derive(Debug, Args)]
pub(super) struct LengthFactors {
    /// Factor on the stamped coordinates and thicknesses, for files in another length unit. Give one for all
    /// files or one for each.
    #[arg(long, value_name = "FACTOR", allow_negative_numbers = true, value_parser = positive)]
    stamped_length_factor: Vec<f64>,
}

impl LengthFactors {
    /// Refuses more or fewer factors than files.
    pub(super) fn check(&self, n_files: usize) -> anyhow::Result<()> {
        one_or_each(self.stamped_length_factor.len(), "length factor", n_files)
    }

    /// Refuses factors that are not those of a project whose poses are taken.
    pub(super) fn check_project(&self, project: &Project, path: &Path) -> anyhow::Result<()> {
        let expected = project.stamped_length_factors();
        let differs = |(file, factor): (usize, &f64)| self.of(file) != *factor;
        if !expected.iter().enumerate().any(differs) {
            return Ok(());
        }
        let option = |factor: &f64| format!("--stamped-length-factor {}", exact(*factor));
        let options: Vec<String> = expected.iter().map(option).collect();
        let text = format!(
            "the poses of {} stand for {}",
            path.display(),
            options.join(" ")
        );
        Err(UsageError(text).into())
    }

    /// The factor of a file.
    pub(super) fn of(&self, file: usize) -> f64 {
        let factor = of_file(&self.stamped_length_factor, file);
        factor.copied().unwrap_or(1.0)
    }
}

/// Factors on the stresses of stamped files.
#[derive(Debug, Args)]
pub(super) struct StressFactors {
    /// Factor on the stamped stresses, for files in another unit of stress. Without it stresses that are
    /// clearly in another unit than the crash deck's are refused. Give one for all files or one for each.
    #[arg(long, value_name = "FACTOR", allow_negative_numbers = true, value_parser = positive)]
    stress_factor: Vec<f64>,
}

impl StressFactors {
    /// Whether there are any.
    pub(super) fn is_given(&self) -> bool {
        !self.stress_factor.is_empty()
    }

    /// The factors as they were given.
    pub(super) fn given(&self) -> &[f64] {
        &self.stress_factor
    }

    /// The factors; more or fewer of them than files are refused.
    pub(super) fn checked(&self, n_files: usize) -> anyhow::Result<&[f64]> {
        one_or_each(self.stress_factor.len(), "stress factor", n_files)?;
        Ok(&self.stress_factor)
    }
}

/// Refuses a number of values that is neither one for all stamped files nor one for each.
pub(super) fn one_or_each(n_values: usize, what: &str, n_files: usize) -> anyhow::Result<()> {
    if n_values < 2 || n_values == n_files {
        return Ok(());
    }
    let text = format!(
        "{n_values} {what}s for {}; give one for all or one for each",
        counted(n_files, "stamped file")
    );
    Err(UsageError(text).into())
}

/// The places of the files without those that stand for one named before with the same choices, which would be mapped
/// onto itself. Tells every file that is named again.
pub(super) fn named_once<'a>(files: impl Iterator<Item = (&'a Path, String)>) -> Vec<usize> {
    let mut named: BTreeSet<PathBuf> = BTreeSet::new();
    let mut chosen: BTreeSet<(PathBuf, String)> = BTreeSet::new();
    let mut kept = Vec::new();
    for (at, (path, choices)) in files.enumerate() {
        let place = path.canonicalize();
        let place = place.unwrap_or_else(|_| path.to_path_buf());
        let is_known = !named.insert(place.clone());
        let is_kept = chosen.insert((place, choices));
        if is_kept {
            kept.push(at);
        }
        if is_known {
            let how_often = if is_kept {
                "twice, with other options"
            } else {
                "once"
            };
            log::warn!("{} is named twice and mapped {how_often}", path.display());
        }
    }
    kept
}

/// Of values that are given for each file those of the `kept` ones; one for all stays.
pub(super) fn of_kept<T: Clone>(values: &[T], kept: &[usize]) -> Vec<T> {
    if values.len() < 2 {
        return values.to_vec();
    }
    let of_kept = kept.iter().filter_map(|&file| values.get(file));
    of_kept.cloned().collect()
}

/// What was given for a file: one value for all, or one for each.
pub(super) fn of_file<T>(values: &[T], file: usize) -> Option<&T> {
    values.get(file).or_else(|| values.first())
}
