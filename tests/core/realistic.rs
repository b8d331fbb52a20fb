//! The realistic example: an honest verdict, within what it states of itself.

use std::path::Path;

use shapematch::app::*;
use shapematch::assess::{PoseKind, ShapeKind, Verdict};
use shapematch::geometry::{Matrix4, Similarity};
use shapematch::jobs::{JobKind, PartSource, PipelineRunner, Runner as _};
use shapematch::monitor::Monitor;
use shapematch::pipeline::load::LoadedPart;
use shapematch::pipeline::outputs::report::report;
use shapematch::pipeline::project::Project;
use shapematch::role::{PerRole, Role};
use shapematch::samples;

use super::app::Window;

fn opened() -> Window {
    let mut window = Window::new();
    window.runner = Some(|kind: JobKind| {
        let run = PipelineRunner.run(kind, &Monitor::silent());
        run.map_err(|error| error.to_string())
    });
    window.act(Action::OpenRealisticExample);
    window
}

fn truth() -> Similarity {
    let files = samples::realistic();
    let file = files.iter().find(|file| file.name == "truth.json").unwrap();
    let truth: serde_json::Value = serde_json::from_slice(&file.bytes).unwrap();
    let rows: [[f64; 4]; 4] = serde_json::from_value(truth["crash_from_stamped"].clone()).unwrap();
    let matrix = Matrix4::from_fn(|row, column| rows[row][column]);
    Similarity::from_matrix4(&matrix, 1e-9).unwrap()
}

#[test]
fn its_verdict_is_honest() {
    let mut window = opened();
    assert!(window.state.has_uncertainty().is_err());
    window.act(Action::MatchOrStop);
    let result = window.state.document.current_result().unwrap();
    let assessment = &result.run.assessment;
    let stated = assessment.uncertainty().unwrap();
    let shape = assessment.shape.as_ref().unwrap();
    let part = window.part(Role::Stamped);
    let off = window
        .pose()
        .max_displacement(&truth(), part.loaded.mesh.positions());
    assert_eq!(
        assessment.verdict,
        Verdict::Good,
        "{:?}",
        assessment.reasons
    );
    assert_eq!(assessment.pose.as_ref().unwrap().kind, PoseKind::Certain);
    assert_eq!(shape.kind, ShapeKind::Deformed);
    assert!(shape.springback > 0.3 && shape.springback < 3.0);
    assert!(
        off < 3.0 * stated.largest + 0.5,
        "{off} for {}",
        stated.largest
    );
}

#[test]
fn its_mapping_meets_what_is_asked_for() {
    // The largest stamped value is a narrow peak, and the largest mapped one lies on a lower and wider one.
    let mut window = opened();
    window.act(Action::MatchOrStop);
    window.act(Action::MapOrCancel);
    let mapping = window.state.document.current_mapping().unwrap();
    let checks = &mapping.record.checks;
    assert!(checks.iter().any(|check| check.is_met.is_some()));
    let failed: Vec<_> = checks.iter().filter(|c| c.is_met == Some(false)).collect();
    assert!(failed.is_empty(), "{failed:?}");
}

#[test]
fn its_uncertainty_is_a_picture_and_its_rivals_are_named() {
    let mut window = opened();
    window.act(Action::MatchOrStop);
    // The colours are there for the best pose, and the action toggles them.
    assert_eq!(window.state.missing_for(ColorBy::Uncertainty), None);
    window.act(Action::ToggleUncertainty);
    assert_eq!(window.state.view.display.color_by, ColorBy::Uncertainty);
    let result = window.state.document.result.clone().unwrap();
    let both = window.state.document.both().unwrap();
    let parts: PerRole<&LoadedPart> = both.map(|part| &*part.loaded);
    let mut run = result.run.clone_inner();
    let mut outcome = (*run.outcome).clone();
    outcome.alternatives = vec![shapematch::registration::Alternative {
        target_from_source: super::app::shifted(3.0).after(&run.crash_from_stamped),
        score_ratio: 1.05,
        by_shape: false,
        start: 0,
    }];
    let other = outcome.alternatives[0].target_from_source;
    run.outcome = outcome.clone().into();
    let page = report(&run, parts, &Monitor::silent()).unwrap();
    assert!(page.contains("how far each node may be off"));
    assert!(
        page.contains("Matrix of pose 2: shifted by 3.00 mm"),
        "no title"
    );
    let number = other.translation.x.to_string();
    assert!(page.contains(&number), "no matrix with {number}");
    // Without rivals it is said whether any were sought.
    outcome.alternatives.clear();
    for (sought, words) in [
        (true, "None: half turns"),
        (false, "Not known: other poses"),
    ] {
        outcome.rivals_sought = sought;
        run.outcome = outcome.clone().into();
        let page = report(&run, parts, &Monitor::silent()).unwrap();
        assert!(page.contains(words), "{words}");
        assert_eq!(page.contains("none near"), sought);
    }
}

#[test]
fn projects_open_the_example_they_were_saved_with() {
    let path = Path::new("a.shapematch");
    let window = opened();
    let text = window.state.to_project(0).to_text(path).unwrap();
    let (project, _) = Project::parse(&text, path).unwrap();
    for (_, entry) in project.parts.iter() {
        assert!(entry.as_ref().unwrap().is_realistic_example);
    }
    let folder = tempfile::tempdir().unwrap();
    let saved = folder.path().join("a.shapematch");
    std::fs::write(&saved, &text).unwrap();
    let mut again = opened();
    let effects = again.state.apply(FileCommand::Open {
        paths: vec![saved],
        role: None,
    });
    for effect in effects {
        if let Effect::StartJob(kind, stamp) = effect {
            again.submit(*kind, stamp);
        }
    }
    assert_eq!(again.part(Role::Crash).source, PartSource::RealisticExample);
    let line = again.state.document.command_line().unwrap();
    assert!(line.starts_with("shapematch sample shapematch-realistic-example --realistic && "));
    // A project that says nothing of it has the first example.
    let earlier = text.replace("\"is_realistic_example\": true,", "");
    let (project, _) = Project::parse(&earlier, path).unwrap();
    assert!(!project.parts.crash.unwrap().is_realistic_example);
}
