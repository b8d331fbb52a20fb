//! `shapematch info`: what a file holds.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

use super::args::InfoArgs;
use super::{check_outputs, json_target, print, progress, project, takes_stdout, write_json};
use crate::formats::{self, Diagnostics};
use crate::pipeline::project::is_project;
use crate::report::{FormingInfo, ModelInfo};
use crate::text::{counted, length};

/// Reads the file and shows its contents.
pub fn run(args: &InfoArgs, quiet: bool) -> anyhow::Result<ExitCode> {
    if is_project(&args.input) {
        args.read.refuse_beside_project("decks and meshes")?;
        return project::info(&args.input, args.json.as_deref());
    }
    check_outputs(
        json_target(args.json.as_deref()),
        std::slice::from_ref(&args.input),
    )?;
    let model = formats::read(&args.input, &args.read.options(), &progress::monitor(quiet))?;
    let files: Vec<PathBuf> = model.files.iter().map(|file| file.path.clone()).collect();
    check_outputs(json_target(args.json.as_deref()), &files)?;
    let info = ModelInfo::of(&model);
    if !takes_stdout(args.json.as_deref()) {
        print(&describe(&info, &model.diagnostics))?;
    }
    if let Some(path) = &args.json {
        write_json(path, &info)?;
    }
    Ok(ExitCode::SUCCESS)
}

fn describe(info: &ModelInfo, diagnostics: &Diagnostics) -> String {
    let mut text = String::new();
    let mut line = |line: String| {
        text.push_str(line.trim_end());
        text.push('\n');
    };
    if !info.title.is_empty() {
        line(format!("Title    {}", info.title));
    }
    if let Some(units) = &info.units {
        line(format!("Units    {units}"));
    }
    for (i, file) in info.files.iter().enumerate() {
        let label = if i == 0 { "File" } else { "Include" };
        line(format!(
            "{label:<8} {} ({})",
            file.path,
            counted(file.bytes as usize, "byte")
        ));
    }
    line(format!(
        "Mesh     {}, {}, {}, {}",
        counted(info.nodes, "node"),
        counted(info.shells, "shell"),
        counted(info.solids, "solid"),
        counted(info.parts.len(), "part"),
    ));
    if let Some(bounds) = &info.bounds {
        let axis = |i: usize| format!("{} … {}", length(bounds.min[i]), length(bounds.max[i]));
        line(format!(
            "Bounds   x {}   y {}   z {}",
            axis(0),
            axis(1),
            axis(2)
        ));
    }
    line(format!("Forming  {}", describe_forming(&info.forming)));
    if !info.parts.is_empty() {
        line(String::new());
        line(parts_table(info).trim_end().to_owned());
    }
    if info.n_diagnostics > 0 {
        line(String::new());
        line(format!(
            "{}:",
            counted(info.n_diagnostics as usize, "diagnostic")
        ));
        for diagnostic in diagnostics.iter() {
            line(format!("  {diagnostic}"));
        }
        let more = info.n_diagnostics as usize - info.diagnostics.len();
        if more > 0 {
            line(format!("  … and {more} more of these kinds"));
        }
    }
    text
}

fn describe_forming(forming: &FormingInfo) -> String {
    if forming.is_empty() {
        return "none".into();
    }
    let mut pieces = Vec::new();
    let range = |range: Option<[f64; 2]>| {
        range.map_or_else(String::new, |[a, b]| {
            format!(" ({} … {})", length(a), length(b))
        })
    };
    if forming.thickness > 0 {
        let shells = counted(forming.thickness, "shell");
        pieces.push(format!(
            "thickness on {shells}{}",
            range(forming.thickness_range)
        ));
    }
    if forming.stress > 0 {
        let shells = counted(forming.stress, "shell");
        let strains = range(forming.plastic_strain_range);
        pieces.push(format!("stress and plastic strain{strains} on {shells}"));
    }
    if forming.strain > 0 {
        pieces.push(format!("strain on {}", counted(forming.strain, "shell")));
    }
    if forming.others > 0 {
        pieces.push(format!(
            "results of {} that are not kept",
            counted(forming.others, "other element")
        ));
    }
    if forming.history_variables > 0 {
        pieces.push(counted(forming.history_variables, "history variable"));
    }
    pieces.join(", ")
}

fn parts_table(info: &ModelInfo) -> String {
    let width = info
        .parts
        .iter()
        .map(|p| p.title.chars().count())
        .max()
        .unwrap_or(0)
        .clamp(5, 40);
    let has_solids = info.solids > 0;
    let solids = |text: &dyn std::fmt::Display| match has_solids {
        true => format!("  {text:>9}"),
        false => String::new(),
    };
    let mut table = format!(
        "{:>12}  {:<width$}  {:>9}{}  {:>9}  {:>9}\n",
        "id",
        "title",
        "shells",
        solids(&"solids"),
        "triangles",
        "thickness"
    );
    for part in &info.parts {
        let thickness = part.thickness.map_or_else(|| "-".into(), length);
        let title: String = part.title.chars().take(width).collect();
        // Writing to a string cannot fail.
        let _ = writeln!(
            table,
            "{:>12}  {title:<width$}  {:>9}{}  {:>9}  {thickness:>9}",
            part.id,
            part.shells,
            solids(&part.solids),
            part.triangles
        );
    }
    table
}
