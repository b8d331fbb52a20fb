//! The cards of one shell as they are copied, exchanged and listed.

use super::super::super::model::IncludedAs;
use super::super::super::moved::reversed_corners;
use super::super::block::Block;
use super::super::card::{Card, FIVE_BY_16, Layout, TEN_BY_8};
use super::super::exponential::{push_exponential, push_int};
use super::super::mesh::{FifthField, ShellCards};
use super::super::nodes::shifted;
use super::super::shells::distinct_corners;
use super::super::state_cards::push_thickness;

/// One shell of the deck.
pub(super) struct Element<'a> {
    /// Its first card and where it stands.
    pub(super) first: (&'a [u8], usize),
    pub(super) thickness: Option<(Card<'a>, &'a [u8], usize)>,
    /// The card with the thickness at mid-side nodes.
    pub(super) second_thickness: Option<(Card<'a>, &'a [u8], usize)>,
    /// Its further cards, with their line ends.
    pub(super) rest: &'a [u8],
    pub(super) is_quadratic: bool,
    /// Its first card, to be read.
    pub(super) card: Card<'a>,
    /// What its cards are.
    pub(super) cards: ShellCards,
}

impl Element<'_> {
    /// The thickness card with these corners, and the second one that mid-side nodes bring, with the means
    /// of the corners beside them.
    pub(super) fn thickness_cards(&self, corners: &[f64; 4], layout: Layout) -> Vec<Vec<u8>> {
        let [a, b, c, d] = *corners;
        // As differences, so that equal thicknesses have themselves as mean.
        let middles = [(a, b), (b, c), (c, d), (d, a)].map(|(a, b)| a + (b - a) / 2.0);
        let both = [
            (corners, &self.thickness),
            (&middles, &self.second_thickness),
        ];
        let n_cards = 1 + usize::from(self.is_quadratic);
        let cards = both[..n_cards].iter().map(|(values, old)| match old {
            Some((card, ..)) => replaced_thickness(card, values, layout),
            None => {
                let mut text = Vec::new();
                push_thickness(&mut text, values, layout);
                text
            }
        });
        cards.collect()
    }

    /// What the corners have in the whole deck, in the order of its card, and the other way round.
    pub(super) fn corners_as_in<T: Copy>(&self, place: &IncludedAs, corners: [T; 4]) -> [T; 4] {
        if place.is_mirrored {
            let [third, fourth] = [4, 5].map(|index| self.card.id(TEN_BY_8, index).unwrap_or(0));
            reversed_corners(corners, fourth == 0 || fourth == third)
        } else {
            corners
        }
    }

    /// What the corners of the shell have in the whole deck, in the order of its card in the file: a node that the
    /// card names twice has its value twice.
    pub(super) fn on_card(&self, place: &IncludedAs, new: [f64; 4]) -> [f64; 4] {
        let ids = [2, 3, 4, 5].map(|index| self.card.id(TEN_BY_8, index).unwrap_or(0));
        let places = distinct_corners(ids).unwrap_or([0, 1, 2, 3]);
        let is_triangle = places[2] == places[3];
        let of_file = if place.is_mirrored {
            reversed_corners(new, is_triangle)
        } else {
            new
        };
        if !is_triangle || ids[3] == 0 || ids[3] == ids[2] {
            return of_file;
        }
        ids.map(|id| {
            let corner = places[..3].iter().position(|&place| ids[place] == id);
            of_file[corner.unwrap_or(0)]
        })
    }

    /// The thickness cards as they stand; `None` if there are none.
    pub(super) fn old_thickness_cards(&self, line_end: &[u8]) -> Option<Vec<u8>> {
        let old = [&self.thickness, &self.second_thickness];
        let lines = old.into_iter().flatten().map(|(_, line, _)| *line);
        let lines: Vec<&[u8]> = lines.collect();
        (!lines.is_empty()).then(|| lines.join(line_end))
    }

    /// Its first card and its thickness cards with the numbers of the whole deck, and the width of their
    /// fields. `None` if one of its further cards would change too in a way that is not known here.
    pub(super) fn in_whole_deck(
        &self,
        place: &IncludedAs,
        keyword: &Keyword,
        new: Option<&[f64; 4]>,
        line_end: &[u8],
    ) -> Option<(Layout, Vec<u8>, Option<Vec<u8>>)> {
        let has_other_length = place.length_factor != 1.0;
        let moves_nodes = place.node_offset != 0 || place.is_mirrored;
        let has_nodes =
            keyword.has_scalar_nodes && moves_nodes || self.is_quadratic && place.is_mirrored;
        let keeps_second = new.is_none() && self.second_thickness.is_some();
        if has_nodes || has_other_length && (self.cards.n_passed_over > 0 || keeps_second) {
            return None;
        }
        let mut ids = [0; 10];
        for (index, id) in ids.iter_mut().enumerate() {
            let offset = match index {
                0 => place.element_offset,
                1 => place.part_offset,
                _ => place.node_offset,
            };
            *id = shifted(self.card.id(TEN_BY_8, index).ok()?, offset);
        }
        let corners = self.corners_as_in(place, [ids[2], ids[3], ids[4], ids[5]]);
        ids[2..6].copy_from_slice(&corners);
        let layout = match (self.card.layout(), *ids.iter().max()?) {
            (Layout::Long, _) => Layout::Long,
            (layout, ..=99_999_999) => layout,
            // Cards of wider fields than eight stay as they are.
            (_, ..=9_999_999_999) => Layout::I10,
            _ => return None,
        };
        let n_ids = if self.is_quadratic { 10 } else { 6 };
        let mut first = Vec::new();
        for &id in &ids[..n_ids] {
            push_int(&mut first, id, layout.width(TEN_BY_8[0]));
        }
        let old = match &self.thickness {
            None => None,
            Some((card, ..)) => {
                let mut old = [0.0; 4];
                for (index, t) in old.iter_mut().enumerate() {
                    *t = card.real_or_zero(FIVE_BY_16, index).ok()? * place.length_factor;
                }
                Some(self.corners_as_in(place, old))
            }
        };
        let Some(corners) = new.copied().or(old) else {
            return Some((layout, first, None));
        };
        let mut cards = self.thickness_cards(&corners, layout);
        if new.is_none()
            && let (Some((_, line, _)), Some(second)) = (&self.second_thickness, cards.get_mut(1))
        {
            *second = line.to_vec();
        }
        if let Some((card, ..)) = &self.thickness
            && self.cards.fifth == FifthField::Angle
            && place.is_mirrored
            && !card.is_empty_field(FIVE_BY_16, 4)
        {
            let angle = 0.0 - card.real_or_zero(FIVE_BY_16, 4).ok()?;
            let text = &mut cards[0];
            text.clear();
            push_thickness(text, &corners, layout);
            push_exponential(text, angle, layout.width(FIVE_BY_16[4]), 8);
        }
        if let Some((card, ..)) = &self.thickness
            && self.cards.fifth == FifthField::CoordinateSystem
            && place.system_offset != 0
            && !card.is_empty_field(FIVE_BY_16, 4)
        {
            let system = shifted(card.id(FIVE_BY_16, 4).ok()?, place.system_offset);
            let text = &mut cards[0];
            text.clear();
            push_thickness(text, &corners, layout);
            push_int(text, system, layout.width(FIVE_BY_16[4]));
        }
        Some((layout, first, Some(cards.join(line_end))))
    }
}

/// The new corner thicknesses with what stands behind them on the card, such as a material angle.
fn replaced_thickness(card: &Card<'_>, new: &[f64; 4], layout: Layout) -> Vec<u8> {
    let mut text = Vec::new();
    push_thickness(&mut text, new, layout);
    let width = layout.width(FIVE_BY_16[0]);
    if card.is_free() {
        let mut fields = card.line().splitn(5, |&byte| byte == b',');
        if let Some(rest) = fields.nth(4) {
            let plain = new.iter().map(|t| format!("{t:.8E}")).collect::<Vec<_>>();
            text = plain.join(",").into_bytes();
            text.push(b',');
            text.extend_from_slice(rest);
        }
    } else if let Some(rest) = card.line().get(4 * width..) {
        text.extend_from_slice(rest);
    }
    text
}

/// The keyword line of a block and the one with the option `THICKNESS`.
pub(super) struct Keyword {
    plain: String,
    thick: String,
    /// True if the line itself says how wide the fields are.
    has_suffix: bool,
    /// A card of each shell names scalar nodes (`DOF`).
    has_scalar_nodes: bool,
}

impl Keyword {
    pub(super) fn of(block: &Block<'_>, cards: ShellCards, bytes: &[u8]) -> Self {
        let rest = &bytes[block.offset..block.body.start];
        let plain = String::from_utf8_lossy(rest).trim_end().to_owned();
        let thick = if cards.thickness {
            plain.clone()
        } else {
            // Behind `*ELEMENT_SHELL`, because the thickness card follows the element's first.
            // Blanks may stand behind the star.
            let blanks = plain.len() - plain[1..].trim_start().len() - 1;
            let stem = ("*ELEMENT_SHELL".len() + blanks).min(plain.len());
            format!("{}_THICKNESS{}", &plain[..stem], &plain[stem..])
        };
        Self {
            plain,
            thick,
            has_suffix: block.suffix.is_some(),
            has_scalar_nodes: block.has_option("DOF"),
        }
    }

    /// The line above cards of a width in a file of a width, from the width of the block it stands for.
    pub(super) fn listed(
        &self,
        is_thick: bool,
        [of_block, of_cards, of_file]: [Layout; 3],
    ) -> Vec<u8> {
        let line = self.line(is_thick);
        let says_width = self.has_suffix || of_block == of_file;
        if of_cards == of_block && says_width {
            return line.to_vec();
        }
        let end = line.iter().position(|byte| b" \t,$".contains(byte));
        let mut listed = line[..end.unwrap_or(line.len())].to_vec();
        if listed
            .last()
            .is_some_and(|&last| Layout::of_suffix(last).is_some())
        {
            listed.pop();
        }
        if of_cards != of_file {
            listed.push(of_cards.suffix());
        }
        listed
    }

    pub(super) fn line(&self, is_thick: bool) -> &[u8] {
        if is_thick {
            self.thick.as_bytes()
        } else {
            self.plain.as_bytes()
        }
    }
}
