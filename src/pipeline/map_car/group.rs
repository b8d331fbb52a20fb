//! Stamped parts that share crash parts, mapped and written together.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::together::{Given, given, that_give_way};
use super::{CarRecipe, Claim, StampedFile};
use crate::formats::Selection;
use crate::geometry::Similarity;
use crate::mapping::Status;
use crate::monitor::Monitor;
use crate::pipeline::PipelineError;
use crate::pipeline::find_parts::mirrored_twin;
use crate::pipeline::load::{LoadedPart, load, prepare};
use crate::pipeline::map::{
    LEAST_AREA, MapOutput, MapRecipe, MapRecord, MapRun, NewStates, PlacedPart, PoseOrigin,
    WriteKind, bare_elements, deck_comments, file_lines, map_parts, map_record, map_report,
    mapped_by_solver, write_mapping,
};
use crate::pipeline::names::file_name;
use crate::pipeline::write_file::write_files_unless_cancelled;
use crate::role::PerRole;

/// Stamped parts that lie on the same elements by more than this share of the area are in conflict.
pub(super) const CONFLICT: f64 = 0.02;

/// What was made of the stamped parts of one group.
pub(super) struct Made {
    pub record: MapRecord,
    pub title: String,
    /// What each stamped part gives; `None` of one that gave way to one that fits better.
    pub given: Vec<Option<Given>>,
    pub files: Vec<String>,
    pub page: Option<String>,
    /// Elements with old states that are not replaced.
    pub n_old_states: usize,
    pub new_states: NewStates,
    /// Cards of the crash deck that let the solver map onto these parts.
    pub by_solver: Vec<String>,
    /// What of each stamped file could not be read or is doubtful.
    pub unread: Vec<Vec<String>>,
    /// Elements that lack a quantity which others have.
    pub bare: Vec<String>,
    /// The pose of the mirror image, where that lies on what a part alone leaves of the crash parts.
    pub mirrored_twin: Option<Similarity>,
}

/// Stamped parts that share a crash part, in the order they were named.
pub(super) fn groups(claims: &BTreeMap<usize, Claim>) -> Vec<Vec<usize>> {
    let mut groups: Vec<(BTreeSet<u64>, Vec<usize>)> = Vec::new();
    for (&at, claim) in claims {
        let mut ids: BTreeSet<u64> = claim.ids.iter().copied().collect();
        let mut members = vec![at];
        groups.retain_mut(|(of_group, others)| {
            let is_apart = of_group.is_disjoint(&ids);
            if !is_apart {
                ids.append(of_group);
                members.append(others);
            }
            is_apart
        });
        members.sort_unstable();
        groups.push((ids, members));
    }
    groups.sort_by(|a, b| a.1.cmp(&b.1));
    groups.into_iter().map(|(_, members)| members).collect()
}

/// Stamped parts that are mapped together.
pub(super) struct Group<'a> {
    pub crash: &'a LoadedPart,
    pub members: Vec<(&'a StampedFile, &'a Claim)>,
    /// Names for the files of each member.
    pub stems: Vec<&'a str>,
}

/// What of a group was mapped.
struct Together<'a> {
    /// Which of the members.
    members: Vec<usize>,
    placed: Vec<PlacedPart<'a>>,
    run: MapRun,
}

impl Group<'_> {
    /// Maps what stays of the group and writes it.
    pub fn map_and_write(
        &self,
        recipe: &CarRecipe,
        monitor: &Monitor,
    ) -> Result<Made, PipelineError> {
        let crash = self.crash_parts(monitor)?;
        let stamped = self.members.iter().map(|(file, claim)| {
            // Read again, so that never more than one group is held.
            let part = load(&file.path, &file.settings, monitor)?;
            // The pose belongs to what it was found for.
            match part.model.changed_since(&claim.files) {
                Some(path) => Err(PipelineError::Changed(path.to_path_buf())),
                None => Ok(part),
            }
        });
        let stamped: Vec<LoadedPart> = stamped.collect::<Result<_, _>>()?;
        let Together {
            members,
            placed,
            run,
        } = self.map_those_that_stay(&crash, &stamped, &recipe.map, monitor)?;
        if run.is_empty() {
            return Err(PipelineError::NothingMapped);
        }
        let given = given(&run, monitor)?;
        // Of equal shares that of the first.
        let most = (0..given.len()).rev().max_by(|a, b| {
            let [a, b] = [a, b].map(|at| given[*at].area);
            a.total_cmp(&b)
        });
        let stem = self.stems[members[most.unwrap_or(0)]];
        let output = MapOutput {
            kind: WriteKind::Include,
            path: recipe.folder.join(format!("{stem}.k")),
            is_large: recipe.is_large,
            default_thickness: recipe.default_thickness,
            // Those of all parts together.
            has_copies: false,
        };
        let comments = deck_comments(&crash, &placed);
        let files = write_mapping(&run, &crash, &output, &comments, monitor)?;
        let record = map_record(&run, &crash, &placed, Some(&files), None, monitor)?;
        let page = recipe.has_pages.then(|| format!("{stem}.html"));
        let report = match &page {
            Some(name) => {
                let report = map_report(&run, &record, &crash, None, monitor)?;
                Some((recipe.folder.join(name), report))
            }
            None => None,
        };
        let report = report.iter().map(|(path, text)| (&**path, text.as_bytes()));
        let made = files.files.iter().map(|file| (&*file.path, &*file.bytes));
        let made: Vec<_> = made.chain(report).collect();
        write_files_unless_cancelled(&made, monitor)?;
        let mirrored_twin = match &stamped[..] {
            [alone] => Self::twin_of(alone, &crash, &run, (recipe, monitor))?,
            _ => None,
        };
        Ok(Made {
            title: titles(&crash),
            given: (0..stamped.len())
                .map(|at| Some(given[members.iter().position(|member| *member == at)?]))
                .collect(),
            files: files
                .files
                .iter()
                .map(|file| file_name(&file.path))
                .collect(),
            n_old_states: if recipe.map.options.replace_states {
                0
            } else {
                files.n_old_states
            },
            new_states: files.new_states,
            by_solver: mapped_by_solver(&crash),
            unread: stamped
                .iter()
                .map(|part| file_lines(part, &recipe.map.options))
                .collect(),
            bare: bare_elements(&run, &placed),
            mirrored_twin,
            record,
            page,
        })
    }

    /// Maps all members together, or where some lie in the place of others that fit better, these alone.
    fn map_those_that_stay<'a>(
        &self,
        crash: &LoadedPart,
        stamped: &'a [LoadedPart],
        recipe: &MapRecipe,
        monitor: &Monitor,
    ) -> Result<Together<'a>, PipelineError> {
        let all: Vec<usize> = (0..stamped.len()).collect();
        let together = self.map_members(all, (crash, stamped), recipe, monitor)?;
        let mapped = &together.run.mapped;
        if mapped.area_share(Status::Conflict, &together.run.target.mesh) <= CONFLICT {
            return Ok(together);
        }
        let mut stay = together.members.clone();
        let all: Vec<_> = stay
            .iter()
            .map(|at| (&stamped[*at], self.members[*at].1))
            .collect();
        let mut give_way = that_give_way(crash, &all).into_iter();
        stay.retain(|_| !give_way.next().unwrap_or(false));
        if stay.len() == stamped.len() {
            return Ok(together);
        }
        self.map_members(stay, (crash, stamped), recipe, monitor)
    }

    fn map_members<'a>(
        &self,
        members: Vec<usize>,
        (crash, stamped): (&LoadedPart, &'a [LoadedPart]),
        recipe: &MapRecipe,
        monitor: &Monitor,
    ) -> Result<Together<'a>, PipelineError> {
        let place = |at: &usize| {
            let claim = self.members[*at].1;
            PlacedPart {
                part: &stamped[*at],
                crash_from_stamped: claim.pose,
                origin: PoseOrigin::Match {
                    verdict: claim.verdict,
                },
            }
        };
        let placed: Vec<PlacedPart<'_>> = members.iter().map(place).collect();
        let mut mapping = recipe.clone();
        // They are given for all files or for none.
        let factors = members.iter().map(|at| self.members[*at].0.stress_factor);
        mapping.stress_factors = factors.flatten().collect();
        Ok(Together {
            run: map_parts(crash, &placed, &mapping, monitor)?,
            placed,
            members,
        })
    }

    /// The pose of the mirror image of a part that is alone, where that lies on what it leaves of the crash parts.
    fn twin_of(
        alone: &LoadedPart,
        crash: &LoadedPart,
        run: &MapRun,
        (recipe, monitor): (&CarRecipe, &Monitor),
    ) -> Result<Option<Similarity>, PipelineError> {
        if run.mapped.mapped_area(&run.target.mesh) >= LEAST_AREA {
            return Ok(None);
        }
        let parts = PerRole::new(crash, alone);
        mirrored_twin(parts, &run.poses[0], &recipe.matching, monitor)
    }

    /// The crash model with the parts of all members chosen.
    fn crash_parts(&self, monitor: &Monitor) -> Result<LoadedPart, PipelineError> {
        let claimed = self.members.iter().flat_map(|(_, claim)| &claim.ids);
        let ids: BTreeSet<u64> = claimed.copied().collect();
        let mut settings = self.crash.settings.clone();
        settings.selection = Selection::Parts(ids.into_iter().collect());
        let model = Arc::clone(&self.crash.model);
        prepare(&self.crash.path, model, &settings, monitor)
    }
}

/// The titles of the chosen parts, each once.
fn titles(crash: &LoadedPart) -> String {
    let ids = crash.chosen_part_ids();
    let named = crash.model.parts.iter();
    let named = named.filter(|part| ids.contains(&part.id) && !part.title.is_empty());
    let mut titles: Vec<&str> = Vec::new();
    for part in named {
        if !titles.contains(&part.title.as_str()) {
            titles.push(&part.title);
        }
    }
    titles.join(", ")
}
