//! The search along the motions that surfaces leave free: a plate, a rail or a cup lies on its counterpart
//! at many places, and only borders and holes distinguish these.

use glam::Vec4;
use nalgebra::SVector;
use rayon::prelude::*;

use super::context::PairContext;
use crate::assess::border_curve::{Place, places};
use crate::assess::free_motion::{FreeMotion, FreeMotionKind};
use crate::assess::least_squares::NormalEquations;
use crate::assess::tolerance::is_source_smaller;
use crate::geometry::{Aabb, Point3, Rotation, Similarity, Vector3};
use crate::monitor::Cancelled;
use crate::registration::Surface;
use crate::search::lanes::{FourVectors, by_coordinate, difference, dot, rotated};
use crate::search::{FeatureGrid, GridSettings};

/// Places along the borders of the smaller part, of which half lie on holes where there are any.
const N_PLACES: usize = 128;
/// Of these so many, spread over all borders, sort the poses of the lattice,
const N_FIRST: usize = 16;
/// and so many the best of them.
const N_SECOND: usize = 48;
/// Places along the borders of the larger part.
const N_MODEL_PLACES: usize = 12_000;
/// Distance beyond which borders have nothing to do with each other, as a share of the larger part's
/// diagonal; the lattice is as fine.
const CUT: f64 = 0.02;
/// Shares of [`CUT`] in the rounds in which poses of the lattice are refined.
const CUTS: [f64; 4] = [1.0, 0.7, 0.4, 0.2];
/// The lattice of a motion in one direction is so many times finer: one that steps over a hole finds its other side.
const FINER_ALONG_ONE: f64 = 8.0;
/// Shifts of a lattice in a plane run at this angle to the axes (34°), as few edges of parts do: along an edge they
/// would lay whole rows of poses on it alike, which leave no room for the right one.
const OBLIQUE: f64 = 0.6;
/// Turns of the lattice lie so many of its steps apart where the part is widest, …
const STEPS_OF_TURN: f64 = 2.0;
/// … and there are no fewer and no more of them than these.
const N_TURNS: [f64; 2] = [24.0, 720.0];
/// A lattice of too many poses is made coarser by this factor, again and again, …
const COARSER: f64 = 1.2;
/// … until its steps are so many times the distance beyond which borders have nothing to do with each other.
const COARSEST: f64 = 8.0;
/// Steps of each round.
const N_STEPS: usize = 3;
/// Share of the smaller part that may lie beside the other one.
const BESIDE: f64 = 0.3;
/// Poses of the lattice that are compared at more places,
const MOST_SORTED: usize = 6000;
/// of these the ones that are refined,
const MOST_REFINED: usize = 600;
/// and of those the ones that are refined to the end.
const MOST_FINISHED: usize = 120;
/// Largest number of poses of the lattice; it is made coarser where it would have more.
const MOST_POSES: f64 = 400_000.0;
/// Borders that run in directions farther apart than this are not the same border: cosine of 37°.
const PARALLEL: f32 = 0.8;
/// In a step a border counts for a place up to so many times the distance across it beyond which it does not.
const ALONG: f64 = 2.0;
/// Largest turn of one step, in radians.
const MOST_TURN: f64 = 0.1;
/// Poses are near each other that lie apart by less than this share of [`CUT`], …
const NEAR: f64 = 0.5;
/// … or of this share of the smaller part's diagonal where that is more, …
const NEAR_EXTENT: f64 = 0.01;
/// … at one place of so many.
const NEAR_PLACES: usize = 8;
/// The grid that finds the nearest border.
const GRID: GridSettings = GridSettings {
    n_cells: 112,
    margin: 0.1,
};

/// One direction of the family of poses.
#[derive(Clone, Copy)]
enum Generator {
    /// A shift along a unit vector.
    Shift(Vector3),
    /// A turn about the unit direction of an axis through a point.
    Turn(Vector3, Point3),
}

impl Generator {
    fn motion(self, amount: f64) -> Similarity {
        match self {
            Self::Shift(direction) => Similarity::from_translation(direction * amount),
            Self::Turn(axis, point) => {
                let turn = Rotation::from_scaled_axis(axis * amount);
                Similarity::about(&point, *turn.to_rotation_matrix().matrix())
            }
        }
    }

    /// Velocity of a point.
    fn velocity(self, at: &Point3) -> Vector3 {
        match self {
            Self::Shift(direction) => direction,
            Self::Turn(axis, point) => axis.cross(&(at - point)),
        }
    }
}

/// Amounts of one generator that are tried.
struct Axis {
    generator: Generator,
    amounts: Vec<f64>,
}

/// Poses of the source along `free` from `pose`, those whose borders fit best first, at most `n` of them and
/// no two near each other. Empty where a part has no borders or the motion is of no known kind.
/// O(poses of the lattice).
pub(super) fn poses_along(
    context: &PairContext<'_>,
    pose: &Similarity,
    free: &FreeMotion,
    n: usize,
) -> Result<Vec<Similarity>, Cancelled> {
    context.check()?;
    let PairContext { source, target, .. } = *context;
    let moves_source = is_source_smaller(source, target, pose.scale);
    let (data, model, model_from_data, free) = if moves_source {
        (source, target, *pose, *free)
    } else {
        let source_from_target = pose.inverse();
        let free = free.moved(&source_from_target);
        (target, source, source_from_target, free)
    };
    let borders = context.borders_of_families[usize::from(moves_source)]
        .get_or_init(|| FamilyBorders::of(data, model));
    let Some(borders) = borders else {
        return Ok(Vec::new());
    };
    let points = data.mesh().positions().iter();
    let moved: Vec<Point3> = points.map(|p| model_from_data.apply(p)).collect();
    let boxes = [Aabb::of_points(&moved), model.mesh().aabb()];
    let axes = axes(&free, boxes, borders.cut);
    if axes.is_empty() {
        return Ok(Vec::new());
    }
    let found = borders.under(&model_from_data).run(&axes, n, context)?;
    let posed = found.into_iter().map(|motion| {
        let model_from_data = motion.after(&model_from_data);
        if moves_source {
            model_from_data
        } else {
            model_from_data.inverse()
        }
    });
    Ok(posed.collect())
}

/// The lattice of motions of a family: shifts as far as most of the smaller part stays beside the larger
/// one, turns all around.
fn axes(free: &FreeMotion, [data, model]: [Aabb; 2], cut: f64) -> Vec<Axis> {
    let direction = free.direction;
    let [own, other] = [&data, &model].map(|aabb| 0.5 * aabb.diagonal());
    let off = model.center() - data.center();
    let room = (other - own).max(0.0) + BESIDE * own;
    let other_axis = if direction.x.abs() < 0.7 {
        Vector3::x()
    } else {
        Vector3::y()
    };
    let oblique = Rotation::from_scaled_axis(direction * OBLIQUE);
    let u = oblique * direction.cross(&other_axis).normalize();
    let v = direction.cross(&u);
    let (center, on_axis) = (data.center(), free.point);
    let radius = |axis: &Vector3, at: &Point3| {
        let arm = |p: Point3| axis.cross(&(p - at)).norm();
        data.corners().into_iter().map(arm).fold(0.0, f64::max)
    };
    let kinds: Vec<(Generator, f64)> = match free.kind {
        FreeMotionKind::Extruded => vec![(Generator::Shift(direction), 0.0)],
        FreeMotionKind::Revolved => {
            let r = radius(&direction, &on_axis);
            vec![(Generator::Turn(direction, on_axis), r)]
        }
        FreeMotionKind::Cylindrical => {
            let r = radius(&direction, &on_axis);
            vec![
                (Generator::Turn(direction, on_axis), r),
                (Generator::Shift(direction), 0.0),
            ]
        }
        FreeMotionKind::Flat => vec![
            (
                Generator::Turn(direction, center),
                radius(&direction, &center),
            ),
            (Generator::Shift(u), 0.0),
            (Generator::Shift(v), 0.0),
        ],
        FreeMotionKind::Spherical | FreeMotionKind::Other => Vec::new(),
    };
    let lattice = |step: f64| -> Vec<Axis> {
        let axis = |&(generator, radius): &(Generator, f64)| {
            let amounts = match generator {
                Generator::Shift(along) => spread(off.dot(&along), room, step),
                Generator::Turn(..) => {
                    let turn = std::f64::consts::PI;
                    let [fewest, most] = N_TURNS;
                    let n = (2.0 * turn * radius / (STEPS_OF_TURN * step))
                        .ceil()
                        .clamp(fewest, most);
                    (0..n as usize).map(|k| 2.0 * turn * k as f64 / n).collect()
                }
            };
            Axis { generator, amounts }
        };
        kinds.iter().map(axis).collect()
    };
    let mut step = if kinds.len() == 1 {
        cut / FINER_ALONG_ONE
    } else {
        cut
    };
    loop {
        let found = lattice(step);
        let count: f64 = found.iter().map(|axis| axis.amounts.len() as f64).product();
        if count <= MOST_POSES || step > COARSEST * cut {
            return found;
        }
        step *= COARSER;
    }
}

/// Amounts `step` apart from `middle - room` to `middle + room`; 0 is among them where it lies within.
fn spread(middle: f64, room: f64, step: f64) -> Vec<f64> {
    let (low, high) = (
        ((middle - room) / step).ceil(),
        ((middle + room) / step).floor(),
    );
    (0..=(high - low).max(0.0) as usize)
        .map(|k| (low + k as f64) * step)
        .collect()
}

/// A motion of the smaller part, and how badly its borders fit.
#[derive(Clone, Copy)]
struct RatedMotion {
    motion: Similarity,
    loss: f64,
}

/// A place in the frame of the grid.
#[derive(Clone, Copy)]
struct Local {
    point: Vector3,
    tangent: Vector3,
    across: Vector3,
    weight: f64,
}

impl Local {
    fn of(place: &Place, weight: f64, grid: &FeatureGrid) -> Self {
        Self {
            point: (place.point - grid.origin()) * grid.scale(),
            tangent: place.tangent,
            across: place.tangent.cross(&place.normal),
            weight,
        }
    }
}

/// Four places in the frame of the grid, coordinate by coordinate.
#[derive(Clone, Copy, Default)]
struct FourPlaces {
    point: FourVectors,
    tangent: FourVectors,
    /// 0 of one that only fills up the four.
    weight: Vec4,
}

impl FourPlaces {
    fn of(places: &[Local]) -> Self {
        let mut four = Self::default();
        for (lane, place) in places.iter().enumerate() {
            for k in 0..3 {
                four.point[k][lane] = place.point[k] as f32;
                four.tangent[k][lane] = place.tangent[k] as f32;
            }
            four.weight[lane] = place.weight as f32;
        }
        four
    }
}

/// The borders of both parts for searches along any family of poses: places along those of the smaller part, which
/// is the data, and a grid over those of the larger one.
pub(super) struct FamilyBorders {
    /// Each in the frame of its part, with its weight; every beginning is spread over all of them.
    data: Vec<(Place, f64)>,
    /// Diagonal of the data.
    data_extent: f64,
    /// In the frame of the grid.
    model: Vec<Local>,
    grid: FeatureGrid,
    /// In the model's unit.
    cut: f64,
}

/// The borders of both parts in the frame of the grid, from one pose of a family on.
struct FamilySearch<'a> {
    borders: &'a FamilyBorders,
    data: Vec<Local>,
    /// The same, four at a time.
    fours: Vec<FourPlaces>,
    extent: f64,
}

impl FamilyBorders {
    /// `None` where a part has no borders.
    fn of(data: &Surface, model: &Surface) -> Option<Self> {
        let still = Similarity::identity();
        let model_places: Vec<Place> = places((model, &still), N_MODEL_PLACES, |_| true);
        let samples: Vec<(Point3, Vector3)> = model_places
            .iter()
            .map(|place| (place.point, place.tangent))
            .collect();
        let grid = FeatureGrid::build(&samples, &GRID)?;
        let holes = places((data, &still), N_PLACES / 2, |is_hole| is_hole);
        let n_trims = if holes.is_empty() {
            N_PLACES
        } else {
            N_PLACES / 2
        };
        let trims = places((data, &still), n_trims, |is_hole| !is_hole);
        let mut own: Vec<(Place, f64)> = Vec::new();
        for kind in [&holes, &trims] {
            let weight = 1.0 / kind.len().max(1) as f64;
            own.extend(kind.iter().map(|place| (*place, weight)));
        }
        if own.is_empty() {
            return None;
        }
        let model_places = model_places.iter();
        Some(Self {
            data: scattered(&own),
            data_extent: data.measures().diagonal,
            model: model_places.map(|p| Local::of(p, 1.0, &grid)).collect(),
            grid,
            cut: CUT * model.measures().diagonal,
        })
    }

    fn under(&self, model_from_data: &Similarity) -> FamilySearch<'_> {
        let data = self.data.iter().map(|(place, weight)| {
            let place = place.moved(model_from_data);
            Local::of(&place, *weight, &self.grid)
        });
        let data: Vec<Local> = data.collect();
        FamilySearch {
            borders: self,
            fours: data.chunks(4).map(FourPlaces::of).collect(),
            data,
            extent: self.data_extent * model_from_data.scale,
        }
    }
}

impl FamilySearch<'_> {
    fn run(
        &self,
        axes: &[Axis],
        n: usize,
        context: &PairContext<'_>,
    ) -> Result<Vec<Similarity>, Cancelled> {
        let count: usize = axes.iter().map(|axis| axis.amounts.len()).product();
        let all = (0..count as u32).into_par_iter().with_min_len(256);
        let loss = |index: u32, n: usize| {
            let motion = motion(axes, &amounts(axes, index as usize));
            let places = &self.fours[..n.min(self.fours.len())];
            (self.loss(places, &motion, self.borders.cut), index)
        };
        let by_loss = |a: &(f64, u32), b: &(f64, u32)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        let mut field: Vec<(f64, u32)> = all.map(|index| loss(index, N_FIRST / 4)).collect();
        keep_first(&mut field, MOST_SORTED, by_loss);
        context.check()?;
        let sorted = field.into_par_iter();
        let mut field: Vec<(f64, u32)> =
            sorted.map(|(_, index)| loss(index, N_SECOND / 4)).collect();
        keep_first(&mut field, MOST_REFINED, by_loss);
        context.check()?;
        let (first, then) = CUTS.split_at(1);
        let mut begun: Vec<(f64, [f64; 3])> = field
            .par_iter()
            .map(|&(_, index)| {
                let amounts = self.refined(axes, amounts(axes, index as usize), first);
                (
                    self.loss(&self.fours, &motion(axes, &amounts), self.borders.cut),
                    amounts,
                )
            })
            .collect();
        // A stable order: equal ones stay in that of the lattice.
        begun.sort_by(|a, b| a.0.total_cmp(&b.0));
        begun.truncate(MOST_FINISHED);
        context.check()?;
        let mut refined: Vec<RatedMotion> = begun
            .par_iter()
            .map(|&(_, begun)| {
                let motion = motion(axes, &self.refined(axes, begun, then));
                RatedMotion {
                    loss: self.loss(&self.fours, &motion, CUTS[2] * self.borders.cut),
                    motion,
                }
            })
            .collect();
        refined.sort_by(|a, b| a.loss.total_cmp(&b.loss));
        let mut distinct: Vec<Similarity> = Vec::new();
        for candidate in refined {
            if distinct.len() == n {
                break;
            }
            let is_near = |other: &Similarity| {
                let places = self.data.iter().step_by(NEAR_PLACES);
                let moved = places.map(|place| {
                    let point = self.outer(&place.point);
                    (candidate.motion.apply(&point) - other.apply(&point)).norm()
                });
                moved.fold(0.0, f64::max) < NEAR * self.borders.cut.max(NEAR_EXTENT * self.extent)
            };
            if !distinct.iter().any(is_near) {
                distinct.push(candidate.motion);
            }
        }
        Ok(distinct)
    }

    /// The amounts after the rounds of these shares of the cut.
    fn refined(&self, axes: &[Axis], mut amounts: [f64; 3], shares: &[f64]) -> [f64; 3] {
        for share in shares {
            for _ in 0..N_STEPS {
                let step = self.step(axes, &amounts, share * self.borders.cut);
                for (amount, more) in amounts.iter_mut().zip(step) {
                    *amount += more;
                }
            }
        }
        amounts
    }

    fn outer(&self, local: &Vector3) -> Point3 {
        self.borders.grid.origin() + local / self.borders.grid.scale()
    }

    /// The motion in the frame of the grid.
    fn in_grid(&self, motion: &Similarity) -> Similarity {
        let origin = self.borders.grid.origin();
        Similarity {
            translation: (motion.apply(origin) - origin) * self.borders.grid.scale(),
            ..*motion
        }
    }

    /// The border of the larger part nearest to a place that was moved, with their distance along it.
    fn beside(&self, point: &Vector3, tangent: &Vector3) -> Option<&Local> {
        let at = [point.x as f32, point.y as f32, point.z as f32];
        let found = &self.borders.model[self.borders.grid.nearest_index(at) as usize];
        (found.tangent.dot(tangent).abs() as f32 > PARALLEL).then_some(found)
    }

    /// Mean over the places of the truncated squared distance across the nearest border, as a share of the
    /// square of the cut.
    fn loss(&self, places: &[FourPlaces], motion: &Similarity, cut: f64) -> f64 {
        let motion = self.in_grid(motion);
        let rows = motion.rotation.transpose().cast::<f32>().data.0;
        let [x, y, z] = motion.translation.cast::<f32>().into();
        let per_cut_sq = (cut * self.borders.grid.scale()).powi(-2) as f32;
        let (mut sum, mut total) = (Vec4::ZERO, Vec4::ZERO);
        for four in places {
            let [u, v, w] = rotated(&rows, &four.point);
            let point = [u + x, v + y, w + z];
            let turned = rotated(&rows, &four.tangent);
            let [a, b, c, d] = self.borders.grid.nearest_four(point);
            let border = by_coordinate([a.point, b.point, c.point, d.point]);
            let tangent = by_coordinate([a.normal, b.normal, c.normal, d.normal]);
            let off = difference(&point, &border);
            let along = dot(&off, &tangent);
            let off_sq = dot(&off, &off) * per_cut_sq;
            let across_sq = off_sq - along * along * per_cut_sq;
            // Past the end of a border the distance along it counts as well.
            let past = (off_sq.sqrt() - 1.0).max(Vec4::ZERO);
            let away = (across_sq + past * past).min(Vec4::ONE);
            let is_parallel = dot(&turned, &tangent).abs().cmpgt(Vec4::splat(PARALLEL));
            sum += four.weight * Vec4::select(is_parallel, away, Vec4::ONE);
            total += four.weight;
        }
        f64::from(sum.element_sum() / total.element_sum())
    }

    /// The Gauss–Newton step of the amounts, pairs farther apart than `cut` left out.
    fn step(&self, axes: &[Axis], amounts: &[f64; 3], cut: f64) -> [f64; 3] {
        let motion = motion(axes, amounts);
        let local = self.in_grid(&motion);
        let moving: Vec<Generator> = (0..axes.len())
            .map(|k| frame(axes, amounts, k, axes[k].generator))
            .collect();
        let mut equations = NormalEquations::<3>::default();
        for place in &self.data {
            let point = local.rotation * place.point + local.translation;
            let tangent = local.rotation * place.tangent;
            let Some(border) = self.beside(&point, &tangent) else {
                continue;
            };
            let gap = (point - border.point).dot(&border.across) / self.borders.grid.scale();
            let ratio = gap / cut;
            let away = (point - border.point).norm() / self.borders.grid.scale();
            if ratio.abs() >= 1.0 || away > ALONG * cut {
                continue;
            }
            let weight = place.weight * (1.0 - ratio * ratio).powi(2);
            let at = self.outer(&point);
            let mut row = SVector::<f64, 3>::zeros();
            for (entry, moving) in row.iter_mut().zip(&moving) {
                *entry = moving.velocity(&at).dot(&border.across);
            }
            equations.add_symmetric(&row, -gap, weight);
        }
        let step = equations.solved();
        std::array::from_fn(|k| match axes.get(k).map(|axis| axis.generator) {
            Some(Generator::Shift(_)) => step[k].clamp(-cut, cut),
            Some(Generator::Turn(..)) => step[k].clamp(-MOST_TURN, MOST_TURN),
            None => 0.0,
        })
    }
}

/// The `n` first of a list in an order, sorted.
fn keep_first<T>(list: &mut Vec<T>, n: usize, order: impl Fn(&T, &T) -> std::cmp::Ordering) {
    if list.len() > n {
        list.select_nth_unstable_by(n, &order);
        list.truncate(n);
    }
    list.sort_unstable_by(order);
}

/// Places in an order whose every beginning is spread over all of them.
fn scattered<T: Copy>(places: &[T]) -> Vec<T> {
    let n = places.len();
    // A step near the golden section of the count that shares no factor with it.
    let mut step = (0.618 * n as f64) as usize;
    let divisor = |mut a: usize, mut b: usize| {
        while b > 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    while step > 1 && divisor(step, n) != 1 {
        step -= 1;
    }
    (0..n).map(|k| places[k * step.max(1) % n]).collect()
}

/// The generator where the ones after it have moved the part: the first of the axes moves it first.
fn frame(axes: &[Axis], amounts: &[f64; 3], k: usize, generator: Generator) -> Generator {
    let Generator::Turn(axis, point) = generator else {
        return generator;
    };
    let mut at = point;
    for (later, amount) in axes.iter().zip(amounts).skip(k + 1) {
        at = later.generator.motion(*amount).apply(&at);
    }
    Generator::Turn(axis, at)
}

fn amounts(axes: &[Axis], mut index: usize) -> [f64; 3] {
    let mut found = [0.0; 3];
    for (amount, axis) in found.iter_mut().zip(axes) {
        *amount = axis.amounts[index % axis.amounts.len()];
        index /= axis.amounts.len();
    }
    found
}

fn motion(axes: &[Axis], amounts: &[f64; 3]) -> Similarity {
    let each = axes.iter().zip(amounts);
    each.fold(Similarity::identity(), |done, (axis, amount)| {
        axis.generator.motion(*amount).after(&done)
    })
}

#[cfg(test)]
mod tests;
