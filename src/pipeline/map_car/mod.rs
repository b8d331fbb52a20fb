//! Many stamped parts onto one crash model: each finds its crash parts, these are mapped part by part, and one
//! deck includes all results.

mod group;
mod record;
mod together;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

pub use record::{CAR_COLUMNS, CarCopy, CarReason, CarRecord, CarRow, CarState};

use super::PipelineError;
use super::error::unless_cancelled;
use super::find_parts::{Fit, FoundParts, Presence, find_parts, guessed_units};
use super::load::{LoadSettings, LoadedPart, load, same_parts_line};
use super::map::{
    DefaultThickness, LEAST_AREA, MapRecipe, NewStates, car_copies, check_shells, elements_path,
};
use super::match_parts::MatchRecipe;
use super::names::file_name;
use super::units::PairUnits;
use super::write_file::{write_file, write_file_unless_cancelled};
use crate::assess::Verdict;
use crate::formats::keyword::rename::name_lines;
use crate::formats::keyword::write::keyword_line;
use crate::formats::model::ReadFile;
use crate::geometry::Similarity;
use crate::mapping::Status;
use crate::monitor::Monitor;
use crate::report::html::CarReport;
use crate::report::{DIRECTION, build_id};
use crate::role::PerRole;
use crate::text::Lengths;
use group::{CONFLICT, Group, Made, groups};
use together::Given;

/// A stamped file and how it is read.
#[derive(Debug, Clone)]
pub struct StampedFile {
    /// Where it is.
    pub path: PathBuf,
    /// Parts, unit, folders of includes.
    pub settings: LoadSettings,
    /// Factor on its stresses, if one was given.
    pub stress_factor: Option<f64>,
}

/// How a car is mapped.
#[derive(Debug, Clone)]
pub struct CarRecipe {
    /// The matches.
    pub matching: MatchRecipe,
    /// The mappings; their factors on stresses are those of the stamped files.
    pub map: MapRecipe,
    /// 16 columns a number instead of 10.
    pub is_large: bool,
    /// Thickness of elements without values.
    pub default_thickness: DefaultThickness,
    /// Where everything is written.
    pub folder: PathBuf,
    /// Whether a page with pictures is written for every mapping.
    pub has_pages: bool,
}

/// Files that a car's mapping writes into its folder, for the check before the work.
pub fn car_files(stamped: &[StampedFile], folder: &Path, has_pages: bool) -> Vec<PathBuf> {
    let mut files = vec![folder.join(MASTER)];
    if has_pages {
        files.push(folder.join(REPORT));
    }
    for stem in stems(stamped) {
        let deck = folder.join(format!("{stem}.k"));
        files.push(elements_path(&deck));
        files.push(deck);
        if has_pages {
            files.push(folder.join(format!("{stem}.html")));
        }
    }
    files
}

/// The deck that includes the others.
pub const MASTER: &str = "mapped.k";
/// The page about all parts.
const REPORT: &str = "report.html";

/// A name for the files of each stamped part, no two the same.
fn stems(stamped: &[StampedFile]) -> Vec<String> {
    let reserved = [MASTER, REPORT].map(|name| stem_of(Path::new(name)));
    let mut taken: BTreeSet<String> = reserved.into_iter().collect();
    // The deck, and the one with its elements beside it.
    let both = |stem: &str| {
        let beside = stem_of(&elements_path(Path::new(&format!("{stem}.k"))));
        [stem.to_lowercase(), beside.to_lowercase()]
    };
    let mut name = |file: &StampedFile| {
        let stem = stem_of(&file.path);
        let mut numbered = (2..).map(|n| format!("{stem}_{n}"));
        let mut free = stem.clone();
        while both(&free).iter().any(|stem| taken.contains(stem)) {
            free = numbered.next().unwrap_or_default();
        }
        taken.extend(both(&free));
        free
    };
    stamped.iter().map(&mut name).collect()
}

fn stem_of(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default();
    stem.to_string_lossy().into_owned()
}

/// A stamped part with its place on the car.
struct Claim {
    /// What the stamped part was read from.
    files: Vec<ReadFile>,
    ids: Vec<u64>,
    pose: Similarity,
    verdict: Verdict,
    /// Whether the match is good but for errors of the reader.
    is_good: bool,
    fit: Fit,
    /// How many tolerances the surfaces differ by, where the right part is perhaps not there.
    doubt: Option<f64>,
}

/// Finds the crash parts of every stamped file, maps them and writes the results into `recipe.folder`: states
/// and elements of each group of parts, a deck that includes all of them, and pages if these are wanted.
///
/// Stamped parts that claim the same crash part are mapped onto it together. A file that cannot be read or
/// that fits nothing is a row of the record, and where nothing is mapped at all no deck is written; an error is only
/// what concerns all: a cancel request, or that the deck that includes them cannot be written.
pub fn map_car(
    crash: &LoadedPart,
    stamped: &[StampedFile],
    recipe: &CarRecipe,
    monitor: &Monitor,
) -> Result<CarRecord, PipelineError> {
    check_shells(crash, std::iter::empty())?;
    let mut rows: Vec<CarRow> = stamped.iter().map(|file| CarRow::new(&file.path)).collect();
    record::tell_apart(&mut rows);
    let claims = claims(crash, stamped, (recipe, &mut rows), monitor)?;
    let stems = stems(stamped);
    let mut included = Vec::new();
    let mut new_states = NewStates::default();
    for members in groups(&claims) {
        monitor.check()?;
        let group = Group {
            crash,
            members: members
                .iter()
                .map(|at| (&stamped[*at], &claims[at]))
                .collect(),
            stems: members.iter().map(|at| &stems[*at][..]).collect(),
        };
        match unless_cancelled(group.map_and_write(recipe, monitor))? {
            Ok(made) => {
                let all = members.iter().zip(&made.given).zip(&made.unread);
                for ((&at, given), unread) in all {
                    let unread = unread.iter().cloned();
                    rows[at].reasons.extend(unread.map(CarReason::Unread));
                    match given {
                        Some(given) => take(&mut rows[at], &made, (given, claims[&at].doubt)),
                        None => rows[at].reasons.push(CarReason::Displaced),
                    }
                }
                included.extend(made.files);
                new_states.add(&made.new_states);
            }
            Err(error) => {
                let why = CarReason::Failed(error.to_string());
                let failed = |at: &usize| rows[*at].reasons.push(why.clone());
                members.iter().for_each(failed);
            }
        }
    }
    let copies = copies(crash, stamped, (recipe, &new_states), monitor)?;
    let record = CarRecord {
        build: build_id(),
        schema: "shapematch.map-car/1",
        direction: DIRECTION.to_owned(),
        crash: crash.path.display().to_string(),
        rows,
        copies,
    };
    // A deck without anything mapped would pass for a result.
    if !included.is_empty() {
        let master = master(&record, crash, &included);
        write_file(&recipe.folder.join(MASTER), master.as_bytes())?;
    }
    if recipe.has_pages {
        let page = car_page(&record, crash);
        write_file(&recipe.folder.join(REPORT), page.as_bytes())?;
    }
    Ok(record)
}

/// Finds the crash parts of every stamped file.
fn claims(
    crash: &LoadedPart,
    stamped: &[StampedFile],
    (recipe, rows): (&CarRecipe, &mut [CarRow]),
    monitor: &Monitor,
) -> Result<BTreeMap<usize, Claim>, PipelineError> {
    let mut claims: BTreeMap<usize, Claim> = BTreeMap::new();
    for (at, (file, row)) in stamped.iter().zip(rows).enumerate() {
        monitor.check()?;
        let found = load(&file.path, &file.settings, monitor).and_then(|part| {
            row.tools_left_out = part.tools_left_out();
            let parts = PerRole::new(crash, &part);
            if same_parts_line(parts).is_some() {
                row.reasons.push(CarReason::SameFile);
                return Ok(None);
            }
            let still = Similarity::identity();
            let found = find_parts(parts, &recipe.matching, &still, monitor)?;
            if found.is_none() {
                row.reasons.push(CarReason::NoPart);
                let unit = guessed_units(parts, monitor)?;
                row.reasons.extend(unit.map(CarReason::OtherUnit));
            }
            let lengths = Lengths::new(PairUnits::of(parts.map(Some)).lengths);
            Ok(found.map(|found| (found, part.model.files.clone(), lengths)))
        });
        match unless_cancelled(found)? {
            Ok(Some((found, files, lengths))) => {
                let claim = claim(row, &found, files, lengths);
                claims.extend(claim.map(|claim| (at, claim)));
            }
            Ok(None) => {}
            Err(error) => row.reasons.push(CarReason::Failed(error.to_string())),
        }
    }
    Ok(claims)
}

/// Writes copies of the crash files that hold states which the new ones take the place of, if that was asked for.
fn copies(
    crash: &LoadedPart,
    stamped: &[StampedFile],
    (recipe, new_states): (&CarRecipe, &NewStates),
    monitor: &Monitor,
) -> Result<Vec<CarCopy>, PipelineError> {
    let mut copies = Vec::new();
    if !recipe.map.options.replace_states {
        return Ok(copies);
    }
    let taken = car_files(stamped, &recipe.folder, true);
    let beside = recipe.folder.join(MASTER);
    for copy in car_copies(crash, new_states, &beside, &taken, monitor)? {
        write_file_unless_cancelled(&copy.path, &copy.bytes, monitor)?;
        copies.extend(copy.replaces.map(|replaces| CarCopy {
            file: file_name(&copy.path),
            replaces: replaces.display().to_string(),
        }));
    }
    Ok(copies)
}

/// Puts what was found into the row; `None` where that says that the right part is not there.
fn claim(
    row: &mut CarRow,
    found: &FoundParts,
    files: Vec<ReadFile>,
    lengths: Lengths,
) -> Option<Claim> {
    if let Presence::Absent { parts, gauge } = &found.presence {
        row.reasons.push(CarReason::Absent(parts.clone()));
        row.reasons.extend(gauge.map(CarReason::Gauge));
        return None;
    }
    let run = &found.found.run;
    row.crash_parts = found.found.part.chosen_part_ids();
    row.crash_from_stamped = Some(run.crash_from_stamped.to_rows());
    row.verdict = Some(run.assessment.verdict);
    row.rms = Some(run.assessment.coverage.rmse());
    if run.assessment.verdict != Verdict::Good {
        row.reasons.push(CarReason::Pose);
        let why = run.assessment.sentences(lengths).into_iter().next();
        row.reasons.extend(why.map(CarReason::Match));
    }
    if !found.rivals.is_empty() {
        row.reasons.push(CarReason::Rivals(found.rivals.clone()));
    }
    Some(Claim {
        files,
        ids: row.crash_parts.clone(),
        pose: run.crash_from_stamped,
        verdict: run.assessment.verdict,
        is_good: run.assessment.verdict_as_read() == Verdict::Good,
        fit: found.found.fit(),
        doubt: match found.presence {
            Presence::Doubtful(times) => Some(times),
            _ => None,
        },
    })
}

/// Puts what was mapped into the row of a part.
fn take(row: &mut CarRow, made: &Made, (given, doubt): (&Given, Option<f64>)) {
    let record = &made.record;
    let conflict = record.area_share(Status::Conflict);
    if conflict > CONFLICT {
        row.reasons.push(CarReason::Conflict(conflict));
    }
    if given.area <= 0.0 {
        row.reasons.push(CarReason::GivesNothing);
        return;
    }
    row.reasons.extend(doubt.map(CarReason::Doubtful));
    row.title.clone_from(&made.title);
    row.mapped_area = Some(given.area);
    row.thickness = Some(given.thickness).filter(|t| t.is_finite());
    row.files.clone_from(&made.files);
    row.page.clone_from(&made.page);
    if record.mapped_area < LEAST_AREA {
        row.reasons.push(CarReason::Area(record.mapped_area));
    }
    let twin = made.mirrored_twin.as_ref();
    row.reasons
        .extend(twin.map(|pose| CarReason::MirrorImage(pose.to_rows())));
    let by_solver = made.by_solver.iter().cloned();
    row.reasons.extend(by_solver.map(CarReason::MappedBySolver));
    if made.n_old_states > 0 {
        row.reasons.push(CarReason::OldStates(made.n_old_states));
    }
    let bare = made.bare.iter().cloned();
    row.reasons.extend(bare.map(CarReason::Bare));
    if let Some(ratio) = given.thickness_ratio {
        row.reasons.push(CarReason::Thickness(ratio));
    }
    row.state = if row.reasons.is_empty() {
        CarState::Sure
    } else {
        CarState::Check
    };
}

/// The deck that includes the results of all parts.
fn master(record: &CarRecord, crash: &LoadedPart, included: &[String]) -> String {
    let mut text = format!(
        "{}$ forming results mapped onto {}\n",
        keyword_line(crash.model.layout_of_include()),
        crash.file_name()
    );
    for row in &record.rows {
        let [file, part, state, ..] = row.cells();
        let onto = match part.as_str() {
            "" => String::new(),
            part => format!(" on part {part}"),
        };
        text.push_str(&format!("$ {file}{onto}: {state}\n"));
    }
    text.push_str(&format!(
        "$ Take the elements that the included files define out of the crash deck.\n$ {}\n",
        record.build
    ));
    for copy in &record.copies {
        text.push_str(&format!("$ {}\n", copy.text()));
    }
    for name in included {
        let lines = name_lines(name).unwrap_or_else(|| vec![name.clone()]);
        text.push_str(&format!("*INCLUDE\n{}\n", lines.join("\n")));
    }
    text.push_str("*END\n");
    text
}

fn car_page(record: &CarRecord, crash: &LoadedPart) -> String {
    let n_of = |state| record.rows.iter().filter(|row| row.state == state).count();
    let states = [CarState::Sure, CarState::Check, CarState::None];
    let page = CarReport {
        build: record.build.clone(),
        crash: crash.file_name(),
        facts: states
            .map(|state| (state.label(), n_of(state).to_string()))
            .to_vec(),
        columns: CAR_COLUMNS,
        rows: record
            .rows
            .iter()
            .map(|row| (row.cells(), row.page.clone()))
            .collect(),
    };
    page.write()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::Memory;
    use crate::pipeline::load::load_from;

    /// A crash model of one element.
    fn crash(keyword: &str) -> LoadedPart {
        let mesh = "*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n3,0.,1.,0.\n*ELEMENT_SHELL\n1,1,1,2,3,3\n*END\n";
        let source = Memory::new().with("crash.k", format!("{keyword}{mesh}"));
        let settings = LoadSettings::default();
        load_from(&source, Path::new("crash.k"), &settings, &Monitor::silent()).unwrap()
    }

    fn record(rows: Vec<CarRow>) -> CarRecord {
        CarRecord {
            build: "build".to_owned(),
            schema: "",
            direction: String::new(),
            crash: "crash.k".to_owned(),
            rows,
            copies: Vec::new(),
        }
    }

    #[test]
    fn the_deck_that_includes_all_has_the_layout_of_the_crash_deck() {
        for keyword in ["*KEYWORD\n", "*KEYWORD I10=Y\n", "*KEYWORD LONG=Y\n"] {
            let text = master(&record(Vec::new()), &crash(keyword), &["a.k".to_owned()]);
            assert!(text.starts_with(keyword), "{text}");
            assert!(text.ends_with("*INCLUDE\na.k\n*END\n"), "{text}");
        }
    }

    #[test]
    fn no_two_files_have_one_name() {
        let stems_of = |names: &[&str]| {
            let file = |name: &&str| StampedFile {
                path: PathBuf::from(name),
                settings: LoadSettings::default(),
                stress_factor: None,
            };
            stems(&names.iter().map(file).collect::<Vec<_>>())
        };
        let names = ["p.dynain", "p_elements.dynain", "q/P.k", "mapped.k"];
        let expected = ["p", "p_elements_2", "P_2", "mapped_2"];
        assert_eq!(stems_of(&names), expected);
        assert_eq!(stems_of(&["p_elements.k", "p.k"]), ["p_elements", "p_2"]);
    }

    #[test]
    fn names_of_included_files_go_on_over_lines() {
        let record = record(vec![CarRow::new(Path::new("empty.dynain"))]);
        let names = ["n".repeat(200), "short.k".to_owned()];
        let text = master(&record, &crash("*KEYWORD\n"), &names);
        let joined = text.replace(" +\n", "");
        for name in &names {
            assert!(joined.contains(&format!("*INCLUDE\n{name}\n")), "{text}");
        }
        assert!(text.contains("\n$ empty.dynain: not mapped\n"), "{text}");
        let lines = text.lines().filter(|line| !line.starts_with('$'));
        assert_eq!(lines.map(str::len).max(), Some(80));
    }
}
