//! Writes a model as a keyword deck: parts, sections, nodes, elements, sets, forming results.

use super::super::model::{
    Material, Model, Part, Section, Shell, ShellControl, ShellFormulation, SolidKind,
};
use super::card::Layout;
use super::fixed_width::fixed_width;
use super::materials::keyword_of;
use crate::monitor::{Cancelled, Monitor};

/// Rows between two questions whether the writing is still wanted.
const CHUNK: usize = 4096;

/// What goes into the deck.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WriteOptions {
    /// Lines of text for the head of the deck, written as comments.
    pub comments: Vec<String>,
    /// Stresses, strains and history variables too.
    pub with_forming: bool,
}

impl Default for WriteOptions {
    fn default() -> Self {
        Self {
            comments: Vec::new(),
            with_forming: true,
        }
    }
}

/// The deck as bytes. Ids beyond 8 digits make it an I10 deck, beyond 10 digits a long one.
/// Coordinates are written so that they read back bit-equal where 16 columns allow it, else with
/// an error below 1e-9 of their size. O(model).
pub fn write(
    model: &Model,
    options: &WriteOptions,
    monitor: &Monitor,
) -> Result<Vec<u8>, Cancelled> {
    let layout = Layout::holding(largest_id(model));
    let mut deck = Writer {
        text: Vec::new(),
        layout,
        monitor,
    };
    deck.head(model, options);
    deck.shell_control(model.shell_control);
    deck.parts(model);
    deck.materials(model);
    deck.nodes(model, "*NODE")?;
    deck.shells(model)?;
    deck.solids(model)?;
    deck.sets(model)?;
    if options.with_forming {
        deck.stresses(model)?;
        deck.strains(model)?;
    }
    deck.line("*END");
    Ok(deck.text)
}

fn largest_id(model: &Model) -> u64 {
    let sections = model.sections.iter().map(|section| section.id);
    let parts = model.parts.iter().map(|part| part.id.max(part.section_id));
    let materials = model.materials.iter().map(|material| material.id);
    let shells = model.shells.iter().map(|shell| shell.id);
    let solids = model.solids.iter().map(|solid| solid.id);
    let nodes = model.nodes.ids().iter().copied();
    let all_sets = [&model.sets.parts, &model.sets.shells, &model.sets.nodes];
    let sets = all_sets.into_iter().flatten();
    let sets = sets.flat_map(|(&id, set)| set.ids.iter().copied().chain([id]));
    let stresses = model.forming.stresses().map(|state| state.element_id);
    let strains = model.forming.strains().map(|state| state.element_id);
    nodes
        .chain(shells)
        .chain(solids)
        .chain(parts)
        .chain(sections)
        .chain(materials)
        .chain(sets)
        .chain(stresses)
        .chain(strains)
        .max()
        .unwrap_or(0)
}

/// The first line of a deck with fields of a width, with its end.
pub fn keyword_line(layout: Layout) -> &'static str {
    match layout {
        Layout::Standard => "*KEYWORD\n",
        Layout::I10 => "*KEYWORD I10=Y\n",
        Layout::Long => "*KEYWORD LONG=Y\n",
    }
}

/// A deck of a width that has the nodes of a model, in fields as wide as their ids ask for, and goes on without its
/// end.
pub fn write_nodes(model: &Model, layout: Layout, monitor: &Monitor) -> Result<Vec<u8>, Cancelled> {
    let largest = model.nodes.ids().iter().copied().max();
    let mut deck = Writer {
        text: Vec::new(),
        layout: Layout::holding(largest.unwrap_or(0)),
        monitor,
    };
    deck.text.extend_from_slice(keyword_line(layout).as_bytes());
    deck.nodes(model, &format!("*NODE{}", char::from(deck.layout.suffix())))?;
    Ok(deck.text)
}

struct Writer<'a> {
    text: Vec<u8>,
    layout: Layout,
    monitor: &'a Monitor,
}

impl Writer<'_> {
    fn head(&mut self, model: &Model, options: &WriteOptions) {
        self.text
            .extend_from_slice(keyword_line(self.layout).as_bytes());
        for comment in options.comments.iter().flat_map(|text| text.lines()) {
            self.line(&format!("$ {comment}"));
        }
        if !model.title.is_empty() {
            self.line("*TITLE");
            self.title(model, &model.title);
        }
    }

    /// What is known of `*CONTROL_SHELL`, by which sections and stresses are read; the solver's defaults for the rest.
    fn shell_control(&mut self, control: ShellControl) {
        if control == ShellControl::default() {
            return;
        }
        self.line("*CONTROL_SHELL");
        self.ints_at(&[(4, control.elform)]);
        self.ints_at(&[(1, i64::from(control.is_lobatto))]);
        if control.element_axes_set != 0 {
            self.end();
            self.end();
            self.ints_at(&[(1, control.element_axes_set.cast_signed())]);
        }
    }

    /// A card of fields of ten columns, blank but for these.
    fn ints_at(&mut self, fields: &[(usize, i64)]) {
        let width = self.layout.width(10);
        let mut next = 0;
        for &(field, value) in fields {
            self.right("", (field - next) * width);
            self.right(&value.to_string(), width);
            next = field + 1;
        }
        self.end();
    }

    fn parts(&mut self, model: &Model) {
        let sections = model.sections.iter().copied();
        let mut sections: Vec<SectionCards> = sections.map(SectionCards::from).collect();
        for part in model.parts.iter().filter(|part| part.is_defined) {
            let section_id = section_of(part, &mut sections);
            self.line("*PART");
            self.title(model, &part.title);
            self.int(part.id, 10);
            self.int(section_id, 10);
            if part.material_id != 0 {
                self.int(part.material_id, 10);
            }
            self.end();
        }
        for section in sections {
            self.line("*SECTION_SHELL");
            self.int(section.id, 10);
            // Behind the id: ELFORM, NIP and QR/IRID.
            let mut fields = vec![(0, 2)];
            if let Some(formulation) = section.formulation {
                fields = vec![(0, formulation.elform), (2, formulation.n_layers.into())];
                let own_rule = formulation.own_rule.map(|rule| -rule.cast_signed());
                let rule = own_rule.or(formulation.is_trapezoidal.then_some(1));
                fields.extend(rule.map(|rule| (4, rule)));
            }
            self.ints_at(&fields);
            self.reals(&section.thickness, 10);
            if section.nloc != 0.0 {
                self.real(section.nloc, 10);
            }
            self.end();
        }
    }

    /// What is known of the materials: enough to map from the deck, not to calculate with it.
    fn materials(&mut self, model: &Model) {
        let mut written: Vec<u64> = Vec::new();
        for Material {
            id,
            law,
            density,
            modulus,
        } in &model.materials
        {
            if written.contains(id) {
                continue;
            }
            if written.is_empty() {
                let materials = model.materials.iter();
                let known = materials.filter(|known| known.density != 0.0 || known.modulus != 0.0);
                self.line(match known.count() {
                    0 => "$ Of the materials only the law is known:",
                    _ => "$ Of the materials only law, density and modulus are known:",
                });
                self.line("$ put their cards from the original deck here before a calculation.");
            }
            written.push(*id);
            self.line(&format!("*{}", keyword_of(law)));
            self.int(*id, 10);
            if *density != 0.0 || *modulus != 0.0 {
                self.reals(&[*density, *modulus], 10);
            }
            self.end();
        }
    }

    fn nodes(&mut self, model: &Model, keyword: &str) -> Result<(), Cancelled> {
        self.line(keyword);
        let rows = model.nodes.ids().iter().zip(model.nodes.positions());
        for (row, (&id, position)) in rows.enumerate() {
            self.pause(row)?;
            self.int(id, 8);
            self.reals(position.coords.as_slice(), 16);
            self.end();
        }
        Ok(())
    }

    /// Runs of shells with and without their own thickness keep the order of the model.
    fn shells(&mut self, model: &Model) -> Result<(), Cancelled> {
        let mut mid_side = model.mid_side.iter().peekable();
        let mut keyword = "";
        for (row, shell) in model.shells.iter().enumerate() {
            self.pause(row)?;
            let extra = model.shell_extra(row as u32);
            let needed = match extra {
                None => "*ELEMENT_SHELL",
                Some(extra) if extra.beta == 0.0 => "*ELEMENT_SHELL_THICKNESS",
                Some(_) => "*ELEMENT_SHELL_BETA",
            };
            if needed != keyword {
                keyword = needed;
                self.line(keyword);
            }
            let quadratic = mid_side.next_if(|(index, _)| *index as usize == row);
            self.shell(model, shell, quadratic.map(|(_, nodes)| nodes));
            if let Some(extra) = extra {
                self.reals(&extra.thickness, 16);
                if extra.beta != 0.0 {
                    self.real(extra.beta, 16);
                }
                self.end();
                if quadratic.is_some() {
                    self.reals(&[0.0; 4], 16);
                    self.end();
                }
            }
        }
        Ok(())
    }

    fn shell(&mut self, model: &Model, shell: &Shell, mid_side: Option<&[u32; 4]>) {
        self.int(shell.id, 8);
        self.int(model.parts[shell.part as usize].id, 8);
        let ids = model.nodes.ids();
        for node in shell.nodes {
            self.int(ids[node as usize], 8);
        }
        for &node in mid_side.into_iter().flatten() {
            self.int(ids.get(node as usize).copied().unwrap_or(0), 8);
        }
        self.end();
    }

    fn solids(&mut self, model: &Model) -> Result<(), Cancelled> {
        let mut kind = None;
        for (row, solid) in model.solids.iter().enumerate() {
            self.pause(row)?;
            if kind != Some(solid.kind) {
                kind = Some(solid.kind);
                self.line(match solid.kind {
                    SolidKind::Solid => "*ELEMENT_SOLID",
                    SolidKind::ThickShell => "*ELEMENT_TSHELL",
                });
            }
            self.int(solid.id, 8);
            self.int(model.parts[solid.part as usize].id, 8);
            if solid.kind == SolidKind::Solid {
                self.end();
            }
            for node in solid.nodes {
                self.int(model.nodes.ids()[node as usize], 8);
            }
            self.end();
        }
        Ok(())
    }

    fn sets(&mut self, model: &Model) -> Result<(), Cancelled> {
        let sets = &model.sets;
        let kinds = [
            ("*SET_PART_LIST_TITLE", &sets.parts),
            ("*SET_SHELL_LIST_TITLE", &sets.shells),
            ("*SET_NODE_LIST_TITLE", &sets.nodes),
        ];
        for (keyword, sets) in kinds {
            for (&id, set) in sets {
                self.monitor.check()?;
                self.line(keyword);
                self.title(model, &set.title);
                self.int(id, 10);
                self.end();
                for row in set.ids.chunks(8) {
                    for &id in row {
                        self.int(id, 10);
                    }
                    self.end();
                }
            }
        }
        Ok(())
    }

    fn stresses(&mut self, model: &Model) -> Result<(), Cancelled> {
        for (row, shell) in model.forming.stresses().enumerate() {
            self.pause(row)?;
            if row == 0 {
                self.line("*INITIAL_STRESS_SHELL");
            }
            let n_thick = shell.points.len() / shell.n_plane.max(1);
            let n_tensor = 6 * shell.n_tensors;
            let counts = [shell.n_plane, n_thick, shell.n_history, n_tensor, 1];
            self.int(shell.element_id, 10);
            for count in counts {
                self.int(count as u64, 10);
            }
            self.end();
            for (i, point) in shell.points.iter().enumerate() {
                let [xx, yy, zz, xy, yz, zx] = point.stress;
                self.five_a_line(&[point.t, xx, yy, zz, xy, yz, zx, point.plastic_strain]);
                self.five_a_line(shell.history_of(i));
                self.five_a_line(shell.tensors_of(i).as_flattened());
            }
        }
        Ok(())
    }

    fn strains(&mut self, model: &Model) -> Result<(), Cancelled> {
        for (row, shell) in model.forming.strains().enumerate() {
            self.pause(row)?;
            if row == 0 {
                self.line("*INITIAL_STRAIN_SHELL");
            }
            let n_thick = shell.points.len() / shell.n_plane.max(1);
            self.int(shell.element_id, 10);
            for count in [shell.n_plane, n_thick, 1] {
                self.int(count as u64, 10);
            }
            self.end();
            for point in shell.points {
                let [xx, yy, zz, xy, yz, zx] = point.strain;
                self.five_a_line(&[xx, yy, zz, xy, yz, zx, point.t]);
            }
        }
        Ok(())
    }

    fn five_a_line(&mut self, values: &[f64]) {
        for line in values.chunks(5) {
            self.reals(line, 16);
            self.end();
        }
    }

    fn reals(&mut self, values: &[f64], width: u8) {
        for &value in values {
            self.real(value, width);
        }
    }

    fn real(&mut self, value: f64, width: u8) {
        let width = self.layout.width(width);
        let text = fixed_width(value, width).unwrap_or_else(|| "0.".to_owned());
        self.right(&text, width);
    }

    fn int(&mut self, value: u64, width: u8) {
        self.right(&value.to_string(), self.layout.width(width));
    }

    fn right(&mut self, text: &str, width: usize) {
        let padding = width.saturating_sub(text.len());
        self.text.extend(std::iter::repeat_n(b' ', padding));
        self.text.extend_from_slice(text.as_bytes());
    }

    /// A title on its own line, byte by byte as the deck had it; a first character that would begin a keyword or
    /// a comment is moved from the first column.
    fn title(&mut self, model: &Model, title: &str) {
        let bytes = model.raw_titles.bytes(title);
        let end = memchr::memchr2(b'\n', b'\r', bytes).unwrap_or(bytes.len());
        if matches!(bytes.first(), Some(b'*' | b'$')) {
            self.text.push(b' ');
        }
        self.text.extend_from_slice(&bytes[..end]);
        self.end();
    }

    fn line(&mut self, text: &str) {
        self.text.extend_from_slice(text.as_bytes());
        self.end();
    }

    fn end(&mut self) {
        self.text.push(b'\n');
    }

    fn pause(&self, row: usize) -> Result<(), Cancelled> {
        if row.is_multiple_of(CHUNK) {
            self.monitor.check()?;
        }
        Ok(())
    }
}

/// A `*SECTION_SHELL` as it is written.
struct SectionCards {
    id: u64,
    thickness: [f64; 4],
    nloc: f64,
    /// `None` where the deck has no section.
    formulation: Option<ShellFormulation>,
}

impl From<Section> for SectionCards {
    fn from(section: Section) -> Self {
        Self {
            id: section.id,
            thickness: section.thickness,
            nloc: section.nloc,
            formulation: Some(section.formulation),
        }
    }
}

/// The section a part names. A thickness that no section holds, as `*PART_COMPOSITE` gives it,
/// gets a section of its own, with a layer for each ply.
fn section_of(part: &Part, sections: &mut Vec<SectionCards>) -> u64 {
    let named = sections
        .iter()
        .find(|section| section.id == part.section_id);
    match (named, part.thickness) {
        (Some(section), Some(own)) if section.thickness != own => {}
        (None, Some(_)) => {}
        _ => return part.section_id,
    }
    let id = if named.is_none() && part.section_id != 0 {
        part.section_id
    } else {
        sections
            .iter()
            .map(|section| section.id + 1)
            .max()
            .unwrap_or(1)
    };
    let of_named = named.map_or((0.0, None), |section| (section.nloc, section.formulation));
    let (nloc, formulation) = part.plies.as_ref().map_or(of_named, |plies| {
        let n_layers = plies.thickness.len() as f64;
        let formulation = ShellFormulation::new(plies.elform, n_layers, 0.0);
        (plies.nloc, Some(formulation))
    });
    sections.push(SectionCards {
        id,
        thickness: part.thickness.expect("both arms above have a thickness"),
        nloc,
        formulation,
    });
    id
}

#[cfg(test)]
mod tests;
