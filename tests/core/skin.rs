//! An offset between skin and mid-surface is taken out of the pose where it can be told from a shift.

use std::path::Path;
use std::sync::Arc;

use shapematch::formats::Model;
use shapematch::geometry::{Similarity, TriMesh};
use shapematch::monitor::Monitor;
use shapematch::pipeline::load::{LoadSettings, LoadedPart, prepare};
use shapematch::pipeline::match_parts::{MatchRecipe, MatchRun, match_parts};
use shapematch::role::PerRole;
use shapematch::samples::SamplePart;
use shapematch::samples::scenario::{Scenario, ScenarioPair};

fn loaded(mesh: &TriMesh, name: &str) -> LoadedPart {
    let model = Arc::new(Model::from_mesh(mesh, name));
    let settings = LoadSettings::default();
    prepare(Path::new(name), model, &settings, &Monitor::silent()).unwrap()
}

fn matched(pair: &ScenarioPair, remove_offset: bool) -> MatchRun {
    let parts = PerRole::new(
        loaded(&pair.crash, "crash"),
        loaded(&pair.stamped, "stamped"),
    );
    let mut recipe = MatchRecipe::default();
    recipe.settings.remove_offset = remove_offset;
    let still = Similarity::identity();
    match_parts(parts.as_ref(), None, &recipe, &still, &Monitor::silent()).unwrap()
}

#[test]
fn the_pose_is_that_of_the_mid_surfaces() {
    for part in [SamplePart::Sill, SamplePart::Rail, SamplePart::Pillar] {
        let pair = Scenario::Offset(1.0).pair(part, 3);
        let truth = pair.crash_from_stamped.unwrap();
        let off = |run: &MatchRun| {
            let nodes = pair.stamped.positions();
            run.crash_from_stamped.max_displacement(&truth, nodes)
        };
        let [pushed, removed] = [false, true].map(|remove| matched(&pair, remove));
        let shape = removed.assessment.shape.as_ref().unwrap();
        assert!(shape.is_offset_removed, "{part:?}: {shape:?}");
        let stated = shape.offset.unwrap();
        assert!(
            (stated.abs() / pair.offset.abs() - 1.0).abs() < 0.15,
            "{part:?}: {stated}"
        );
        assert!(
            off(&removed) < 0.5 * pair.offset.abs(),
            "{part:?}: {}",
            off(&removed)
        );
        assert!(off(&removed) <= off(&pushed) + 0.05, "{part:?}");
        let certain = removed.assessment.uncertainty().unwrap();
        assert!(
            off(&removed) <= 3.0 * certain.largest + 0.05,
            "{part:?}: {}",
            certain.largest
        );
        let words = removed
            .assessment
            .statements(shapematch::text::Lengths::default());
        assert!(words[1].contains("taken out of the pose"), "{words:?}");
    }
}

#[test]
fn nothing_is_removed_where_it_cannot_be_told_or_is_not_there() {
    let flat = Scenario::Offset(1.0).pair(SamplePart::Plate, 3);
    let same = Scenario::SameSurface.pair(SamplePart::Rail, 3);
    for pair in [flat, same] {
        let [plain, removed] = [false, true].map(|remove| matched(&pair, remove));
        assert_eq!(plain.crash_from_stamped, removed.crash_from_stamped);
        assert!(!removed.assessment.shape.as_ref().unwrap().is_offset_removed);
    }
}
