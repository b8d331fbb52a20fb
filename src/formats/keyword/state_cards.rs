//! Writes the initial state of shells: thickness, stresses, strains, history variables.
//!
//! The cards are `*ELEMENT_SHELL_THICKNESS`, `*INITIAL_STRESS_SHELL` and `*INITIAL_STRAIN_SHELL` of
//! the LS-DYNA keyword manual, volume I. Numbers have nine digits in 16 columns, or four in 10.

use rayon::prelude::*;

use super::card::Layout;
use super::exponential::{push_exponential, push_int};
use crate::geometry::tensor::Tensor;
use crate::monitor::{Cancelled, Monitor};

/// Elements that are formatted as one piece.
const CHUNK: usize = 512;
/// The largest id in ten columns.
const MOST_IN_TEN: u64 = 9_999_999_999;

/// The state of one shell as it is written. Points stand layer by layer in rising T and inside a layer
/// around the element.
#[derive(Debug, Clone, Copy)]
pub struct ShellState<'a> {
    /// The deck's element id.
    pub id: u64,
    /// Places T of the layers, −1 to 1.
    pub places: &'a [f64],
    /// Stress xx, yy, zz, xy, yz, zx and effective plastic strain at each point: the number of
    /// layers times 1 or 4. Empty for no stress card.
    pub states: &'a [[f64; 7]],
    /// History variables of each layer, all with the same number; empty for none. Points of one layer
    /// share them.
    pub history: &'a [f64],
    /// Tensors among the history of each layer (`NTENSR`), likewise.
    pub tensors: &'a [Tensor],
    /// Places T of the strains.
    pub strain_places: &'a [f64],
    /// Strain xx, yy, zz, xy, yz, zx at each of them; empty for no strain card.
    pub strains: &'a [[f64; 6]],
}

/// How the cards are spelled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StateFormat {
    /// Width of the fields of the deck.
    pub layout: Layout,
    /// 16 columns a number (`LARGE` 1) instead of 10.
    pub is_large: bool,
}

/// Lines of a deck, in the order of these pieces. Together they may be too long to copy without a look for a cancel.
pub type Pieces = Vec<Vec<u8>>;

/// The cards of shells 0 to `n_shells`, stresses first, as lines that can stand in any deck of the same
/// layout: where ids have more digits than its fields, the keywords ask for the long one (`+`). `state_of` gives
/// the state of a shell; shells without states or strains get no card.
/// Bytes do not depend on the number of threads. O(values), about 60 ns each.
pub fn write_states<'a>(
    n_shells: usize,
    state_of: impl Fn(usize) -> ShellState<'a> + Sync,
    format: StateFormat,
    monitor: &Monitor,
) -> Result<Pieces, Cancelled> {
    let largest = (0..n_shells).map(|shell| state_of(shell).id).max();
    let is_wider = format.layout != Layout::Long && largest > Some(MOST_IN_TEN);
    let (format, suffix) = if is_wider {
        let layout = Layout::Long;
        (StateFormat { layout, ..format }, "+")
    } else {
        (format, "")
    };
    let mut pieces = Vec::new();
    let stresses = chunks(n_shells, monitor, |text, shell| {
        stress_card(text, &state_of(shell), format);
    })?;
    append(
        &mut pieces,
        &format!("*INITIAL_STRESS_SHELL{suffix}\n"),
        stresses,
    );
    let strains = chunks(n_shells, monitor, |text, shell| {
        strain_card(text, &state_of(shell), format);
    })?;
    append(
        &mut pieces,
        &format!("*INITIAL_STRAIN_SHELL{suffix}\n"),
        strains,
    );
    Ok(pieces)
}

/// Formats the shells in pieces, in parallel, in order.
fn chunks(
    n_shells: usize,
    monitor: &Monitor,
    write: impl Fn(&mut Vec<u8>, usize) + Sync,
) -> Result<Pieces, Cancelled> {
    (0..n_shells.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            monitor.check()?;
            let mut text = Vec::new();
            for shell in chunk * CHUNK..((chunk + 1) * CHUNK).min(n_shells) {
                write(&mut text, shell);
            }
            Ok(text)
        })
        .collect()
}

fn append(pieces: &mut Pieces, keyword: &str, cards: Pieces) {
    if cards.iter().any(|piece| !piece.is_empty()) {
        pieces.push(keyword.as_bytes().to_vec());
        pieces.extend(cards);
    }
}

fn stress_card(text: &mut Vec<u8>, state: &ShellState<'_>, format: StateFormat) {
    let n_layers = state.places.len();
    if state.states.is_empty() || n_layers == 0 {
        return;
    }
    let n_plane = state.states.len() / n_layers;
    let n_history = state.history.len() / n_layers;
    let n_tensors = state.tensors.len() / n_layers;
    let counts = [
        n_plane,
        n_layers,
        n_history,
        6 * n_tensors,
        usize::from(format.is_large),
        0,
        0,
    ];
    push_header(text, state.id, &counts, format.layout);
    for (i, point) in state.states.iter().enumerate() {
        let layer = i / n_plane;
        let t = state.places[layer];
        let [xx, yy, zz, xy, yz, zx, plastic] = *point;
        push_values(text, &[t, xx, yy, zz, xy, yz, zx, plastic], 8, format);
        push_values(
            text,
            &state.history[layer * n_history..][..n_history],
            8,
            format,
        );
        let tensors = &state.tensors[layer * n_tensors..][..n_tensors];
        push_values(text, tensors.as_flattened(), 6, format);
    }
}

/// Two surface points are written without counts, which is how decks mark them.
fn strain_card(text: &mut Vec<u8>, state: &ShellState<'_>, format: StateFormat) {
    let n_layers = state.strain_places.len();
    if state.strains.is_empty() || n_layers == 0 {
        return;
    }
    let are_surfaces = state.strain_places == [-1.0, 1.0];
    let n_plane = if are_surfaces {
        0
    } else {
        state.strains.len() / n_layers
    };
    let n_thick = if are_surfaces { 0 } else { n_layers };
    let counts = [n_plane, n_thick, usize::from(format.is_large), 0, 0, 0, 0];
    push_header(text, state.id, &counts, format.layout);
    for (i, strain) in state.strains.iter().enumerate() {
        let t = state.strain_places[i * n_layers / state.strains.len()];
        let [xx, yy, zz, xy, yz, zx] = *strain;
        push_values(text, &[xx, yy, zz, xy, yz, zx, t], 7, format);
    }
}

fn push_header(text: &mut Vec<u8>, id: u64, counts: &[usize], layout: Layout) {
    let width = layout.width(10);
    push_int(text, id, width);
    for &count in counts {
        push_int(text, count as u64, width);
    }
    text.push(b'\n');
}

/// Values in lines of five (large) or `per_line` (small) fields.
fn push_values(text: &mut Vec<u8>, values: &[f64], per_line: usize, format: StateFormat) {
    let (per_line, standard, digits) = if format.is_large {
        (5, 16, 8)
    } else {
        (per_line, 10, 3)
    };
    let width = format.layout.width(standard);
    for line in values.chunks(per_line) {
        for &value in line {
            // An exponent of three digits has no room in a narrow field.
            let is_nothing = width < 16 && value.abs() < 1e-99;
            let value = if is_nothing { 0.0 } else { value };
            push_exponential(text, value, width, digits);
        }
        text.push(b'\n');
    }
}

/// The four corner thicknesses of a shell as the second card of `*ELEMENT_SHELL_THICKNESS`, without
/// line end.
pub(super) fn push_thickness(text: &mut Vec<u8>, corners: &[f64; 4], layout: Layout) {
    for &corner in corners {
        push_exponential(text, corner, layout.width(16), 8);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text_of(state: ShellState<'_>, is_large: bool) -> String {
        let format = StateFormat {
            layout: Layout::Standard,
            is_large,
        };
        let text = write_states(1, |_| state, format, &Monitor::silent());
        let text = text.unwrap().concat();
        String::from_utf8(text).unwrap()
    }

    #[test]
    fn cards_look_as_the_manual_has_them() {
        let states = [
            [112.5, -40.25, 0.0, 8.5, -0.0, 0.0, 0.04125],
            [-80.0, 31.0, 0.0, -6.0, 0.0, 0.0, 0.0391],
        ];
        let strains = [
            [0.0312, 0.0105, -0.0417, 0.002, 0.0, 0.0],
            [0.03, 0.0098, -0.0398, 0.0018, 0.0, 0.0],
        ];
        let state = ShellState {
            id: 100_001,
            places: &[-0.577_350_269_2, 0.577_350_269_2],
            states: &states,
            history: &[],
            tensors: &[],
            strain_places: &[-1.0, 1.0],
            strains: &strains,
        };
        let expected = "\
*INITIAL_STRESS_SHELL
    100001         1         2         0         0         1         0         0
 -5.77350269E-01  1.12500000E+02 -4.02500000E+01  0.00000000E+00  8.50000000E+00
  0.00000000E+00  0.00000000E+00  4.12500000E-02
  5.77350269E-01 -8.00000000E+01  3.10000000E+01  0.00000000E+00 -6.00000000E+00
  0.00000000E+00  0.00000000E+00  3.91000000E-02
*INITIAL_STRAIN_SHELL
    100001         0         0         1         0         0         0         0
  3.12000000E-02  1.05000000E-02 -4.17000000E-02  2.00000000E-03  0.00000000E+00
  0.00000000E+00 -1.00000000E+00
  3.00000000E-02  9.80000000E-03 -3.98000000E-02  1.80000000E-03  0.00000000E+00
  0.00000000E+00  1.00000000E+00
";
        assert_eq!(text_of(state, true), expected);
    }

    #[test]
    fn small_cards_and_history() {
        let state = ShellState {
            id: 7,
            places: &[0.0],
            states: &[[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 0.5]],
            history: &[9.0, -8.0],
            tensors: &[[1.0, 2.0, 3.0, 4.0, 5.0, 6.0], [7.0; 6]],
            strain_places: &[],
            strains: &[],
        };
        let expected = "\
*INITIAL_STRESS_SHELL
         7         1         1         2        12         0         0         0
 0.000E+00 1.000E+00 2.000E+00 3.000E+00 4.000E+00 5.000E+00 6.000E+00 5.000E-01
 9.000E+00-8.000E+00
 1.000E+00 2.000E+00 3.000E+00 4.000E+00 5.000E+00 6.000E+00
 7.000E+00 7.000E+00 7.000E+00 7.000E+00 7.000E+00 7.000E+00
";
        assert_eq!(text_of(state, false), expected);
        // Large tensors run on over lines of five.
        let large = text_of(state, true);
        assert_eq!(large.lines().count(), 2 + 2 + 1 + 3);
        assert!(large.ends_with("  7.00000000E+00  7.00000000E+00\n"));
    }
}
