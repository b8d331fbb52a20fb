//! The sections of the page, from top to bottom.

use maud::{Markup, html};

use super::page::{block, cell, fact_table, folded, image, printable, section};
use super::{CardsInfo, Figure, Report, charts};
use crate::assess::deviation::OverlapClass;
use crate::assess::{beside, likely_beside};
use crate::geometry::{Matrix3, Similarity, Vector3};
use crate::report::matrix::number;
use crate::report::{AlternativeRecord, MatrixForm, PoseRecord};
use crate::role::PerRole;
use crate::text::{counted, fixed, percent, sentence, vector};

/// The sections with the words of their links.
const LINKS: [(&str, &str); 9] = [
    ("pictures", "Pictures"),
    ("pose", "Pose"),
    ("deviation", "Deviation"),
    ("transformation", "Transformation"),
    ("starts", "Starts"),
    ("cards", "Cards"),
    ("settings", "Settings"),
    ("files", "Files"),
    ("repeat", "Repeat"),
];

impl Report<'_> {
    pub(super) fn header(&self) -> Markup {
        let (record, verdict) = (self.record, self.record.verdict);
        let names = record.files.as_ref().map(|file| printable(&file.name));
        html! {
            header {
                p.kicker { "Match report of " (record.build) }
                h1 {
                    span.stamped { "▲\u{a0}" (names.stamped) }
                    " "
                    span.joint { "on" }
                    " "
                    span.crash { "■\u{a0}" (names.crash) }
                }
                div class={ "verdict " (verdict.label().to_lowercase()) } role="status" {
                    strong { span aria-hidden="true" { (verdict.sign()) " " } (verdict.label()) }
                    ul {
                        li { (verdict.advice(record.pose_statement)) }
                        @for reason in &record.reasons {
                            li { (printable(&sentence(reason))) }
                        }
                        @for statement in &record.statements {
                            li { (printable(&sentence(statement))) }
                        }
                        @for warning in &record.warnings {
                            li { "⚠ " (printable(&sentence(warning))) }
                        }
                    }
                }
                (self.key_figures())
                nav aria-label="Sections" {
                    @for (id, name) in LINKS {
                        a href={ "#" (id) } { (name) }
                    }
                }
            }
        }
    }

    /// The numbers that matter most.
    fn key_figures(&self) -> Markup {
        let (metrics, lengths) = (&self.record.metrics, self.lengths());
        let limit = lengths.of(metrics.overlap.limit);
        let n_agree = self.groups.first().map_or(0, |group| group.members.len());
        let agreement = format!("{n_agree} of {}", self.outcome.starts.len());
        let next = self.record.alternatives.first();
        html! {
            dl.figures {
                (key_figure("▲ stamped on ■ crash", &percent(metrics.overlap.stamped), &format!("within {limit}")))
                (key_figure("■ crash on ▲ stamped", &percent(metrics.overlap.crash), &format!("within {limit}")))
                (key_figure("RMS distance", &lengths.of(metrics.rmse), "of the overlap"))
                (key_figure("P95", &lengths.of(metrics.p95), "of the overlap"))
                (key_figure("Starts that agree", &agreement, ""))
                @match next {
                    Some(other) => (next_pose(other)),
                    None if self.outcome.rivals_sought => (key_figure("Next best pose", "none near", "")),
                    None => (key_figure("Next best pose", "–", "not looked for everywhere")),
                }
            }
        }
    }

    pub(super) fn main(&self) -> Markup {
        let settings = html! {
            div.two { (self.settings_table()) (self.times_table()) }
        };
        html! {
            (section("pictures", "Pictures", &self.pictures()))
            (section("pose", "Pose", &self.pose_section()))
            (section("deviation", "Deviation", &self.deviation_section()))
            (section("transformation", "Transformation", &self.transformation()))
            (section("starts", "Starts", &self.starts_section()))
            (section("cards", "LS-DYNA cards", &self.cards_section()))
            (section("settings", "Settings and times", &settings))
            (section("files", "Files", &self.files_section()))
            (section("repeat", "Repeat this match", &self.repeat_section()))
        }
    }

    fn pictures(&self) -> Markup {
        html! {
            p.soft {
                span.crash { "■ Crash part" } ": fixed. "
                span.stamped { "▲ Stamped part" } ": moved onto it."
            }
            (pictures(&self.figures.parts))
            (pictures(&self.figures.overlays))
        }
    }

    fn deviation_section(&self) -> Markup {
        let (deviation, lengths) = (self.deviation, self.lengths());
        let stats = PerRole {
            crash: &deviation.target_on_source.stats,
            stamped: &deviation.source_on_target.stats,
        };
        let sign = if deviation.is_signed {
            "Positive where the stamped part lies in front of the crash part, on the side of its \
             normals; negative behind it."
        } else {
            "Without sign, because the crash part has no consistent sides."
        };
        html! {
            p { (sign) " Grey: " (OverlapClass::OnlyHere.label()) ", because the other part ends there." }
            (pictures(&self.figures.maps))
            div.scale { (charts::color_legend(&self.scale, lengths)) }
            @if let Some(offset) = stats.stamped.offset {
                p {
                    "Nearly everywhere the parts are " (lengths.of(offset.value))
                    " apart, at a thickness of " (lengths.of(offset.thickness))
                    ": that looks like different reference surfaces, not like a bad fit."
                }
            }
            h3 { "Distribution of the distances" }
            (charts::histogram(stats, &self.scale, deviation.limit, lengths))
            (self.histogram_legend())
            (self.distance_table())
            @if !self.figures.spots.is_empty() {
                h3 { "Largest deviations" }
                div class="pictures three" { @for spot in &self.figures.spots { (figure(spot)) } }
                (self.spot_table())
            }
        }
    }

    fn histogram_legend(&self) -> Markup {
        let (scale, limit, lengths) = (&self.scale, self.deviation.limit, self.lengths());
        html! {
            ul.legend {
                li { i style={ "background:" (charts::css_gradient(scale)) } {} "▲ stamped nodes, bars" }
                li { i.line style="border-color:var(--text)" {} "■ crash nodes, line" }
                @if scale.tolerance > 0.0 {
                    li {
                        i style="background:var(--band)" {}
                        "± " (lengths.of(scale.tolerance)) ": explained by faceting"
                    }
                }
                @if limit <= scale.max {
                    li {
                        i.line style="border-top-style:dashed" {}
                        "± " (lengths.of(limit)) ": overlap limit"
                    }
                }
            }
        }
    }

    fn transformation(&self) -> Markup {
        let pose = &self.record.pose;
        let unit = self.lengths().unit;
        let unit = unit.map_or("the crash file's unit", |unit| unit.symbol());
        let motion = motion(pose);
        let others = MatrixForm::ALL
            .iter()
            .filter(|form| **form != MatrixForm::Rows);
        html! {
            p {
                "Moves " span.stamped { "▲ stamped" } " onto " span.crash { "■ crash" }
                ", for column vectors, lengths in " (unit) ":"
            }
            p.math {
                "crash = " i { "c" } " · " i { "R" } " · stamped + " i { "t" }
            }
            (block("the matrix by rows", &MatrixForm::Rows.write(&motion), false))
            (self.motion_table(unit))
            h3 { "Other forms" }
            @for form in others {
                (folded(form.label(), &form.write(&motion)))
            }
        }
    }

    fn motion_table(&self, unit: &str) -> Markup {
        let pose = &self.record.pose;
        let rotation = &pose.rotation_axis_angle;
        let lengths = self.lengths();
        let place = |at, decimals| vector(at, lengths.decimals_as_of_mm(decimals));
        let mut rows = vec![
            (
                "Translation of the centre",
                cell(format!("{} {unit}", place(pose.center_move, 3))),
            ),
            (
                "Rotation",
                cell(format!(
                    "{}° about the axis {}{}",
                    fixed(rotation.angle_deg, 4),
                    vector(rotation.axis, 6),
                    pose.mirror_words()
                )),
            ),
            (
                "Determinant of R",
                cell(format!("{:.12}", pose.determinant)),
            ),
            ("Scale c", cell(number(pose.scale))),
        ];
        if let Some(node) = pose.sample_node {
            let (from, to) = (place(node.stamped, 4), place(node.crash, 4));
            rows.push(("Sample node", cell(format!("{}: {from} → {to}", node.id))));
        }
        let factor = self.record.units.stamped_factor;
        if factor != 1.0 {
            let factor = number(factor);
            let words = format!("the lengths of the stamped file are multiplied by {factor}");
            rows.push(("Before that", cell(words)));
        }
        fact_table("The motion", &rows)
    }

    fn starts_section(&self) -> Markup {
        let outcome = self.outcome;
        let iterations: usize = outcome.starts.iter().map(|s| s.iterations.len()).sum();
        html! {
            p {
                (counted(outcome.starts.len(), "start")) " took " (counted(iterations, "iteration"))
                " and ended in " (counted(self.groups.len(), "pose")) "."
            }
            (self.start_table())
            @if let Some(chart) = charts::convergence(outcome, self.lengths()) {
                h3 { "Convergence" }
                (chart)
                ul.legend {
                    li { i.line style="border-color:var(--stamped)" {} "best start" }
                    li { i.line style="border-color:var(--crash);border-top-style:dashed" {} "close in the search" }
                    li { i.line style="border-color:var(--faint)" {} "dropped" }
                }
            }
        }
    }

    fn cards_section(&self) -> Markup {
        html! { @for cards in self.cards { (self.card(cards)) } }
    }

    fn card(&self, cards: &CardsInfo) -> Markup {
        let name = cards.name;
        match &cards.text {
            Ok((text, error)) => html! {
                p {
                    code { (name) }
                    ": read back after writing; rounding moves no node by more than "
                    (format!("{error:.1e}")) (self.lengths().suffix()) "."
                }
                (folded(&format!("Cards with {name}"), text))
            },
            Err(reason) => html! {
                p { code { (name) } ": not written, because " (printable(reason)) "." }
            },
        }
    }

    fn repeat_section(&self) -> Markup {
        html! {
            p { "This line repeats the match with the same numbers to the last bit:" }
            (block("the command line", &self.record.command_line, true))
        }
    }

    pub(super) fn footer(&self) -> Markup {
        let (record, machine) = (self.record, &self.record.machine);
        html! {
            footer {
                p {
                    (record.build) ". " (machine.os) " " (machine.arch) ", " (machine.threads)
                    " threads. A match draws no random numbers: the same files and settings give \
                     the same result."
                }
            }
        }
    }
}

fn key_figure(name: &str, value: &str, note: &str) -> Markup {
    html! { div { dt { (name) } dd { (value) " " small { (note) } } } }
}

/// How the next best pose fits. The report of an alternative stands beside the best one.
fn next_pose(other: &AlternativeRecord) -> Markup {
    let ratio = other.score_ratio;
    let name = if other.number == 1 {
        "Best pose"
    } else {
        "Next best pose"
    };
    if other.by_shape {
        key_figure(name, likely_beside(ratio), "by its shape")
    } else {
        key_figure(name, &beside(ratio), "error")
    }
}

/// The motion of a record.
fn motion(pose: &PoseRecord) -> Similarity {
    Similarity {
        rotation: Matrix3::from_fn(|i, j| pose.rotation[i][j]),
        translation: Vector3::from(pose.translation),
        scale: pose.scale,
    }
}

pub(super) fn pictures(figures: &[Figure]) -> Markup {
    html! { div.pictures { @for one in figures { (figure(one)) } } }
}

pub(super) fn figure(figure: &Figure) -> Markup {
    html! {
        figure {
            div.plate {
                (image(&figure.png, figure.size, &figure.alt))
                @if figure.is_marked { span.mark aria-hidden="true" {} }
            }
            figcaption { b { (printable(&figure.title)) } " " (printable(&figure.caption)) }
        }
    }
}
