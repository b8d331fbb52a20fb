//! The search along the motions that surfaces leave free: a plate, a rail or a cup lies on its counterpart
//! at many places, and only borders and holes distinguish these.

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
    let still = Similarity::identity();
    let (data, model) = if moves_source {
        ((source, pose), (target, &still))
    } else {
        ((target, &still), (source, pose))
    };
    let Some(search) = BorderSearch::new(data, model) else {
        return Ok(Vec::new());
    };
    let axes = axes(free, [box_of(data), box_of(model)], search.cut);
    if axes.is_empty() {
        return Ok(Vec::new());
    }
    let found = search.run(&axes, n, context)?;
    let posed = found.into_iter().map(|motion| {
        if moves_source {
            motion.after(pose)
        } else {
            motion.inverse().after(pose)
        }
    });
    Ok(posed.collect())
}

fn box_of((surface, pose): (&Surface, &Similarity)) -> Aabb {
    let points = surface.mesh().positions().iter().map(|p| pose.apply(p));
    let points: Vec<Point3> = points.collect();
    Aabb::of_points(&points)
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
    let u = direction.cross(&other_axis).normalize();
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

/// Borders of both parts in the frame of a grid over those of the larger one.
struct BorderSearch {
    grid: FeatureGrid,
    data: Vec<Local>,
    model: Vec<Local>,
    /// In the target's unit.
    cut: f64,
    extent: f64,
}

impl BorderSearch {
    fn new(data: (&Surface, &Similarity), model: (&Surface, &Similarity)) -> Option<Self> {
        let model_places: Vec<Place> = places(model, N_MODEL_PLACES, |_| true);
        let samples: Vec<(Point3, Vector3)> = model_places
            .iter()
            .map(|place| (place.point, place.tangent))
            .collect();
        let grid = FeatureGrid::build(&samples, &GRID)?;
        let holes = places(data, N_PLACES / 2, |is_hole| is_hole);
        let n_trims = if holes.is_empty() {
            N_PLACES
        } else {
            N_PLACES / 2
        };
        let trims = places(data, n_trims, |is_hole| !is_hole);
        let local = |place: &Place, weight: f64| Local {
            point: (place.point - grid.origin()) * grid.scale(),
            tangent: place.tangent,
            across: place.tangent.cross(&place.normal),
            weight,
        };
        let mut own: Vec<Local> = Vec::new();
        for kind in [&holes, &trims] {
            let weight = 1.0 / kind.len().max(1) as f64;
            own.extend(kind.iter().map(|place| local(place, weight)));
        }
        if own.is_empty() {
            return None;
        }
        Some(Self {
            data: scattered(&own),
            model: model_places.iter().map(|place| local(place, 1.0)).collect(),
            cut: CUT * model.0.measures().diagonal * model.1.scale,
            extent: data.0.measures().diagonal * data.1.scale,
            grid,
        })
    }

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
            let places = &self.data[..n.min(self.data.len())];
            (self.loss(places, &motion, self.cut), index)
        };
        let by_loss = |a: &(f64, u32), b: &(f64, u32)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        let mut field: Vec<(f64, u32)> = all.map(|index| loss(index, N_FIRST)).collect();
        keep_first(&mut field, MOST_SORTED, by_loss);
        context.check()?;
        let sorted = field.into_par_iter();
        let mut field: Vec<(f64, u32)> = sorted.map(|(_, index)| loss(index, N_SECOND)).collect();
        keep_first(&mut field, MOST_REFINED, by_loss);
        context.check()?;
        let (first, then) = CUTS.split_at(1);
        let mut begun: Vec<(f64, [f64; 3])> = field
            .par_iter()
            .map(|&(_, index)| {
                let amounts = self.refined(axes, amounts(axes, index as usize), first);
                (
                    self.loss(&self.data, &motion(axes, &amounts), self.cut),
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
                    loss: self.loss(&self.data, &motion, CUTS[2] * self.cut),
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
                moved.fold(0.0, f64::max) < NEAR * self.cut.max(NEAR_EXTENT * self.extent)
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
                let step = self.step(axes, &amounts, share * self.cut);
                for (amount, more) in amounts.iter_mut().zip(step) {
                    *amount += more;
                }
            }
        }
        amounts
    }

    fn outer(&self, local: &Vector3) -> Point3 {
        self.grid.origin() + local / self.grid.scale()
    }

    /// The motion in the frame of the grid.
    fn in_grid(&self, motion: &Similarity) -> Similarity {
        let origin = self.grid.origin();
        Similarity {
            translation: (motion.apply(origin) - origin) * self.grid.scale(),
            ..*motion
        }
    }

    /// The border of the larger part nearest to a place that was moved, with their distance along it.
    fn beside(&self, point: &Vector3, tangent: &Vector3) -> Option<&Local> {
        let at = [point.x as f32, point.y as f32, point.z as f32];
        let found = &self.model[self.grid.nearest_index(at) as usize];
        (found.tangent.dot(tangent).abs() as f32 > PARALLEL).then_some(found)
    }

    /// Mean over the places of the truncated squared distance across the nearest border, as a share of the
    /// square of the cut.
    fn loss(&self, places: &[Local], motion: &Similarity, cut: f64) -> f64 {
        let motion = self.in_grid(motion);
        let per_cut = 1.0 / (cut * self.grid.scale());
        let (mut sum, mut total) = (0.0, 0.0);
        for place in places {
            let point = motion.rotation * place.point + motion.translation;
            let tangent = motion.rotation * place.tangent;
            let away = self.beside(&point, &tangent).map_or(1.0, |border| {
                let off = point - border.point;
                let across = off.dot(&border.across) * per_cut;
                // Past the end of a border the distance along it counts as well.
                let apart = (off.norm() * per_cut - 1.0).max(0.0);
                (across * across + apart * apart).min(1.0)
            });
            sum += place.weight * away;
            total += place.weight;
        }
        sum / total
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
            let gap = (point - border.point).dot(&border.across) / self.grid.scale();
            let ratio = gap / cut;
            let away = (point - border.point).norm() / self.grid.scale();
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
fn scattered(places: &[Local]) -> Vec<Local> {
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
mod tests {
    use super::*;
    use crate::assess::AssessSettings;
    use crate::geometry::TriMesh;
    use crate::monitor::Monitor;

    /// A flat sheet of 60 by 40 cells of 2 mm with three holes, of which the columns from `first` on are
    /// there.
    fn plate(first: usize) -> Surface {
        let (columns, rows) = (60, 40);
        let point = |i: usize| {
            let (x, y) = (i % (columns + 1), i / (columns + 1));
            Point3::new(2.0 * x as f64, 2.0 * y as f64, 0.0)
        };
        let holes = [(40, 6, 4), (50, 28, 6), (12, 20, 5)];
        let is_solid = |(x, y): (usize, usize)| {
            let within = |&(left, low, size): &(usize, usize, usize)| {
                (left..left + size).contains(&x) && (low..low + size).contains(&y)
            };
            x >= first && !holes.iter().any(within)
        };
        let cells = (0..columns * rows).map(|i| (i % columns, i / columns));
        let triangles = cells.filter(|&cell| is_solid(cell)).flat_map(|(x, y)| {
            let a = (y * (columns + 1) + x) as u32;
            let up = a + columns as u32 + 1;
            [[a, a + 1, up + 1], [a, up + 1, up]]
        });
        let points = (0..(columns + 1) * (rows + 1)).map(point);
        let mesh = TriMesh::new(points.collect(), triangles.collect()).unwrap();
        Surface::new(&mesh, "source").unwrap()
    }

    #[test]
    fn a_piece_of_a_plate_is_found_by_its_holes_whichever_side_it_is_on() {
        let (whole, piece) = (plate(0), plate(35));
        let free = FreeMotion {
            kind: FreeMotionKind::Flat,
            direction: Vector3::z(),
            point: Point3::origin(),
        };
        let turn = Generator::Turn(Vector3::z(), Point3::new(90.0, 40.0, 0.0)).motion(2.0);
        let shift = Generator::Shift(Vector3::new(-31.0, 12.0, 0.0)).motion(1.0);
        let start = shift.after(&turn);
        let off = |surface: &Surface, pose: &Similarity| {
            let points = surface.mesh().positions().iter();
            let moved = points.map(|p| (pose.apply(p) - p).norm());
            moved.fold(0.0, f64::max)
        };
        assert!(off(&piece, &start) > 50.0);
        let (settings, monitor) = (AssessSettings::default(), Monitor::silent());
        for (source, target) in [(&piece, &whole), (&whole, &piece)] {
            let context = PairContext::new([source, target], &settings, &monitor);
            let found = poses_along(&context, &start, &free, 4).unwrap();
            assert!(off(source, &found[0]) < 0.5, "{}", off(source, &found[0]));
        }
    }
}
