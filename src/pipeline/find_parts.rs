//! The parts of a crash model that a stamped part belongs to, found by likeness and by matches.

mod fit;

use std::collections::BTreeMap;
use std::iter;
use std::sync::Arc;
use std::time::Instant;

pub use fit::{Fit, Presence};

use super::error::unless_cancelled;
use super::joined_parts::joined_parts;
use super::likeness::{AS_ALIKE, Moments, Signature, joined_signatures, moments_of_parts};
use super::load::{LoadedPart, prepare};
use super::match_parts::{MatchRecipe, MatchRun, match_parts};
use super::{PipelineError, millis_since};
use crate::assess::{Ambiguity, BorderFit, Verdict};
use crate::formats::Selection;
use crate::geometry::Similarity;
use crate::geometry::chunks::for_chunks;
use crate::monitor::{Cancelled, Monitor};
use crate::registration::{Hand, UnitGuess, guess_unit};
use crate::role::PerRole;
use crate::search::ClosestPoint as _;

/// Choices of crash parts that are matched at most, the most alike first.
const MOST_TRIED: usize = 12;
/// Less alike ones are not tried: their edges and areas are three times as long and large.
const LEAST_LIKENESS: f64 = 0.1;
/// Where a match leaves something to look at, each part must lie on the other with at least this share.
const LEAST_SHARE: f64 = 0.3;
/// A stamped part of which this share lies on no crash part may belong to several.
const UNCOVERED: f64 = 0.15;
/// So much of a further part must lie there.
const LIES_THERE: f64 = 0.5;
/// So alike are a crash part and the stamped one in another unit, and none in its own, for that unit to be named.
const ALIKE_IN_UNIT: f64 = 0.7;
/// Triangles of a part that are asked.
const N_PLACES: usize = 400;

/// A choice of crash parts with its match.
#[derive(Debug, Clone)]
pub struct Found {
    /// The crash model with these parts chosen.
    pub part: LoadedPart,
    /// The match of the stamped part on them.
    pub run: MatchRun,
}

/// What a stamped part belongs to.
#[derive(Debug, Clone)]
pub struct FoundParts {
    /// The crash parts and the match on them.
    pub found: Found,
    /// Ids of other parts that the stamped part fits about as well, or lies closer to: copies, or the other side of
    /// the car.
    pub rivals: Vec<u64>,
    /// Whether the part it belongs to is there.
    pub presence: Presence,
    /// Time of the whole search in milliseconds.
    pub took_ms: f64,
}

impl FoundParts {
    /// The match on them, with the time of the whole search and the ids of the other parts.
    pub fn run(&self) -> MatchRun {
        let mut run = self.found.run.clone().beside_alike_parts(&self.rivals);
        run.times.find_ms = self.took_ms - run.times.total_ms;
        run.times.total_ms = self.took_ms;
        run
    }
}

/// The parts of the crash model that the stamped part belongs to; `None` if no match says so.
///
/// The chosen parts of `parts.crash` are compared by area, spread and thickness, one by one, those that share nodes
/// together, and all together, and the most alike of these choices are matched, each by itself, until one is good.
/// Those that are as alike as that one are matched too. Where much of the stamped part lies on nothing, parts that lie
/// there are taken in and all matched together. `current` is where the stamped part lies, for recipes that start there.
/// A stop request ends it with the best so far. Fails only when cancelled.
pub fn find_parts(
    parts: PerRole<&LoadedPart>,
    recipe: &MatchRecipe,
    current: &Similarity,
    monitor: &Monitor,
) -> Result<Option<FoundParts>, PipelineError> {
    let begin = Instant::now();
    let task = Task {
        parts,
        recipe,
        current,
        monitor,
    };
    let mut search = Search::default();
    let signatures = Signatures::of(parts, monitor)?;
    let candidates = signatures.candidates();
    let n_tried = candidates.len().min(MOST_TRIED) as u64;
    for (n_done, (likeness, ids)) in (0_u64..).zip(candidates).take(MOST_TRIED) {
        if search.is_over(likeness) || monitor.stop_requested() {
            break;
        }
        monitor.progress("parts", n_done, Some(n_tried));
        if let Some(found) = task.alone(ids)? {
            search.take(likeness, found);
        }
    }
    let rivals = search.rivals();
    let Some((_, found)) = search.best else {
        return Ok(None);
    };
    let mut found = task.with_further_parts(found)?;
    let rivals = not_among(&found.part.chosen_part_ids(), rivals);
    let is_rival = |(id, _): &&(u64, Fit)| rivals.contains(id);
    let singles: Vec<(u64, Fit)> = search.singles.iter().filter(is_rival).copied().collect();
    let presence = presence(parts, &found, &singles, &signatures);
    // Matches on them that follow are as ambiguous, until the user chooses.
    found.part.settings.alike_parts.clone_from(&rivals);
    Ok(Some(FoundParts {
        presence,
        found,
        rivals,
        took_ms: millis_since(begin),
    }))
}

/// The units that the files seem to be in, where none of the chosen crash parts has the size of the stamped part
/// but one would have it in another unit.
pub fn guessed_units(
    parts: PerRole<&LoadedPart>,
    monitor: &Monitor,
) -> Result<Option<UnitGuess>, Cancelled> {
    let Signatures { stamped, crash } = Signatures::of(parts, monitor)?;
    let Some(stamped) = stamped else {
        return Ok(None);
    };
    let is_alike = |(_, own): &(_, Signature)| stamped.likeness(own) >= ALIKE_IN_UNIT;
    if crash.iter().any(is_alike) {
        return Ok(None);
    }
    let alike = crash.into_iter().filter_map(|(_, own)| {
        let guess = guess_unit((own.area / stamped.area).sqrt())?;
        let likeness = stamped.scaled(guess.factor()).likeness(&own);
        (likeness >= ALIKE_IN_UNIT).then_some((likeness, guess))
    });
    let best = alike.max_by(|a, b| a.0.total_cmp(&b.0));
    Ok(best.map(|(_, guess)| guess))
}

/// Whether the part that the stamped one belongs to is among those that were tried. `rivals` fit about as well as
/// the one that was `found`; copies of it and the other side of the car are no sign that it is wrong.
fn presence(
    parts: PerRole<&LoadedPart>,
    found: &Found,
    rivals: &[(u64, Fit)],
    signatures: &Signatures,
) -> Presence {
    let ids = found.part.chosen_part_ids();
    let mut shapes: Vec<Signature> = ids.iter().filter_map(|id| signatures.shape(*id)).collect();
    let mut others = Vec::new();
    for (id, of_rival) in rivals {
        let Some(own) = signatures.shape(*id) else {
            continue;
        };
        if shapes.iter().all(|shape| shape.likeness(&own) < AS_ALIKE) {
            shapes.push(own);
            others.push((*id, *of_rival));
        }
    }
    let [stamped, crash] = [parts.stamped, &found.part].map(LoadedPart::mean_thickness);
    let gauge = stamped.zip(crash).map(|(stamped, crash)| stamped / crash);
    let first = ids.first().copied().unwrap_or_default();
    Presence::of((first, &found.fit()), &others, gauge)
}

/// The rivals that were not taken in as further parts of the sheet.
fn not_among(taken: &[u64], mut rivals: Vec<u64>) -> Vec<u64> {
    rivals.retain(|id| !taken.contains(id));
    rivals
}

/// True if one of several chosen crash parts, or some of them, should be found first: alone they are more like the
/// stamped part than all together are, or the others have no shells.
pub fn is_part_open(parts: PerRole<&LoadedPart>) -> bool {
    let n_chosen = parts.crash.chosen_part_ids().len();
    if n_chosen < 2 {
        return false;
    }
    let signatures = Signatures::of(parts, &Monitor::silent());
    let signatures = signatures.expect("nobody cancels a silent monitor");
    let candidates = signatures.candidates();
    let most_alike = candidates.first();
    most_alike.is_some_and(|(_, ids)| ids.len() < n_chosen)
}

/// What every match of the search needs.
struct Task<'a> {
    parts: PerRole<&'a LoadedPart>,
    recipe: &'a MatchRecipe,
    current: &'a Similarity,
    monitor: &'a Monitor,
}

/// The convincing matches so far.
#[derive(Default)]
struct Search {
    /// The best with its likeness.
    best: Option<(f64, Found)>,
    /// Every part that was tried alone, with how well it fits.
    singles: Vec<(u64, Fit)>,
}

impl Search {
    /// True if parts no more alike than this need not be tried.
    fn is_over(&self, likeness: f64) -> bool {
        self.best.as_ref().is_some_and(|(of_best, found)| {
            let least = found.fit().least_alike();
            least.is_some_and(|least| likeness < least * of_best)
        })
    }

    fn take(&mut self, likeness: f64, found: Found) {
        if !found.is_convincing() {
            return;
        }
        let fit = found.fit();
        if let [id] = found.part.chosen_part_ids()[..] {
            self.singles.push((id, fit));
        }
        let is_better = |(_, best): &(f64, Found)| fit.is_better_than(&best.fit());
        if self.best.as_ref().is_none_or(is_better) {
            self.best = Some((likeness, found));
        }
    }

    /// Parts that fit about as well as the best.
    fn rivals(&self) -> Vec<u64> {
        let Some((_, best)) = &self.best else {
            return Vec::new();
        };
        let own = best.part.chosen_part_ids();
        let of_best = best.fit();
        let is_rival = |(id, fit): &(u64, Fit)| {
            (fit.is_as_good_as(&of_best) && !own.contains(id)).then_some(*id)
        };
        self.singles.iter().filter_map(is_rival).collect()
    }
}

impl Found {
    /// How well the part fits.
    pub(super) fn fit(&self) -> Fit {
        let assessment = &self.run.assessment;
        let shape = assessment.shape.as_ref();
        let borders = shape.map(|shape| &shape.borders);
        let [stamped, crash] = self.shares();
        let verdict = assessment.verdict_as_read();
        Fit {
            verdict,
            is_one_shape: verdict != Verdict::Poor
                && shape.is_some_and(|shape| shape.reasons.is_empty()),
            covered: stamped * crash,
            n_holes_apart: borders.map_or(0, BorderFit::n_alone),
            rmse: assessment.coverage.rmse(),
            unremarkable: shape.map_or(0.0, |shape| shape.tolerance.unremarkable()),
            apart: shape.map_or(f64::INFINITY, |shape| {
                shape.springback.hypot(shape.remainder)
            }),
            remainder: shape.map_or(0.0, |shape| shape.remainder / shape.tolerance.remainder),
            is_mirrored: self.run.crash_from_stamped.is_mirrored(),
        }
    }

    /// Shares of the stamped and of the crash part that lie on the other.
    fn shares(&self) -> [f64; 2] {
        let coverage = &self.run.assessment.coverage;
        [coverage.source_on_target, coverage.target_on_source].map(|side| side.overlap)
    }

    /// Whether a match that nobody looked at says that the parts belong together: a small flat piece lies
    /// somewhere on many parts.
    fn is_convincing(&self) -> bool {
        match self.run.assessment.verdict_as_read() {
            Verdict::Good => true,
            Verdict::Check => self.shares().iter().all(|share| *share >= LEAST_SHARE),
            Verdict::Poor => false,
        }
    }
}

impl Task<'_> {
    /// The match of the stamped part on these parts of the crash model and no others. Parts that cannot be
    /// matched are none to choose. Fails only when cancelled.
    fn alone(&self, ids: Vec<u64>) -> Result<Option<Found>, PipelineError> {
        let PerRole { crash, stamped } = self.parts;
        let mut settings = crash.settings.clone();
        settings.choose(Selection::Parts(ids));
        let model = Arc::clone(&crash.model);
        let part = prepare(&crash.path, model, &settings, self.monitor);
        let Ok(part) = unless_cancelled(part)? else {
            return Ok(None);
        };
        let pair = PerRole::new(&part, stamped);
        let run = match_parts(pair, None, self.recipe, self.current, self.monitor);
        let run = unless_cancelled(run)?.ok();
        Ok(run.map(|run| Found { part, run }))
    }

    /// The match on more parts, where these lie on what the found ones leave of the stamped part.
    fn with_further_parts(&self, found: Found) -> Result<Found, PipelineError> {
        let further = further_parts(self.parts, &found, self.monitor)?;
        if further.is_empty() || self.monitor.stop_requested() {
            return Ok(found);
        }
        let mut ids = found.part.chosen_part_ids();
        ids.extend(further);
        let together = self.alone(ids)?;
        Ok(together.filter(Found::is_convincing).unwrap_or(found))
    }
}

/// The pose in which the mirror image of the stamped part lies on most of what the stamped part itself, in its
/// `own` pose, leaves of the crash parts, as where one half of a symmetric sheet was formed; of several in which it
/// fits about as well the first. `None` where it lies there in none.
pub fn mirrored_twin(
    parts: PerRole<&LoadedPart>,
    own: &Similarity,
    recipe: &MatchRecipe,
    monitor: &Monitor,
) -> Result<Option<Similarity>, PipelineError> {
    let mut recipe = recipe.clone();
    recipe.settings.hand = if own.is_mirrored() {
        Hand::Same
    } else {
        Hand::Mirrored
    };
    let run = match_parts(parts, None, &recipe, &Similarity::identity(), monitor);
    let Ok(run) = unless_cancelled(run)? else {
        return Ok(None);
    };
    if run.assessment.verdict == Verdict::Poor {
        return Ok(None);
    }
    let alternatives = Ambiguity::near(&run.outcome.alternatives).iter();
    let alternatives = alternatives.map(|other| other.target_from_source);
    for pose in iter::once(run.crash_from_stamped).chain(alternatives) {
        if lies_on_the_rest(parts, [own, &pose], monitor)? {
            return Ok(Some(pose));
        }
    }
    Ok(None)
}

/// Whether the stamped part under its other pose lies on most of what it leaves of the crash parts under its own.
fn lies_on_the_rest(
    parts: PerRole<&LoadedPart>,
    poses: [&Similarity; 2],
    monitor: &Monitor,
) -> Result<bool, Cancelled> {
    let (stamped, crash) = (&parts.stamped.surface, &parts.crash.surface);
    let mesh = crash.mesh();
    let edges = [stamped, crash].map(|surface| surface.measures().mean_edge_length);
    let near = edges[0].max(edges[1]);
    let poses = poses.map(|pose| (pose.inverse(), pose.scale));
    let (mut left, mut there) = (0.0, 0.0);
    for_chunks(mesh.n_triangles(), monitor, |range| {
        for triangle in range {
            let centre = mesh.triangle_centroid(triangle);
            let [own, other] = poses.each_ref().map(|(inverse, scale)| {
                let hit = stamped
                    .bvh()
                    .closest(&inverse.apply(&centre), near / scale, None, None);
                hit.is_some()
            });
            let area = mesh.triangle_area(triangle);
            left += if own { 0.0 } else { area };
            there += if other && !own { area } else { 0.0 };
        }
    })?;
    Ok(there > LIES_THERE * left)
}

/// What parts are compared by.
struct Signatures {
    /// Of the stamped part; `None` without area.
    stamped: Option<Signature>,
    /// Of every chosen crash part with shells alone, of those that share nodes together, and of all together where
    /// they are several.
    crash: Vec<(Vec<u64>, Signature)>,
}

impl Signatures {
    fn of(parts: PerRole<&LoadedPart>, monitor: &Monitor) -> Result<Self, Cancelled> {
        let moments =
            |part: &LoadedPart| moments_of_parts(&part.model, part.settings.length_factor, monitor);
        let moments = parts.map(moments).transpose()?;
        let used = parts.map(|part| part.chosen_part_ids());
        let all_of = |ids: &[u64], role: &BTreeMap<u64, Moments>| {
            let of_parts = ids.iter().filter_map(|id| role.get(id));
            of_parts.fold(Moments::default(), |sum, moments| sum.and(moments))
        };
        let stamped = all_of(&used.stamped, &moments.stamped);
        let stamped = stamped.signature(parts.stamped.mean_thickness());
        let summaries = parts.crash.model.part_summaries();
        let mut crash: Vec<(Vec<u64>, Signature)> = Vec::new();
        for row in summaries.iter().filter(|row| used.crash.contains(&row.id)) {
            let thickness = parts.crash.lengthened(row.thickness);
            let own = moments.crash.get(&row.id);
            if let Some(own) = own.and_then(|own| own.signature(thickness)) {
                crash.push((vec![row.id], own));
            }
        }
        monitor.check()?;
        let chosen = used.crash.iter().copied().collect();
        let joined = joined_parts(&parts.crash.model, &chosen);
        let rows: BTreeMap<u64, Option<f64>> = summaries
            .iter()
            .map(|row| (row.id, row.thickness))
            .collect();
        let thickness = |id| parts.crash.lengthened(*rows.get(&id)?);
        crash.extend(joined_signatures(&joined, &moments.crash, thickness));
        // Solids beside shells, such as adhesive, are no part of the sheet.
        let mut with_shells = used.crash;
        with_shells.retain(|id| moments.crash.contains_key(id));
        if with_shells.len() > 1 {
            let together = all_of(&with_shells, &moments.crash);
            if let Some(together) = together.signature(parts.crash.mean_thickness()) {
                crash.push((with_shells, together));
            }
        }
        Ok(Self { stamped, crash })
    }

    /// That of a crash part, whatever its thickness.
    fn shape(&self, id: u64) -> Option<Signature> {
        let mut alone = self.crash.iter().filter(|(ids, _)| *ids == [id]);
        alone.next().map(|(_, own)| Signature {
            thickness: None,
            ..*own
        })
    }

    /// The choices of parts with their likeness to the stamped part, the most alike first.
    fn candidates(&self) -> Vec<(f64, Vec<u64>)> {
        let Some(stamped) = &self.stamped else {
            return Vec::new();
        };
        let all = self.crash.iter();
        let mut found: Vec<(f64, Vec<u64>)> = all
            .map(|(ids, own)| (stamped.likeness(own), ids.clone()))
            .collect();
        found.retain(|(likeness, _)| *likeness >= LEAST_LIKENESS);
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        found
    }
}

/// Parts of which more than half lies on what the found ones leave of the stamped part.
fn further_parts(
    parts: PerRole<&LoadedPart>,
    found: &Found,
    monitor: &Monitor,
) -> Result<Vec<u64>, Cancelled> {
    let pose = found.run.crash_from_stamped;
    let (stamped, crash) = (&parts.stamped.surface, &found.part.surface);
    let near =
        (stamped.measures().mean_edge_length * pose.scale).max(crash.measures().mean_edge_length);
    let mesh = stamped.mesh();
    let (mut area, mut left) = (0.0, 0.0);
    let mut is_left = vec![false; mesh.n_triangles()];
    for_chunks(mesh.n_triangles(), monitor, |range| {
        for triangle in range {
            let centre = pose.apply(&mesh.triangle_centroid(triangle));
            let own = mesh.triangle_area(triangle);
            is_left[triangle] = crash.bvh().closest(&centre, near, None, None).is_none();
            area += own;
            left += if is_left[triangle] { own } else { 0.0 };
        }
    })?;
    if left <= UNCOVERED * area {
        return Ok(Vec::new());
    }
    let all = parts.crash;
    let stamped_from_crash = pose.inverse();
    let own = found.part.chosen_part_ids();
    let mut triangles_of = vec![Vec::new(); all.model.parts.len()];
    for (triangle, &part) in all.ids.parts().iter().enumerate() {
        triangles_of[part as usize].push(triangle);
    }
    let lies_there = |triangles: &[usize]| {
        let step = triangles.len().div_ceil(N_PLACES).max(1);
        let (mut area, mut there) = (0.0, 0.0);
        for &triangle in triangles.iter().step_by(step) {
            let own = all.mesh.triangle_area(triangle);
            area += own;
            let centre = stamped_from_crash.apply(&all.mesh.triangle_centroid(triangle));
            let hit = stamped
                .bvh()
                .closest(&centre, near / pose.scale, None, None);
            if hit.is_some_and(|hit| is_left[hit.triangle as usize]) {
                there += own;
            }
        }
        there > LIES_THERE * area
    };
    let mut further = Vec::new();
    for (part, triangles) in all.model.parts.iter().zip(&triangles_of) {
        monitor.check()?;
        if !triangles.is_empty() && !own.contains(&part.id) && lies_there(triangles) {
            further.push(part.id);
        }
    }
    Ok(further)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_the_sheet_is_no_rival_of_it() {
        assert_eq!(not_among(&[1, 2, 3], vec![2, 7]), [7]);
    }
}
