//! What stands on the page, from top to bottom.

use super::page::{block, escaped, fact_table, folded, image, section};
use super::{CardsInfo, Figure, Report, charts};
use crate::geometry::{Matrix3, Similarity, Vector3};
use crate::report::MatrixForm;
use crate::report::matrix::number;

impl Report<'_> {
    pub(super) fn header(&self) -> String {
        let record = self.record;
        let [stamped, crash] =
            [&record.files.stamped, &record.files.crash].map(|f| escaped(&f.name));
        let (sign, sentence) = match record.verdict {
            "good" => ("✔", "The pose can be used."),
            "check" => ("⚠", "Probably right; look at the reasons."),
            _ => ("✖", "Do not use this pose."),
        };
        let reasons: String = record
            .reasons
            .iter()
            .map(|reason| format!("<li>{}</li>", escaped(&sentence_of(reason))))
            .collect();
        let (class, word) = (record.verdict, record.verdict.to_uppercase());
        let links: String = [
            ("pictures", "Pictures"),
            ("deviation", "Deviation"),
            ("transformation", "Transformation"),
            ("starts", "Starts"),
            ("cards", "Cards"),
            ("settings", "Settings"),
            ("files", "Files"),
            ("repeat", "Repeat"),
        ]
        .iter()
        .map(|(id, name)| format!("<a href=\"#{id}\">{name}</a>"))
        .collect();
        format!(
            "<header>\n<p class=\"kicker\">Match report of {}</p>\n\
             <h1><span class=\"stamped\">▲\u{a0}{stamped}</span> <span class=\"joint\">on</span> \
             <span class=\"crash\">■\u{a0}{crash}</span></h1>\n\
             <div class=\"verdict {class}\" role=\"status\"><strong><span aria-hidden=\"true\">{sign} </span>{word}</strong>\
             <ul><li>{sentence}</li>{reasons}</ul></div>\n{}\
             <nav aria-label=\"Sections\">{links}</nav>\n</header>\n",
            escaped(&record.build),
            self.key_figures()
        )
    }

    /// The numbers that matter most.
    fn key_figures(&self) -> String {
        let (metrics, lengths) = (&self.record.metrics, self.lengths());
        let n_starts = self.outcome.starts.len();
        let n_agree = self.groups.first().map_or(0, |group| group.starts.len());
        let limit = lengths.of(metrics.overlap.limit);
        let next = self.record.alternatives.first().map_or_else(
            || ("none near".to_owned(), String::new()),
            |other| {
                (
                    format!("× {:.2}", other.score_ratio),
                    "worse score".to_owned(),
                )
            },
        );
        let within = |share: f64| (percent(share), format!("within {limit}"));
        let figures = [
            ("▲ stamped on ■ crash", within(metrics.overlap.stamped)),
            ("■ crash on ▲ stamped", within(metrics.overlap.crash)),
            (
                "Rms distance",
                (lengths.of(metrics.rmse), "of the covered area".to_owned()),
            ),
            ("95 % lie within", (lengths.of(metrics.p95), String::new())),
            (
                "Starts that agree",
                (format!("{n_agree} of {n_starts}"), String::new()),
            ),
            ("Next best pose", next),
        ];
        let figures: String = figures
            .iter()
            .map(|(name, (value, note))| {
                format!("<div><dt>{name}</dt><dd>{value} <small>{note}</small></dd></div>")
            })
            .collect();
        format!("<dl class=\"figures\">{figures}</dl>\n")
    }

    pub(super) fn main(&self) -> String {
        let mut text = section("pictures", "Pictures", &self.pictures());
        text += &section("deviation", "Deviation", &self.deviation_section());
        text += &section("transformation", "Transformation", &self.transformation());
        text += &section("starts", "Starts", &self.starts_section());
        text += &section("cards", "LS-DYNA cards", &self.cards_section());
        let settings = format!(
            "<div class=\"two\">{}{}</div>",
            self.settings_table(),
            self.times_table()
        );
        text += &section("settings", "Settings and times", &settings);
        text += &section("files", "Files", &self.files_section());
        text + &section("repeat", "Repeat this match", &self.repeat_section())
    }

    fn pictures(&self) -> String {
        let figures = self.figures;
        format!(
            "<p class=\"soft\"><span class=\"crash\">■ Crash part</span>: fixed. \
             <span class=\"stamped\">▲ Stamped part</span>: moved onto it.</p>\n{}{}",
            pictures(&figures.parts),
            pictures(&figures.overlays)
        )
    }

    fn deviation_section(&self) -> String {
        let (deviation, lengths) = (self.deviation, self.lengths());
        let [stamped, crash] = [&deviation.source_on_target, &deviation.target_on_source];
        let sign = if deviation.is_signed {
            "Positive where the stamped part lies in front of the crash part, on the side of its \
             normals; negative behind it."
        } else {
            "Without sign, because the crash part has no consistent sides."
        };
        let chart = charts::histogram(
            [&stamped.stats, &crash.stats],
            &self.scale,
            deviation.limit,
            lengths,
        );
        let band = if self.scale.tolerance > 0.0 {
            let noise = lengths.of(self.scale.tolerance);
            format!(
                "<li><i style=\"background:var(--band)\"></i>± {noise}: explained by the facets</li>"
            )
        } else {
            String::new()
        };
        let limit = if deviation.limit <= self.scale.max {
            let limit = lengths.of(deviation.limit);
            format!(
                "<li><i class=\"line\" style=\"border-top-style:dashed\"></i>± {limit}: limit of the overlap</li>"
            )
        } else {
            String::new()
        };
        let gradient = charts::css_gradient(&self.scale);
        let offset = stamped.stats.offset.map_or_else(String::new, |offset| {
            let (value, thickness) = (lengths.of(offset.value), lengths.of(offset.thickness));
            format!(
                "<p>Nearly everywhere the parts are {value} apart, at a thickness of {thickness}: \
                 that looks like different reference surfaces, not like a bad fit.</p>"
            )
        });
        format!(
            "<p>{sign} Grey: no counterpart, because the other part ends there.</p>\n{}\
             <div class=\"scale\">{}</div>{offset}\n<h3>How the distances spread</h3>\n{chart}\
             <ul class=\"legend\"><li><i style=\"background:{gradient}\"></i>▲ stamped nodes, bars</li>\
             <li><i class=\"line\" style=\"border-color:var(--text)\"></i>■ crash nodes, line</li>{band}{limit}</ul>\n{}{}",
            pictures(&self.figures.maps),
            charts::color_legend(&self.scale, lengths),
            self.distance_table(),
            self.spots()
        )
    }

    fn spots(&self) -> String {
        if self.figures.spots.is_empty() {
            return String::new();
        }
        let pictures: String = self.figures.spots.iter().map(figure).collect();
        format!(
            "<h3>Worst places</h3>\n<div class=\"pictures three\">{pictures}</div>\n{}",
            self.spot_table()
        )
    }

    fn transformation(&self) -> String {
        let pose = &self.record.pose;
        let lengths = self.lengths();
        let unit = lengths.axis("");
        let unit = unit.trim_start_matches(", ");
        let unit = if unit.is_empty() {
            "the crash file's unit"
        } else {
            unit
        };
        let motion = motion(pose);
        let turn = &pose.rotation_axis_angle;
        let vector = |v: [f64; 3], decimals: usize| {
            let parts = v.map(|x| format!("{:.decimals$}", x + 0.0).replace('-', "−"));
            format!("({})", parts.join(", "))
        };
        let mut rows = vec![
            (
                "Centre moves by",
                format!("{} {unit}", vector(pose.center_move, 3)),
            ),
            (
                "Part turns by",
                format!(
                    "{:.4}° about the axis {}",
                    turn.angle_deg,
                    vector(turn.axis, 6)
                ),
            ),
            ("Determinant of R", format!("{:.12}", pose.determinant)),
            ("Scale c", number(pose.scale)),
        ];
        if let Some(node) = pose.sample_node {
            let (from, to) = (vector(node.stamped, 4), vector(node.crash, 4));
            rows.push(("Sample node", format!("{}: {from} → {to}", node.id)));
        }
        let factor = self.record.units.stamped_factor;
        if factor != 1.0 {
            rows.push((
                "Before that",
                format!(
                    "the lengths of the stamped file are multiplied by {}",
                    number(factor)
                ),
            ));
        }
        let main = block(
            "the matrix by rows",
            &MatrixForm::Rows.write(&motion),
            false,
        );
        let others: String = MatrixForm::ALL
            .iter()
            .filter(|form| **form != MatrixForm::Rows)
            .map(|form| folded(form.label(), &form.write(&motion)))
            .collect();
        format!(
            "<p>Moves <span class=\"stamped\">▲ stamped</span> onto <span class=\"crash\">■ crash</span>, \
             for column vectors, lengths in {unit}:</p>\n\
             <p class=\"math\"><i>p</i><sub>crash</sub> = {}<i>R</i> · <i>p</i><sub>stamped</sub> + <i>t</i></p>\n\
             {main}{}<h3>Other forms</h3>\n{others}",
            if pose.scale == 1.0 {
                ""
            } else {
                "<i>c</i> · "
            },
            fact_table("In words", &rows)
        )
    }

    fn starts_section(&self) -> String {
        let outcome = self.outcome;
        let iterations: usize = outcome.starts.iter().map(|s| s.iterations.len()).sum();
        let summary = format!(
            "<p>{} starts took {iterations} iterations and ended in {} poses.</p>\n",
            outcome.starts.len(),
            self.groups.len()
        );
        let chart = charts::convergence(outcome, self.lengths()).map_or_else(String::new, |chart| {
            format!(
                "<h3>Convergence</h3>\n{chart}<ul class=\"legend\">\
                 <li><i class=\"line\" style=\"border-color:var(--stamped)\"></i>winner</li>\
                 <li><i class=\"line\" style=\"border-color:var(--crash);border-top-style:dashed\"></i>runners-up</li>\
                 <li><i class=\"line\" style=\"border-color:var(--faint)\"></i>dropped</li></ul>\n"
            )
        });
        summary + &self.start_table() + &chart
    }

    fn cards_section(&self) -> String {
        self.cards.iter().map(|cards| self.card(cards)).collect()
    }

    fn card(&self, cards: &CardsInfo) -> String {
        let name = escaped(cards.name);
        match &cards.text {
            Ok((text, error)) => format!(
                "<p><code>{name}</code>: read back after writing; rounding moves no node by more than {}.</p>\n{}",
                escaped(&format!(
                    "{error:.1e}{}",
                    self.lengths().axis("").trim_start_matches(',')
                )),
                folded(&format!("Cards with {}", cards.name), text)
            ),
            Err(reason) => {
                format!(
                    "<p><code>{name}</code>: not written, because {}.</p>\n",
                    escaped(reason)
                )
            }
        }
    }

    fn repeat_section(&self) -> String {
        let line = block("the command line", &self.record.command_line, true);
        format!(
            "<p>This line does the match again, with the same numbers to the last bit:</p>\n{line}"
        )
    }

    pub(super) fn footer(&self) -> String {
        let (record, machine) = (self.record, &self.record.machine);
        format!(
            "<footer><p>{}. {} {}, {} threads. A match draws no random numbers: the same files and \
             settings give the same result.</p></footer>\n",
            escaped(&record.build),
            escaped(machine.os),
            escaped(machine.arch),
            machine.threads
        )
    }
}

/// The motion of a record.
fn motion(pose: &crate::report::PoseRecord) -> Similarity {
    Similarity {
        rotation: Matrix3::from_fn(|i, j| pose.rotation[i][j]),
        translation: Vector3::from(pose.translation),
        scale: pose.scale,
    }
}

fn pictures(figures: &[Figure]) -> String {
    let figures: String = figures.iter().map(figure).collect();
    format!("<div class=\"pictures\">{figures}</div>\n")
}

fn figure(figure: &Figure) -> String {
    let image = image(&figure.png, figure.size, &figure.alt);
    let mark = if figure.is_marked {
        "<span class=\"mark\" aria-hidden=\"true\"></span>"
    } else {
        ""
    };
    let (title, caption) = (escaped(&figure.title), escaped(&figure.caption));
    format!(
        "<figure><div class=\"plate\">{image}{mark}</div><figcaption><b>{title}</b> {caption}</figcaption></figure>\n"
    )
}

/// A share as the window writes it.
pub(super) fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

/// A reason as a sentence.
fn sentence_of(reason: &str) -> String {
    let mut letters = reason.chars();
    let first = letters.next().map(|c| c.to_uppercase().to_string());
    let end = if reason.ends_with(['.', '?', '!']) {
        ""
    } else {
        "."
    };
    first.unwrap_or_default() + letters.as_str() + end
}
