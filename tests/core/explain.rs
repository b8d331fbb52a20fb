//! What the window says after a move and after a weak or failed match, and that each remedy does something.

use shapematch::app::*;
use shapematch::assess::{
    Assessment, Clarity, Reason, ShapeKind, ShapeReason, Twin, TwinAxis, Verdict,
};
use shapematch::geometry::{Point3, Rotation, Similarity, TriMesh, Vector3};
use shapematch::jobs::{JobEvent, JobKey, JobStage};
use shapematch::registration::{Hand, Method, Surface};
use shapematch::role::Role;
use shapematch::samples::SampleVariant;
use shapematch::text::Lengths;

use super::app::Window;
use super::bracket::write_bracket;

#[test]
fn the_overlap_follows_each_move_with_its_change() {
    let mut window = Window::with_both();
    assert_eq!(window.state.current_overlap(), None);
    window.apply(MoveCommand::Translate {
        axis: Axis::X,
        frame: AxisFrame::Global,
        distance: 500.0,
    });
    let far = *window.state.current_overlap().unwrap();
    assert_eq!((far.overlap, far.change), (0.0, None));
    window.act(Action::Undo);
    let back = *window.state.current_overlap().unwrap();
    assert!(back.overlap > 0.99, "{back:?}");
    assert_eq!(back.change, Some(back.overlap));
}

#[test]
fn a_drag_is_measured_when_it_ends() {
    let mut window = Window::with_both();
    let gesture = GestureId(0);
    for x in [1.0, 2.0] {
        window.apply(MoveCommand::Drag {
            gesture,
            delta: Similarity {
                translation: Vector3::new(x, 0.0, 0.0),
                ..Similarity::identity()
            },
            name: "Drag".to_owned(),
        });
        assert_eq!(window.state.current_overlap(), None);
    }
    window.apply(MoveCommand::EndDrag);
    assert!(window.state.current_overlap().is_some());
}

#[test]
fn a_weak_match_has_causes_whose_remedies_do_something() {
    let mut window = Window::with_both_and_no_rivals();
    assert!(window.state.causes().is_empty());
    window.act(Action::MatchOrStop);
    let result = window.state.document.current_result().unwrap();
    assert_ne!(result.run.assessment.verdict, Verdict::Good);
    let causes = window.state.causes();
    assert!(!causes.is_empty() && causes.len() <= 3);
    // The strip is bent about one direction only.
    let slides = causes.iter().find(|cause| cause.title.contains("Sliding"));
    assert!(
        slides.unwrap().evidence.contains("the y axis"),
        "{slides:?}"
    );
    for cause in causes {
        let (label, remedy) = cause.remedy.unwrap();
        let mut other = Window::with_both();
        other.state = window.state.clone();
        let shown = |state: &AppState| (state.document.clone(), state.view.clone(), state.pairs);
        let before = shown(&other.state);
        for command in remedy {
            other.apply(command);
        }
        assert!(before != shown(&other.state), "{label} does nothing");
    }
}

/// Changes what was found out about the result.
fn reassess(window: &mut Window, change: impl FnOnce(&mut Assessment)) {
    let result = window.state.document.result.as_mut().unwrap();
    let mut run = (*result.run).clone();
    let mut assessment = (*run.assessment).clone();
    change(&mut assessment);
    run.assessment = assessment.into();
    result.run = std::sync::Arc::new(run).into();
}

#[test]
fn the_larger_part_is_named_with_how_many_times_it_is_as_large() {
    let mut window = Window::with_both();
    window.act(Action::MatchOrStop);
    for (ratio, words) in [
        (
            0.001,
            "The stamped part is 1000 times as large as the crash part.",
        ),
        (
            1000.0,
            "The crash part is 1000 times as large as the stamped part.",
        ),
    ] {
        reassess(&mut window, |assessment| {
            assessment.verdict = Verdict::Poor;
            assessment.scale_check.size_ratio = ratio;
            assessment.scale_check.unit = shapematch::registration::guess_unit(ratio);
        });
        assert_eq!(window.state.causes()[0].evidence, words);
    }
}

#[test]
fn the_part_of_the_other_hand_comes_before_a_mapping() {
    let mut window = Window::with_both_and_no_rivals();
    window.act(Action::MatchOrStop);
    let score_ratio = 0.7;
    for (reason, is_better) in [
        (
            Reason::OppositeHand {
                score_ratio,
                by_borders: false,
            },
            true,
        ),
        // Its own mirror image is no other part.
        (
            Reason::NearMirrorImage {
                score_ratio,
                by_borders: false,
            },
            false,
        ),
    ] {
        reassess(&mut window, |assessment| {
            assessment.verdict = Verdict::Poor;
            assessment.reasons = vec![reason];
        });
        assert_eq!(window.state.is_other_hand_better(), is_better);
    }
}

#[test]
fn errors_of_the_reader_lead_to_the_diagnostics() {
    let mut window = Window::with_both();
    window.act(Action::MatchOrStop);
    reassess(&mut window, |assessment| {
        assessment.verdict = Verdict::Check;
        assessment.reasons = vec![Reason::ReadErrors {
            in_source: 0,
            in_target: 1,
        }];
    });
    let causes = window.state.causes();
    let cause = causes
        .into_iter()
        .find(|cause| cause.title == "Read errors")
        .unwrap();
    assert!(
        cause.evidence.starts_with("1 read error in the crash file"),
        "{cause:?}"
    );
    for command in cause.remedy.unwrap().1 {
        window.apply(command);
    }
    assert_eq!(window.state.view.tab, BottomTab::Diagnostics);
}

#[test]
fn an_ambiguous_pose_is_told_from_the_pose_that_is_shown() {
    let mut window = Window::with_both_and_no_rivals();
    window.act(Action::MatchOrStop);
    let result = window.state.document.result.as_ref().unwrap();
    let ratio = result.run.outcome.alternatives[0].score_ratio;
    reassess(&mut window, |assessment| {
        assessment.ambiguity.clarity = Clarity::Ambiguous;
        assessment.ambiguity.ratio = Some(ratio);
    });
    let ambiguous = |window: &Window| {
        let causes = window.state.causes();
        let mut causes = causes.into_iter();
        causes
            .find(|cause| cause.title == "Ambiguous pose")
            .unwrap()
    };
    let of_best = ambiguous(&window);
    let evidence = &of_best.evidence;
    assert!(
        evidence.contains("nearly as well (error 2 % higher)"),
        "{evidence}"
    );
    window.act(Action::NextAlternative);
    let (evidence, remedy) = (ambiguous(&window).evidence, ambiguous(&window).remedy);
    assert!(
        evidence.contains("at least as well (error 2 % lower)"),
        "{evidence}"
    );
    for command in remedy.unwrap().1 {
        window.apply(command);
    }
    let result = window.state.document.current_result().unwrap();
    assert_eq!(result.alternative, None);
}

#[test]
fn shapes_that_differ_are_explained_from_the_reason_not_from_its_words() {
    let mut window = Window::with_both_and_no_rivals();
    window.act(Action::MatchOrStop);
    let with = |reasons: Vec<Reason>, window: &mut Window| {
        reassess(window, |assessment| assessment.reasons = reasons);
        let causes = window.state.causes();
        causes
            .iter()
            .any(|cause| cause.title.contains("Springback"))
    };
    let differ = Reason::Shape {
        difference: ShapeReason::Bent {
            by: 0.5,
            limit: 0.1,
        },
    };
    assert!(with(vec![differ], &mut window));
    assert!(!with(vec![Reason::Stopped], &mut window));
}

#[test]
fn a_failed_match_leaves_the_pose_and_says_what_to_try() {
    let mut window = Window::with_both();
    window.holds = true;
    window.act(Action::MatchOrStop);
    let before = window.state.document.clone();
    let job = window.state.jobs.running().unwrap().id;
    window.apply(JobEvent {
        id: job,
        key: JobKey::Match,
        stamp: before.stamp(),
        elapsed: std::time::Duration::from_secs(1),
        stage: JobStage::Failed("no start found usable pairs".to_owned()),
    });
    assert_eq!(window.state.document, before);
    assert_eq!(
        window.state.match_failure(),
        Some("no start found usable pairs")
    );
    let labels: Vec<_> = window
        .state
        .failure_causes()
        .into_iter()
        .filter_map(|cause| Some(cause.remedy?.0))
        .collect();
    assert_eq!(labels, ["Try all starts", "Pick point pairs"]);
    window.holds = false;
    window.act(Action::MatchOrStop);
    assert_eq!(window.state.match_failure(), None);
}

#[test]
fn umeyama_needs_the_same_nodes_and_says_so() {
    let mut window = Window::with_both_and_no_rivals();
    let mut recipe = window.state.document.recipe.clone();
    recipe.settings.set_method(Method::Umeyama);
    window.apply(MatchCommand::SetRecipe(Box::new(recipe)));
    window.act(Action::MatchOrStop);
    let message = window.state.match_failure().unwrap();
    assert!(message.contains("another method"), "{message}");
    let causes = window.state.failure_causes();
    assert_eq!(causes.len(), 1);
    let (label, commands) = causes.into_iter().next().unwrap().remedy.unwrap();
    assert!(label.contains("Fractional ICP"));
    for command in commands {
        window.apply(command);
    }
    assert!(window.state.document.current_result().is_some());
}

#[test]
fn a_twin_is_told_by_angle_and_axis() {
    let corner = |x: f64, y: f64| Point3::new(x, y, 0.0);
    let positions = vec![
        corner(0.0, 0.0),
        corner(100.0, 0.0),
        corner(100.0, 30.0),
        corner(0.0, 30.0),
    ];
    let mesh = TriMesh::new(positions, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    let plate = Surface::new(&mesh, "source").unwrap();
    let pose = |turn: Vector3| Similarity {
        rotation: *Rotation::new(turn).to_rotation_matrix().matrix(),
        ..Similarity::identity()
    };
    let best = pose(Vector3::new(0.3, 0.2, 0.1));
    let half = std::f64::consts::PI;
    for (turn, axis, words) in [
        (
            Vector3::x() * half,
            TwinAxis::Long,
            "rotated by 180° about its long axis",
        ),
        (
            Vector3::y() * half,
            TwinAxis::Cross,
            "rotated by 180° about its short axis",
        ),
        (
            Vector3::z() * (half / 2.0),
            TwinAxis::Through,
            "rotated by 90° in its own plane",
        ),
    ] {
        let twin = Twin::of(&plate, &best, &best.after(&pose(turn)));
        assert_eq!(twin.axis, axis);
        assert_eq!(twin.words(Lengths::default()), words);
    }
}

#[test]
fn a_file_in_metres_is_the_cause_among_the_parts_of_a_whole_model_too() {
    let [whole, metres] = [SampleVariant::WholeModel, SampleVariant::Metres].map(|variant| {
        let folder = tempfile::tempdir().unwrap();
        write_bracket(folder.path(), variant);
        folder
    });
    let mut window = Window::new();
    window.runner = Some(super::app_mapping::real);
    let crash = whole.path().join("crash.k");
    window.open(crash.to_str().unwrap(), Role::Crash);
    let stamped = metres.path().join("stamped.dynain");
    window.open(stamped.to_str().unwrap(), Role::Stamped);
    window.act(Action::MatchOrStop);
    let causes = window.state.causes();
    let titles: Vec<_> = causes.iter().map(|cause| cause.title.as_str()).collect();
    assert_eq!(titles, ["Different units"]);
    let (label, _) = causes[0].remedy.as_ref().unwrap();
    assert_eq!(label, "Treat stamped as m");
}

/// A match that says that the opposite hand fits better, and that the shapes differ.
fn with_remedies() -> Window {
    let mut window = Window::with_both();
    window.act(Action::MatchOrStop);
    reassess(&mut window, |assessment| {
        assessment.verdict = Verdict::Poor;
        assessment.reasons = vec![Reason::OppositeHand {
            score_ratio: 0.5,
            by_borders: false,
        }];
    });
    window
}

fn take_remedy(window: &mut Window, label: &str) {
    let remedies = window.state.causes();
    let mut remedies = remedies.into_iter().filter_map(|cause| cause.remedy);
    let found = remedies.find(|remedy| remedy.0.starts_with(label));
    for command in found.unwrap().1 {
        window.apply(command);
    }
}

fn hand(window: &Window) -> Hand {
    window.state.document.recipe.settings.hand
}

#[test]
fn what_a_remedy_changed_is_undone_with_its_match_and_ends_with_its_parts() {
    let mut window = with_remedies();
    take_remedy(&mut window, "Match the opposite hand");
    assert_eq!(hand(&window), Hand::Mirrored);
    assert_eq!(window.state.history.undo_name(), Some("Match"));
    window.act(Action::Undo);
    assert_eq!(hand(&window), Hand::Same);
    let before = window.state.document.current_result().unwrap();
    let reasons = &before.run.assessment.reasons;
    assert!(matches!(reasons[..], [Reason::OppositeHand { .. }]));
    window.act(Action::Redo);
    assert_eq!(hand(&window), Hand::Mirrored);

    // What the user chose himself stays, and the same file read again is the same part.
    let mut recipe = window.state.document.recipe.clone();
    recipe.settings.n_coarse_points = 700;
    window.apply(MatchCommand::SetRecipe(Box::new(recipe)));
    window.apply(FileCommand::Reload(Role::Stamped));
    assert_eq!(hand(&window), Hand::Mirrored);
    window.open("panel_stamped.k", Role::Stamped);
    assert_eq!(hand(&window), Hand::Same);
    assert_eq!(window.state.document.recipe.settings.n_coarse_points, 700);
    window.act(Action::Undo);
    assert_eq!(hand(&window), Hand::Mirrored, "with the parts");
    window.apply(PartCommand::UseOnly(PartRef {
        role: Role::Crash,
        id: 12,
    }));
    assert_eq!(hand(&window), Hand::Same, "another crash part");

    let mut window = with_remedies();
    take_remedy(&mut window, "Match the opposite hand");
    window.act(Action::ResetAll);
    assert_eq!(hand(&window), Hand::Same, "as before the remedy");
    window.act(Action::Undo);
    assert_eq!(hand(&window), Hand::Mirrored, "with its result");

    let mut window = Window::with_both();
    let mut recipe = window.state.document.recipe.clone();
    recipe.settings.hand = Hand::Either;
    window.apply(MatchCommand::SetRecipe(Box::new(recipe)));
    window.open("panel_stamped.k", Role::Stamped);
    assert_eq!(hand(&window), Hand::Either, "the user's own choice");
}

#[test]
fn a_remedy_whose_match_is_cancelled_changes_nothing() {
    let mut window = with_remedies();
    let before = window.state.document.clone();
    let n_steps = window.state.history.n_done();
    window.holds = true;
    take_remedy(&mut window, "Match the opposite hand");
    assert_eq!(hand(&window), Hand::Mirrored);
    window.apply(MatchCommand::Cancel);
    assert_eq!(window.state.document, before);
    assert_eq!(window.state.history.n_done(), n_steps);
}

#[test]
fn a_tolerance_that_was_allowed_holds_for_these_parts() {
    let mut window = with_remedies();
    reassess(&mut window, |assessment| {
        let by = 4.693;
        assessment.reasons = vec![Reason::Shape {
            difference: ShapeReason::Surface {
                by,
                limit: 1.0,
                at: Point3::origin(),
                mostly: false,
            },
        }];
    });
    let tolerance = |window: &Window| window.state.document.recipe.settings.shape_tolerance;
    take_remedy(&mut window, "Allow");
    assert_eq!(tolerance(&window), 4.7);
    assert_eq!(window.state.history.undo_name(), Some("Allow 4.70"));
    window.open("panel_stamped.k", Role::Stamped);
    assert_eq!(tolerance(&window), 0.0);
    window.act(Action::Undo);
    assert_eq!(tolerance(&window), 4.7);
    window.act(Action::Undo);
    assert_eq!(tolerance(&window), 0.0);
}

#[test]
fn the_question_about_the_unit_stays_in_sight() {
    let mut window = Window::new();
    window.open("stamped.k", Role::Crash);
    window.open("says_gpa.k", Role::Stamped);
    assert_eq!(window.state.unit_hint(), None);
    assert_eq!(window.state.view.sections.in_use(), Section::Match);
    window.open("metres.k", Role::Stamped);
    assert!(window.state.unit_hint().is_some());
    assert_eq!(window.state.view.sections.in_use(), Section::Load);
}

#[test]
fn a_unit_that_was_changed_after_the_match_is_named() {
    let mut window = Window::with_both();
    window.act(Action::MatchOrStop);
    window.apply(FileCommand::SetLengthFactor {
        role: Role::Stamped,
        factor: 2.0,
    });
    let stale = window.state.stale(Section::Match).unwrap();
    assert_eq!(stale.reason, "the unit was changed after the match");
    let why = window.state.document.match_of_parts().unwrap_err().0;
    assert!(why.starts_with("The unit was changed"), "{why}");
    window.act(Action::Undo);
    window.apply(PartCommand::UseOnly(PartRef {
        role: Role::Crash,
        id: 12,
    }));
    let stale = window.state.stale(Section::Match).unwrap();
    assert_eq!(stale.reason, "a part was changed after the match");
}

#[test]
fn several_parts_and_a_different_one_come_before_other_poses() {
    let mut window = Window::with_both_and_no_rivals();
    window.act(Action::MatchOrStop);
    let titles = |window: &Window| -> Vec<String> {
        let causes = window.state.causes();
        causes.into_iter().map(|cause| cause.title).collect()
    };
    reassess(&mut window, |assessment| {
        assessment.verdict = Verdict::Poor;
        assessment.ambiguity.clarity = Clarity::Ambiguous;
    });
    assert!(titles(&window).contains(&"Ambiguous pose".to_owned()));
    reassess(&mut window, |assessment| {
        assessment.shape.as_mut().unwrap().kind = ShapeKind::Different;
    });
    let found = titles(&window);
    assert_eq!(found[0], "A different part");
    assert!(!found.contains(&"Ambiguous pose".to_owned()), "{found:?}");
    reassess(&mut window, |assessment| {
        assessment.coverage.target_on_source.overlap = 0.2;
    });
    assert_eq!(titles(&window)[0], "2 crash parts are matched as one");
}
