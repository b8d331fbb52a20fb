//! Reading a large block in line-aligned pieces on all cores, in the order of the file.

use std::ops::Range;

use memchr::memchr;
use rayon::prelude::*;

use super::block::Block;
use crate::monitor::{Cancelled, Monitor};

/// Bytes per piece. Fixed, so that results do not depend on the number of threads.
const PIECE: usize = 1 << 19;
/// Pieces that are read before their results are put together; bounds the memory in between.
const PIECES_PER_WAVE: usize = 16;

/// A piece does not have the same number of cards for each entity, so its neighbours may be cut in
/// the middle of one; the block is read on from there in one go.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Irregular;

/// How [`read`] may cut a block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Cut {
    /// After any this many cards.
    Every(usize),
    /// Nowhere: only the cards themselves tell where an entity ends.
    Nowhere,
}

/// Reads the body of `block` by `parse`, which is given a byte range and whether it must refuse
/// ranges that are not regular; `append` gets the results and their ranges in order.
pub(crate) fn read<T: Send>(
    block: &Block<'_>,
    cut: Cut,
    monitor: &Monitor,
    parse: impl Fn(Range<usize>, bool) -> Result<T, Irregular> + Sync,
    mut append: impl FnMut(T, Range<usize>),
) -> Result<(), Cancelled> {
    monitor.check()?;
    let body = block.body.clone();
    let pieces = match cut {
        Cut::Every(n_cards) if body.len() > 2 * PIECE => pieces(block, n_cards),
        _ => Vec::new(),
    };
    for wave in pieces.chunks(PIECES_PER_WAVE) {
        monitor.check()?;
        let results: Vec<_> = wave
            .par_iter()
            .map(|range| parse(range.clone(), true))
            .collect();
        for (result, range) in results.into_iter().zip(wave) {
            match result {
                Ok(result) => append(result, range.clone()),
                Err(Irregular) => {
                    let rest = range.start..body.end;
                    if let Ok(result) = parse(rest.clone(), false) {
                        append(result, rest);
                    }
                    return Ok(());
                }
            }
        }
    }
    if pieces.is_empty()
        && let Ok(result) = parse(body.clone(), false)
    {
        append(result, body);
    }
    Ok(())
}

/// Ranges of about [`PIECE`] bytes that begin at a multiple of `n_cards` cards. Empty if cards
/// cannot be counted without looking at what they mean.
fn pieces(block: &Block<'_>, n_cards: usize) -> Vec<Range<usize>> {
    // Encrypted text could run over a cut.
    if block.has_encrypted {
        return Vec::new();
    }
    let bytes = block.file.bytes();
    let body = block.body.clone();
    let mut starts = vec![body.start];
    while let Some(from) = starts.last().map(|start| start + PIECE) {
        if from >= body.end {
            break;
        }
        match memchr(b'\n', &bytes[from..body.end]) {
            Some(length) if from + length + 1 < body.end => starts.push(from + length + 1),
            _ => break,
        }
    }
    let ends = starts[1..].iter().copied().chain([body.end]);
    let mut pieces: Vec<Range<usize>> = starts.iter().zip(ends).map(|(&a, b)| a..b).collect();
    if n_cards == 1 {
        return pieces;
    }
    let counts: Option<Vec<usize>> = pieces
        .par_iter()
        .map(|range| count_cards(block, range))
        .collect();
    let Some(counts) = counts else {
        return Vec::new();
    };
    let mut n_before = 0usize;
    for (i, count) in counts.into_iter().enumerate() {
        let n_to_skip = n_before.next_multiple_of(n_cards) - n_before;
        if i > 0 && n_to_skip > 0 {
            let mut cards = block.cards_in(pieces[i].clone());
            for _ in 0..n_to_skip {
                cards.next_line();
            }
            let start = cards.offset();
            pieces[i].start = start;
            pieces[i - 1].end = start;
        }
        n_before += count;
    }
    pieces
}

/// Cards in a range; `None` if there is a blank line, which may or may not be one.
fn count_cards(block: &Block<'_>, range: &Range<usize>) -> Option<usize> {
    let mut cards = block.cards_in(range.clone());
    let mut count = 0;
    while let Some((line, offset)) = cards.next_line() {
        if line.trim_ascii().is_empty() {
            let rest = &block.file.bytes()[offset..block.body.end];
            // Blank lines at the end of a block are nobody's card in a list of elements.
            return rest.trim_ascii().is_empty().then_some(count);
        }
        count += 1;
    }
    Some(count)
}
