//! Deviation, labels and section as the window keeps them: commands in, state and jobs out.

use std::sync::Arc;
use std::time::Duration;

use shapematch::app::*;
use shapematch::geometry::{Plane, Point3, Vector3};
use shapematch::jobs::{JobId, JobKey, JobKind, JobStage};
use shapematch::pipeline::inspect::Comparison;
use shapematch::role::{PerRole, Role};

use super::app::Window;

fn with_map() -> Window {
    let mut window = Window::with_both();
    window.act(Action::ToggleDeviation);
    window
}

fn nudge(window: &mut Window, distance: f64) {
    window.apply(MoveCommand::Translate {
        axis: Axis::Z,
        frame: AxisFrame::Global,
        distance,
    });
}

/// The last comparison as if it had taken so long.
fn as_if_it_took(window: &mut Window, took: Duration) {
    let comparison = Comparison {
        took,
        ..window.state.comparison().unwrap().clone()
    };
    let compared = OfParts::new(&window.state.document, Arc::new(comparison).into());
    window.state.inspect.compared = Some(compared);
}

#[test]
fn the_deviation_is_measured_when_something_shows_it_and_follows_quick_moves() {
    let mut window = Window::with_both();
    assert_eq!(window.state.freshness(), Freshness::Missing);
    window.act(Action::ToggleDeviation);
    assert_eq!(window.state.freshness(), Freshness::Current);
    as_if_it_took(&mut window, Duration::from_millis(20));
    nudge(&mut window, 0.5);
    assert_eq!(window.state.freshness(), Freshness::Current);
    let (role, stats) = window.state.deviation_stats().unwrap();
    assert_eq!(role, Role::Stamped);
    // The strip bends, so the distance is a little less than the way.
    assert!((0.4..=0.5).contains(&stats.max), "{}", stats.max);
    window.act(Action::Undo);
    assert_eq!(window.state.freshness(), Freshness::Current);
    assert!(window.state.deviation_stats().unwrap().1.max.abs() < 1e-9);
}

/// What is hidden does not catch the pointer.
#[test]
fn landmarks_of_hidden_parts_are_not_shown() {
    let mut window = Window::with_both();
    let n_shown = |window: &Window| {
        let landmarks = window.part(Role::Crash).shown_landmarks();
        landmarks
            .map(|of_part| of_part.corners.len())
            .sum::<usize>()
    };
    assert!(n_shown(&window) > 0);
    for id in window.part(Role::Crash).facts.used.clone() {
        let role = Role::Crash;
        window.apply(PartCommand::SetVisible(PartRef { role, id }, false));
    }
    assert_eq!(n_shown(&window), 0);
}

#[test]
fn a_map_of_the_match_that_is_turned_off_brings_the_colours_before_it_back() {
    let mut window = Window::with_both();
    let colors = |window: &Window| window.state.view.display.color_by;
    window.act(Action::ToggleDeviation);
    window.act(Action::ToggleDeviation);
    assert_eq!(colors(&window), ColorBy::Role);
    let display = Display {
        color_by: ColorBy::PlasticStrain,
        ..window.state.view.display.clone()
    };
    window.apply(ViewCommand::SetDisplay(Box::new(display)));
    window.act(Action::ToggleDeviation);
    window.act(Action::ToggleEdges);
    window.act(Action::ToggleOverlap);
    assert_eq!(colors(&window), ColorBy::Overlap);
    window.act(Action::ToggleOverlap);
    assert_eq!(colors(&window), ColorBy::PlasticStrain);
    assert!(window.state.view.display.has_edges, "the rest stays");
}

#[test]
fn the_deviation_follows_to_another_pose_of_the_match() {
    let mut window = with_map();
    window.act(Action::MatchOrStop);
    let of_best = window.state.deviation_stats().unwrap().1.rms;
    window.act(Action::NextAlternative);
    assert_eq!(window.state.freshness(), Freshness::Current);
    let comparison = window.state.comparison().unwrap();
    assert_eq!(comparison.crash_from_stamped, window.pose());
    assert_ne!(window.state.deviation_stats().unwrap().1.rms, of_best);
}

#[test]
fn a_slow_deviation_is_out_of_date_until_it_is_asked_for() {
    let mut window = with_map();
    as_if_it_took(&mut window, Duration::from_secs(20));
    nudge(&mut window, 0.5);
    assert_eq!(window.state.freshness(), Freshness::OutOfDate);
    window.holds = true;
    window.act(Action::UpdateDeviation);
    assert_eq!(window.state.freshness(), Freshness::Updating);
    window.finish_held();
    assert_eq!(window.state.freshness(), Freshness::Current);
    // Another level is another surface.
    as_if_it_took(&mut window, Duration::from_secs(20));
    window.apply(ReduceCommand::To {
        roles: PerRole {
            crash: true,
            stamped: true,
        },
        max_triangles: 60,
    });
    assert_eq!(window.state.freshness(), Freshness::OutOfDate);
    window.act(Action::UpdateDeviation);
    assert_eq!(window.state.freshness(), Freshness::Current);
    let level = window
        .state
        .document
        .part(Role::Stamped)
        .unwrap()
        .reduced_mesh();
    let drawn = window.state.comparison().unwrap().drawn(level).unwrap();
    assert_eq!(drawn.signed.len(), level.n_vertices());
}

#[test]
fn a_cancelled_comparison_is_not_asked_for_again_by_itself() {
    let mut window = Window::with_both();
    window.holds = true;
    window.act(Action::ToggleDeviation);
    assert!(window.state.jobs.is_active(JobKey::Compare));
    assert_eq!(window.held.len(), 1);
    window.act(Action::Escape);
    assert!(window.held.is_empty() && !window.state.jobs.is_busy());
    window.act(Action::ToggleEdges);
    assert!(window.held.is_empty(), "no second try");
    window.act(Action::UpdateDeviation);
    assert!(matches!(window.held[0].1, JobKind::Compare(_)));
}

#[test]
fn a_comparison_that_failed_is_tried_again_at_another_pose_alone() {
    let freshness_after = |moved: f64| {
        let mut window = Window::with_both();
        let asked_at = window.state.document.stamp();
        if moved != 0.0 {
            nudge(&mut window, moved);
        }
        let stage = JobStage::Failed("the memory is full".to_owned());
        window.tell(JobId(99), JobKey::Compare, asked_at, stage);
        window.act(Action::ToggleDeviation);
        window.state.freshness()
    };
    assert_eq!(freshness_after(0.5), Freshness::Current);
    assert_eq!(freshness_after(0.0), Freshness::Missing);
}

#[test]
fn nothing_is_measured_that_nobody_sees() {
    let mut window = Window::with_both();
    window.holds = true;
    let n_compared = |window: &Window| {
        let held = window.held.iter();
        held.filter(|(_, kind, _)| matches!(kind, JobKind::Compare(_)))
            .count()
    };
    nudge(&mut window, 0.5);
    assert_eq!(n_compared(&window), 0);
    window.apply(ViewCommand::SetTab(BottomTab::Deviation));
    assert_eq!(n_compared(&window), 1);
}

#[test]
fn colours_are_symmetric_round_and_neutral_within_the_tolerance() {
    let mut window = with_map();
    nudge(&mut window, 0.7);
    let scale_of = |window: &mut Window, coloring: Coloring| {
        window.state.view.display.coloring = coloring;
        window.state.deviation_scale().unwrap()
    };
    let scale = scale_of(&mut window, Coloring::default());
    assert_eq!((scale.min, scale.max, scale.tolerance), (-1.0, 1.0, 0.2));
    let narrow = Coloring {
        limits: Some([-0.4, 0.4]),
        ..Coloring::default()
    };
    let scale = scale_of(&mut window, narrow);
    assert_eq!((scale.max, scale.tolerance), (0.4, 0.2), "same share");
    let typed = Coloring {
        limits: Some([-0.5, 2.0]),
        tolerance: Some(0.3),
        ..Coloring::default()
    };
    let scale = scale_of(&mut window, typed);
    assert_eq!((scale.min, scale.max, scale.tolerance), (-0.5, 2.0, 0.3));
}

#[test]
fn labels_are_steps_of_the_history_and_belong_to_their_part() {
    let mut window = with_map();
    let n_steps = window.state.history.n_done();
    let near = Point3::new(3.1, 1.9, 0.2);
    window.apply(InspectCommand::Pin(Role::Stamped, near));
    window.apply(InspectCommand::Pin(Role::Stamped, near));
    assert_eq!(window.state.history.n_done(), n_steps + 1, "one is enough");
    let label = window.state.document.labels[0].clone();
    assert_eq!(label.position, Point3::new(3.0, 2.0, 0.02 * 9.0));
    let part = window.state.document.part(Role::Stamped).unwrap();
    let loaded = &part.loaded;
    let ids = loaded.model.nodes.ids();
    let nodes = loaded.ids.nodes().iter();
    let mut node = nodes
        .filter(|n| n.vertex == label.vertex)
        .map(|n| ids[n.node as usize]);
    assert_eq!(label.node, node.next());
    nudge(&mut window, 0.5);
    window.act(Action::UpdateDeviation);
    let value = window.state.label_value(&label).unwrap();
    assert!((0.45..=0.5).contains(&value), "{value}");
    for name in ["f", "fl", "flange"] {
        window.apply(InspectCommand::Rename {
            id: label.id,
            name: name.to_owned(),
            gesture: GestureId(1),
        });
    }
    assert_eq!(window.state.document.labels[0].name, "flange");
    window.act(Action::Undo);
    assert_eq!(window.state.document.labels[0].name, "");
    window.apply(InspectCommand::Remove(label.id));
    assert!(window.state.document.labels.is_empty());
    window.act(Action::Undo);
    assert_eq!(window.state.document.labels, [label]);
    window.apply(FileCommand::Swap);
    let (role, _) = window.state.document.shown_labels().next().unwrap();
    assert_eq!(role, Role::Crash, "it went with its part");
    window.act(Action::CloseCrash);
    assert_eq!(window.state.document.shown_labels().count(), 0);
}

#[test]
fn the_section_cuts_across_the_longest_side_and_steps_by_a_tenth_of_an_element() {
    let mut window = Window::with_both();
    assert!(Action::SectionForward.enabled(&window.state).is_err());
    window.act(Action::ToggleSection);
    let plane = window.state.inspect.section.shown().unwrap();
    assert_eq!(plane.normal, Vector3::x());
    assert_eq!(
        plane.point,
        window.state.visible_bounds(Role::Crash).center()
    );
    window.act(Action::SectionForward);
    window.act(Action::SectionForward);
    window.act(Action::SectionBack);
    let moved = window.state.inspect.section.shown().unwrap();
    let step = window.state.document.section_step();
    assert!((moved.distance(&plane.point) + step).abs() < 1e-12);
    window.act(Action::SectionZ);
    let turned = window.state.inspect.section.shown().unwrap();
    assert_eq!(turned, Plane::new(moved.point, &Vector3::z()));
    window.act(Action::ToggleSectionClip);
    assert!(window.state.inspect.section.is_clipped);
    window.act(Action::ToggleSection);
    assert_eq!(window.state.inspect.section.shown(), None);
    window.act(Action::ToggleSection);
    assert_eq!(
        window.state.inspect.section.shown(),
        Some(turned),
        "it stays where it was"
    );
}

/// Shares and colours can be compared with those before the move, until the range is asked for.
#[test]
fn the_range_stays_while_a_matched_part_is_moved_by_hand() {
    let mut window = with_map();
    window.act(Action::MatchOrStop);
    let range = |window: &Window| window.state.deviation_scale().unwrap().max;
    let before = range(&window);
    nudge(&mut window, 0.3);
    assert_eq!(range(&window), before);
    assert!(window.state.is_range_held());
    window.apply(InspectCommand::FitRange);
    assert_ne!(range(&window), before);
    assert!(!window.state.is_range_held());
}

/// With the parts apart the plane goes through one of them, and anew where the parts were moved away from it.
#[test]
fn the_section_meets_a_part() {
    let mut window = Window::with_both();
    window.act(Action::ToggleMoveOver);
    nudge(&mut window, 5000.0);
    window.act(Action::ToggleSection);
    let crash = window.part(Role::Crash).bounds();
    let plane = window.state.inspect.section.shown().unwrap();
    assert_eq!(plane.point, crash.center());
    window.act(Action::ToggleSection);
    let far = Plane::new(Point3::new(9e6, 0.0, 0.0), &Vector3::x());
    window.state.inspect.section.plane = Some(far);
    window.act(Action::ToggleSection);
    assert_eq!(window.state.inspect.section.shown(), Some(plane));
}

/// A plane of the parts before goes through the ones that are loaded now, across the same direction.
#[test]
fn the_section_goes_with_the_parts_that_are_loaded() {
    let mut window = Window::with_both();
    window.act(Action::SectionY);
    let plane = window.state.inspect.section.shown().unwrap();
    let far = Plane::new(Point3::new(9e6, 9e6, 9e6), &plane.normal);
    let section = SectionView {
        plane: Some(far),
        ..window.state.inspect.section
    };
    window.apply(InspectCommand::SetSection(section));
    assert_eq!(window.state.inspect.section.shown(), Some(far));
    // A direction that is asked for finds the parts, too.
    window.act(Action::SectionX);
    let across = window.state.inspect.section.shown().unwrap();
    assert_eq!(across.normal, Vector3::x());
    assert!(across.meets(&window.part(Role::Crash).bounds()));
    window.apply(InspectCommand::SetSection(section));
    window.open("panel_crash.k", Role::Crash);
    let placed = window.state.inspect.section.shown().unwrap();
    assert_eq!(placed.normal, plane.normal);
    assert!(placed.meets(&window.part(Role::Crash).bounds()));
}

#[test]
fn looking_at_a_place_brings_the_camera_there() {
    let mut window = with_map();
    let place = Point3::new(3.0, 2.0, 0.18);
    window.apply(InspectCommand::LookAt {
        role: Role::Stamped,
        point: place,
        text: "node 7".to_owned(),
    });
    let (role, marked) = window.state.looked_at().unwrap();
    assert_eq!((role, &*marked.text), (Role::Stamped, "node 7"));
    let camera = window.state.view.cameras.stamped;
    let bounds = window.state.visible_bounds(Role::Stamped);
    assert!((camera.target - place).norm() < 1e-6);
    assert!(camera.height < 0.5 * bounds.diagonal());
    assert_eq!(window.state.view.focus, Role::Stamped);
    window.apply(Command::Escape);
    assert!(window.state.looked_at().is_none(), "the mark is gone first");
}
