//! Projects: saved and opened, moved, changed on disk, from later programs, and kept in case of a crash.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use proptest::prelude::*;
use shapematch::app::*;
use shapematch::geometry::Similarity;
use shapematch::jobs::{
    JobKey, JobOutput, JobStage, Located, PartSource, PipelineRunner, ProjectFile, ProjectRequest,
    Runner as _,
};
use shapematch::monitor::Monitor;
use shapematch::pipeline::map::{ChangedParts, PoseOrigin};
use shapematch::pipeline::match_parts::MatchRecipe;
use shapematch::pipeline::project::{PartEntry, Project};
use shapematch::registration::{
    DataSide, Floor, Hand, MatchSettings, Method, Metric, Motion, PairSelection, PairWith, Search,
    StartMethod, StartSettings,
};
use shapematch::role::{PerRole, Role};
use shapematch::samples::SampleVariant;
use shapematch::settings::Choice;
use shapematch::units::LengthUnit;

use super::app::{Window, shifted};

/// The example on disk, and a place for a project beside it.
fn folder() -> (tempfile::TempDir, [PathBuf; 3]) {
    let folder = tempfile::tempdir().unwrap();
    let mut paths = Vec::new();
    for file in shapematch::samples::bundled() {
        let path = folder.path().join(file.name);
        std::fs::write(&path, &file.bytes).unwrap();
        paths.push(path);
    }
    let find = |begins: &str| {
        let mut found = paths.iter();
        let is_it = |p: &&PathBuf| p.file_name().unwrap().to_str().unwrap().starts_with(begins);
        found.find(is_it).unwrap().clone()
    };
    let project = folder.path().join("floor.shapematch");
    let paths = [find("crash"), find("stamped"), project];
    (folder, paths)
}

/// A window with real files, reduced, moved, hidden and matched.
fn worked(crash: &Path, stamped: &Path) -> Window {
    let mut window = Window::real();
    for (path, role) in [(crash, Role::Crash), (stamped, Role::Stamped)] {
        window.apply(FileCommand::Open {
            paths: vec![path.to_path_buf()],
            role: Some(role),
        });
    }
    let units = Some(LengthUnit::Millimeter.into());
    window.apply(FileCommand::SetUnits {
        role: Role::Stamped,
        units,
    });
    window.apply(ReduceCommand::To {
        roles: PerRole {
            crash: true,
            stamped: true,
        },
        max_triangles: 400,
    });
    let id = window.part(Role::Crash).facts.parts[0].id;
    let part = PartRef {
        role: Role::Crash,
        id,
    };
    window.apply(PartCommand::SetColor(part, Some([1, 2, 3])));
    window.apply(PartCommand::SetVisible(part, false));
    window.apply(MatchCommand::Run);
    window.apply(ViewCommand::ToggleMoveOver);
    let mut display = window.state.view.display.clone();
    display.has_unused = true;
    window.apply(ViewCommand::SetDisplay(Box::new(display)));
    assert!(window.state.document.current_result().is_some());
    window
}

/// Saves as the shell does.
fn save(window: &mut Window, path: &Path) {
    window.apply(ProjectCommand::Write(path.to_path_buf()));
    let effects = std::mem::take(&mut window.effects);
    let mut n_written = 0;
    for effect in effects {
        if let Effect::WriteProject {
            path,
            project,
            kept,
            ..
        } = effect
        {
            project.write(&path).unwrap();
            window.apply(ProjectCommand::Written(path, project.saved_at, kept));
            n_written += 1;
        }
    }
    assert_eq!(n_written, 1);
}

fn open(path: &Path) -> Window {
    let mut window = Window::real();
    window.apply(FileCommand::Open {
        paths: vec![path.to_path_buf()],
        role: None,
    });
    window
}

#[cfg(unix)]
#[test]
fn a_file_whose_name_is_no_text_is_no_part_of_a_project() {
    use std::os::unix::ffi::OsStrExt as _;
    let folder = tempfile::tempdir().unwrap();
    let name = std::ffi::OsStr::from_bytes(b"t\xfcr.dynain");
    let entry = PartEntry {
        file: Some(folder.path().join(name)),
        ..PartEntry::default()
    };
    let project = Project {
        parts: PerRole::new(None, Some(entry)),
        ..Project::default()
    };
    let path = folder.path().join("a.shapematch");
    let error = project.write(&path).unwrap_err().to_string();
    assert!(error.contains("invalid UTF-8") && !path.exists(), "{error}");
}

#[test]
fn two_other_parts_are_not_saved_into_the_file_of_those_before() {
    let (folder, [crash, stamped, path]) = folder();
    let mut window = worked(&crash, &stamped);
    save(&mut window, &path);
    let is_saved_there = |window: &Window| window.state.project_path() == Some(&path);
    assert!(is_saved_there(&window));
    let mut exchange = |role, file: &Path| {
        let copy = folder
            .path()
            .join(format!("other_{}", file.file_name().unwrap().display()));
        std::fs::copy(file, &copy).unwrap();
        window.apply(FileCommand::Open {
            paths: vec![copy],
            role: Some(role),
        });
        is_saved_there(&window)
    };
    // A later state of one part is the same work.
    assert!(exchange(Role::Stamped, &stamped));
    assert!(!exchange(Role::Crash, &crash));
    window.act(Action::Undo);
    assert!(is_saved_there(&window));
}

#[test]
fn a_mapping_says_which_file_is_not_that_of_its_project() {
    let (folder, [crash, stamped, path]) = folder();
    let mut window = worked(&crash, &stamped);
    save(&mut window, &path);
    let map = |crash: &Path, stamped: &Path| {
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_shapematch"))
            .arg("map")
            .args([crash, stamped])
            .args(["--quantities", "thickness", "--project"])
            .arg(&path)
            .output();
        let output = output.unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        (output.status.code(), said)
    };
    let (code, said) = map(&crash, &stamped);
    assert!(code == Some(0) && !said.contains("is not the"), "{said}");
    let (code, said) = map(&stamped, &crash);
    assert_ne!(code, Some(0), "{said}");
    let later = folder.path().join("later.k");
    let mut text = b"$ later\n".to_vec();
    let packed = std::fs::File::open(&stamped).unwrap();
    std::io::Read::read_to_end(&mut flate2::read::GzDecoder::new(packed), &mut text).unwrap();
    std::fs::write(&later, text).unwrap();
    let (code, said) = map(&crash, &later);
    assert_eq!(code, Some(0), "{said}");
    assert!(
        said.contains("later.k is not the stamped part of "),
        "{said}"
    );
}

/// The step back over the opening of a project leads to work that is not of its file.
#[test]
fn the_step_before_a_project_was_opened_is_not_saved_into_its_file() {
    let (_folder, [crash, stamped, path]) = folder();
    let mut first = worked(&crash, &stamped);
    save(&mut first, &path);
    let mut window = Window::real();
    window.apply(FileCommand::OpenExample);
    window.apply(FileCommand::Open {
        paths: vec![path.clone()],
        role: None,
    });
    assert_eq!(window.state.project_path(), Some(&path));
    window.act(Action::Undo);
    assert_eq!(window.state.project_path(), None);
    window.effects.clear();
    window.act(Action::SaveProject);
    let mut effects = window.effects.iter();
    assert!(effects.any(|effect| matches!(effect, Effect::AskSaveProject(_))));
    window.act(Action::Redo);
    assert_eq!(window.state.project_path(), Some(&path));
}

#[test]
fn unsaved_work_before_a_project_is_told_with_the_way_back_to_it() {
    let (_folder, [crash, stamped, path]) = folder();
    let mut window = worked(&crash, &stamped);
    save(&mut window, &path);
    let is_told = |window: &mut Window| {
        window.close_toasts();
        let paths = vec![path.clone()];
        window.apply(FileCommand::Open { paths, role: None });
        let mut toasts = window.state.log.notices.toasts();
        toasts.any(|n| n.text.contains("unsaved work") && n.offers == [Action::Undo])
    };
    assert!(!is_told(&mut window), "all of it is saved");
    window.act(Action::FlipX);
    let before = window.state.document.clone();
    assert!(is_told(&mut window));
    assert!(!window.state.is_unsaved());
    window.act(Action::Undo);
    assert_eq!(window.state.document, before);
    assert!(window.state.is_unsaved());
}

fn pose_bits(pose: &Similarity) -> Vec<u64> {
    let numbers = pose.rotation.iter().chain(pose.translation.iter());
    numbers.chain([&pose.scale]).map(|x| x.to_bits()).collect()
}

/// Everything that has to come back.
fn assert_same_work(a: &Window, b: &Window) {
    let (old, new) = (&a.state.document, &b.state.document);
    let poses = [old, new].map(|d| pose_bits(d.crash_from_stamped()));
    assert_eq!(poses[0], poses[1]);
    assert_eq!(old.recipe, new.recipe);
    for role in Role::ALL {
        let (old, new) = (a.part(role), b.part(role));
        assert_eq!(old.loaded.settings, new.loaded.settings);
        assert_eq!(old.hidden, new.hidden);
        assert_eq!(old.colors, new.colors);
        assert_eq!(old.wanted_level, new.wanted_level);
        assert_eq!(old.reduced_mesh(), new.reduced_mesh());
        assert_eq!(*old.loaded.mesh, *new.loaded.mesh);
    }
    let (old, new) = (
        a.state.document.current_result(),
        b.state.document.current_result(),
    );
    let (old, new) = (old.unwrap(), new.unwrap());
    assert_eq!(old.alternative, new.alternative);
    assert_eq!(old.run.outcome, new.run.outcome);
    assert_eq!(old.run.assessment, new.run.assessment);
    assert_eq!(old.run.times, new.run.times);
    assert_eq!(a.state.view.cameras, b.state.view.cameras);
    assert_eq!(a.state.view.display, b.state.view.display);
    assert_eq!(a.state.view.is_moved_over, b.state.view.is_moved_over);
}

#[test]
fn an_example_pair_is_one_step() {
    let mut window = Window::real();
    window.apply(FileCommand::OpenExample);
    let example = window.part(Role::Crash).bounds();
    window.apply(FileCommand::OpenRealisticExample);
    assert_ne!(window.part(Role::Crash).bounds(), example);
    window.act(Action::Undo);
    assert_eq!(window.part(Role::Crash).bounds(), example);
    assert_eq!(window.part(Role::Stamped).source, PartSource::Example);
}

#[test]
fn a_sweep_after_saving_is_to_be_saved() {
    let (folder, [crash, stamped, path]) = folder();
    let mut window = worked(&crash, &stamped);
    save(&mut window, &path);
    window.holds = true;
    window.apply(MatchCommand::Sweep(Box::default()));
    let (id, kind, stamp) = window.held.remove(0);
    let done = JobOutput::Swept(Arc::default());
    window.tell(id, kind.key(), stamp, JobStage::Finished(done));
    assert!(window.state.is_unsaved());
    save(&mut window, &path);
    assert!(!window.state.is_unsaved());
    drop(folder);
}

#[test]
fn a_project_brings_everything_back() {
    let (folder, [crash, stamped, path]) = folder();
    let mut window = worked(&crash, &stamped);
    assert!(window.state.is_unsaved());
    save(&mut window, &path);
    assert!(!window.state.is_unsaved());
    assert_eq!(window.state.project_name().as_deref(), Some("floor"));
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(
        text.starts_with("{\n  \"schema\": \"shapematch.project/1\""),
        "{}",
        &text[..200]
    );
    let place = folder.path().to_str().unwrap();
    assert!(
        !text.contains(&format!("\"file\": \"{place}")),
        "absolute path"
    );

    let again = open(&path);
    assert_same_work(&window, &again);
    assert!(!again.state.is_unsaved());
    assert_eq!(again.state.history.n_done(), 1);
    assert_eq!(again.state.project_path(), Some(&path));
    assert_eq!(again.state.settings.recent.first(), Some(&path));

    // The whole folder goes elsewhere, and the project is written again: the same work.
    let elsewhere = tempfile::tempdir().unwrap();
    for file in [&crash, &stamped, &path] {
        let to = elsewhere.path().join(file.file_name().unwrap());
        std::fs::rename(file, to).unwrap();
    }
    let moved = open(&elsewhere.path().join("floor.shapematch"));
    assert_same_work(&window, &moved);
}

/// A packed deck with one more line: another byte is another content.
fn touched(path: &Path) -> Vec<u8> {
    use std::io::{Read as _, Write as _};
    let packed = std::fs::read(path).unwrap();
    let mut text = Vec::new();
    flate2::read::GzDecoder::new(&packed[..])
        .read_to_end(&mut text)
        .unwrap();
    text.extend(b"$ touched\n");
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packer.write_all(&text).unwrap();
    packer.finish().unwrap()
}

#[test]
fn a_file_that_changed_keeps_the_pose_and_ages_the_result() {
    let (_folder, [crash, stamped, path]) = folder();
    let mut window = worked(&crash, &stamped);
    save(&mut window, &path);
    std::fs::write(&crash, touched(&crash)).unwrap();
    let again = open(&path);
    assert_eq!(
        pose_bits(again.state.document.crash_from_stamped()),
        pose_bits(window.state.document.crash_from_stamped())
    );
    assert!(again.state.document.result.is_some());
    assert!(again.state.document.current_result().is_none());
    let origin = again.state.document.pose_origin();
    let is_told = matches!(
        origin,
        PoseOrigin::Outdated {
            changed: ChangedParts::Crash,
            distance: None,
            ..
        }
    );
    assert!(is_told, "{origin:?}");
    let toast = again.state.log.notices.toasts().next().unwrap();
    assert!(toast.text.contains("has changed since"), "{}", toast.text);
}

/// A project knows which parts were exchanged after the match, not only that something was.
#[test]
fn a_part_exchanged_after_the_match_is_still_exchanged_when_the_project_is_opened() {
    let is_told = |window: &Window, when: &str| {
        let state = &window.state;
        assert!(state.document.result.is_some(), "{when}");
        assert!(state.document.match_of_parts().is_err(), "{when}");
        let stale = state.stale(Section::Match).map(|stale| stale.reason);
        let reason = "a part was changed after the match";
        assert_eq!(stale, Some(reason), "{when}");
    };
    let (_folder, [crash, stamped, path]) = folder();
    let mut window = worked(&crash, &stamped);
    std::fs::write(&crash, touched(&crash)).unwrap();
    window.apply(FileCommand::Reload(Role::Crash));
    is_told(&window, "read again");
    save(&mut window, &path);
    is_told(&open(&path), "opened");
    // Once more: what is saved is what was opened.
    let mut again = open(&path);
    again.apply(MoveCommand::Flip(Axis::X));
    save(&mut again, &path);
    is_told(&open(&path), "opened and saved again");

    // A project of a program that did not keep it still opens.
    let text = std::fs::read_to_string(&path).unwrap();
    let mut project: serde_json::Value = serde_json::from_str(&text).unwrap();
    project["result"]
        .as_object_mut()
        .unwrap()
        .remove("exchanged");
    let old = serde_json::to_string(&project).unwrap();
    let (old, notes) = Project::parse(&old, &path).unwrap();
    assert!(notes.is_empty(), "{notes:?}");
    assert_eq!(old.result.unwrap().exchanged, PerRole::both(false));
}

/// Another window's state of the project is not written over; this work can go elsewhere, or that state be opened.
#[test]
fn a_project_that_is_not_saved_offers_what_can_be_done() {
    let (_folder, [crash, stamped, path]) = folder();
    let mut window = worked(&crash, &stamped);
    assert!(Action::ReopenProject.enabled(&window.state).is_err());
    save(&mut window, &path);
    window.apply(MoveCommand::Flip(Axis::X));
    let failed = |is_elsewhere| ProjectCommand::SaveFailed {
        reason: "that is why".to_owned(),
        is_elsewhere,
    };
    let offers = |window: &Window| {
        let told = window.state.log.notices.toasts().next().expect("a toast");
        assert_eq!(told.text, "the project is not saved: that is why");
        told.offers.clone()
    };
    window.apply(failed(false));
    assert_eq!(offers(&window), [Action::SaveProjectAs]);
    window.apply(failed(true));
    assert_eq!(
        offers(&window),
        [Action::SaveProjectAs, Action::ReopenProject]
    );
    window.act(Action::ReopenProject);
    assert!(window.state.document.current_result().is_some());
    window.act(Action::Undo);
    assert!(
        window.state.document.current_result().is_none(),
        "the work is one step back"
    );
}

/// A saved project whose stamped file was moved since, with the files it names and where that one is now.
fn saved_without_stamped() -> (tempfile::TempDir, [PathBuf; 3], PathBuf) {
    let (folder, [crash, stamped, path]) = folder();
    let mut window = worked(&crash, &stamped);
    save(&mut window, &path);
    let elsewhere = folder.path().join("elsewhere.k");
    std::fs::rename(&stamped, &elsewhere).unwrap();
    (folder, [crash, stamped, path], elsewhere)
}

#[test]
fn a_missing_file_is_asked_for_or_done_without() {
    let (_folder, [_, stamped, path], hidden) = saved_without_stamped();
    let mut asked = open(&path);
    assert_eq!(asked.state.view.dialog, Some(Dialog::MissingFiles));
    let (_, missing) = asked.state.project.missing.clone().unwrap();
    let of_stamped = ProjectFile::Part(Role::Stamped);
    assert_eq!(missing, [(of_stamped, stamped)]);
    assert!(asked.state.document.part(Role::Crash).is_none());
    asked.apply(ProjectCommand::Locate(of_stamped, Located::Without));
    assert!(asked.state.document.part(Role::Crash).is_some());
    assert!(asked.state.document.part(Role::Stamped).is_none());
    assert!(asked.state.document.current_result().is_none());

    let mut asked = open(&path);
    // A dynain is known by its content, whatever its name.
    asked.apply(ProjectCommand::Locate(of_stamped, Located::At(hidden)));
    assert_eq!(asked.state.view.dialog, None);
    assert!(asked.state.document.current_result().is_some());
}

/// The crash part read as the stamped part would be matched onto itself.
#[test]
fn the_file_of_the_other_part_is_not_taken_for_a_missing_one() {
    let (folder, [crash, stamped, path], elsewhere) = saved_without_stamped();
    let copy = folder.path().join("copy.k");
    std::fs::copy(&crash, &copy).unwrap();
    let of_stamped = ProjectFile::Part(Role::Stamped);
    let mut asked = open(&path);
    assert_eq!(asked.state.project.refused, None);
    for given in [&crash, &copy] {
        asked.apply(ProjectCommand::Locate(
            of_stamped,
            Located::At(given.clone()),
        ));
        assert_eq!(asked.state.view.dialog, Some(Dialog::MissingFiles));
        let (request, missing) = asked.state.project.missing.clone().unwrap();
        assert_eq!(missing, [(of_stamped, stamped.clone())]);
        assert!(request.located.is_empty());
        let name = given.file_name().unwrap().to_str().unwrap();
        let why = format!("{name} is the crash part of the project, not the stamped part.");
        assert_eq!(asked.state.project.refused, Some(why));
    }
    // Any other file is the user's choice, and is told.
    let other = folder.path().join("other.k");
    std::fs::write(&other, touched(&elsewhere)).unwrap();
    asked.apply(ProjectCommand::Locate(of_stamped, Located::At(other)));
    assert_eq!(asked.state.view.dialog, None);
    assert_eq!(asked.state.project.refused, None);
    assert!(asked.state.document.current_result().is_none());
    let told = "other.k is not the file that the project was saved with; poses are kept";
    let mut toasts = asked.state.log.notices.toasts();
    assert!(toasts.any(|toast| toast.text.contains(told)));
}

/// Both ways round, and where both are missing.
#[test]
fn a_stamped_file_is_not_taken_for_the_crash_part() {
    let (folder, [crash, stamped, path]) = folder();
    let mut window = worked(&crash, &stamped);
    save(&mut window, &path);
    let now = folder.path().join("moved");
    std::fs::create_dir(&now).unwrap();
    let [crash_now, stamped_now] = [&crash, &stamped].map(|file| {
        let to = now.join(file.file_name().unwrap());
        std::fs::rename(file, &to).unwrap();
        to
    });
    let mut asked = open(&path);
    let of_crash = ProjectFile::Part(Role::Crash);
    asked.apply(ProjectCommand::Locate(of_crash, Located::At(stamped_now)));
    let why = asked.state.project.refused.clone().unwrap();
    assert!(
        why.ends_with(" is the stamped part of the project, not the crash part."),
        "{why}"
    );
    assert_eq!(asked.state.project.missing.as_ref().unwrap().1.len(), 2);
    asked.apply(ProjectCommand::Locate(of_crash, Located::At(crash_now)));
    assert_eq!(asked.state.view.dialog, None);
    assert_same_work(&window, &asked);
}

#[test]
fn files_that_moved_together_are_asked_for_once() {
    let (folder, [crash, stamped, path]) = folder();
    let mut window = worked(&crash, &stamped);
    save(&mut window, &path);
    let of = |role| ProjectFile::Part(role);
    let moved = |to: &str| {
        let to = folder.path().join(to);
        std::fs::create_dir_all(to.parent().unwrap()).unwrap();
        to
    };
    let crash_now = moved("new/car/front.k");
    std::fs::rename(&crash, &crash_now).unwrap();
    let stamped_now = moved("new/car").join(stamped.file_name().unwrap());
    std::fs::rename(&stamped, &stamped_now).unwrap();
    let mut asked = open(&path);
    assert_eq!(asked.state.project.missing.as_ref().unwrap().1.len(), 2);
    asked.apply(ProjectCommand::Locate(
        of(Role::Crash),
        Located::At(crash_now.clone()),
    ));
    assert_eq!(asked.state.view.dialog, None);
    assert_same_work(&window, &asked);
    assert_eq!(asked.part(Role::Stamped).loaded.path, stamped_now);

    // Another content under its name is not taken unasked.
    std::fs::write(&stamped_now, b"$ another\n").unwrap();
    let mut asked = open(&path);
    asked.apply(ProjectCommand::Locate(
        of(Role::Crash),
        Located::At(crash_now),
    ));
    assert_eq!(asked.state.view.dialog, Some(Dialog::MissingFiles));
    let missing = &asked.state.project.missing.as_ref().unwrap().1;
    assert_eq!(*missing, [(of(Role::Stamped), stamped)]);
}

#[test]
fn a_mapping_is_there_again_when_its_project_is_opened() {
    let folder = tempfile::tempdir().unwrap();
    let pair = super::bracket::write_bracket(folder.path(), SampleVariant::Plain);
    let path = folder.path().join("a.shapematch");
    let mut window = Window::real();
    for (name, role) in [("crash.k", Role::Crash), ("stamped.dynain", Role::Stamped)] {
        window.open(folder.path().join(name).to_str().unwrap(), role);
    }
    window.apply(MoveCommand::SetPose {
        crash_from_stamped: pair.crash_from_stamped,
        name: "Known pose".to_owned(),
    });
    window.act(Action::MapOrCancel);
    // Beside what it wrote itself, as another mapper's result.
    let other = folder.path().join("other.k");
    std::fs::copy(folder.path().join("crash.k"), &other).unwrap();
    window.apply(MapCommand::CompareWith(other));
    window.apply(ViewCommand::SetTab(BottomTab::Log));
    save(&mut window, &path);

    let again = open(&path);
    let [old, new] = [&window, &again].map(|w| w.state.document.current_mapping().unwrap());
    assert_eq!(old.run.mapped, new.run.mapped);
    assert_eq!(old.other.is_some(), new.other.is_some());
    assert!(!again.state.is_unsaved());
    assert_eq!(again.state.history.n_done(), 1);
    // The window looks as it did.
    assert_eq!(again.state.view.display, window.state.view.display);
    // Saved while the mapping is being made again, the project still has it.
    let mut early = Window::real();
    early.holds = true;
    early.apply(FileCommand::Open {
        paths: vec![path.clone()],
        role: None,
    });
    while !early.state.jobs.is_active(JobKey::Map) {
        let (id, kind, stamp) = early.held.remove(0);
        early.finish(id, kind, stamp);
    }
    assert!(early.state.document.current_mapping().is_none());
    assert!(early.state.to_project(0).is_mapped);

    // Mapped at another pose it is of no use.
    window.act(Action::FlipX);
    save(&mut window, &path);
    let again = open(&path);
    assert!(again.state.document.mapping.result.is_none());
}

#[test]
fn later_programs_are_named_and_their_additions_kept() {
    let (_folder, [crash, stamped, path]) = folder();
    let mut window = worked(&crash, &stamped);
    save(&mut window, &path);
    let text = std::fs::read_to_string(&path).unwrap();
    let newer = text
        .replace("shapematch.project/1", "shapematch.project/7")
        .replacen(
            "\"program\": \"shapematch",
            "\"program\": \"shapematch 9.1 or",
            1,
        );
    let error = Project::parse(&newer, &path).unwrap_err().to_string();
    assert!(
        error.contains("version 7") && error.contains("shapematch 9.1"),
        "{error}"
    );

    let odd = text.replace("shapematch.project/1", "shapematch.project/2.1");
    let error = Project::parse(&odd, &path).unwrap_err().to_string();
    assert!(error.contains("version 2.1"), "{error}");

    let more = text
        .replacen("{", "{\n  \"spring_back\": {\"of\": [1.5, 2]},", 1)
        .replacen("\"allowance\"", "\"mood\": \"good\", \"allowance\"", 1);
    let (project, notes) = Project::parse(&more, &path).unwrap();
    assert_eq!(notes.len(), 2, "{notes:?}");
    assert!(notes[0].contains("recipe.settings.mood"), "{notes:?}");
    assert!(project.to_text(&path).unwrap().contains("spring_back"));
    std::fs::write(&path, &more).unwrap();
    let mut again = open(&path);
    assert!(again.state.document.current_result().is_some());
    save(&mut again, &path);
    assert!(
        std::fs::read_to_string(&path)
            .unwrap()
            .contains("spring_back")
    );
}

#[test]
fn rubbish_is_refused_with_a_message() {
    let path = Path::new("a.shapematch");
    for (text, said) in [
        ("", "no project but empty"),
        ("{", "line 1"),
        ("[1]", "no project of shapematch"),
        (
            "{\"schema\": \"shapematch.match/1\"}",
            "no project of shapematch",
        ),
        (
            "{\"schema\": \"shapematch.project/1\", \"pose\": 3}",
            "\"pose\"",
        ),
    ] {
        let error = Project::parse(text, path).unwrap_err().to_string();
        assert!(error.contains(said), "{text}: {error}");
    }
    let least = "{\"schema\": \"shapematch.project/1\"}";
    let (project, notes) = Project::parse(least, path).unwrap();
    assert_eq!(notes, Vec::<String>::new());
    assert_eq!(project.pose, Similarity::identity());
    let odd = "{\"schema\": \"shapematch.project/1\", \"recipe\": {\"settings\": {\"metric\": \"love\"}}}";
    let (project, notes) = Project::parse(odd, path).unwrap();
    assert_eq!(project.recipe, MatchRecipe::default());
    assert!(
        notes[0].contains("recipe") && notes[0].contains("love"),
        "{notes:?}"
    );
}

/// Every setting, with values that only a bit-exact text keeps.
fn any_recipe() -> impl Strategy<Value = MatchRecipe> {
    let one = |n: usize| 0..n;
    let floats = prop::collection::vec(1e-9..1e9_f64, 6);
    let counts = prop::collection::vec(1usize..1_000_000, 4);
    let choices = (
        one(Method::ALL.len()),
        one(4),
        one(3),
        one(Metric::ALL.len()),
        one(Hand::ALL.len()),
        one(StartMethod::ALL.len()),
    );
    let flags = prop::collection::vec(any::<bool>(), 7);
    (floats, counts, choices, flags).prop_map(
        |(x, n, (method, select, floor, metric, hand, start), is)| {
            let floor = [Floor::Auto, Floor::None, Floor::Length(x[0])][floor];
            let selection = [
                PairSelection::All,
                PairSelection::TrimmedSearch,
                PairSelection::Trimmed { overlap: x[1] },
                PairSelection::Fractional {
                    lambda: x[1],
                    floor,
                },
            ][select];
            MatchRecipe {
                settings: MatchSettings {
                    method: Method::ALL[method],
                    pair_with: if is[0] {
                        PairWith::Node
                    } else {
                        PairWith::Triangle
                    },
                    selection,
                    metric: Metric::ALL[metric],
                    motion: if is[1] {
                        Motion::Rigid
                    } else {
                        Motion::Similarity
                    },
                    hand: Hand::ALL[hand],
                    starts: StartSettings {
                        method: StartMethod::ALL[start],
                        angle_segment_deg: x[2],
                        both_signs: is[2],
                        poses: vec![shifted(x[3]), shifted(-x[4])],
                        wide_search: is[3],
                    },
                    search: if is[4] {
                        Search::CoarseToFine
                    } else {
                        Search::EveryStart
                    },
                    refine_on_full: is[5],
                    data_side: if is[6] {
                        DataSide::Auto
                    } else {
                        DataSide::Target
                    },
                    allowance: x[3],
                    shape_tolerance: x[3],
                    remove_offset: is[1],
                    max_normal_angle_deg: x[4],
                    n_coarse_points: n[0],
                    n_refine_points: n[1],
                    max_iterations: n[2],
                    motion_tolerance: x[5],
                },
                max_triangles: is[0].then_some(n[3]),
            }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn every_setting_comes_back_to_the_last_bit(recipe in any_recipe(), saved_at: u64) {
        let project = Project {
            recipe,
            saved_at,
            parts: PerRole::new(Some(PartEntry::default()), None),
            ..Project::default()
        };
        let path = Path::new("folder/a.shapematch");
        let (read, notes) = Project::parse(&project.to_text(path).unwrap(), path).unwrap();
        prop_assert_eq!(notes, Vec::<String>::new());
        prop_assert_eq!(read.recipe, project.recipe);
        prop_assert_eq!(read.saved_at, project.saved_at);
        prop_assert_eq!(read.parts, project.parts);
    }
}

#[test]
fn work_is_kept_after_each_step_and_restored_as_unsaved() {
    let (folder, [crash, stamped, _]) = folder();
    let mut window = worked(&crash, &stamped);
    let kept = |window: &mut Window| {
        window.apply(ProjectCommand::Autosave);
        let effects = std::mem::take(&mut window.effects);
        let kept = effects.into_iter().find_map(|effect| match effect {
            Effect::Autosave(project) => Some(*project),
            _ => None,
        });
        kept.map(|project| {
            let path = folder.path().join("kept/run.shapematch");
            project.write_in_new_folder(&path).unwrap();
            path
        })
    };
    assert!(window.state.needs_autosave());
    assert!(kept(&mut window).is_some());
    assert!(!window.state.needs_autosave());
    assert!(kept(&mut window).is_none());
    window.apply(MoveCommand::Begin {
        kind: MotionKind::Move,
        frame: window.state.move_frame().unwrap(),
    });
    assert!(!window.state.needs_autosave(), "a move is under way");
    window.apply(Command::Escape);
    window.act(Action::FlipX);
    let path = kept(&mut window).unwrap();

    let mut again = Window::real();
    again.apply(ProjectCommand::Restore(path));
    let pose = pose_bits(window.state.document.crash_from_stamped());
    assert_eq!(pose_bits(again.state.document.crash_from_stamped()), pose);
    assert!(again.state.document.result.is_some());
    assert!(again.state.document.current_result().is_none());
    assert!(again.state.is_unsaved());
    assert_eq!(again.state.project_path(), None);
    again.act(Action::Undo);
    assert!(again.state.document.part(Role::Crash).is_none());
}

#[test]
fn leaving_asks_only_if_something_would_be_lost() {
    let quits = |window: &mut Window| {
        window.effects.clear();
        window.apply(Command::Quit);
        window.effects.iter().any(|e| matches!(e, Effect::Quit))
    };
    let mut window = Window::new();
    assert!(quits(&mut window));
    window.open("crash.k", Role::Crash);
    window.open("stamped.k", Role::Stamped);
    assert!(
        quits(&mut window),
        "opening the files again brings this back"
    );
    window.act(Action::FlipX);
    assert!(!quits(&mut window));
    assert_eq!(window.state.view.dialog, Some(Dialog::Unsaved));
    window.apply(Command::Escape);
    assert_eq!(window.state.view.dialog, None);
    window.act(Action::Undo);
    assert!(quits(&mut window));
    // Nothing is there yet that could be saved, but minutes of a match would be lost.
    window.holds = true;
    window.act(Action::MatchOrStop);
    assert!(!window.state.is_unsaved() && !quits(&mut window));
    assert_eq!(window.state.view.dialog, Some(Dialog::Unsaved));
    let running = window.state.unfinished_work();
    assert_eq!(running, Some("A match is running."));
    window.apply(Command::Escape);
    window.apply(Command::CancelPresent);
    assert_eq!(window.state.unfinished_work(), None);
    window.holds = false;
    window.act(Action::Redo);
    window.apply(ProjectCommand::QuitUnsaved);
    assert!(window.effects.iter().any(|e| matches!(e, Effect::Quit)));

    // Save and leave: asks where to, and leaves when it is written.
    window.effects.clear();
    window.apply(ProjectCommand::SaveAndQuit);
    let asked = window.effects.iter().find_map(|effect| match effect {
        Effect::AskSaveProject(path) => Some(path.clone()),
        _ => None,
    });
    assert_eq!(asked, Some(PathBuf::from("stamped.shapematch")));
    let folder = tempfile::tempdir().unwrap();
    save(&mut window, &folder.path().join("a"));
    assert!(window.effects.iter().any(|e| matches!(e, Effect::Quit)));
    assert_eq!(window.state.project_name().as_deref(), Some("a"));

    // A dialog that was closed keeps the window open, also after a later save.
    window.act(Action::FlipY);
    window.project_dialog_closed();
    window.effects.clear();
    save(&mut window, &folder.path().join("a.shapematch"));
    assert!(!window.effects.iter().any(|e| matches!(e, Effect::Quit)));
}

impl Window {
    fn project_dialog_closed(&mut self) {
        self.apply(ProjectCommand::SaveAndQuit);
        self.apply(ProjectCommand::NotWritten);
    }

    /// A window whose worker does everything itself.
    fn real() -> Self {
        let mut window = Self::new();
        window.runner = Some(|kind| {
            let done = PipelineRunner.run(kind, &Monitor::silent());
            done.map_err(|error| error.to_string())
        });
        window
    }
}

#[test]
fn a_request_finds_files_beside_the_project() {
    let request = ProjectRequest::default();
    assert!(request.located.is_empty());
    let (folder, [crash, ..]) = folder();
    let entry = PartEntry {
        file: Some(PathBuf::from("/gone").join(crash.file_name().unwrap())),
        ..PartEntry::default()
    };
    let project = folder.path().join("p.shapematch");
    assert_eq!(entry.locate(&project), Some(crash));
    assert_eq!(entry.locate(Path::new("/gone/p.shapematch")), None);
}

#[test]
fn the_command_line_runs_and_describes_a_project() {
    let (folder, [crash, stamped, path]) = folder();
    let mut window = worked(&crash, &stamped);
    save(&mut window, &path);
    // The same match again, from the pose that was saved.
    window.apply(MatchCommand::Run);
    let matrix = folder.path().join("m.txt");
    let program = |args: &[&str]| {
        let program = env!("CARGO_BIN_EXE_shapematch");
        let output = std::process::Command::new(program).args(args).output();
        let output = output.unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{said}");
        String::from_utf8(output.stdout).unwrap()
    };
    let project = path.to_str().unwrap();
    program(&["match", project, "--matrix", matrix.to_str().unwrap()]);
    let text = std::fs::read_to_string(&matrix).unwrap();
    let pose = shapematch::report::parse_matrix(&text).unwrap().motion;
    let here = *window.state.document.crash_from_stamped();
    assert_eq!(pose_bits(&pose), pose_bits(&here));
    let told = program(&["info", project]);
    for words in [
        "unchanged",
        "reduced to 400",
        "in mm",
        "Fractional ICP",
        "GOOD",
    ] {
        assert!(told.contains(words), "{words}: {told}");
    }
    // Levels are taken in place of those of the project; what it has its own of is refused.
    let levels = program(&["match", project, "--crash-triangles", "300", "--json", "-"]);
    let record: serde_json::Value = serde_json::from_str(&levels).unwrap();
    let used = |role| record["parameters"][role].as_u64().unwrap();
    assert!((200..=300).contains(&used("crash_triangles")), "{levels}");
    assert!((301..=400).contains(&used("stamped_triangles")), "{levels}");
    for option in [
        "--crash-part=1",
        "--stamped-units=mm",
        "--crash-length-factor=25.4",
        "--include-folder=.",
        "--read-limit=2",
        "--method=paper",
    ] {
        let refused = std::process::Command::new(env!("CARGO_BIN_EXE_shapematch"))
            .args(["match", project, option])
            .output()
            .unwrap();
        assert_eq!(refused.status.code(), Some(2), "{option}");
        let said = String::from_utf8_lossy(&refused.stderr);
        let name = option.split('=').next().unwrap();
        assert!(said.contains(&format!("{name} is for two files")), "{said}");
    }
    let both = std::process::Command::new(env!("CARGO_BIN_EXE_shapematch"))
        .args(["match", crash.to_str().unwrap()])
        .output()
        .unwrap();
    assert!(!both.status.success());
    assert!(String::from_utf8_lossy(&both.stderr).contains("project"));
}

/// A recovered session still knows which state of the project's file it goes back to, so that what another window
/// has saved there since is not written over unasked.
#[test]
fn a_recovered_session_knows_when_its_project_was_saved() {
    let (folder, [crash, stamped, path]) = folder();
    let mut window = worked(&crash, &stamped);
    save(&mut window, &path);
    let saved_at = Project::read(&path).unwrap().0.saved_at;
    window.apply(MoveCommand::Flip(Axis::X));
    let session = folder.path().join("session.shapematch");
    window
        .state
        .to_project(saved_at + 60)
        .write(&session)
        .unwrap();
    let mut recovered = Window::real();
    recovered.apply(ProjectCommand::Restore(session));
    assert_eq!(recovered.state.project_path(), Some(&path));
    recovered.effects.clear();
    recovered.apply(ProjectCommand::Save);
    let replaces = recovered.effects.iter().find_map(|effect| match effect {
        Effect::WriteProject { replaces, .. } => Some(*replaces),
        _ => None,
    });
    assert_eq!(replaces, Some(Some(saved_at)));
}

/// A pose that no match stands for is not what a new match gives; one that was refined is.
#[test]
fn the_command_line_says_when_a_project_lies_elsewhere_than_its_match() {
    let (folder, [crash, stamped, path]) = folder();
    let mut window = worked(&crash, &stamped);
    let moved = Similarity {
        translation: window.pose().translation + shapematch::geometry::Vector3::x(),
        ..window.pose()
    };
    window.apply(MoveCommand::SetPose {
        crash_from_stamped: moved,
        name: "by hand".to_owned(),
    });
    save(&mut window, &path);
    let matrix = folder.path().join("m.txt");
    let run = |options: &[&str]| {
        let project = ["match", path.to_str().unwrap()];
        let matrix = ["--matrix", matrix.to_str().unwrap()];
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_shapematch"))
            .args([&project, &matrix, options].concat())
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        (output.status.code(), said)
    };
    let note = "the stamped part was moved after the match";
    let (_, said) = run(&[]);
    assert!(
        said.contains(note) && said.contains("--start current"),
        "{said}"
    );
    let refined = |window: &Window| {
        let text = std::fs::read_to_string(&matrix).unwrap();
        let pose = shapematch::report::parse_matrix(&text).unwrap().motion;
        assert_eq!(pose_bits(&pose), pose_bits(&window.pose()));
    };
    window.act(Action::Refine);
    assert!(window.state.document.current_result().is_some());
    let (_, said) = run(&["--start", "current", "--wide-search", "no"]);
    assert!(!said.contains(note), "{said}");
    refined(&window);
    let (code, said) = run(&["--method", "icp"]);
    assert_eq!(code, Some(2), "{said}");

    save(&mut window, &path);
    let (_, said) = run(&[]);
    assert!(!said.contains(note), "{said}");
    refined(&window);
}

#[test]
fn what_a_remedy_changed_ends_with_its_parts_in_an_opened_project_too() {
    let (_folder, [crash, stamped, path]) = folder();
    let mut window = worked(&crash, &stamped);
    let before = window.state.document.recipe.clone();
    let mut recipe = before.clone();
    recipe.settings.hand = Hand::Mirrored;
    window.apply(MatchCommand::SetRemedy {
        name: "Match the opposite hand".to_owned(),
        recipe: Box::new(recipe.clone()),
        is_matched: false,
    });
    save(&mut window, &path);
    let mut opened = open(&path);
    assert_eq!(opened.state.document.recipe, recipe);
    opened.apply(FileCommand::Close(Role::Stamped));
    assert_eq!(opened.state.document.recipe, before);
}
