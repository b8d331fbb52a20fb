//! Everything that leaves the program, read back.

use std::path::Path;
use std::sync::{Arc, OnceLock};

use base64::Engine as _;
use shapematch::formats::{Memory, ReadOptions, read};
use shapematch::geometry::{Point3, Similarity, TriMesh};
use shapematch::jobs::{
    Destination, ExportRequest, Exported, JobError, JobKind, JobOutput, PipelineRunner, Runner as _,
};
use shapematch::monitor::Monitor;
use shapematch::pipeline::load::{LoadSettings, LoadedPart, load_from};
use shapematch::pipeline::match_parts::{MatchRecipe, MatchRun, match_parts};
use shapematch::pipeline::outputs::node_table::{node_deviations, node_table};
use shapematch::pipeline::outputs::record::match_record;
use shapematch::pipeline::outputs::report::report;
use shapematch::pipeline::outputs::{MeshOutput, Output, OutputInput};
use shapematch::report::cards::read_back;
use shapematch::report::{CardForm, parse_matrix};
use shapematch::role::{PerRole, Role};
use shapematch::samples;

/// A name that would break a page that does not guard itself.
const HOSTILE: &str = "<b>\"crash\" & 'co'.k.gz";

struct Matched {
    parts: PerRole<Arc<LoadedPart>>,
    run: Arc<MatchRun>,
}

/// The bundled pair, matched once for all tests.
fn matched() -> &'static Matched {
    static MATCHED: OnceLock<Matched> = OnceLock::new();
    MATCHED.get_or_init(|| {
        let files = samples::bundled();
        let load = |starts: &str, name: &str| {
            let file = files
                .iter()
                .find(|file| file.name.starts_with(starts))
                .unwrap();
            let memory = Memory::new().with(name, file.bytes.clone());
            let settings = LoadSettings::default();
            let part = load_from(&memory, Path::new(name), &settings, &Monitor::silent());
            Arc::new(part.unwrap())
        };
        let parts = PerRole {
            crash: load("crash", HOSTILE),
            stamped: load("stamped", "stamped.dynain.gz"),
        };
        let (recipe, current) = (MatchRecipe::default(), Similarity::identity());
        let run = match_parts(
            parts.as_deref(),
            None,
            &recipe,
            &current,
            &Monitor::silent(),
        );
        let run = Arc::new(run.unwrap());
        Matched { parts, run }
    })
}

impl Matched {
    fn input(&self) -> OutputInput {
        OutputInput {
            parts: self.parts.clone().map(Some),
            crash_from_stamped: self.run.crash_from_stamped,
            run: Some(Arc::clone(&self.run)),
            ..OutputInput::default()
        }
    }
}

fn try_export(to: Destination, output: Output, input: OutputInput) -> Result<Exported, JobError> {
    let number = 1;
    let kind = JobKind::Export(ExportRequest {
        number,
        to,
        output,
        input,
    });
    match PipelineRunner.run(kind, &Monitor::silent())? {
        JobOutput::Exported(exported) => Ok(exported),
        other => panic!("{other:?}"),
    }
}

fn export(to: Destination, output: Output) -> Exported {
    try_export(to, output, matched().input()).unwrap()
}

/// Start tags without an end.
const VOID: [&str; 3] = ["meta", "img", "br"];

/// Checks that every tag is closed in its turn; returns the attributes of all tags.
fn well_formed(page: &str) -> Vec<&str> {
    let mut open: Vec<&str> = Vec::new();
    let mut attributes = Vec::new();
    let mut rest = page.strip_prefix("<!DOCTYPE html>\n").unwrap();
    while let Some(at) = rest.find('<') {
        assert!(
            !rest[..at].contains('>'),
            "a stray > before {}",
            &rest[at..at + 20]
        );
        let raw = open
            .last()
            .is_some_and(|tag| ["style", "script"].contains(tag));
        let tag = &rest[at + 1..];
        let end = tag.find('>').unwrap();
        let (tag, after) = (&tag[..end], &tag[end + 1..]);
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name), "closed out of turn");
        } else {
            assert!(!raw, "markup in a script");
            let name = tag.split([' ', '/']).next().unwrap();
            assert!(name.chars().all(|c| c.is_ascii_alphanumeric()), "{name:?}");
            attributes.push(&tag[name.len()..]);
            if !VOID.contains(&name) && !tag.ends_with('/') {
                open.push(name);
            }
        }
        rest = after;
        // Styles and scripts hold signs of their own.
        if let Some(raw @ ("style" | "script")) = open.last().copied() {
            let end = rest.find(&format!("</{raw}>")).unwrap();
            assert!(!rest[..end].contains("://"), "a reference to the outside");
            rest = &rest[end..];
        }
    }
    assert!(open.is_empty(), "never closed: {open:?}");
    attributes
}

fn unescaped(text: &str) -> String {
    let plain = text
        .replace("&lt;", "<")
        .replace("&gt;", ">")
        .replace("&quot;", "\"");
    plain.replace("&#39;", "'").replace("&amp;", "&")
}

#[test]
fn the_report_is_one_page_that_needs_nothing_else() {
    let Matched { parts, run } = matched();
    let page = report(run, parts.as_deref(), &Monitor::silent()).unwrap();
    assert!(page.len() < 2_000_000, "{} bytes", page.len());
    let attributes = well_formed(&page);
    assert!(!page.contains("<b>\"crash\""), "a file name became markup");
    let mut n_pictures = 0;
    for attribute in &attributes {
        for (name, value) in [("src=\"", true), ("href=\"", false)] {
            let Some((_, value_on)) = attribute.split_once(name) else {
                continue;
            };
            let target = value_on.split('"').next().unwrap();
            if value {
                let data = target.strip_prefix("data:image/png;base64,").unwrap();
                let png = base64::engine::general_purpose::STANDARD
                    .decode(data)
                    .unwrap();
                let mut reader = png::Decoder::new(std::io::Cursor::new(png))
                    .read_info()
                    .unwrap();
                let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
                reader.next_frame(&mut pixels).unwrap();
                assert!(pixels.iter().any(|&byte| byte != 0), "an empty picture");
                assert!(attribute.contains("alt=\""), "a picture without words");
                n_pictures += 1;
            } else {
                let id = target.strip_prefix('#').unwrap();
                assert!(page.contains(&format!("id=\"{id}\"")), "no place {id}");
            }
        }
    }
    assert!(n_pictures >= 8, "{n_pictures} pictures");
}

#[test]
fn the_numbers_of_the_report_are_those_of_the_record() {
    let Matched { parts, run } = matched();
    let page = report(run, parts.as_deref(), &Monitor::silent()).unwrap();
    let record = match_record(run, parts.as_deref());
    let blocks: Vec<String> = page
        .split("<pre")
        .skip(1)
        .map(|block| {
            let (_, text) = block.split_once('>').unwrap();
            unescaped(text.split("</pre>").next().unwrap())
        })
        .collect();
    let matrix = parse_matrix(&blocks[0]).unwrap();
    assert_eq!(matrix.motion.to_rows(), record.pose.matrix);
    assert!(blocks.contains(&record.command_line));
    let card = blocks
        .iter()
        .find(|text| text.contains("*INCLUDE_STAMPED_PART_MATRIX"));
    let on_card = read_back(&format!("{}\n", card.unwrap())).unwrap();
    let corners = parts.stamped.mesh.aabb().corners();
    assert!(on_card.max_displacement(&run.crash_from_stamped, &corners) < 1e-3);
    for (_, part) in parts.iter() {
        let hash = part.hash().unwrap();
        assert!(page.contains(&hash.to_string()));
    }
    assert!(page.contains(record.verdict.label()));
}

#[test]
fn node_deviations_read_back_to_the_same_bits() {
    let Matched { parts, run } = matched();
    let pose = &run.crash_from_stamped;
    let silent = Monitor::silent();
    let stated = run.assessment.uncertainty();
    let (rows, _) = node_deviations(parts.as_deref(), pose, stated, &silent).unwrap();
    let n_nodes = |part: &LoadedPart| part.ids.nodes().len();
    assert_eq!(rows.len(), n_nodes(&parts.crash) + n_nodes(&parts.stamped));
    let text = node_table(parts.as_deref(), pose, stated, &silent).unwrap();
    assert!(text.contains("\n# lengths in mm\n"), "no unit in the head");
    let lines: Vec<&str> = text.lines().filter(|line| !line.starts_with('#')).collect();
    assert_eq!(lines.len(), rows.len() + 1);
    for (line, row) in lines[1..].iter().zip(&rows) {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |i: usize| cells[i].parse::<f64>().unwrap();
        assert_eq!((cells[0], number(1)), (row.role.word(), row.node as f64));
        assert_eq!(Point3::new(number(2), number(3), number(4)), row.at);
        assert_eq!(number(5), row.distance);
        assert_eq!(cells[8].is_empty(), row.role == Role::Crash);
    }
    // The largest of the nodes is what the result states.
    let of_nodes = rows.iter().filter_map(|row| row.pose_uncertainty);
    let largest = of_nodes.fold(0.0, f64::max);
    assert!((largest - stated.unwrap().largest).abs() < 1e-9 * largest);
    // The nearest element is as far as the distance says, where the other part is there.
    let row = rows
        .iter()
        .find(|row| row.role == Role::Stamped && row.distance.abs() > 0.5)
        .unwrap();
    let element = row.nearest_element.unwrap();
    let shell = parts
        .crash
        .model
        .shells
        .iter()
        .find(|shell| shell.id == element)
        .unwrap();
    let reach = 30.0 + row.distance.abs();
    let corner = &parts.crash.model.nodes.positions()[shell.nodes[0] as usize];
    assert!((corner - row.at).norm() < reach);
}

fn same_positions(path: &Path, expected: &TriMesh, tolerance: f64) {
    let model = read(path, &ReadOptions::default(), &Monitor::silent()).unwrap();
    let mesh = model.surface(&Default::default()).unwrap().mesh;
    assert_eq!(mesh.n_triangles(), expected.n_triangles(), "{path:?}");
    for triangle in 0..mesh.n_triangles() {
        for (a, b) in mesh
            .corners(triangle)
            .iter()
            .zip(expected.corners(triangle))
        {
            assert!((a - b).amax() <= tolerance, "{path:?}: {a} is not {b}");
        }
    }
}

#[test]
fn the_moved_part_is_the_same_in_every_format() {
    let Matched { parts, run } = matched();
    let folder = tempfile::tempdir().unwrap();
    let stamped = &parts.stamped;
    let moved = stamped.mesh.transformed(&run.crash_from_stamped);
    // STL holds 32 bits; at 5 m that is a quarter of a thousandth.
    for (name, tolerance) in [("a.stl", 3e-4), ("a.ply", 0.0), ("a.obj", 0.0)] {
        let path = folder.path().join(name);
        let to = Destination::File(path.clone());
        assert_eq!(export(to.clone(), Output::Mesh(MeshOutput::Moved)).to, to);
        same_positions(&path, &moved, tolerance);
    }
}

#[test]
fn the_moved_deck_keeps_ids_and_turns_its_tensors() {
    let Matched { parts, run } = matched();
    let stamped = &parts.stamped;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("moved.k");
    let to = Destination::File(path.clone());
    export(to, Output::Mesh(MeshOutput::Moved));
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("$ lengths in mm"), "no unit in the head");
    let back = read(&path, &ReadOptions::default(), &Monitor::silent()).unwrap();
    let before = &stamped.model;
    assert_eq!(back.nodes.ids(), before.nodes.ids());
    let ids = |model: &shapematch::formats::Model| -> Vec<u64> {
        model.shells.iter().map(|shell| shell.id).collect()
    };
    assert_eq!(ids(&back), ids(before));
    assert!(before.forming.n_stress() > 0, "the sample has no stresses");
    assert_eq!(back.forming.n_stress(), before.forming.n_stress());
    for index in (0..before.forming.n_stress()).step_by(97) {
        let (was, is) = (before.forming.stress(index), back.forming.stress(index));
        assert_eq!(was.element_id, is.element_id);
        for (was, is) in was.points.iter().zip(is.points) {
            let turned = shapematch::geometry::tensor::rotated(
                &was.stress,
                &run.crash_from_stamped.rotation,
            );
            let size = turned.iter().fold(1e-3_f64, |size, x| size.max(x.abs()));
            for (is, expected) in is.stress.iter().zip(turned) {
                assert!(
                    (is - expected).abs() < 1e-3 * size,
                    "{is} is not {expected}"
                );
            }
        }
    }
}

#[test]
fn the_converted_part_lies_where_it_was_in_the_other_unit() {
    let stamped = &matched().parts.stamped;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("converted.k");
    let settings = LoadSettings {
        length_factor: 25.4,
        ..LoadSettings::default()
    };
    let model = Arc::clone(&stamped.model);
    let scaled = shapematch::pipeline::load::prepare(
        Path::new("inches.k"),
        model,
        &settings,
        &Monitor::silent(),
    );
    let mut input = matched().input();
    input.parts.stamped = Some(Arc::new(scaled.unwrap()));
    let output = Output::Mesh(MeshOutput::Converted);
    try_export(Destination::File(path.clone()), output, input).unwrap();
    let back = read(&path, &ReadOptions::default(), &Monitor::silent()).unwrap();
    let before = stamped.model.nodes.positions();
    for (is, was) in back.nodes.positions().iter().zip(before) {
        assert!((is - was * 25.4).norm() < 1e-3);
    }
    let thickness = |model: &shapematch::formats::Model| model.shell_extras[0].thickness[0];
    assert!((thickness(&back) - 25.4 * thickness(&stamped.model)).abs() < 1e-4);
}

#[test]
fn cards_go_to_the_clipboard_with_what_rounding_costs() {
    let Matched { parts, run } = matched();
    let to = Destination::Clipboard("Include card".to_owned());
    let exported = export(to, Output::Cards(CardForm::StampedPart));
    let on_card = read_back(&exported.text.unwrap()).unwrap();
    let corners = parts.stamped.mesh.aabb().corners();
    assert!(on_card.max_displacement(&run.crash_from_stamped, &corners) < 1e-3);
    assert!(exported.notes[0].contains("read back"));
}

#[test]
fn cards_of_a_poor_pose_say_that_it_is_poor() {
    let run = &matched().run;
    let mut poor = MatchRun::clone(run);
    poor.assessment = Arc::new(shapematch::assess::Assessment {
        verdict: shapematch::assess::Verdict::Poor,
        ..shapematch::assess::Assessment::clone(&run.assessment)
    });
    let input = OutputInput {
        run: Some(Arc::new(poor)),
        ..matched().input()
    };
    let output = Output::Cards(CardForm::StampedPart);
    let made = output.make(&input, None, &Monitor::silent()).unwrap();
    assert!(made.notes[1].contains("POOR"), "{:?}", made.notes);
}

#[test]
fn cards_of_a_file_that_the_solver_cannot_include_say_so() {
    let name = Path::new("stamped.stl");
    let mesh = &matched().parts.stamped.mesh;
    let files = Memory::new().with(name, shapematch::formats::stl::write_binary(mesh));
    let stamped = load_from(&files, name, &LoadSettings::default(), &Monitor::silent()).unwrap();
    let mut input = matched().input();
    input.parts.stamped = Some(Arc::new(stamped));
    for &form in CardForm::ALL {
        let made = Output::Cards(form)
            .make(&input, None, &Monitor::silent())
            .unwrap();
        let told = "stamped.stl is STL, which the solver cannot include";
        assert!(made.notes[1].starts_with(told), "{:?}", made.notes);
        assert!(std::str::from_utf8(&made.bytes).unwrap().contains(told));
    }
}

#[test]
fn an_alternative_is_measured_anew_before_it_is_written() {
    let mut run = MatchRun::clone(&matched().run);
    let mut outcome = shapematch::registration::MatchOutcome::clone(&run.outcome);
    let up = Similarity {
        translation: shapematch::geometry::Vector3::new(0.0, 0.0, 400.0),
        ..Similarity::identity()
    };
    let other = up.after(&outcome.target_from_source);
    outcome.alternatives = vec![shapematch::registration::Alternative {
        target_from_source: other,
        score_ratio: 1.2,
        by_shape: false,
        start: 0,
    }];
    run.outcome = Arc::new(outcome);
    let input = OutputInput {
        run: Some(Arc::new(run)),
        alternative: Some(0),
        ..matched().input()
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("match.json");
    try_export(
        Destination::File(path.clone()),
        Output::Record,
        input.clone(),
    )
    .unwrap();
    let record: serde_json::Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    assert_eq!(record["matrix"][2][3].as_f64(), Some(other.translation.z));
    let told = "pose 2 of the match, not the best (with that, error 17 % lower)";
    assert_eq!(record["warnings"][0], told);
    let cards = Output::Cards(CardForm::StampedPart);
    let cards = try_export(
        Destination::Clipboard("Include card".to_owned()),
        cards,
        input,
    );
    assert!(
        cards
            .unwrap()
            .text
            .unwrap()
            .contains(&format!("$ {told}\n"))
    );
    assert_eq!(record["verdict"], "poor");
    let best = &record["alternatives"][0];
    assert_eq!(
        best["matrix"][2][3].as_f64(),
        Some(matched().run.crash_from_stamped.translation.z)
    );
}

#[test]
fn a_level_of_the_window_is_that_of_the_command_line() {
    use shapematch::jobs::ReduceInput;
    use shapematch::pipeline::match_parts::ReducedPair;
    let PerRole { crash, stamped } = &matched().parts;
    for max_triangles in [150, 900, 6000] {
        let kind = JobKind::Reduce(ReduceInput {
            role: Role::Stamped,
            part: Arc::clone(stamped),
            recording: None,
            max_triangles,
        });
        let level = match PipelineRunner.run(kind, &Monitor::silent()).unwrap() {
            JobOutput::Reduced { level, .. } => level,
            other => panic!("{other:?}"),
        };
        let ceilings = PerRole::new(None, Some(max_triangles));
        let pair =
            ReducedPair::new(matched().parts.as_deref(), ceilings, &Monitor::silent()).unwrap();
        assert_eq!(
            pair.meshes.stamped.positions(),
            level.level.mesh.positions()
        );
        assert_eq!(
            pair.meshes.stamped.triangles(),
            level.level.mesh.triangles()
        );
        assert!(Arc::ptr_eq(&pair.meshes.crash, &crash.mesh));
    }
}

#[test]
fn the_window_overwrites_no_file_it_has_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("stamped.dynain.gz");
    let files = samples::bundled();
    let file = files.iter().find(|file| file.name.starts_with("stamped"));
    std::fs::write(&path, &file.unwrap().bytes).unwrap();
    let settings = LoadSettings::default();
    let part = shapematch::pipeline::load::load(&path, &settings, &Monitor::silent()).unwrap();
    let mut input = matched().input();
    input.parts.stamped = Some(Arc::new(part));
    let before = std::fs::read(&path).unwrap();
    let refused = try_export(Destination::File(path.clone()), Output::Record, input);
    let reason = refused.unwrap_err().to_string();
    assert!(reason.contains("would overwrite"), "{reason}");
    assert_eq!(std::fs::read(&path).unwrap(), before);
}
