//! The assessment of poses: free motions, coverage, ambiguity, verdict.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use shapematch::assess::*;
use shapematch::geometry::{Matrix3, Point3, Pose, Similarity, TriMesh, Vector3};
use shapematch::monitor::{Monitor, Observer, Progress};
use shapematch::registration::*;
use shapematch::samples::disturb;
use shapematch::settling::*;
use shapematch::text::Lengths;
use shapematch::units::LengthUnit;

use super::drawn_pan::{everywhere, pan, panel, placement, worst_node};

/// An n × n grid over the unit square, mapped by `place`.
fn sheet(n: u32, place: impl Fn(f64, f64) -> Point3) -> TriMesh {
    let mut positions = Vec::new();
    for j in 0..=n {
        for i in 0..=n {
            positions.push(place(
                f64::from(i) / f64::from(n),
                f64::from(j) / f64::from(n),
            ));
        }
    }
    let mut triangles = Vec::new();
    for j in 0..n {
        for i in 0..n {
            let a = j * (n + 1) + i;
            triangles.push([a, a + 1, a + n + 2]);
            triangles.push([a, a + n + 2, a + n + 1]);
        }
    }
    TriMesh::new(positions, triangles).unwrap()
}

fn freedom(mesh: &TriMesh) -> Freedom {
    let surface = Surface::new(mesh, "target").unwrap();
    free_motions(&surface, &surface, &Similarity::identity(), 1.0)
}

#[test]
fn free_motions_are_named_with_their_axis() {
    let flat = freedom(&sheet(12, |u, v| Point3::new(300.0 * u, 200.0 * v, 7.0)));
    let motion = flat.motion.unwrap();
    assert_eq!((motion.kind, flat.n_free), (FreeMotionKind::Flat, 3));
    assert!(motion.words().contains("the z axis"), "{}", motion.words());

    let cylinder = freedom(&sheet(24, |u, v| {
        let angle = 2.0 * u;
        Point3::new(50.0 * angle.sin(), 300.0 * v, 50.0 * angle.cos())
    }));
    let motion = cylinder.motion.unwrap();
    assert_eq!(motion.kind, FreeMotionKind::Cylindrical);
    assert!(motion.direction.y > 0.999);
    assert!(motion.point.x.abs() < 0.5 && motion.point.z.abs() < 0.5);

    let groove = freedom(&sheet(40, |u, v| {
        let x = 200.0 * (u - 0.5);
        Point3::new(x, 300.0 * v, 20.0 * (x / 30.0).sin() + 0.1 * x)
    }));
    assert_eq!(groove.motion.unwrap().kind, FreeMotionKind::Extruded);

    let dome = freedom(&sheet(40, |u, v| {
        let (radius, angle) = (20.0 + 80.0 * u, 5.0 * v);
        let height = 0.004 * radius * radius + 3.0 * (radius / 12.0).sin();
        Point3::new(radius * angle.cos(), radius * angle.sin(), height)
    }));
    assert_eq!(dome.motion.unwrap().kind, FreeMotionKind::Revolved);
    assert!(dome.motion.unwrap().direction.z > 0.999);

    assert_eq!(freedom(&pan(9.0, 0.0, everywhere)).motion, None);
}

/// The other skin of a finely meshed profile lies beyond the overlap, and slides along itself all the same.
#[test]
fn an_extruded_profile_is_held_by_nothing_along_itself_however_far_its_skins_lie_apart() {
    let angle = |off: f64, length: f64| {
        sheet(60, |u, v| {
            let along = 60.0 * (u - 0.5);
            let (x, y) = if along < 0.0 {
                (0.0, -along)
            } else {
                (along, 0.0)
            };
            Point3::new(x - off, y - off, length * (v - 0.5))
        })
    };
    let (source, target) = (angle(0.0, 40.0), angle(0.9, 60.0));
    let [source, target] = [&source, &target].map(|mesh| Surface::new(mesh, "source").unwrap());
    let mut outcome = matched(&source, &target);
    outcome.target_from_source = Similarity::identity();
    let settings = AssessSettings::default();
    let monitor = Monitor::silent();
    let assessment = assess(&source, &target, &outcome, &settings, &monitor).unwrap();
    assert_eq!(assessment.coverage.better_overlap(), 0.0);
    assert_eq!(assessment.coverage.rmse(), f64::INFINITY);
    let motion = assessment.freedom.motion.unwrap();
    assert_eq!(motion.kind, FreeMotionKind::Extruded);
    assert_ne!(
        assessment.verdict,
        Verdict::Good,
        "{:?}",
        assessment.reasons
    );
    let lines = assessment.sentences(Lengths::new(Some(LengthUnit::Millimeter)));
    assert!(!lines.iter().any(|line| line.contains("inf")), "{lines:?}");
}

#[test]
fn a_smooth_panel_that_comes_apart_where_it_is_moved_does_not_slide() {
    // Two meshes of one surface, whose curvature changes a little along x and y.
    let panel = |n: u32, along_y: f64| {
        let mesh = sheet(n, |u, v| {
            let (x, y) = (1200.0 * (u - 0.5), 900.0 * (v - 0.5));
            let arched = x * x / 8_000.0 + x.powi(3) / 1e8;
            let across = y * y / 24_000.0 + y.powi(3) / 3e7;
            Point3::new(x, y, arched + along_y * across)
        });
        Surface::new(&mesh, "target").unwrap()
    };
    let pose = Similarity::identity();
    let found = |along_y| free_motions(&panel(74, along_y), &panel(100, along_y), &pose, 5.0);
    let hood = found(1.0);
    assert!(hood.weakest < 1e-4, "{hood:?}");
    assert_eq!((hood.motion, hood.n_free), (None, 0));
    // What is arched in one direction only slides in the other.
    let bent = found(0.0);
    assert!(bent.motion.is_some(), "{bent:?}");
}

/// A hat profile along x, whose elements cut across its folds at random, with a bead as high as given.
fn hat_with_cut_folds(n: u32, bead: f64) -> Surface {
    let random = |seed: f64| 0.5 * (seed.sin() * 43_758.545).fract();
    let mesh = sheet(n, |u, v| {
        let is_inside = |t: f64| (0.01..0.99).contains(&t);
        let moved = |t: f64, seed: f64| {
            let step = if is_inside(t) { random(seed) } else { 0.0 };
            t + 0.8 * step / f64::from(n) - 0.5
        };
        let along = 500.0 * moved(u, 12.9 * u + 78.2 * v);
        let across = 300.0 * moved(v, 63.7 * u + 10.9 * v);
        let height = (90.0 - across.abs()).clamp(0.0, 40.0);
        let away = (along - 60.0).hypot(across) / 60.0;
        let top = height + bead * (1.0 - away * away).max(0.0).powi(2);
        Point3::new(along, across, top)
    });
    Surface::new(&mesh, "target").unwrap()
}

#[test]
fn facets_that_cut_across_folds_do_not_hold_a_profile_along_itself() {
    let freedom = |bead| {
        let pair = [24, 31].map(|n| hat_with_cut_folds(n, bead));
        free_motions(&pair[0], &pair[1], &Similarity::identity(), 5.0)
    };
    let plain = freedom(0.0);
    assert!(plain.weakest > 1e-4, "{plain:?}");
    let motion = plain.motion.unwrap();
    assert_eq!(motion.kind, FreeMotionKind::Extruded);
    assert!(motion.direction.x > 0.99, "{motion:?}");
    let beaded = freedom(12.0);
    assert_eq!(beaded.motion, None, "{beaded:?}");
}

/// The usual match of two full meshes.
pub fn matched(source: &Surface, target: &Surface) -> MatchOutcome {
    let input = MatchInput {
        source,
        target,
        reduced: None,
    };
    match_surfaces(&input, &MatchSettings::default(), &Monitor::silent()).unwrap()
}

/// A match of two meshes, and its assessment.
pub fn judge(source: &TriMesh, target: &TriMesh) -> (MatchOutcome, Assessment) {
    let surfaces = [source, target].map(|mesh| Surface::new(mesh, "source").unwrap());
    let monitor = Monitor::silent();
    let outcome = matched(&surfaces[0], &surfaces[1]);
    let settings = AssessSettings::default();
    let assessed = assess(&surfaces[0], &surfaces[1], &outcome, &settings, &monitor).unwrap();
    (outcome, assessed)
}

#[test]
fn a_right_pose_is_good_and_covers_everything() {
    let source = pan(6.0, 0.0, everywhere).transformed(&placement(3));
    let (_, assessed) = judge(&source, &pan(9.0, 0.35, everywhere));
    assert_eq!(assessed.verdict, Verdict::Good, "{:?}", assessed.reasons);
    assert!(assessed.coverage.source_on_target.overlap > 0.98);
    assert!(assessed.coverage.target_on_source.overlap > 0.98);
}

/// Counts how often the work looks whether it is to end, once it has said that half of it is done.
#[derive(Default)]
struct AskedSince(AtomicUsize);

impl Observer for AskedSince {
    fn progress(&self, progress: Progress) {
        if progress.done == 1 {
            self.0.store(0, Ordering::Relaxed);
        }
    }

    fn asked(&self) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }
}

#[test]
fn every_step_of_an_assessment_can_be_cancelled() {
    let part = Surface::new(&pan(9.0, 0.0, everywhere), "source").unwrap();
    let outcome = matched(&part, &part);
    let observer = Arc::new(AskedSince::default());
    let monitor = Monitor::with_observer(observer.clone());
    let settings = AssessSettings::default();
    assess(&part, &part, &outcome, &settings, &monitor).unwrap();
    // After the free motions, the statements, and that of the opposite hand.
    assert_eq!(observer.0.load(Ordering::Relaxed), 3);
    monitor.request_cancel();
    assert!(assess(&part, &part, &outcome, &settings, &monitor).is_err());
}

#[test]
fn a_strip_one_element_wide_meets_itself_as_a_whole() {
    // All of its nodes lie on the border, at a distance of rounding or of noise in any direction.
    let strip = |noise: f64| {
        let place = |i: u32, x: f64| {
            let (y, jitter) = (f64::from(i), f64::from(i * 7 % 11) - 5.0);
            let wave = 0.3 * y * y + x * 0.1 * y.sin();
            Point3::new(x + noise * jitter, 12.0 * y, wave - noise * jitter)
        };
        let positions = (0..9).flat_map(|i| [place(i, 0.0), place(i, 20.0)]);
        let triangles = (0..8).flat_map(|i| {
            let a = 2 * i;
            [[a, a + 1, a + 3], [a, a + 3, a + 2]]
        });
        TriMesh::new(positions.collect(), triangles.collect()).unwrap()
    };
    for noise in [0.0, 1e-4] {
        let source = strip(noise).transformed(&placement(5));
        let (_, assessed) = judge(&source, &strip(0.0));
        let met = assessed.shape.as_ref().unwrap().met;
        assert!((met - 1.0).abs() < 1e-9, "{noise}: {met}");
        assert_ne!(assessed.verdict, Verdict::Poor, "{noise}");
    }
}

#[test]
fn the_opposite_hand_needs_more_than_a_lower_score() {
    let source = pan(6.0, 0.0, everywhere).transformed(&placement(3));
    let target = pan(9.0, 0.35, everywhere);
    let (mut outcome, _) = judge(&source, &target);
    let same = outcome.target_from_source;
    let [source, target] = [&source, &target].map(|mesh| Surface::new(mesh, "source").unwrap());
    let (settings, monitor) = (AssessSettings::default(), Monitor::silent());
    let mut reasons = |pose: Option<Similarity>| {
        outcome.mirror_check.score_ratio = Some(0.7);
        outcome.mirror_check.target_from_source = pose;
        let assessed = assess(&source, &target, &outcome, &settings, &monitor).unwrap();
        (assessed.verdict, assessed.reasons[0].clone())
    };
    // The shape at that pose is no better than at the result's, so the score alone is not believed.
    let score_ratio = 0.7;
    let near = Reason::NearMirrorImage {
        score_ratio,
        by_borders: false,
    };
    assert_eq!(reasons(Some(same)), (Verdict::Check, near));
    let opposite = Reason::OppositeHand {
        score_ratio,
        by_borders: false,
    };
    assert_eq!(reasons(None), (Verdict::Poor, opposite));
}

#[test]
fn overlap_names_both_denominators() {
    let half = pan(9.0, 0.35, |x, _| x < 0.0);
    let (_, assessed) = judge(&pan(6.0, 0.0, everywhere), &half);
    let coverage = &assessed.coverage;
    assert!((coverage.source_on_target.overlap - 0.5).abs() < 0.05);
    assert!(coverage.target_on_source.overlap > 0.97);
    assert_eq!(assessed.verdict, Verdict::Good, "{:?}", assessed.reasons);
}

#[test]
fn a_flat_plate_is_not_good() {
    let plate = |n| sheet(n, |u, v| Point3::new(300.0 * u, 200.0 * v, 0.0));
    let turn = Pose::new(Vector3::new(10.0, 20.0, 30.0), Vector3::new(0.5, 0.1, 0.2));
    let (_, assessed) = judge(&plate(20).transformed(&turn.into()), &plate(14));
    assert_ne!(assessed.verdict, Verdict::Good);
    let motion = assessed.freedom.motion;
    assert_eq!(motion.unwrap().kind, FreeMotionKind::Flat);
    assert_eq!(assessed.open_motion(), motion.as_ref());
    // Holes or borders that hold the plate leave no reason, and nothing to be drawn.
    let held = |reason: &Reason| !matches!(reason, Reason::Sliding { .. });
    let held = Assessment {
        reasons: assessed
            .reasons
            .iter()
            .filter(|r| held(r))
            .cloned()
            .collect(),
        ..assessed
    };
    assert_eq!((held.freedom.motion, held.open_motion()), (motion, None));
}

#[test]
fn a_symmetric_part_is_ambiguous() {
    let hat = |n| {
        sheet(n, |u, v| {
            let (x, y) = (300.0 * (u - 0.5), 200.0 * (v - 0.5));
            Point3::new(
                x,
                y,
                30.0 * (-(x / 90.0).powi(2) - (y / 50.0).powi(2)).exp(),
            )
        })
    };
    let (outcome, assessed) = judge(&hat(30).transformed(&placement(2)), &hat(23));
    assert_eq!(
        assessed.ambiguity.clarity,
        Clarity::Ambiguous,
        "{:?}",
        assessed.ambiguity
    );
    assert_ne!(assessed.verdict, Verdict::Good);
    let alternative = outcome.alternatives[0].target_from_source;
    assert!(alternative.angle_to(&outcome.target_from_source) > 3.0);
}

#[test]
fn parts_that_have_nothing_in_common_are_poor() {
    let wave = sheet(30, |u, v| {
        let (x, y) = (400.0 * u, 250.0 * v);
        Point3::new(x, y, 40.0 * (x / 40.0).sin() * (y / 30.0).cos())
    });
    let (_, assessed) = judge(&wave, &pan(9.0, 0.0, everywhere));
    assert_eq!(assessed.verdict, Verdict::Poor, "{:?}", assessed.reasons);
    assert!(!assessed.reasons.is_empty());
}

#[test]
fn that_several_parts_are_matched_as_one_comes_before_their_size() {
    let target = pan(9.0, 0.0, everywhere);
    let source = target.transformed(&Similarity::from_scale(1.0 / 9.8));
    let [source, target] = [&source, &target].map(|mesh| Surface::new(mesh, "source").unwrap());
    let outcome = matched(&source, &target);
    let reasons = |n_target_parts| {
        let settings = AssessSettings {
            n_target_parts,
            ..AssessSettings::default()
        };
        let monitor = Monitor::silent();
        let assessed = assess(&source, &target, &outcome, &settings, &monitor).unwrap();
        assert_eq!(assessed.verdict, Verdict::Poor);
        assessed.reasons
    };
    let of_one = reasons(1);
    assert!(
        matches!(of_one[..], [Reason::DifferentUnits { .. }]),
        "{of_one:?}"
    );
    let of_several = reasons(12);
    let several = Reason::SeveralParts {
        n_parts: 12,
        size_ratio: outcome.scale_check.size_ratio,
    };
    assert_eq!(of_several[..], [several, of_one[0].clone()]);
}

#[test]
fn a_piece_of_a_part_in_the_same_unit_is_in_no_other() {
    let target = pan(9.0, 0.0, everywhere);
    let [source, target] = [&target, &target].map(|mesh| Surface::new(mesh, "source").unwrap());
    let mut outcome = matched(&source, &target);
    let is_told = |outcome: &MatchOutcome, is_one_unit| {
        let settings = AssessSettings {
            is_one_unit,
            ..AssessSettings::default()
        };
        let assessed = assess(&source, &target, outcome, &settings, &Monitor::silent());
        let reasons = assessed.unwrap().reasons;
        matches!(reasons[..], [Reason::DifferentUnits { .. }])
    };
    // About as large beside the part as centimetres beside millimetres, and exactly so: files that name one unit may
    // be wrong.
    for (size_ratio, is_factor) in [(9.4, false), (10.0, true)] {
        let unit = guess_unit(size_ratio);
        assert!(unit.is_some());
        (outcome.scale_check.size_ratio, outcome.scale_check.unit) = (size_ratio, unit);
        assert!(is_told(&outcome, false));
        assert_eq!(is_told(&outcome, true), is_factor, "{size_ratio}");
    }
}

#[test]
fn the_size_of_several_parts_names_no_unit() {
    let target = pan(9.0, 0.0, everywhere);
    let [source, target] = [&target, &target].map(|mesh| Surface::new(mesh, "source").unwrap());
    let mut outcome = matched(&source, &target);
    // Parts in metres that are three times as large together as the source.
    let size_ratio = 0.003;
    (outcome.scale_check.size_ratio, outcome.scale_check.unit) =
        (size_ratio, guess_unit(size_ratio));
    assert!(outcome.scale_check.unit.is_some());
    let reasons = |n_target_parts| {
        let settings = AssessSettings {
            n_target_parts,
            ..AssessSettings::default()
        };
        let assessed = assess(&source, &target, &outcome, &settings, &Monitor::silent());
        assessed.unwrap().reasons
    };
    assert!(matches!(reasons(1)[..], [Reason::DifferentUnits { .. }]));
    assert_eq!(reasons(5)[..], [Reason::SizesFarApart { size_ratio }]);
}

#[test]
fn sizes_far_apart_are_a_reason_where_no_unit_is_known() {
    let target = pan(9.0, 0.0, everywhere);
    for (factor, words) in [(1e-4, "1e4"), (1.0 / 80.0, "80.0"), (1e4, "1e4")] {
        let source = target.transformed(&Similarity::from_scale(factor));
        let [source, target] = [&source, &target].map(|mesh| Surface::new(mesh, "source").unwrap());
        let mut outcome = matched(&target, &target);
        outcome.scale_check.size_ratio = 1.0 / factor;
        outcome.scale_check.unit = guess_unit(1.0 / factor);
        let settings = AssessSettings::default();
        let assessed = assess(&source, &target, &outcome, &settings, &Monitor::silent()).unwrap();
        assert_eq!(assessed.verdict, Verdict::Poor, "{factor}");
        let [Reason::SizesFarApart { .. }] = assessed.reasons[..] else {
            panic!("{:?}", assessed.reasons);
        };
        let told = assessed.reasons[0].words(Lengths::new(None));
        assert_eq!(
            told,
            format!("sizes differ by a factor of {words}: check the unit")
        );
    }
}

#[test]
fn what_could_not_be_read_is_at_most_check_and_changes_nothing_else() {
    let target = pan(9.0, 0.0, everywhere);
    let [source, target] = [&target, &target].map(|mesh| Surface::new(mesh, "source").unwrap());
    let outcome = matched(&source, &target);
    let with_errors = |n_source_errors| {
        let settings = AssessSettings {
            n_source_errors,
            ..AssessSettings::default()
        };
        assess(&source, &target, &outcome, &settings, &Monitor::silent()).unwrap()
    };
    let (whole, in_part) = (with_errors(0), with_errors(2));
    assert_eq!(whole.verdict, Verdict::Good, "{:?}", whole.reasons);
    assert_eq!(in_part.verdict, Verdict::Check);
    assert_eq!(in_part.verdict_as_read(), Verdict::Good);
    let reason = Reason::ReadErrors {
        in_source: 2,
        in_target: 0,
    };
    assert_eq!(in_part.reasons, std::slice::from_ref(&reason));
    assert_eq!(in_part.shape, whole.shape);
    assert_eq!(
        reason.words(Lengths::new(None)),
        "2 read errors in the stamped file: nodes or elements may be missing or misplaced"
    );
}

/// Surfaces that differ by much, mostly or at some places.
fn surfaces_apart(mostly: bool) -> ShapeReason {
    ShapeReason::Surface {
        by: 40.0,
        limit: 4.0,
        at: Point3::new(1.0, 2.0, 3.0),
        mostly,
    }
}

/// Of each kind of difference one that leaves the parts one.
fn differences() -> [ShapeReason; 6] {
    let (by, limit) = (5.0, 4.0);
    let at = Point3::new(1.0, 2.0, 3.0);
    [
        surfaces_apart(false),
        ShapeReason::Bent { by, limit },
        ShapeReason::Borders { by, limit, at },
        ShapeReason::Hole {
            by,
            limit,
            at,
            is_mean: true,
        },
        ShapeReason::Stretched {
            by,
            share: -0.02,
            axis: PartAxis::Width,
        },
        ShapeReason::Holes {
            only_source: 1,
            only_target: 2,
            at,
        },
    ]
}

/// One of each kind of reason, with the verdict it stands for.
fn every_reason() -> Vec<(Reason, Verdict)> {
    let unit = guess_unit(25.4).unwrap();
    let (source, target, limit) = (0.1, 0.2, 4.0);
    let shape = |difference| Reason::Shape { difference };
    let twin = Some(Twin {
        angle: std::f64::consts::PI,
        axis: TwinAxis::Long,
        shift: 0.25,
        is_mirrored: false,
    });
    let motion = FreeMotion {
        kind: FreeMotionKind::Extruded,
        direction: Vector3::y(),
        point: Point3::origin(),
    };
    let poor = [
        Reason::OppositeHand {
            score_ratio: 0.5,
            by_borders: false,
        },
        Reason::SeveralParts {
            n_parts: 12,
            size_ratio: 8.6,
        },
        Reason::DifferentUnits {
            size_ratio: 25.0,
            unit,
        },
        Reason::SizesFarApart { size_ratio: 1e-4 },
        shape(ShapeReason::HardlyMet { share: 0.2 }),
        shape(surfaces_apart(true)),
        Reason::EndedEarly {
            termination: Termination::NoPairs,
        },
    ];
    let check = [
        Reason::NearMirrorImage {
            score_ratio: 0.9,
            by_borders: true,
        },
        Reason::PairScale { scale: 1.1 },
        Reason::Uncertain {
            by: f64::INFINITY,
            limit,
            along: PartDirection::Along,
        },
        Reason::BothOverhang { source, target },
        Reason::PartlyMet { share: 0.6 },
        Reason::Sliding {
            motion,
            held_across: Some(0.5),
        },
        Reason::NearAlternative {
            score_ratio: 1.2,
            by_shape: false,
            twin,
        },
        Reason::EqualAlternative {
            score_ratio: 1.01,
            by_shape: true,
            twin: None,
            n_equivalent: 2,
        },
        Reason::OthersNotSought,
        Reason::Stopped,
        Reason::ReadErrors {
            in_source: 1,
            in_target: 2,
        },
    ];
    let good = Reason::InOrder {
        overlap: 0.98,
        p95: 0.1,
        rivals_sought: true,
    };
    let poor = poor.map(|reason| (reason, Verdict::Poor)).into_iter();
    let differences = differences().map(|difference| Reason::Shape { difference });
    let check = check.into_iter().chain(differences);
    let check = check.map(|reason| (reason, Verdict::Check));
    poor.chain(check).chain([(good, Verdict::Good)]).collect()
}

#[test]
fn every_reason_has_words_a_weight_and_comes_back_from_text() {
    let lengths = Lengths::new(Some(LengthUnit::Millimeter));
    for (reason, severity) in every_reason() {
        assert_eq!(reason.severity(), severity, "{reason:?}");
        let words = reason.words(lengths);
        assert!(words.len() > 10 && !words.ends_with('.'), "{words}");
        let text = serde_json::to_string(&reason).unwrap();
        let back: Reason = serde_json::from_str(&text).unwrap();
        assert_eq!(back, reason, "{text}");
    }
    let differ = Reason::Shape {
        difference: ShapeReason::Bent {
            by: 0.5,
            limit: 0.1234,
        },
    };
    let words = differ.words(lengths);
    assert!(words.contains("0.500 mm") && words.contains("0.123 mm"));
    let stored = r#"{"kind":"shape","difference":{"what":"bent","by":0.5,"limit":0.1234}}"#;
    assert_eq!(serde_json::to_string(&differ).unwrap(), stored);
}

/// A wheel arch: a strip of 150° about an axis with a step across it, n × n cells.
fn arch(n: u32, phase: f64) -> TriMesh {
    sheet(n, |u, v| {
        let angle = 2.6 * u + 0.2;
        let step = ((v - 0.5) / 0.15).clamp(0.0, 1.0);
        let step = 80.0 * step * step * (3.0 - 2.0 * step);
        let radius = 320.0 * (1.0 + 0.06 * (1.7 * angle + phase).sin()) + step;
        let along = 90.0 * (v + 0.3 * u);
        Point3::new(radius * angle.cos(), radius * angle.sin(), along)
    })
}

#[test]
fn skin_on_mid_surface_does_not_turn_an_arch_off_its_borders() {
    for phase in [0.0, 4.0] {
        let target = arch(60, phase);
        for offset in [-1.0, 1.0] {
            let error = error_of(&arch(71, phase), &target, offset);
            assert!(
                error < 0.5,
                "phase {phase}, offset {offset}: {error:.2} mm off"
            );
        }
    }
}

/// How far a part is off at worst that is laid on another one after an offset.
fn error_of(part: &TriMesh, target: &TriMesh, offset: f64) -> f64 {
    let truth = placement(4);
    let stamped = disturb::offset(part, offset).transformed(&truth.inverse());
    let surface = |mesh: &TriMesh, name| Surface::new(mesh, name).unwrap();
    let (source, target) = (surface(&stamped, "source"), surface(target, "target"));
    let outcome = matched(&source, &target);
    let settings = AssessSettings {
        thickness: Some(1.0),
        ..AssessSettings::default()
    };
    let monitor = Monitor::silent();
    let context = PairContext::new([&source, &target], &settings, &monitor);
    let held = held_by_borders(&context, &outcome).unwrap();
    let pose = held.map(|held| held.target_from_source);
    let refined = || refined_with_borders(&context, &outcome.target_from_source).unwrap();
    let pose = pose.or_else(refined);
    let pose = pose.unwrap_or(outcome.target_from_source);
    worst_node(&stamped, &truth, &pose)
}

#[test]
fn parts_of_which_each_has_a_piece_that_the_other_lacks_are_one_where_they_meet() {
    // They share two fifths of the length, which is 58 % of each.
    let left = pan(6.0, 0.0, |x, _| x < 90.0);
    let right = pan(7.0, 0.35, |x, _| x > -90.0);
    let truth = placement(12);
    let stamped = left.transformed(&truth.inverse());
    let (outcome, assessment) = judge(&stamped, &right);
    let error = worst_node(&stamped, &truth, &outcome.target_from_source);
    assert!(error < 0.6, "{error}");
    let shape = assessment.shape.unwrap();
    assert!(shape.met > 0.5 && shape.met < 0.7, "{shape:?}");
    // Another pose is nearly as good, which has nothing to do with that.
    let overhangs = |reason: &Reason| matches!(reason, Reason::BothOverhang { .. });
    assert!(!assessment.reasons.iter().any(overhangs));
}

#[test]
fn parts_that_share_less_than_half_of_each_and_nothing_else_speaks_against_are_one() {
    let left = panel(4.0, 0.0, |x, _| x < 29.0);
    let right = panel(5.0, 0.35, |x, _| x > -29.0);
    let truth = placement(12);
    let stamped = left.transformed(&truth.inverse());
    let [source, target] = [&stamped, &right].map(|mesh| Surface::new(mesh, "source").unwrap());
    let (settings, check, silent) = (
        MatchSettings::default(),
        AssessSettings::default(),
        Monitor::silent(),
    );
    let mut outcome = matched(&source, &target);
    settle(&mut outcome, [&source, &target], &settings, &check, &silent).unwrap();
    let error = worst_node(&stamped, &truth, &outcome.target_from_source);
    assert!(error < 0.6, "{error}");
    let assessment = assess(&source, &target, &outcome, &check, &silent).unwrap();
    let shape = assessment.shape.unwrap();
    assert!(shape.met > 0.35 && shape.met < 0.5, "{shape:?}");
    assert_eq!(assessment.verdict, Verdict::Check);
    let [Reason::BothOverhang { .. }] = assessment.reasons[..] else {
        panic!("{:?}", assessment.reasons);
    };
    assert_ne!(shape.kind, ShapeKind::Different);
    assert!(shape.reasons.is_empty());
}

#[test]
fn that_more_of_both_parts_overlaps_tells_no_row_of_waves_from_the_next() {
    // Ends that are cut against each other: under every pose each part has a piece that the other lacks.
    let rail = |n: u32, slant: f64, cut_at: f64| {
        sheet(n, |u, v| {
            let x = 440.0 * u + slant * (v - 0.5) + cut_at;
            let waves = (std::f64::consts::TAU * x / 40.0).sin() * (4.0 + 3.0 * v);
            Point3::new(x, 100.0 * v, waves + 15.0 * v * v)
        })
    };
    let truth = placement(5);
    let stamped = rail(90, 140.0, 0.0).transformed(&truth.inverse());
    let crash = rail(110, -140.0, 25.0);
    let [source, target] = [&stamped, &crash].map(|mesh| Surface::new(mesh, "source").unwrap());
    let silent = Monitor::silent();
    let mut outcome = matched(&source, &target);
    let settings = AssessSettings::default();
    let context = PairContext::new([&source, &target], &settings, &silent);
    let chosen = chosen_by_shape(&context, &outcome).unwrap();
    let chosen = chosen.unwrap();
    outcome.target_from_source = chosen.target_from_source;
    outcome.alternatives = chosen.alternatives;
    let assessment = assess(&source, &target, &outcome, &settings, &silent).unwrap();
    let shape = assessment.shape.unwrap();
    assert!(shape.met > 0.7 && shape.met < 0.95, "{shape:?}");
    assert_eq!(assessment.ambiguity.clarity, Clarity::Ambiguous);
    // Each of the like poses lies a whole number of waves from the true one.
    for other in outcome.alternatives.iter().filter(|a| a.score_ratio < 1.1) {
        let off = other.target_from_source.after(&truth.inverse());
        let waves = off.translation.x / 40.0;
        assert!((waves - waves.round()).abs() < 0.05, "{waves}");
    }
}

#[test]
fn a_bend_does_not_push_a_curved_strip_along_itself() {
    // A strip of 1,000 mm that is cut elsewhere at both ends, bent by 2 mm.
    let strip = |n: u32, longer: f64, bend: f64| {
        sheet(n, |u, v| {
            let (x, y) = ((1000.0 + longer) * (u - 0.5), 120.0 * (v - 0.5));
            let (along, angle) = (x / 500.0, x / 250.0 + 0.4);
            let z = 40.0 * angle.sin() + 8.0 * (y / 30.0).cos();
            let w = bend * (along * along - 1.0 / 3.0);
            let slope = bend * 2.0 * along / 500.0;
            Point3::new(x - slope * z, y, z + w)
        })
    };
    let target = Surface::new(&strip(60, 0.0, 0.0), "target").unwrap();
    let source = Surface::new(&strip(66, 60.0, 2.0), "source").unwrap();
    let (settings, monitor) = (AssessSettings::default(), Monitor::silent());
    let unbent = |source: &Surface, pose: &Similarity| {
        let context = PairContext::new([source, &target], &settings, &monitor);
        without_bend(&context, pose).unwrap()
    };
    let off = |pose: &Similarity| pose.translation.x.abs();
    for shift in [-8.0, 8.0] {
        let pose = Similarity::from_translation(Vector3::new(shift, 0.0, 0.0));
        let found = unbent(&source, &pose).unwrap();
        assert!(off(&found) < 1.0, "{found:?}");
    }
    let plain = Surface::new(&strip(66, 60.0, 0.0), "source").unwrap();
    let found = unbent(&plain, &Similarity::identity());
    assert_eq!(found, None);
}

#[test]
fn a_twist_does_not_turn_a_bowed_panel_about_its_normal() {
    // Turned by five degrees, the bow is the twist: the panel fits but for three pads, which the closest pairs leave
    // out.
    let panel = |n: u32, wider: f64, twist: f64| {
        sheet(n, |u, v| {
            let (x, y) = ((600.0 + wider) * (u - 0.5), (400.0 + wider) * (v - 0.5));
            let pads = [(-200.0, 110.0), (150.0, -120.0), (60.0, 130.0)];
            let pads = pads.map(|(at_x, at_y): (f64, f64)| {
                let far = ((x - at_x).powi(2) + (y - at_y).powi(2)) / (28.0 * 28.0);
                25.0 * (-far).exp()
            });
            let (along, across) = (x / 300.0, y / 200.0);
            let bent = 12.0 * along * along + twist * along * across;
            Point3::new(x, y, bent + pads.iter().sum::<f64>())
        })
    };
    let truth = placement(3);
    let stamped = panel(80, 20.0, 1.5).transformed(&truth.inverse());
    let [source, target] =
        [&stamped, &panel(60, 0.0, 0.0)].map(|mesh| Surface::new(mesh, "source").unwrap());
    let outcome = matched(&source, &target);
    let off = |pose: &Similarity| worst_node(&stamped, &truth, pose);
    let (closest, all) = (outcome.target_from_source, outcome.with_all_pairs.unwrap());
    assert!(
        off(&closest) > 10.0 && off(&all) < 3.0,
        "{} {}",
        off(&closest),
        off(&all)
    );
    let (settings, monitor) = (AssessSettings::default(), Monitor::silent());
    let context = PairContext::new([&source, &target], &settings, &monitor);
    let is_better = |poses| is_better_with_all_pairs(&context, poses).unwrap();
    assert!(is_better([&closest, &all]) && !is_better([&all, &closest]));
}

#[test]
fn an_offset_is_no_larger_than_the_sheet() {
    let target = arch(60, 0.0);
    let settings = AssessSettings {
        thickness: Some(1.0),
        ..AssessSettings::default()
    };
    let offset_of = |offset: f64| {
        let source = disturb::offset(&arch(71, 0.0), offset);
        let [source, target] = [&source, &target].map(|mesh| Surface::new(mesh, "source").unwrap());
        let silent = Monitor::silent();
        let mut outcome = matched(&source, &target);
        outcome.target_from_source = Similarity::identity();
        let assessment = assess(&source, &target, &outcome, &settings, &silent).unwrap();
        assessment.shape.unwrap().offset
    };
    let near = offset_of(0.8).unwrap();
    assert!((near - 0.8).abs() < 0.05, "{near}");
    assert_eq!(offset_of(2.0), None);
}

#[test]
fn a_bent_panel_is_placed_as_a_whole_wherever_its_closest_half_lies() {
    // A panel of 1,200 x 900 mm, and the same before its trim, bent by 2 mm, on another mesh.
    let panel = |n: u32, margin: f64, bend: f64| {
        let mesh = sheet(n, |u, v| {
            let x = (1200.0 + 2.0 * margin) * (u - 0.5);
            let y = (900.0 + 2.0 * margin) * (v - 0.5);
            let arched = x * x / 8_000.0 + y * y / 6_000.0;
            let crease = 12.0 * (y / 120.0 - x / 900.0).tanh();
            Point3::new(x, y, arched + crease + bend * (x / 600.0).powi(2))
        });
        Surface::new(&mesh, "panel").unwrap()
    };
    let (crash, stamped) = (panel(60, 0.0, 0.0), panel(91, 90.0, 2.0));
    let corners = crash.mesh().aabb().corners();
    let off = |pose: &Similarity| pose.max_displacement(&Similarity::identity(), &corners);
    // Whatever the pairs that were kept have made of it, one of the first poses was right.
    let mut outcome = matched(&stamped, &crash);
    outcome.target_from_source = Similarity::from_translation(Vector3::new(400.0, 0.0, 0.0));
    let (settings, monitor) = (AssessSettings::default(), Monitor::silent());
    let context = PairContext::new([&stamped, &crash], &settings, &monitor);
    let placed = placed_as_a_whole(&context, &outcome).unwrap();
    let placed = placed.unwrap();
    assert!(off(&placed.target_from_source) < 10.0, "{placed:?}");
    // The pose before is told, as a worse one.
    let before = |other: &&Alternative| off(&other.target_from_source) > 300.0;
    let before = placed.alternatives.iter().find(before).unwrap();
    assert!(before.score_ratio > 1.4, "{before:?}");
    // Where the parts meet as a whole already there is nothing to do.
    outcome.target_from_source = Similarity::identity();
    let again = placed_as_a_whole(&context, &outcome).unwrap();
    assert_eq!(again, None);
}

/// The poses of a match that fit as well as its result, which is the first of them.
fn likely_poses(source: &Surface, target: &Surface) -> Vec<Similarity> {
    let mut outcome = matched(source, target);
    let (settings, monitor) = (AssessSettings::default(), Monitor::silent());
    let context = PairContext::new([source, target], &settings, &monitor);
    let held = held_by_borders(&context, &outcome).unwrap();
    if let Some(held) = held {
        outcome.target_from_source = held.target_from_source;
        outcome.alternatives = held.alternatives;
    }
    let others = outcome.alternatives.iter();
    let likely = others.filter(|other| other.score_ratio < 1.3);
    let poses = likely.map(|other| other.target_from_source);
    std::iter::once(outcome.target_from_source)
        .chain(poses)
        .collect()
}

/// Asserts that a stamped mesh that holds a part twice, `apart` from each other, has both among its likely poses on the
/// part.
fn both_are_likely(part: &TriMesh, crash: &TriMesh, apart: Vector3) {
    let shift = Similarity::from_translation(apart);
    let twice = disturb::joined(part, &part.transformed(&shift));
    let target = Surface::new(crash, "target").unwrap();
    let corners = part.aabb().corners();
    for seed in 1..=3 {
        let truth = placement(seed);
        let stamped = twice.transformed(&truth.inverse());
        let source = Surface::new(&stamped, "source").unwrap();
        let poses = likely_poses(&source, &target);
        for second in [Similarity::identity(), shift.inverse()] {
            let off = |pose: &Similarity| {
                let off = pose.after(&truth.inverse());
                off.max_displacement(&second, &corners)
            };
            let least = poses.iter().map(off).fold(f64::INFINITY, f64::min);
            assert!(least < 2.0, "seed {seed}: {least:.1} mm");
        }
    }
}

#[test]
fn the_second_of_two_symmetric_parts_in_one_mesh_is_as_likely() {
    let hat = |n| {
        sheet(n, |u, v| {
            let (x, y) = (300.0 * (u - 0.5), 200.0 * (v - 0.5));
            let top = 30.0 * (-(x / 90.0).powi(2) - (y / 50.0).powi(2)).exp();
            Point3::new(x, y, top)
        })
    };
    both_are_likely(&hat(30), &hat(23), Vector3::new(0.0, 230.0, 0.0));
}

#[test]
fn the_second_of_two_rails_in_one_mesh_is_as_likely() {
    // An open profile of one width along 900 mm, cut aslant at one end.
    let rail = |n| {
        sheet(n, |u, v| {
            let across = 160.0 * v;
            let wall = 50.0 / (1.0 + (-(across - 50.0) / 4.0).exp());
            let lip = -20.0 / (1.0 + (-(across - 120.0) / 4.0).exp());
            Point3::new(u * (900.0 + 0.4 * across), across, wall + lip)
        })
    };
    both_are_likely(&rail(61), &rail(47), Vector3::new(0.0, 210.0, 0.0));
}

/// A channel with flanges from `first` to `last` along itself, whose walls come closer to each other by 0.6° each.
fn tapered(n: u32, [first, last]: [f64; 2]) -> TriMesh {
    let step = |t: f64| 1.0 / (1.0 + (-t / 2.0).exp());
    sheet(n, |u, v| {
        let x = first + u * (last - first);
        let (y, half) = (170.0 * (v - 0.5), 45.0 - 0.0105 * x);
        Point3::new(x, y, 50.0 * (step(y + half) - step(y - half)))
    })
}

#[test]
fn a_channel_whose_ends_coincide_is_as_likely_as_one_whose_walls_do() {
    let [source, target] = [(70, [0.0, 560.0]), (59, [140.0, 700.0])].map(|(n, range)| {
        let mesh = tapered(n, range);
        Surface::new(&mesh, "source").unwrap()
    });
    let right = Similarity::identity();
    let slid = Similarity::from_translation(Vector3::new(140.0, 0.0, 0.0));
    let (settings, monitor) = (AssessSettings::default(), Monitor::silent());
    let context = PairContext::new([&source, &target], &settings, &monitor);
    let aside = |poses| pulled_aside(&context, poses, Remainder::MayGrow).unwrap();
    assert_eq!(aside([&right, &slid]), Some(PulledAside::Rival));
    assert_eq!(aside([&slid, &right]), None);
    // The pose under which the walls lie on each other is the result, whichever covers more.
    let mut outcome = matched(&source, &target);
    let [found, other] = [slid, right];
    outcome.target_from_source = found;
    outcome.alternatives = vec![Alternative {
        target_from_source: other,
        score_ratio: 7.0,
        by_shape: false,
        start: outcome.winner,
    }];
    let chosen = chosen_by_shape(&context, &outcome).unwrap();
    let chosen = chosen.unwrap();
    let off = |pose: &Similarity| pose.max_displacement(&right, &source.mesh().aabb().corners());
    assert!(off(&chosen.target_from_source) < 5.0, "{chosen:?}");
    let rival = &chosen.alternatives[0];
    assert_eq!(rival.score_ratio, 1.0);
    assert!(
        (off(&rival.target_from_source) - 140.0).abs() < 5.0,
        "{rival:?}"
    );
}

/// `n` × `m` cells of 10 mm without those in holes, its right and upper ends cut off by these lengths; a hole is given
/// by its first column and row and its width in cells.
fn holed(
    [n, m]: [u32; 2],
    cut_off: [f64; 2],
    holes: &[[u32; 3]],
    height: impl Fn(f64, f64) -> f64,
) -> TriMesh {
    let points = (0..(n + 1) * (m + 1)).map(|k| {
        let (i, j) = (k % (n + 1), k / (n + 1));
        let [off_x, off_y] = [(i == n, cut_off[0]), (j == m, cut_off[1])]
            .map(|(is_end, by)| if is_end { by } else { 0.0 });
        let (x, y) = (10.0 * f64::from(i) - off_x, 10.0 * f64::from(j) - off_y);
        Point3::new(x, y, height(x, y))
    });
    let is_hole = |i: u32, j: u32| {
        let holds = |[left, low, width]: &[u32; 3]| {
            (*left..left + width).contains(&i) && (*low..low + width).contains(&j)
        };
        holes.iter().any(holds)
    };
    let cells = (0..n * m).map(|k| (k % n, k / n));
    let solid = cells.filter(|&(i, j)| !is_hole(i, j));
    let triangles = solid.flat_map(|(i, j)| {
        let a = j * (n + 1) + i;
        [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]
    });
    TriMesh::new(points.collect(), triangles.collect()).unwrap()
}

#[test]
fn outlines_that_end_a_few_millimetres_apart_do_not_pull_a_part_aside() {
    let arch = |x: f64, _: f64| 40.0 * ((x - 300.0) / 300.0).powi(2);
    let holes = [[8, 6, 3], [44, 18, 3], [28, 12, 4], [46, 5, 3]];
    let [crash, stamped] =
        [[0.0; 2], [8.0, 4.0]].map(|cut_off| holed([60, 30], cut_off, &holes, arch));
    let [source, target] = [&stamped, &crash].map(|mesh| Surface::new(mesh, "source").unwrap());
    let mut outcome = matched(&source, &target);
    let (settings, monitor) = (AssessSettings::default(), Monitor::silent());
    let as_usual = MatchSettings::default();
    settle(
        &mut outcome,
        [&source, &target],
        &as_usual,
        &settings,
        &monitor,
    )
    .unwrap();
    // Before, the ends shared out what was cut off: it lay 2.4 mm aside.
    let error = worst_node(
        &stamped,
        &Similarity::identity(),
        &outcome.target_from_source,
    );
    assert!(error < 0.05, "{error} mm");
}

/// A Z-profile along x with three holes that distinguish its ends, sides and hands.
fn z_profile() -> TriMesh {
    let step = |_: f64, y: f64| 20.0 * ((y - 60.0) / 6.0).tanh();
    holed(
        [40, 12],
        [0.0; 2],
        &[[4, 1, 2], [14, 9, 2], [20, 1, 2]],
        step,
    )
}

#[test]
fn holes_tell_the_opposite_hand_of_a_profile_that_has_several_poses() {
    let target = z_profile();
    // The mirrored part moved so that its surface and its outline lie on the target.
    let onto = Similarity {
        translation: Vector3::new(400.0, 0.0, 0.0),
        ..Similarity::mirror_x()
    };
    let surface = |mesh: &TriMesh, name| Surface::new(mesh, name).unwrap();
    let (source, target) = (
        surface(&target.transformed(&onto), "source"),
        surface(&target, "target"),
    );
    let mut outcome = matched(&source, &target);
    outcome.target_from_source = Similarity::identity();
    // Turned about the profile's axis too, surface and outline lie on the target as well, and no hole on any other.
    let half_turn = Similarity {
        rotation: Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0)),
        translation: Vector3::new(0.0, 120.0, 0.0),
        scale: 1.0,
    };
    outcome.mirror_check.score_ratio = Some(1.0);
    outcome.mirror_check.target_from_source = Some(half_turn.after(&onto));
    let (settings, monitor) = (AssessSettings::default(), Monitor::silent());
    let context = PairContext::new([&source, &target], &settings, &monitor);
    let opposite = hand_by_borders(&context, &outcome).unwrap().unwrap();
    let error = worst_node(source.mesh(), &onto, &opposite.target_from_source);
    assert!(error < 0.1, "{error} mm");
    assert!(opposite.score_ratio < 0.8, "{}", opposite.score_ratio);
}

#[test]
fn the_edge_of_a_cut_beside_a_hole_is_not_its_border() {
    let waves = |x: f64, y: f64| 30.0 * (x / 70.0).cos() * (y / 60.0).cos() + x * x / 4000.0;
    let whole = holed([60, 15], [0.0; 2], &[[20, 4, 8]], waves);
    // The piece ends 4 mm before the hole.
    let piece = holed([20, 15], [4.0, 0.0], &[], waves);
    let (_, assessed) = judge(&piece, &whole);
    assert_eq!(assessed.verdict, Verdict::Good, "{:?}", assessed.reasons);
}

#[test]
fn every_step_that_moves_a_pose_hears_a_cancel() {
    let [source, target] = [9.0, 7.0].map(|pitch| {
        let mesh = pan(pitch, 0.0, everywhere);
        Surface::new(&mesh, "source").unwrap()
    });
    let mut outcome = matched(&source, &target);
    let before = outcome.clone();
    let (settings, monitor) = (AssessSettings::default(), Monitor::silent());
    monitor.request_cancel();
    let context = PairContext::new([&source, &target], &settings, &monitor);
    let pose = &before.target_from_source;
    let poses = [pose, &Similarity::identity()];
    assert!(is_better_with_all_pairs(&context, poses).is_err());
    assert!(held_by_borders(&context, &before).is_err());
    assert!(refined_with_borders(&context, pose).is_err());
    assert!(pulled_aside(&context, poses, Remainder::MayGrow).is_err());
    assert!(chosen_by_shape(&context, &before).is_err());
    assert!(placed_by_holes(&context, &before).is_err());
    assert!(placed_as_a_whole(&context, &before).is_err());
    assert!(placed_on_copies(&context, &before).is_err());
    assert!(hand_by_borders(&context, &before).is_err());
    assert!(without_trims(&context, pose).is_err());
    assert!(without_bend(&context, pose).is_err());
    assert!(without_offset(&context, pose).is_err());
    let (surfaces, as_usual) = ([&source, &target], MatchSettings::default());
    let settled = settle(&mut outcome, surfaces, &as_usual, &settings, &monitor);
    assert!(settled.is_err());
    assert_eq!(outcome.target_from_source, before.target_from_source);
}
