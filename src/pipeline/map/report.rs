//! The report of a mapping: draws the pictures and collects what [`crate::report::html`] lays out.

use super::lists::givers;
use super::record::{DistributionRecord, MapRecord, PairRecord, von_mises_of};
use super::verdict::{change, change_text};
use super::{
    CheckReason, CheckRecord, ComparedRow, DifferenceRecord, MapRecipe, MapRun, OtherResult,
    PipelineError, ProbeRecord, ProbedValue, ShownValue,
};
use crate::colormap::{ColorMap, ColorScale, Rgb, UNMATCHED};
use crate::geometry::chunks::{for_chunks, map_chunks};
use crate::geometry::{Camera, Similarity, TriMesh};
use crate::mapping::{MapOptions, ShellMesh, SourcePart};
use crate::monitor::{Cancelled, Monitor};
use crate::pipeline::forming_values::FormingValue;
use crate::pipeline::load::LoadedPart;
use crate::pipeline::outputs::report_figures::{From, fitted, view_of};
use crate::pipeline::units::PairUnits;
use crate::report::MatrixForm;
use crate::report::html::{
    CheckReport, Figure, FilesReport, MapReport, NumberRow, QuantityReport, map_figure,
};
use crate::report::picture::{Paint, Picture, PictureMesh, picture};
use crate::role::PerRole;
use crate::settings::{MAP_SETTINGS, Setting};
use crate::text::{
    Lengths, counted, factor_note, fixed, grouped, length, millis, percent, share, signed,
};

/// Pixels of a picture.
const SIZE: [usize; 2] = [560, 380];

/// Writes the report of a run as one HTML file with pictures of thickness, plastic strain and, where
/// stresses were mapped, von Mises stress before and after, their difference, and the status of the
/// elements. `record` is that of the run; where it holds a comparison, `other` is what was compared with, and
/// both results stand in pictures too.
pub fn map_report(
    run: &MapRun,
    record: &MapRecord,
    crash: &LoadedPart,
    other: Option<&OtherResult>,
    monitor: &Monitor,
) -> Result<String, PipelineError> {
    let painter = Painter::new(run, crash, monitor)?;
    let quantities = painter.quantities(record)?;
    monitor.progress("draw", 2, Some(3));
    let compared = painter.compared(record, other)?;
    let present = record.statuses.iter().map(|row| row.status);
    let report = MapReport {
        build: record.build.clone(),
        names: [
            crash.file_name(),
            record
                .stamped
                .iter()
                .map(|stamped| record.stamped_name(stamped))
                .collect::<Vec<_>>()
                .join(", "),
        ],
        facts: facts(record, painter.lengths),
        warnings: record.warnings.clone(),
        checks: checks(record),
        statuses: record
            .statuses
            .iter()
            .map(|row| {
                [
                    row.status.label().to_owned(),
                    grouped(row.n_elements),
                    share(row.area_share),
                ]
            })
            .collect(),
        status_figures: vec![painter.statuses()?],
        status_colors: present
            .map(|status| {
                (
                    status.label().to_owned(),
                    hex(ColorScale::statuses().color(f64::from(status as u8))),
                )
            })
            .collect(),
        files: painter.files(record)?,
        quantities,
        probes: record.probes.iter().flat_map(probe_rows).collect(),
        comparison: comparison_rows(record),
        compared,
        compared_with: record
            .comparison
            .as_ref()
            .map_or_else(String::new, |other| other.files.join(", ")),
        poses: run
            .poses
            .iter()
            .zip(&record.stamped)
            .map(|(pose, stamped)| {
                let name = record.stamped_name(stamped) + &factor_note(stamped.length_factor);
                (name, MatrixForm::Rows.write(pose))
            })
            .collect(),
        settings: settings(&run.recipe, painter.lengths),
        read: record.files.clone(),
        lengths: painter.lengths,
        command_line: record.command_line.clone(),
    };
    Ok(report.write())
}

/// What it was mapped with, as far as section 4 and the command line ask for it: name, value.
fn settings(recipe: &MapRecipe, lengths: Lengths) -> Vec<(&'static str, String)> {
    let options = &recipe.options;
    let mut quantities = options.quantities;
    let chosen = quantities.named().into_iter().filter(|(_, is_on)| **is_on);
    let quantities: Vec<&str> = chosen.map(|(name, _)| name).collect();
    let shown = |row: &Setting<MapOptions>| {
        let value = row.get(options)?;
        Some((row.label, row.shown(&value, lengths)))
    };
    let of_file = |value: Option<String>| value.unwrap_or_else(|| "as in the file".to_owned());
    let factors: Vec<String> = recipe.stress_factors.iter().map(f64::to_string).collect();
    let mut rows = vec![("Quantities", quantities.join(", "))];
    rows.extend(MAP_SETTINGS.iter().filter_map(shown));
    rows.extend([
        ("Layers", of_file(recipe.n_layers.map(|n| n.to_string()))),
        (
            "Rule through the thickness",
            of_file(recipe.rule.map(|rule| rule.name().to_owned())),
        ),
        (
            "Points in the plane",
            of_file(recipe.n_plane.map(|n| n.to_string())),
        ),
        ("Stamped material", of_file(recipe.stamped_law.clone())),
    ]);
    if !factors.is_empty() {
        rows.push(("Stress factors", factors.join(", ")));
    }
    rows
}

/// The headline figures: name, value, what the value is.
fn facts(record: &MapRecord, lengths: Lengths) -> Vec<[String; 3]> {
    let mut facts = vec![
        [
            "Crash part".to_owned(),
            match &record.crash_parts[..] {
                [id] => id.to_string(),
                ids => counted(ids.len(), "part"),
            },
            String::new(),
        ],
        [
            "Area with values".to_owned(),
            percent(record.mapped_area),
            "of the crash part".to_owned(),
        ],
        [
            "Elements".to_owned(),
            grouped(record.n_elements),
            format!("mapped in {}", millis(record.map_ms)),
        ],
    ];
    for (name, pair, suffix) in [
        ("Mean thickness", &record.thickness, lengths.suffix()),
        ("Mean plastic strain", &record.plastic_strain, ""),
    ] {
        if let Some(pair) = pair {
            let change = change_text(change(pair.crash.mean, pair.stamped.mean));
            let note = format!("{change} to {}", pair.stamped_word());
            let mean = format!("{}{suffix}", length(pair.crash.mean));
            facts.push([name.to_owned(), mean, note]);
        }
    }
    if let Some(back) = &record.map_back {
        for (name, difference) in [
            ("Thickness there and back", &back.thickness),
            ("Plastic strain there and back", &back.plastic),
        ] {
            if let Some(of_range) = difference.share_of_range() {
                let note = "of the range, 95 % of the area".to_owned();
                facts.push([name.to_owned(), share(of_range), note]);
            }
        }
    }
    facts
}

/// A row for each quantity of a probe.
fn probe_rows(probe: &ProbeRecord) -> Vec<[String; 10]> {
    let finite = |value: f64, text: String| {
        if value.is_finite() {
            text
        } else {
            "–".to_owned()
        }
    };
    let row = |value: &ProbedValue| {
        let difference = value.crash - value.stamped;
        [
            probe.element.to_string(),
            match (probe.stamped_element, &probe.stamped_file) {
                (Some(id), Some(file)) => format!("{id} ({file})"),
                (Some(id), None) => id.to_string(),
                (None, _) => "–".to_owned(),
            },
            probe.status.label().to_owned(),
            finite(probe.normal_distance, signed(probe.normal_distance)),
            finite(probe.angle_deg, fixed(probe.angle_deg, 1)),
            fixed(probe.confidence, 2),
            value.name.to_owned(),
            finite(value.stamped, length(value.stamped)),
            finite(value.crash, length(value.crash)),
            finite(difference, signed(difference)),
        ]
    };
    probe.values.iter().map(row).collect()
}

fn comparison_rows(record: &MapRecord) -> Vec<(String, [String; 6])> {
    let Some(other) = &record.comparison else {
        return Vec::new();
    };
    let row = |row: ComparedRow<'_>| {
        let found = row.difference;
        let cells = [
            grouped(found.n_elements),
            signed(found.mean),
            length(found.rms),
            length(found.p95),
            length(found.max),
            found.element.to_string(),
        ];
        (row.name.to_owned(), cells)
    };
    other.rows().map(row).collect()
}

fn checks(record: &MapRecord) -> Vec<CheckReport> {
    let check = |check: &CheckRecord| CheckReport {
        cells: [&check.name, &check.found, &check.limit].map(Clone::clone),
        is_met: check.is_met,
        reason: check.reason.map(CheckReason::label),
    };
    record.checks.iter().map(check).collect()
}

/// Colours of values on two sides: 5 % to 99 % of the area of both.
fn values_scale(a: &DistributionRecord, b: &DistributionRecord) -> ColorScale {
    let (low, high) = (a.p5.min(b.p5), a.p99.max(b.p99));
    ColorScale::new(ColorMap::Viridis, low, high.max(low + f64::MIN_POSITIVE))
}

fn color(scale: &ColorScale, value: f64) -> Rgb {
    if value.is_finite() {
        scale.color(value)
    } else {
        UNMATCHED
    }
}

/// What the bins of two sides span.
fn range_of(a: &DistributionRecord, b: &DistributionRecord) -> [f64; 2] {
    [a.min.min(b.min), a.max.max(b.max)]
}

fn number_row(of: &DistributionRecord) -> NumberRow {
    [of.mean, of.min, of.p5, of.p50, of.p95, of.p99, of.max].map(length)
}

/// The look of a stamped file as a CSS background.
fn swatch(file: usize) -> String {
    let (color, is_hatched) = ColorScale::file_look(file);
    let color = hex(color);
    if is_hatched {
        format!("repeating-linear-gradient(135deg,#262a30 0 2px,{color} 2px 6px)")
    } else {
        color
    }
}

fn hex([r, g, b]: Rgb) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Draws elements in one colour each, both sides under one camera.
struct Painter<'a> {
    run: &'a MapRun,
    monitor: &'a Monitor,
    camera: Camera,
    target: ElementMesh,
    sources: Vec<ElementMesh>,
    lengths: Lengths,
}

/// A mesh whose elements share no corner, so that each has its own colour.
struct ElementMesh {
    mesh: TriMesh,
    n_elements: usize,
    element_of_vertex: Vec<u32>,
}

impl ElementMesh {
    fn new(shells: &ShellMesh, monitor: &Monitor) -> Result<Self, Cancelled> {
        let (triangles, element_of) = shells.triangles(monitor)?;
        monitor.check()?;
        let n = triangles.n_triangles();
        let positions = map_chunks(3 * n, monitor, |corner| {
            let node = triangles.triangles()[corner / 3][corner % 3];
            triangles.positions()[node as usize]
        })?;
        let split = map_chunks(n, monitor, |t| [0, 1, 2].map(|i| 3 * t as u32 + i))?;
        let mesh = TriMesh::new(positions, split);
        monitor.check()?;
        Ok(Self {
            mesh: mesh.expect("corners count the positions, which were checked"),
            n_elements: shells.len(),
            element_of_vertex: map_chunks(3 * n, monitor, |corner| element_of[corner / 3])?,
        })
    }

    /// The colour of each vertex from those of the elements.
    fn colors(
        &self,
        color: impl Fn(usize) -> Rgb,
        monitor: &Monitor,
    ) -> Result<Vec<Rgb>, Cancelled> {
        let mut of_elements = Vec::with_capacity(self.n_elements);
        for_chunks(self.n_elements, monitor, |range| {
            of_elements.extend(range.map(&color));
        })?;
        map_chunks(self.element_of_vertex.len(), monitor, |vertex| {
            of_elements[self.element_of_vertex[vertex] as usize]
        })
    }
}

impl<'a> Painter<'a> {
    fn new(run: &'a MapRun, crash: &LoadedPart, monitor: &'a Monitor) -> Result<Self, Cancelled> {
        let view = view_of(&crash.surface, From::Front);
        let units = PairUnits::of(PerRole::new(Some(crash), None));
        let target = ElementMesh::new(&run.target.mesh, monitor)?;
        let still = Similarity::identity();
        let sources = run.sources.iter();
        let sources = sources.map(|source| ElementMesh::new(&source.mesh, monitor));
        Ok(Self {
            run,
            monitor,
            camera: fitted(view, target.mesh.positions(), &still, SIZE, monitor)?,
            target,
            lengths: Lengths::new(units.lengths),
            sources: sources.collect::<Result<_, Cancelled>>()?,
        })
    }

    /// Every quantity with statistics, before and after.
    fn quantities(&self, record: &MapRecord) -> Result<Vec<QuantityReport>, Cancelled> {
        let run = self.run;
        let mut quantities = Vec::new();
        self.monitor.progress("draw", 0, Some(3));
        let scale = run.recipe.options.thickness_scale;
        if let Some(pair) = &record.thickness {
            let on_source = |part: &SourcePart, element| scale * part.mean_thickness(element);
            let on_target = |element: usize| run.thickness(element);
            let name = self.lengths.axis("Thickness");
            quantities.push(self.quantity(&name, pair, &on_source, &on_target)?);
        }
        self.monitor.progress("draw", 1, Some(3));
        if let Some(pair) = &record.plastic_strain {
            let on_source = |part: &SourcePart, element| part.mean_plastic_strain(element);
            let on_target = |element: usize| run.plastic_strain(element);
            let name = "Effective plastic strain, mean over the layers";
            quantities.push(self.quantity(name, pair, &on_source, &on_target)?);
        }
        if let Some(pair) = &record.von_mises {
            let shown = ShownValue::compared(Some(FormingValue::VonMises));
            let on_source = |part: &SourcePart, element| von_mises_of(part, element);
            let on_target = |element: usize| run.shown(element, &shown);
            let name = "Von Mises stress in the middle of the sheet";
            quantities.push(self.quantity(name, pair, &on_source, &on_target)?);
        }
        Ok(quantities)
    }

    /// Before, after and difference with tables and histograms.
    fn quantity(
        &self,
        name: &str,
        pair: &PairRecord,
        on_source: &dyn Fn(&SourcePart, usize) -> f64,
        on_target: &dyn Fn(usize) -> f64,
    ) -> Result<QuantityReport, Cancelled> {
        let scale = values_scale(&pair.stamped, &pair.crash);
        let before = self.draw_sources(|source, element| {
            color(&scale, on_source(&self.run.sources[source], element))
        })?;
        let after = self.draw_target(|element| color(&scale, on_target(element)))?;
        let (apart, signed) = self.draw_difference(&scale, |element| {
            on_target(element) - self.run.at_partner(element, on_source)
        })?;
        let figure = |png, title, caption| map_figure(png, SIZE, title, caption);
        let stamped_word = pair.stamped_word();
        let [stamped, moved] = match self.run.sources.len() {
            1 => ["▲ Stamped part,", "before, moved by the pose."],
            _ => ["▲ Stamped parts,", "before, each moved by its pose."],
        };
        Ok(QuantityReport {
            name: name.to_owned(),
            rows: vec![
                (
                    format!("▲ {stamped_word}, covered"),
                    number_row(&pair.stamped),
                ),
                ("■ crash, mapped".to_owned(), number_row(&pair.crash)),
            ],
            shares: pair.histograms.clone(),
            range: range_of(&pair.stamped, &pair.crash),
            histogram_distance: pair.histogram_distance,
            figures: vec![
                figure(before, stamped, moved),
                figure(after, "■ Crash part,", "mapped; grey has no value."),
                figure(apart, "Difference,", "mapped less the stamped element."),
            ],
            scales: [scale, signed],
            sides: [
                format!("▲ {stamped_word}, where it is covered"),
                "■ crash, mapped".to_owned(),
            ],
            difference: "difference, mapped less stamped",
        })
    }

    /// Every quantity that both this mapping and another result have.
    fn compared(
        &self,
        record: &MapRecord,
        other: Option<&OtherResult>,
    ) -> Result<Vec<QuantityReport>, Cancelled> {
        let mut quantities = Vec::new();
        let Some((comparison, other)) = record.comparison.as_ref().zip(other) else {
            return Ok(quantities);
        };
        for row in comparison.rows() {
            let shown = ShownValue::compared(row.value);
            let name = match row.value {
                None => self.lengths.axis(row.name),
                Some(_) => row.name.to_owned(),
            };
            quantities.push(self.beside(&name, row.difference, other, &shown)?);
        }
        Ok(quantities)
    }

    /// This mapping, another result, and their difference.
    fn beside(
        &self,
        name: &str,
        found: &DifferenceRecord,
        other: &OtherResult,
        shown: &ShownValue,
    ) -> Result<QuantityReport, Cancelled> {
        let scale = values_scale(&found.here, &found.other);
        let here = self.draw_target(|element| color(&scale, self.run.shown(element, shown)))?;
        let there = self.draw_target(|element| color(&scale, other.shown(element, shown)))?;
        let (apart, signed) = self.draw_difference(&scale, |element| {
            self.run.difference_to(other, element, shown)
        })?;
        let figure = |png, title, caption| map_figure(png, SIZE, title, caption);
        Ok(QuantityReport {
            name: name.to_owned(),
            rows: vec![
                ("this mapping".to_owned(), number_row(&found.here)),
                ("the other result".to_owned(), number_row(&found.other)),
            ],
            shares: found.histograms.clone(),
            range: range_of(&found.here, &found.other),
            histogram_distance: found.histogram_distance,
            figures: vec![
                figure(here, "■ This mapping,", "grey has no value."),
                figure(there, "■ The other result,", "grey has no value."),
                figure(apart, "Difference,", "this mapping less the other result."),
            ],
            scales: [scale, signed],
            sides: ["this mapping", "the other result"].map(str::to_owned),
            difference: "difference, this mapping less the other result",
        })
    }

    /// The crash part in the colours of a difference, and these colours.
    fn draw_difference(
        &self,
        values: &ColorScale,
        difference: impl Fn(usize) -> f64,
    ) -> Result<(Vec<u8>, ColorScale), Cancelled> {
        let areas = self.run.target.mesh.areas();
        let all = (0..areas.len()).map(|e| (difference(e).abs(), areas[e]));
        let spread = crate::mapping::distribution(all);
        let limit = spread.map_or(0.0, |found| {
            let [.., p99] = found.percentiles;
            p99
        });
        let limit = if limit > 0.0 {
            limit
        } else {
            1e-3 * values.max.abs().max(1e-9)
        };
        let signed = ColorScale::symmetric(limit, 0.0);
        let png = self.draw_target(|element| color(&signed, difference(element)))?;
        Ok((png, signed))
    }

    fn statuses(&self) -> Result<Figure, Cancelled> {
        let elements = &self.run.mapped.elements;
        let scale = ColorScale::statuses();
        let number = |element: usize| f64::from(elements[element].status as u8);
        let png = self.draw_target(|element| scale.color(number(element)))?;
        let caption = "status of the elements.";
        Ok(map_figure(png, SIZE, "■ Crash part,", caption))
    }

    /// Which stamped file gave each element its values; `None` where there is one file alone.
    fn files(&self, record: &MapRecord) -> Result<Option<FilesReport>, Cancelled> {
        if self.run.sources.len() < 2 {
            return Ok(None);
        }
        let of_file = |file: usize| ColorScale::file_look(file).0;
        let is_hatched = |file: usize| ColorScale::file_look(file).1;
        let mut drawn = self.picture_of_target(|element| {
            let file = self.run.values_from(element);
            file.map_or(UNMATCHED, of_file)
        })?;
        if (0..self.run.sources.len()).any(is_hatched) {
            let mask = self.picture_of_target(|element| {
                let file = self.run.values_from(element);
                [if file.is_some_and(is_hatched) { 255 } else { 0 }; 3]
            })?;
            drawn = drawn.hatched(&mask);
        }
        let png = drawn.to_png();
        let shares = givers(self.run, self.monitor)?;
        let row =
            |name: String, n_elements: usize, area: f64| [name, grouped(n_elements), share(area)];
        let named = record.stamped.iter().zip(&shares).enumerate();
        let mut rows: Vec<(String, [String; 3])> = named
            .map(|(file, (stamped, share))| {
                let name = record.stamped_name(stamped);
                let row = row(name, share.n_elements, share.area_share);
                (swatch(file), row)
            })
            .collect();
        let n_given: usize = shares.iter().map(|share| share.n_elements).sum();
        if n_given < record.n_elements {
            let given: f64 = shares.iter().map(|share| share.area_share).sum();
            let n = record.n_elements - n_given;
            let row = row("no values".to_owned(), n, (1.0 - given).max(0.0));
            rows.push((hex(UNMATCHED), row));
        }
        let caption = "in the colour of the file that gave each element its values.";
        Ok(Some(FilesReport {
            figure: map_figure(png, SIZE, "■ Crash part,", caption),
            rows,
        }))
    }

    fn draw_target(&self, color: impl Fn(usize) -> Rgb) -> Result<Vec<u8>, Cancelled> {
        Ok(self.picture_of_target(color)?.to_png())
    }

    fn picture_of_target(&self, color: impl Fn(usize) -> Rgb) -> Result<Picture, Cancelled> {
        let still = Similarity::identity();
        let colors = self.target.colors(color, self.monitor)?;
        let mesh = PictureMesh {
            mesh: &self.target.mesh,
            world_from_mesh: &still,
            paint: Paint::PerVertex(&colors),
        };
        picture(SIZE, &self.camera, None, &[mesh], self.monitor)
    }

    fn draw_sources(&self, color: impl Fn(usize, usize) -> Rgb) -> Result<Vec<u8>, Cancelled> {
        let numbered = self.sources.iter().enumerate();
        let colors = numbered
            .map(|(source, mesh)| mesh.colors(|element| color(source, element), self.monitor))
            .collect::<Result<Vec<_>, Cancelled>>()?;
        let all = self.sources.iter().zip(&self.run.poses).zip(&colors);
        let meshes: Vec<PictureMesh<'_>> = all
            .map(|((source, pose), colors)| PictureMesh {
                mesh: &source.mesh,
                world_from_mesh: pose,
                paint: Paint::PerVertex(colors),
            })
            .collect();
        Ok(picture(SIZE, &self.camera, None, &meshes, self.monitor)?.to_png())
    }
}
