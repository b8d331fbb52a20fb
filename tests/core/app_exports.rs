//! What leaves the window: names, places, questions.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use shapematch::app::*;
use shapematch::geometry::Similarity;
use shapematch::jobs::{JobKind, JobOutput};
use shapematch::pipeline::match_parts::MatchRun;
use shapematch::pipeline::outputs::record::match_record;
use shapematch::pipeline::outputs::{MeshOutput, Output};
use shapematch::report::MatrixForm;
use shapematch::role::{PerRole, Role};

use super::app::{Window, shifted};
use super::find_parts::really;

fn last_effect(window: &Window) -> &Effect {
    window.effects.last().expect("an effect")
}

#[test]
fn the_first_picture_asks_for_a_place_and_the_next_goes_beside_it() {
    let mut window = Window::with_both();
    window.act(Action::TakePicture);
    let choice = match last_effect(&window) {
        Effect::AskPicture { choice, path } => {
            assert_eq!(path, Path::new("stamped.png"));
            *choice
        }
        other => panic!("{other:?}"),
    };
    let path = PathBuf::from("pictures/a.png");
    window.apply(ExportCommand::WritePicture { choice, path });
    match last_effect(&window) {
        Effect::TakePicture { place, texts, .. } => {
            assert_eq!(*place, PicturePlace::File("pictures/a.png".into()));
            let pose = texts
                .iter()
                .find(|(keyword, _)| *keyword == "Pose")
                .unwrap();
            let read = shapematch::report::parse_matrix(&pose.1).unwrap();
            assert_eq!(read.motion, window.pose());
        }
        other => panic!("{other:?}"),
    }
    window.act(Action::TakePictureTransparent);
    match last_effect(&window) {
        Effect::TakePicture { choice, place, .. } => {
            assert!(choice.is_transparent);
            let next = PicturePlace::Next {
                folder: "pictures".into(),
                stem: "stamped".into(),
            };
            assert_eq!(*place, next);
        }
        other => panic!("{other:?}"),
    }
    assert!(!window.state.settings.picture.is_transparent);
}

#[test]
fn a_picture_of_values_has_their_numbers_unless_it_is_chosen_otherwise() {
    let mut window = Window::with_both();
    let usual = PictureChoice::default();
    assert!(!usual.has_overlays(&window.state));
    assert_eq!(usual.size_of(&window.state), usual.size);
    let mut display = window.state.view.display.clone();
    display.color_by = ColorBy::Thickness;
    window.apply(ViewCommand::SetDisplay(Box::new(display)));
    assert!(usual.has_overlays(&window.state));
    assert_eq!(usual.size_of(&window.state), PictureSize::Window(1));
    let overlays = Some(false);
    let plain = PictureChoice { overlays, ..usual };
    let bare = PictureChoice {
        is_transparent: true,
        ..usual
    };
    for choice in [plain, bare] {
        assert!(!choice.has_overlays(&window.state), "{choice:?}");
        assert_eq!(choice.size_of(&window.state), usual.size);
    }
    // The key that leaves out the background leaves out what would bring it back.
    window.apply(ExportCommand::TakePicture {
        is_transparent: true,
    });
    match last_effect(&window) {
        Effect::AskPicture { choice, .. } => assert!(!choice.has_overlays(&window.state)),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_card_for_a_file_in_another_unit_is_answered_with_the_converted_file() {
    let mut window = Window::with_both();
    window.apply(MatchCommand::Run);
    let cards = Output::Cards(shapematch::report::CardForm::StampedPart);
    window.apply(ExportCommand::AskSave(cards));
    assert!(matches!(last_effect(&window), Effect::AskSave { kind, .. } if *kind == cards));
    window.apply(FileCommand::SetLengthFactor {
        role: Role::Stamped,
        factor: 1000.0,
    });
    window.apply(ExportCommand::AskSave(cards));
    match last_effect(&window) {
        Effect::AskSave { kind, path, .. } => {
            assert_eq!(*kind, Output::Mesh(MeshOutput::Converted));
            assert_eq!(path, Path::new("stamped_converted.k"));
        }
        other => panic!("{other:?}"),
    }
    let told = |window: &Window| window.state.log.notices.kept().next().unwrap().clone();
    assert!(told(&window).text.contains("1000"), "{:?}", told(&window));
    // A copy is answered with the same words, which name a menu entry and no option.
    let n_told = told(&window).count;
    let form = CopyForm::Cards(shapematch::report::CardForm::StampedPart);
    window.apply(ExportCommand::Copy(form));
    let Notice { text, count, .. } = told(&window);
    assert_eq!(count, n_told + 1);
    assert!(
        text.contains("Save part as") && !text.contains("--"),
        "{text}"
    );
}

#[test]
fn every_output_that_is_asked_for_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let paths = ["a.txt", "b.txt", "c.txt"].map(|name| folder.path().join(name));
    let mut window = Window::with_both();
    window.holds = true;
    for path in paths.clone() {
        let kind = Output::Log;
        window.apply(ExportCommand::Write { kind, path });
    }
    assert!(window.state.jobs.is_exporting());
    window.finish_held();
    assert!(!window.state.jobs.is_exporting());
    let are_there = paths.map(|path| path.exists());
    assert_eq!(are_there, [true; 3]);
}

/// Asserts that a command line has all these pieces.
fn assert_has(line: &str, pieces: &[&str]) {
    for piece in pieces {
        assert!(line.contains(piece), "{piece}: {line}");
    }
}

#[test]
fn the_command_line_says_levels_settings_and_pose() {
    let mut window = Window::with_both();
    let plain = window.state.document.command_line().unwrap();
    assert_eq!(plain, "shapematch match crash.k stamped.k");
    let mut recipe = window.state.document.recipe.clone();
    recipe.settings.starts.method = shapematch::registration::StartMethod::CurrentPose;
    recipe.settings.allowance = 0.25;
    window.apply(MatchCommand::SetRecipe(Box::new(recipe)));
    window.apply(MoveCommand::SetPose {
        crash_from_stamped: shifted(2.5),
        name: "by hand".to_owned(),
    });
    window.apply(ReduceCommand::To {
        roles: PerRole {
            crash: false,
            stamped: true,
        },
        max_triangles: 60,
    });
    let line = window.state.document.command_line().unwrap();
    assert_has(
        &line,
        &[
            "--stamped-triangles 60",
            "--allowance 0.25",
            "--start current --start-pose",
            "1.0 0.0 0.0 2.5",
        ],
    );
    window.act(Action::CopyCommandLine);
    assert!(matches!(last_effect(&window), Effect::CopyText(text) if *text == line));
}

#[test]
fn after_refining_the_copied_line_is_that_of_the_record() {
    let mut window = Window::with_both();
    window.act(Action::MatchOrStop);
    let line = |window: &Window| window.state.document.command_line().unwrap();
    let recorded = |window: &Window| {
        let result = window.state.document.current_result().unwrap();
        let parts = Role::ALL.map(|role| window.part(role).loaded.to_arc());
        let [crash, stamped] = &parts;
        match_record(&result.run, PerRole::new(&**crash, &**stamped)).command_line
    };
    assert_eq!(line(&window), recorded(&window));
    window.apply(MoveCommand::SetPose {
        crash_from_stamped: shifted(2.5),
        name: "by hand".to_owned(),
    });
    window.act(Action::Refine);
    let line = line(&window);
    assert_eq!(line, recorded(&window));
    assert_has(
        &line,
        &[
            "--start current",
            "--wide-search no",
            "--start-pose",
            "1.0 0.0 0.0 2.5",
        ],
    );
}

#[test]
fn a_pose_that_was_moved_after_the_match_is_refused_with_one_reason() {
    let mut window = Window::with_both();
    let reasons = |window: &Window| {
        let actions = [Action::SaveCards, Action::SaveReport, Action::SaveRecord];
        let mut reasons = actions.map(|action| action.enabled(&window.state)).to_vec();
        let cards = CopyForm::all().filter(|form| matches!(form, CopyForm::Cards(_)));
        reasons.extend(cards.map(|form| form.enabled(&window.state)));
        reasons
    };
    for reason in reasons(&window) {
        assert_eq!(reason, Err(Reason("Run a match first.")));
    }
    window.act(Action::MatchOrStop);
    assert!(reasons(&window).iter().all(Result::is_ok));
    window.apply(MoveCommand::Flip(Axis::X));
    let why = Action::CopyCommandLine.enabled(&window.state);
    assert!(why.is_err_and(|why| why.0.contains("after the match")));
    for reason in reasons(&window) {
        assert_eq!(reason, why);
    }
}

#[test]
fn a_mirrored_pose_is_named_where_it_is_copied_and_in_the_log() {
    let mut window = Window::with_both();
    window.apply(MatchCommand::Run);
    let result_row = |window: &Window| {
        let mut rows = window.state.log.rows().iter().rev();
        let row = rows.find(|row| row.step == LogStep::Result).unwrap();
        row.text.clone()
    };
    assert!(!result_row(&window).contains("mirrored"));
    window.runner = Some(mirrored_match);
    window.apply(MatchCommand::Run);
    let line = result_row(&window);
    assert!(line.contains(", mirrored: overlap stamped"), "{line}");
    for (form, words) in [
        (MatrixForm::Rows, "(stamped → crash, mirrored, "),
        (MatrixForm::Inverse, "(crash → stamped, mirrored, "),
    ] {
        window.apply(ExportCommand::Copy(CopyForm::Matrix(form)));
        let mut toasts = window.state.log.notices.toasts();
        assert!(toasts.any(|toast| toast.text.contains(words)), "{words}");
    }
}

/// A real match whose part is mirrored.
fn mirrored_match(kind: JobKind) -> Result<JobOutput, String> {
    match really(kind)? {
        JobOutput::Matched(run) => Ok(JobOutput::Matched(Arc::new(MatchRun {
            crash_from_stamped: run.crash_from_stamped.after(&Similarity::mirror_x()),
            ..MatchRun::clone(&run)
        }))),
        other => Ok(other),
    }
}

#[test]
fn nothing_of_the_result_leaves_while_a_start_is_shown() {
    let mut window = Window::with_both();
    window.apply(MatchCommand::Run);
    let kept = [
        Action::CopyMatrix,
        Action::CopyCommandLine,
        Action::SaveReport,
        Action::SaveRecord,
        Action::SaveDeviations,
        Action::SaveMatrix,
        Action::SaveCards,
        Action::SaveMoved,
    ];
    let refusals = |window: &Window| -> Vec<String> {
        let refused = kept.map(|action| action.enabled(&window.state).err());
        let reasons = refused.into_iter().flatten();
        reasons.map(|Reason(reason)| reason.to_owned()).collect()
    };
    assert!(refusals(&window).is_empty());
    assert_eq!(window.state.shown_instead(), None);
    window.act(Action::Align);
    window.act(Action::NextStart);
    assert_eq!(window.state.shown_instead().as_deref(), Some("start 2"));
    let why = "A start is previewed: show the real pose first.";
    assert_eq!(refusals(&window), vec![why; kept.len()]);
    let can_map = window.state.can_map().unwrap_err();
    assert_eq!(can_map.0, why);
    window.apply(MatchCommand::ShowStart(None));
    assert!(refusals(&window).is_empty());
    assert!(window.state.can_map().is_ok());
    window.apply(PreviewCommand::AsLoaded(true));
    let shown = window.state.shown_instead();
    assert_eq!(shown.as_deref(), Some("the part as loaded"));
    assert_eq!(refusals(&window).len(), kept.len());
}
