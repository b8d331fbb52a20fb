//! The table adds up: no setting without a row, no row without a setting, no name twice.

use std::collections::BTreeSet;

use serde_json::Value as Json;

use super::*;
use crate::geometry::{Point3, TriMesh};
use crate::mapping::{MapMethod, MapOptions, NormalSense, Overlap};
use crate::monitor::Monitor;
use crate::registration::{
    DataSide, Hand, MatchInput, MatchSettings, Method, Metric, Motion, PairSelection, PairWith,
    RegistrationError, Search, StartMethod, Surface, match_surfaces,
};
use crate::text::Lengths;

/// The fields of a stored object, those of inner objects behind a dot.
fn leaves(json: &Json, path: &str, found: &mut BTreeSet<String>) {
    for (name, value) in json.as_object().unwrap() {
        let path = if path.is_empty() {
            name.clone()
        } else {
            format!("{path}.{name}")
        };
        let is_inner = ["settings", "settings.starts"].contains(&path.as_str());
        if is_inner {
            leaves(value, &path, found);
        } else {
            found.insert(path);
        }
    }
}

#[test]
fn every_field_has_exactly_one_row() {
    let mut fields = BTreeSet::new();
    let recipe = serde_json::to_value(MatchRecipe::default()).unwrap();
    leaves(&recipe, "", &mut fields);
    // The parameters of each kind of pair selection are settings of their own.
    for selection in PairSelection::ALL {
        let stored = serde_json::to_value(selection).unwrap();
        let kinds = stored.as_object().into_iter().flatten();
        for parameter in kinds.flat_map(|(_, inner)| inner.as_object().unwrap().keys()) {
            fields.insert(format!("settings.selection.{parameter}"));
        }
    }
    let rows: Vec<String> = SETTINGS.iter().map(|row| row.field.to_owned()).collect();
    assert_eq!(rows.len(), fields.len(), "a field has two rows");
    assert_eq!(rows.into_iter().collect::<BTreeSet<_>>(), fields);
    // The quantities of a mapping are chosen apart.
    let options = serde_json::to_value(MapOptions::default()).unwrap();
    let names = options.as_object().unwrap().keys();
    let fields: BTreeSet<&str> = names.map(String::as_str).collect();
    let rows: BTreeSet<&str> = MAP_SETTINGS.iter().map(|row| row.field).collect();
    assert_eq!(rows.len(), MAP_SETTINGS.len(), "a field has two rows");
    assert_eq!(&rows | &BTreeSet::from(["quantities"]), fields);
}

#[test]
fn no_name_stands_twice() {
    no_name_twice(&SETTINGS);
    no_name_twice(&MAP_SETTINGS);
    for row in &SETTINGS {
        assert!(std::ptr::eq(setting(row.option).unwrap(), row));
    }
}

fn no_name_twice<R>(rows: &[Setting<R>]) {
    let count = |names: Vec<&str>| {
        (
            names.len(),
            names.into_iter().collect::<BTreeSet<_>>().len(),
        )
    };
    let all = |name: fn(&Setting<R>) -> &'static str| rows.iter().map(name).collect::<Vec<_>>();
    for names in [
        all(|row| row.option),
        all(|row| row.key),
        all(|row| row.label),
        all(|row| row.help),
    ] {
        let (n, n_different) = count(names.clone());
        assert_eq!(n, n_different, "{names:?}");
    }
    for row in rows {
        assert!(
            !row.help.ends_with('.') && !row.help.is_empty(),
            "{}",
            row.option
        );
    }
}

/// Names of a choice are found again and differ; so do its labels.
fn check_choice<T: Choice + std::fmt::Debug>() {
    let mut seen = BTreeSet::new();
    for choice in T::ALL {
        let ChoiceWords { name, label, help } = choice.words();
        assert_eq!(T::from_name(name), Some(*choice));
        assert!(seen.insert(name), "{name} stands twice");
        assert!(seen.insert(label) && !help.ends_with('.'), "{choice:?}");
    }
    assert_eq!(T::from_name("no such choice"), None);
}

#[test]
fn choices_are_found_by_name() {
    check_choice::<Method>();
    check_choice::<StartMethod>();
    check_choice::<DataSide>();
    check_choice::<PairWith>();
    check_choice::<PairSelection>();
    check_choice::<Metric>();
    check_choice::<Motion>();
    check_choice::<Hand>();
    check_choice::<Search>();
    check_choice::<MapMethod>();
    check_choice::<NormalSense>();
    check_choice::<Overlap>();
}

#[test]
fn values_are_shown_with_their_unit() {
    let recipe = MatchRecipe::default();
    let shown = |option: &str| {
        let row = setting(option).unwrap();
        row.shown(&row.get(&recipe).unwrap(), Lengths::default())
    };
    assert_eq!(shown("angle-segment"), "40°");
    assert_eq!(shown("tolerance"), "0.001 edge lengths");
    assert_eq!(shown("refine-points"), "3,000");
    assert_eq!(shown("refine-on-full"), "yes");
    assert_eq!(shown("method"), "Fractional ICP");
    assert_eq!(shown("triangles"), "full meshes");
    assert_eq!(shown("floor"), "estimated");
}

/// A square of two triangles.
fn square() -> TriMesh {
    let corner = |x: f64, y: f64| Point3::new(x, y, 0.0);
    let corners = vec![
        corner(0.0, 0.0),
        corner(9.0, 0.0),
        corner(9.0, 5.0),
        corner(0.0, 5.0),
    ];
    TriMesh::new(corners, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
}

#[test]
fn the_ranges_of_the_table_are_those_of_the_match() {
    let surface = Surface::new(&square(), "source").unwrap();
    let input = MatchInput {
        source: &surface,
        target: &surface,
        reduced: None,
    };
    let refused = |row: &Setting, value: f64| {
        let mut recipe = MatchRecipe::default();
        if row.option == "overlap" {
            recipe.settings = MatchSettings::of(Method::Trimmed);
        }
        assert!(row.set(&mut recipe, &Value::Number(value)));
        let monitor = Monitor::silent();
        // Whatever is not refused at once need not run.
        monitor.request_cancel();
        let result = match_surfaces(&input, &recipe.settings, &monitor);
        matches!(
            result,
            Err(RegistrationError::Setting { .. } | RegistrationError::AngleSegment { .. })
        )
    };
    for row in &SETTINGS {
        let Domain::Number { range, .. } = &row.domain else {
            continue;
        };
        let (low, high) = (*range.start(), *range.end());
        assert!(!refused(row, low) && !refused(row, high), "{}", row.option);
        assert!(refused(row, low - 1e-6), "{}", row.option);
        assert!(
            high == f64::MAX || refused(row, high + 1e-6),
            "{}",
            row.option
        );
        assert!(refused(row, f64::NAN), "{}", row.option);
    }
}
