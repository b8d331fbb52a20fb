//! What a mapping warns about.

use std::collections::BTreeSet;

use super::ready::stress_unit_question;
use super::{MapFiles, MapRun, PlacedPart, PoseOrigin, mapped_by_solver};
use crate::formats::diagnostic::{DiagnosticKind, Severity};
use crate::formats::keyword::materials::is_known_law;
use crate::formats::model::Part;
use crate::mapping::{Facing, MapOptions, Quantities, SourcePart, Status};
use crate::pipeline::load::{LoadedPart, same_parts_line};
use crate::pipeline::units::scaled_pose;
use crate::registration::guess_unit;
use crate::role::PerRole;
use crate::settings::exact;
use crate::text::{counted, length, parts_by_id, share, trimmed};

/// The parts of a stamped file that have neither stresses nor strains, and no thickness but that of their
/// section; in words.
fn without_results(placed: &PlacedPart<'_>, shells: &[u32]) -> Option<String> {
    let model = &placed.part.model;
    let has_results = model.parts_with_results();
    let has_thickness =
        |shell: &&u32| (model.shell_extra(**shell)).is_some_and(|e| e.thickness != [0.0; 4]);
    let part_of = |shell: &u32| model.shells[*shell as usize].part;
    let formed = shells.iter().filter(has_thickness).map(part_of);
    let formed: BTreeSet<u32> = formed.collect();
    let all: BTreeSet<u32> = shells.iter().map(part_of).collect();
    let is_silent = |part: &&u32| !has_results[**part as usize] && !formed.contains(part);
    let silent: Vec<&Part> = (all.iter().filter(is_silent))
        .map(|&part| &model.parts[part as usize])
        .collect();
    let ids: Vec<u64> = silent.iter().map(|part| part.id).collect();
    let has_section = silent.iter().any(|part| part.thickness.is_some());
    let what_comes = if has_section {
        "crash elements that it alone covers get the thickness of its section and nothing else"
    } else {
        "nothing is mapped from there"
    };
    let name = placed.part.file_name();
    (!ids.is_empty()).then(|| {
        format!(
            "{name}: no forming results in {}; {what_comes}",
            parts_by_id(&ids)
        )
    })
}

/// What is to be told of a mapping, each in a sentence.
pub(super) fn warnings(
    run: &MapRun,
    crash: &LoadedPart,
    stamped: &[PlacedPart<'_>],
    files: Option<&MapFiles>,
) -> Vec<String> {
    let mut warnings = mapped_by_solver(crash);
    warnings.extend(unread_line(crash));
    warnings.extend(moved_nodes(crash));
    warnings.extend(nodes_off(crash));
    for placed in stamped {
        warnings.extend(nodes_off(placed.part));
        warnings.extend(scaled_pose(placed.part, placed.crash_from_stamped.scale));
        warnings.extend(same_parts_line(PerRole::new(crash, placed.part)));
        warnings.extend(file_lines(placed.part, &run.recipe.options));
    }
    warnings.extend(not_there(run));
    warnings.extend(bare_elements(run, stamped));
    let sources = stamped.iter().zip(&run.source_shells);
    warnings.extend(sources.filter_map(|(placed, shells)| without_results(placed, shells)));
    let sources = stamped.iter().zip(&run.sources);
    warnings.extend(sources.flat_map(|(placed, source)| left_out(placed, source)));
    warnings.extend(in_two_files(run, stamped));
    warnings.extend(of_elements(run));
    warnings.extend(other_unit(run, stamped));
    warnings.extend(stress_units(run, crash, stamped));
    warnings.extend(unscaled_history(run, stamped));
    warnings.extend(unknown_law(run));
    if let Some(ratio) = run.thickness_sums().unusual_ratio() {
        warnings.push(format!(
            "the mapped thickness is {} times that of the crash elements; another gauge or another unit?",
            length(ratio)
        ));
    }
    for gap in run.mapped.history.iter().flat_map(|h| &h.left_out) {
        let law = |law: &Option<String>| match law {
            Some(law) => format!("material {law}"),
            None => "an unknown material".to_owned(),
        };
        let hint = if gap.source.is_none() {
            " (--stamped-material names it)"
        } else {
            ""
        };
        warnings.push(format!(
            "history variables of {} are left out: they belong to {} in the stamped file{hint}, \
             the crash part has {}",
            counted(gap.n_elements, "element"),
            law(&gap.source),
            law(&gap.target)
        ));
    }
    let keeps_thickness =
        |files: &&MapFiles| files.n_composite > 0 && run.recipe.options.quantities.thickness;
    if let Some(files) = files.filter(keeps_thickness) {
        warnings.push(format!(
            "no thickness is written for {} with plies in the card (_COMPOSITE), whose own thicknesses stay",
            counted(files.n_composite, "element")
        ));
    }
    if let Some(files) = files {
        warnings.extend(files.lost_includes.clone());
        warnings.extend(old_states_warning(run, files));
    }
    warnings
}

/// Stamped files that hold the same elements, each with results that the other lacks, such as thickness and stresses:
/// an element takes its values from one file.
fn in_two_files(run: &MapRun, stamped: &[PlacedPart<'_>]) -> Vec<String> {
    let results = |source: &SourcePart| {
        let has_states = source.states.n_present() > 0;
        [
            has_thickness(source),
            has_states,
            source.strains.n_present() > 0,
        ]
    };
    let files: Vec<_> = (stamped.iter().zip(&run.sources))
        .map(|(placed, source)| (placed.part, source, results(source)))
        .collect();
    let mut told = Vec::new();
    for (number, (part, source, own)) in files.iter().enumerate() {
        for (other_part, other, theirs) in &files[number + 1..] {
            let mut both = own.iter().zip(theirs);
            let lacks_some = both.clone().any(|(own, theirs)| !own && *theirs);
            let has_some = both.any(|(own, theirs)| *own && !theirs);
            let is_same_mesh = source.mesh.corners() == other.mesh.corners()
                && source.mesh.positions() == other.mesh.positions();
            if lacks_some && has_some && is_same_mesh {
                told.push(format!(
                    "{} and {} hold the same elements with different results, of which each crash element takes those \
                     of one file; name a deck that includes both (*INCLUDE), the one with the thickness last",
                    part.file_name(),
                    other_part.file_name()
                ));
            }
        }
    }
    told
}

/// Whether an element of a stamped part has a thickness.
fn has_thickness(source: &SourcePart) -> bool {
    (0..source.thickness.len()).any(|element| source.mean_thickness(element).is_finite())
}

/// Says how many elements of a stamped file have no results because places of layers differ in too many ways.
fn left_out(placed: &PlacedPart<'_>, source: &SourcePart) -> Vec<String> {
    let of = |what: &str, n: usize| {
        (n > 0).then(|| {
            format!(
                "{}: {what} of {} are left out: places of layers through the thickness differ in more than 65,535 ways",
                placed.part.file_name(),
                counted(n, "element")
            )
        })
    };
    let lines = [
        of("stresses and plastic strains", source.states.n_left_out()),
        of("strains", source.strains.n_left_out()),
    ];
    lines.into_iter().flatten().collect()
}

/// Asks about the unit of a stamped file whose given pose puts it beside the crash part, from the sizes of both.
/// A match says so itself.
fn other_unit(run: &MapRun, stamped: &[PlacedPart<'_>]) -> Vec<String> {
    if run.mapped.mapped_area(&run.target.mesh) >= run.recipe.wanted_area() {
        return Vec::new();
    }
    let hint = |(placed, source): (&PlacedPart<'_>, &SourcePart)| {
        let is_given = placed.origin == PoseOrigin::Given && placed.crash_from_stamped.scale == 1.0;
        let ratio = run.target.mesh.area() / source.mesh.area();
        let unit = guess_unit(ratio.sqrt()).filter(|_| is_given)?;
        Some(format!(
            "{}: by its size in {}, and the crash part in {}? --stamped-length-factor {} would convert it",
            placed.part.file_name(),
            unit.source.plural(),
            unit.target.plural(),
            exact(unit.factor() * placed.part.settings.length_factor)
        ))
    };
    stamped.iter().zip(&run.sources).filter_map(hint).collect()
}

/// Asks about the unit of stresses where nothing tells it and their size is that of another unit than usual.
fn stress_units(run: &MapRun, crash: &LoadedPart, stamped: &[PlacedPart<'_>]) -> Vec<String> {
    if !run.recipe.options.quantities.stress {
        return Vec::new();
    }
    let crash_parts: BTreeSet<u32> = run.target.mesh.parts().iter().copied().collect();
    let crash_parts: Vec<u32> = crash_parts.into_iter().collect();
    let files = stamped.iter().zip(&run.sources).enumerate();
    let open = files.filter(|(file, _)| run.recipe.stress_factor(*file).is_none());
    open.filter_map(|(_, (placed, source))| {
        stress_unit_question(crash, &crash_parts, placed.part, source)
    })
    .collect()
}

/// Names the files whose history variables keep their numbers although their stresses were multiplied: which of
/// them are stresses, no file says.
fn unscaled_history(run: &MapRun, stamped: &[PlacedPart<'_>]) -> Vec<String> {
    let is_mapped = run.mapped.history.iter().any(|h| h.n_present() > 0);
    let files = stamped.iter().zip(&run.sources).enumerate();
    let files = files.filter(|(_, (_, source))| is_mapped && !source.history.is_empty());
    let told = files.filter_map(|(file, (placed, _))| {
        let given = run.recipe.stress_factor(file).unwrap_or(1.0);
        let includes = placed.part.model.files.iter();
        let mut factors = includes.map(|file| given * file.included_as.stress_factor);
        let factor = factors.find(|factor| *factor != 1.0)?;
        Some(format!(
            "{}: its stresses were multiplied by {}; history variables, and the tensors among them, keep their \
             numbers, because no file says which of them are stresses",
            placed.part.file_name(),
            trimmed(factor, 9)
        ))
    });
    told.collect()
}

/// Says that the material law given for the stamped parts is none of those that could be meant. Where history
/// variables are left out because of it, that is said instead.
fn unknown_law(run: &MapRun) -> Option<String> {
    let law = run.recipe.stamped_law.as_ref()?;
    let is_told = run.mapped.history.iter().any(|h| !h.left_out.is_empty());
    let is_there = run.target.laws.values().any(|known| known == law);
    (!is_told && !is_there && !is_known_law(law)).then(|| {
        format!(
            "--stamped-material {law} is a material law of no crash part that is mapped onto and none of those usual for \
             sheets"
        )
    })
}

/// What is to be told of the status of the elements and of where they lie.
fn of_elements(run: &MapRun) -> Vec<String> {
    let mut warnings = Vec::new();
    let mapped = &run.mapped;
    let area = mapped.mapped_area(&run.target.mesh);
    if area < run.recipe.wanted_area() {
        warnings.push(format!(
            "only {} of the crash part's area carries values; the status of the elements says why",
            share(area)
        ));
    }
    let count = |status: Status| mapped.counts()[status as usize];
    for (status, what) in [
        (
            Status::TwoLayers,
            "near two sheets that their normals do not tell apart",
        ),
        (Status::Conflict, "on two stamped parts"),
    ] {
        if count(status) > 0 {
            warnings.push(format!("{} {what}", counted(count(status), "element")));
        }
    }
    let wanted = run.recipe.options.quantities;
    let n_filled = count(Status::Filled);
    if n_filled > 0 && (wanted.stress || wanted.strain || wanted.history) {
        warnings.push(format!(
            "{} filled from neighbours: thickness and plastic strain alone, stresses there are 0",
            counted(n_filled, "element")
        ));
    }
    if area > 0.0 && mapped.facings.contains(&Facing::Mixed) {
        warnings.push(
            "normals of the two parts agree on no side; sheets that lie close are told apart by \
             distance alone, or by their normals with --signed yes"
                .to_owned(),
        );
    }
    if count(Status::Far) > 0 {
        warnings.push(format!(
            "the stamped part lies over {} farther than the largest distance; --max-distance sets it",
            counted(count(Status::Far), "element")
        ));
    }
    if mapped.n_distant > 0 {
        warnings.push(format!(
            "{} farther from the stamped part than half the distance within which it is looked for",
            counted(mapped.n_distant, "element")
        ));
    }
    warnings
}

/// What is to be told of the file of a stamped part: what could not be read, what is doubtful, and what is left
/// out.
pub(in crate::pipeline) fn file_lines(part: &LoadedPart, options: &MapOptions) -> Vec<String> {
    let local = options.quantities.strain.then(|| local_strains(part));
    let lines = [
        unread_line(part),
        moved_nodes(part),
        doubtful_line(part),
        repeated_elements(part),
        part.stacked_line(),
        local.flatten(),
    ];
    lines.into_iter().flatten().collect()
}

/// Says what of the file of a part could not be read; `None` if all could.
pub fn unread_line(part: &LoadedPart) -> Option<String> {
    let what = |n| {
        format!(
            "{} of what the file holds could not be read",
            counted(n, "piece")
        )
    };
    let unread = told_of(part, |kind| kind.severity() == Severity::Error, what);
    unread.or_else(|| {
        let is_cut_off = |kind| kind == DiagnosticKind::NoEnd;
        told_of(part, is_cut_off, |_| "its end may be missing".to_owned())
    })
}

/// Says that elements may hang on other nodes than they should.
fn moved_nodes(part: &LoadedPart) -> Option<String> {
    let what = |n| {
        let verb = if n == 1 { "is" } else { "are" };
        format!(
            "{} {verb} defined again at another place, and elements that belong to the second lie wrong",
            counted(n, "node")
        )
    };
    told_of(part, |kind| kind == DiagnosticKind::DuplicateNode, what)
}

/// Says that nodes lie off the mid-surface, which their elements are taken to lie in.
fn nodes_off(part: &LoadedPart) -> Option<String> {
    let what = |_| "nodes lie off the mid-surface".to_owned();
    told_of(part, |kind| kind == DiagnosticKind::OffMidSurface, what)
}

/// Says which results are taken though they may not be meant so.
fn doubtful_line(part: &LoadedPart) -> Option<String> {
    let what = |n| counted(n, "doubtful result");
    told_of(part, |kind| kind == DiagnosticKind::DoubtfulForming, what)
}

/// Says that results cannot be told apart.
fn repeated_elements(part: &LoadedPart) -> Option<String> {
    let what = |n| {
        let n = counted(n, "element");
        format!("{n} with an id that another one has, so that one of them alone gets the results")
    };
    told_of(part, |kind| kind == DiagnosticKind::DuplicateElement, what)
}

/// Says which strains are left out.
pub(super) fn local_strains(part: &LoadedPart) -> Option<String> {
    let what = |n| {
        let rest = match n {
            1 => "of its element is",
            _ => "of their elements are",
        };
        format!("{} in axes {rest} left out", counted(n, "strain"))
    };
    told_of(part, |kind| kind == DiagnosticKind::LocalStrains, what)
}

/// How many diagnostics of some kinds reading a part made, in words, with the first.
fn told_of(
    part: &LoadedPart,
    is_one: impl Fn(DiagnosticKind) -> bool,
    what: impl Fn(usize) -> String,
) -> Option<String> {
    let found = &part.model.diagnostics;
    let n: u64 = found
        .counts()
        .filter(|(kind, _)| is_one(*kind))
        .map(|(_, n)| n)
        .sum();
    let first = found.iter().find(|one| is_one(one.kind))?;
    Some(format!(
        "{}: {} ({first}); its diagnostics (tab Diagnostics, shapematch info) name each",
        part.file_name(),
        what(usize::try_from(n).unwrap_or(usize::MAX)),
    ))
}

/// Names quantities that were asked for one by one and that no stamped file holds.
fn not_there(run: &MapRun) -> Option<String> {
    let [_, named] = absent(run);
    (!named.is_empty() && run.recipe.options.quantities != Quantities::FULL).then(|| {
        format!(
            "{} were asked for, and no stamped file holds any",
            named.join(" and ")
        )
    })
}

/// The quantities that were asked for and that no stamped file holds: first those that every forming result has, then
/// those that many lack.
pub(super) fn absent(run: &MapRun) -> [Vec<&'static str>; 2] {
    let wanted = run.recipe.options.quantities;
    let sources = &run.sources;
    let no_thickness = wanted.thickness && !sources.iter().any(has_thickness);
    let no_states = sources.iter().all(|part| part.states.n_present() == 0);
    let no_strains = sources.iter().all(|part| part.strains.n_present() == 0);
    let no_history = sources.iter().all(|part| part.history.is_empty());
    let usual = [
        ("thicknesses", no_thickness),
        ("stresses", wanted.stress && no_states),
        ("plastic strains", wanted.plastic_strain && no_states),
    ];
    let further = [
        ("strains", wanted.strain && no_strains),
        ("history variables", wanted.history && no_history),
    ];
    let names = |all: &[(&'static str, bool)]| {
        let absent = all.iter().filter(|(_, is_absent)| *is_absent);
        absent.map(|(name, _)| *name).collect()
    };
    [names(&usual), names(&further)]
}

/// Says how many elements with other values have no thickness, and how many have no stress card, with the first
/// stamped element of each.
pub(in crate::pipeline) fn bare_elements(run: &MapRun, stamped: &[PlacedPart<'_>]) -> Vec<String> {
    let told = |what: &str, have_none: &str, bare: &[usize]| {
        let giver = run.giver(*bare.first()?);
        let first = giver.and_then(|(file, shell)| {
            let part = stamped.get(file)?.part;
            let id = part.model.shells.get(shell)?.id;
            Some(format!("; the first is shell {id} of {}", part.file_name()))
        });
        let verb = if bare.len() == 1 { "gets" } else { "get" };
        Some(format!(
            "{} {verb} other values but {what}: the stamped elements there have {have_none}{}",
            counted(bare.len(), "element"),
            first.unwrap_or_default()
        ))
    };
    let [no_thickness, no_state] = bare(run);
    let lines = [
        told("no thickness", "none above 0", &no_thickness),
        told("neither stresses nor plastic strains", "none", &no_state),
    ];
    lines.into_iter().flatten().collect()
}

/// The elements with other values that have no thickness, and those that have no stress card, where these were asked
/// for.
pub(super) fn bare(run: &MapRun) -> [Vec<usize>; 2] {
    let mapped = &run.mapped;
    // Rings that are filled have what their neighbours have.
    let is_mapped = |status: Status| status.has_values() && status != Status::Filled;
    let bare = |is_bare: &dyn Fn(usize) -> bool| -> Vec<usize> {
        let elements = mapped.elements.iter().enumerate();
        let bare =
            elements.filter(|(element, report)| is_mapped(report.status) && is_bare(*element));
        bare.map(|(element, _)| element).collect()
    };
    let thickness = &mapped.thickness;
    let no_thickness = |element: usize| thickness.get(element).is_some_and(|t| t.is_nan());
    let no_state = |element: usize| {
        let states = mapped.states.as_ref();
        states.is_some_and(|states| states.of(element).is_empty())
    };
    [bare(&no_thickness), bare(&no_state)]
}

/// What is to be told of states that the crash deck has already.
fn old_states_warning(run: &MapRun, files: &MapFiles) -> Option<String> {
    let (n_old, n_kept) = (files.n_old_states, files.n_kept_states);
    let replaces = run.recipe.options.replace_states;
    if replaces && n_kept > 0 {
        let (verb, them) = if n_kept == 1 {
            ("keeps", "it")
        } else {
            ("keep", "them")
        };
        return Some(format!(
            "{} {verb} the initial stresses or strains that the crash deck has, because none are mapped onto {them}",
            counted(n_kept, "element")
        ));
    }
    (!replaces && n_old > 0).then(|| {
        let verb = if n_old == 1 { "is" } else { "are" };
        format!(
            "{} of mapped elements {verb} in the crash deck already and would count beside the mapped ones; take \
             them out of it, or let --replace-states yes write copies without them",
            counted(n_old, "initial state")
        )
    })
}
