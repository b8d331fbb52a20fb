//! The tables of the report.

use super::Report;
use super::page::{escaped, fact_table, image, table};
use super::sections::percent;
use crate::registration::Method;
use crate::report::matrix::number;
use crate::report::{FileRecord, fate_words, grouped};

/// Groups of starts that are listed.
const N_GROUPS: usize = 8;

impl Report<'_> {
    /// Both directions, number by number.
    pub(super) fn distance_table(&self) -> String {
        let lengths = self.lengths();
        let ways = [
            (
                "▲ stamped → ■ crash",
                &self.deviation.source_on_target.stats,
            ),
            (
                "■ crash → ▲ stamped",
                &self.deviation.target_on_source.stats,
            ),
        ];
        let rows: Vec<Vec<String>> = ways
            .iter()
            .map(|(name, stats)| {
                let [matched, off, only] = stats.class_shares.map(percent);
                let distances = [stats.mean, stats.rms, stats.p95, stats.min, stats.max];
                let distances = distances.map(|d| lengths.bare(d));
                let mut row = vec![(*name).to_owned(), matched, off, only];
                row.extend(distances);
                row
            })
            .collect();
        let caption = lengths.axis("Distances of nodes, weighted by area");
        let columns = [
            "Nodes of → to",
            "Matched#",
            "Off by more#",
            "No counterpart#",
            "Mean#",
            "Rms#",
            "95 % within#",
            "Least#",
            "Largest#",
        ];
        table(&caption, &columns, &rows)
    }

    /// The worst places that have pictures, and those after them.
    pub(super) fn spot_table(&self) -> String {
        let lengths = self.lengths();
        let spots = &self.deviation.source_on_target.spots;
        let rows: Vec<Vec<String>> = spots
            .iter()
            .take(8)
            .enumerate()
            .map(|(i, spot)| {
                let at = self.record_point(&spot.position);
                let at = at.map(|x| format!("{x:.2}").replace('-', "−"));
                let [x, y, z] = at;
                vec![(i + 1).to_string(), lengths.bare(spot.value), x, y, z]
            })
            .collect();
        let caption =
            lengths.axis("Largest deviations of the stamped part, in the crash part's frame");
        table(&caption, &["Place", "Distance#", "x#", "y#", "z#"], &rows)
    }

    /// A point of the stamped part where the matrix puts it.
    fn record_point(&self, point: &crate::geometry::Point3) -> [f64; 3] {
        self.outcome.target_from_source.apply(point).into()
    }

    /// Starts by where they ended.
    pub(super) fn start_table(&self) -> String {
        let lengths = self.lengths();
        let n_starts = self.outcome.starts.len();
        let groups = self.groups.iter().enumerate().take(N_GROUPS);
        let rows: Vec<Vec<String>> = groups
            .map(|(i, group)| {
                let best = &self.outcome.starts[group.best];
                let last = best.iterations.last();
                let picture = self
                    .figures
                    .starts
                    .get(i)
                    .map_or_else(String::new, |figure| {
                        image(&figure.png, figure.size, &figure.alt)
                    });
                let (apart, turned) = self.group_distances[i];
                let kept = last.map_or_else(|| "–".to_owned(), |it| percent(it.fraction));
                let rmse = last.map_or_else(|| "–".to_owned(), |it| lengths.bare(it.rmse));
                vec![
                    (i + 1).to_string(),
                    picture,
                    format!("{} of {n_starts}", group.starts.len()),
                    escaped(&self.start_words(group.best)),
                    rmse,
                    kept,
                    best.iterations.len().to_string(),
                    lengths.bare(apart),
                    format!("{turned:.1}°"),
                    escaped(&fate_words(best.fate)),
                ]
            })
            .collect();
        let n_more = self.groups.len().saturating_sub(N_GROUPS);
        let more = if n_more > 0 {
            format!("<p class=\"soft\">{n_more} more poses were dropped early.</p>\n")
        } else {
            String::new()
        };
        let caption = lengths
            .axis("Poses that starts ended in; each row stands for all starts that met there");
        let columns = [
            "Pose",
            "Picture",
            "Starts#",
            "Found from",
            "Rms#",
            "Kept#",
            "Iterations#",
            "Centre off by#",
            "Turned by#",
            "Fate",
        ];
        table(&caption, &columns, &rows).replace("<td><img", "<td class=\"thumb\"><img") + &more
    }

    fn start_words(&self, start: usize) -> String {
        let start = &self.outcome.starts[start];
        let mut words = start.kind.label();
        if start.flipped {
            words += ", normals opposed";
        }
        if start.mirrored {
            words += ", mirrored";
        }
        words
    }

    /// Every choice of the method.
    pub(super) fn settings_table(&self) -> String {
        let (record, lengths) = (self.record, self.lengths());
        let p = &record.parameters;
        let text = |text: &str| escaped(text);
        let yes_no = |value: bool| if value { "yes" } else { "no" }.to_owned();
        let mut rows = vec![
            (
                "Method",
                text(Method::from_name(record.method).map_or(record.method, Method::label)),
            ),
            ("Pairs kept", text(p.selection)),
        ];
        let optional = [
            ("λ", p.lambda.map(number)),
            ("Floor", p.floor.map(|floor| lengths.of(floor))),
            ("Overlap", p.trimmed_overlap.map(percent)),
        ];
        rows.extend(
            optional
                .into_iter()
                .filter_map(|(name, value)| Some((name, value?))),
        );
        let [crash, stamped] = p
            .max_triangles
            .map(|n| n.map_or_else(|| "full".into(), grouped));
        let turns = p.n_rotations.map_or_else(
            || "–".to_owned(),
            |n| format!("{n} of {}°", number(p.angle_segment_deg)),
        );
        rows.extend([
            ("Paired with", text(p.pairs)),
            ("Residual", text(p.residual)),
            ("Motion", text(p.motion)),
            ("Hand", text(p.hand)),
            (
                "Points of",
                format!("{}, in the end {}", text(p.points_of), p.data_side),
            ),
            ("First poses", text(p.start_method)),
            ("Turns about the normal", turns),
            ("Both directions of the normal", yes_no(p.both_directions)),
            ("More starts where none convinces", yes_no(p.widen)),
            ("Search", text(p.search)),
            (
                "Points of the race",
                format!(
                    "{}, then {}",
                    grouped(p.race_points),
                    grouped(p.refine_points)
                ),
            ),
            ("Iterations at most", grouped(p.max_iterations)),
            (
                "Settled below",
                format!("{} edge lengths", number(p.motion_tolerance)),
            ),
            (
                "Normals within",
                format!("{}°", number(p.max_normal_angle_deg)),
            ),
            ("Allowance", lengths.of(p.allowance)),
            ("Reduced to", format!("■ {crash}, ▲ {stamped}")),
            (
                "Triangles of the search",
                format!(
                    "■ {}, ▲ {}",
                    grouped(p.crash_triangles),
                    grouped(p.stamped_triangles)
                ),
            ),
            ("Finished on the full meshes", yes_no(p.finish_on_full)),
        ]);
        fact_table("Settings", &rows)
    }

    /// Durations with bars.
    pub(super) fn times_table(&self) -> String {
        let t = &self.record.timings;
        let steps = [
            ("Read", t.read_ms),
            ("Reduce", t.reduce_ms),
            ("Align", t.align_ms),
            ("Match", t.match_ms),
            ("Verify", t.verify_ms),
            ("Total", t.total_ms),
        ];
        let longest = steps.iter().map(|(_, ms)| *ms).fold(1e-9, f64::max);
        let rows: Vec<Vec<String>> = steps
            .iter()
            .map(|(name, ms)| {
                let width = (120.0 * ms / longest).round();
                let bar = format!("<span class=\"meter\" style=\"width:{width}px\"></span>");
                vec![(*name).to_owned(), format!("{ms:.1} ms"), bar]
            })
            .collect();
        format!(
            "<div>{}</div>",
            table("Times", &["Step", "Time#", "Share"], &rows)
        )
    }

    /// Both files with what was taken from them.
    pub(super) fn files_section(&self) -> String {
        let files = &self.record.files;
        let mut text = String::from("<div class=\"two\">");
        text += &self.file("■ Crash part, fixed", &files.crash);
        text += &self.file("▲ Stamped part, moved", &files.stamped);
        text += "</div>\n";
        if !self.record.warnings.is_empty() {
            let warnings: String = self
                .record
                .warnings
                .iter()
                .map(|warning| format!("<li>{}</li>", escaped(warning)))
                .collect();
            text += &format!("<h3>To know</h3>\n<ul>{warnings}</ul>\n");
        }
        text
    }

    fn file(&self, title: &str, file: &FileRecord) -> String {
        let ids: Vec<String> = file.parts.iter().take(12).map(u64::to_string).collect();
        let more = if file.parts.len() > 12 {
            format!(" and {} more", file.parts.len() - 12)
        } else {
            String::new()
        };
        let hash = |hash: &Option<crate::formats::FileHash>| {
            hash.map_or_else(|| "–".to_owned(), |hash| format!("<code>{hash}</code>"))
        };
        let units = match (file.units, file.units_from) {
            (Some(units), Some(from)) => format!("{}, {}", escaped(units), escaped(from)),
            _ => "unknown".to_owned(),
        };
        let thickness = file
            .thickness
            .map_or_else(|| "–".to_owned(), |t| self.lengths().of(t));
        let mut rows = vec![
            ("File", escaped(&file.path)),
            ("SHA-256", hash(&file.hash)),
            ("Units", units),
            ("Lengths multiplied by", number(file.length_factor)),
            ("Parts matched", format!("{}{more}", ids.join(", "))),
            ("Nodes in the file", grouped(file.nodes)),
            ("Triangles matched", grouped(file.triangles)),
            ("Mean thickness", thickness),
            ("Findings of the reader", file.findings.to_string()),
        ];
        for include in file.includes.iter().take(20) {
            rows.push((
                "Includes",
                format!("{}<br>{}", escaped(&include.path), hash(&include.hash)),
            ));
        }
        fact_table(title, &rows)
    }
}
