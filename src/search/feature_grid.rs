//! The nearest of many surface points for every cell of a regular grid: an approximate closest
//! point in constant time, however far away the query is.

use glam::{Vec3A, Vec4};
use rayon::prelude::*;

use crate::geometry::{Aabb, Point3, Vector3};

/// Cells along one row at most; bounds memory at 2 million cells of four bytes.
const MAX_CELLS: usize = 128;
/// A cell that no sample has reached yet.
const EMPTY: u32 = u32::MAX;

/// A sample of a surface, in the frame of its grid.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GridFeature {
    /// Where it lies.
    pub point: Vec3A,
    /// The unit normal there.
    pub normal: Vec3A,
}

/// How fine a grid is and how far it reaches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridSettings {
    /// Cells along the longest side of the grid, margins included; at most 128.
    pub n_cells: usize,
    /// Room around the samples on each side, as a share of the diagonal of their box.
    pub margin: f64,
}

impl Default for GridSettings {
    fn default() -> Self {
        Self {
            n_cells: 72,
            margin: 0.15,
        }
    }
}

/// A regular grid whose cells name the sample nearest to their centre.
///
/// The frame of the grid has its origin at the middle of the samples' box and their diagonal as its
/// unit of length, so that `f32` is enough. The sample that a cell names is at most
/// one and a half diagonals of a cell farther from the cell's centre than the nearest one.
#[derive(Debug, Clone)]
pub struct FeatureGrid {
    origin: Point3,
    /// Grid units per unit of length.
    scale: f64,
    /// Lowest corner, in the frame of the grid.
    low: [f32; 3],
    /// Cells per grid unit.
    per_unit: f32,
    /// Cells along x, y and z.
    shape: [usize; 3],
    /// Layer by layer, in rows along x: queries along a sheet find neighbours in one line of the cache.
    cells: Vec<u32>,
    features: Vec<GridFeature>,
}

impl FeatureGrid {
    /// Builds the grid over `samples` (points with unit normals). `None` if there is no sample, one
    /// is not finite, or all lie in one point. O(cells + samples), in parallel; the same for any
    /// number of threads.
    pub fn build(samples: &[(Point3, Vector3)], settings: &GridSettings) -> Option<Self> {
        let aabb = Aabb::of_points(samples.iter().map(|(point, _)| point));
        let diagonal = aabb.diagonal();
        if samples.is_empty() || !(diagonal.is_finite() && diagonal > 0.0) {
            return None;
        }
        let (origin, scale) = (aabb.center(), 1.0 / diagonal);
        let half = aabb.extents() * (0.5 * scale) + Vector3::repeat(settings.margin);
        let n_longest = settings.n_cells.clamp(1, MAX_CELLS);
        let cell = 2.0 * half.max() / n_longest as f64;
        let shape = [half.x, half.y, half.z]
            .map(|half| ((2.0 * half / cell).ceil() as usize).clamp(1, n_longest));
        let features = samples.iter().map(|(point, normal)| GridFeature {
            point: narrow((point - origin) * scale).into(),
            normal: narrow(*normal).into(),
        });
        let mut grid = Self {
            origin,
            scale,
            low: std::array::from_fn(|k| -0.5 * (shape[k] as f64 * cell) as f32),
            per_unit: (1.0 / cell) as f32,
            shape,
            cells: Vec::new(),
            features: features.collect(),
        };
        grid.cells = grid.nearest_of_cells();
        Some(grid)
    }

    /// The samples, in the order they were given.
    pub fn features(&self) -> &[GridFeature] {
        &self.features
    }

    /// Grid units per unit of length: the reciprocal of the diagonal of the samples' box.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// The origin of the grid's frame, in that of the samples.
    pub fn origin(&self) -> &Point3 {
        &self.origin
    }

    /// A point in the frame of the grid.
    pub fn to_local(&self, point: &Point3) -> [f32; 3] {
        narrow((point - self.origin) * self.scale)
    }

    /// A direction and length of the grid's frame in that of the samples.
    pub fn to_outer(&self, vector: [f32; 3]) -> Vector3 {
        Vector3::from(vector.map(f64::from)) / self.scale
    }

    /// Width of a cell, in grid units.
    pub fn cell(&self) -> f32 {
        1.0 / self.per_unit
    }

    /// Largest error of a cell's distance, in grid units: the diagonal of a cell and a half.
    #[cfg(test)]
    fn slack(&self) -> f32 {
        1.5 * 3.0_f32.sqrt() * self.cell()
    }

    /// Index of the sample nearest to the middle of the query's cell; queries outside the grid ask
    /// the outermost cell. In grid units; any cell for a query that is not a number.
    #[inline]
    pub fn nearest_index(&self, query: [f32; 3]) -> u32 {
        self.cells[self.cell_at(query)]
    }

    /// The sample of [`FeatureGrid::nearest_index`].
    #[inline]
    pub fn nearest(&self, query: [f32; 3]) -> &GridFeature {
        &self.features[self.nearest_index(query) as usize]
    }

    /// [`FeatureGrid::nearest`] of four queries, given coordinate by coordinate. One at the border of two cells may
    /// ask either.
    #[inline(always)]
    pub fn nearest_four(&self, query: [Vec4; 3]) -> [&GridFeature; 4] {
        // Numbers up to 2²³ added to it are rounded, and stand in its low bits.
        const ROUNDING: f32 = 8_388_608.0;
        let number = |n: usize| Vec4::splat(n as f32);
        let along = |k: usize| {
            let steps = (query[k] - Vec4::splat(self.low[k])) * self.per_unit - 0.5;
            // What is not a number becomes zero.
            let steps = steps.max(Vec4::ZERO).min(number(self.shape[k] - 1));
            (steps + ROUNDING) - ROUNDING
        };
        let cell = along(2) * number(self.shape[1]) + along(1);
        let cell = cell * number(self.shape[0]) + along(0) + ROUNDING;
        let of_cell = |cell: f32| {
            let cell = cell.to_bits() ^ ROUNDING.to_bits();
            &self.features[self.cells[cell as usize] as usize]
        };
        [
            of_cell(cell.x),
            of_cell(cell.y),
            of_cell(cell.z),
            of_cell(cell.w),
        ]
    }

    #[inline]
    fn cell_at(&self, query: [f32; 3]) -> usize {
        // Float to integer saturates, and a number that is none becomes zero.
        let along = |k: usize| {
            let steps = (query[k] - self.low[k]) * self.per_unit;
            (steps.max(0.0) as usize).min(self.shape[k] - 1)
        };
        (along(2) * self.shape[1] + along(1)) * self.shape[0] + along(0)
    }

    fn center_along(&self, axis: usize, cell: usize) -> f32 {
        self.low[axis] + (cell as f32 + 0.5) / self.per_unit
    }

    /// The sample nearest to each cell. Rows along x know their own samples, layers then the nearest of their
    /// rows, and the grid the nearest of its layers.
    fn nearest_of_cells(&self) -> Vec<u32> {
        let [nx, ny, nz] = self.shape;
        let mut layers = self.samples_of_cells();
        layers
            .par_chunks_mut(nx)
            .with_min_len(64)
            .enumerate()
            .for_each_init(Envelope::default, |envelope, (row, names)| {
                envelope.take(self, 0, [row % ny, row / ny], names.iter().copied());
                envelope.lowest_at(self.centers_along(0), names.iter_mut());
            });
        layers.par_chunks_mut(nx * ny).enumerate().for_each_init(
            Envelope::default,
            |envelope, (z, layer)| {
                for x in 0..nx {
                    let names = layer[x..].iter().step_by(nx).copied();
                    envelope.take(self, 1, [x, z], names);
                    let names = layer[x..].iter_mut().step_by(nx);
                    envelope.lowest_at(self.centers_along(1), names);
                }
            },
        );
        // What lies above each row of the lowest layer.
        let walls: Vec<Vec<u32>> = (0..ny)
            .into_par_iter()
            .map_init(Envelope::default, |envelope, y| {
                let mut wall = vec![EMPTY; nx * nz];
                for x in 0..nx {
                    let names = layers[y * nx + x..].iter().step_by(nx * ny).copied();
                    envelope.take(self, 2, [x, y], names);
                    let names = wall[x..].iter_mut().step_by(nx);
                    envelope.lowest_at(self.centers_along(2), names);
                }
                wall
            })
            .collect();
        layers
            .par_chunks_mut(nx * ny)
            .enumerate()
            .for_each(|(z, layer)| {
                for (row, wall) in layer.chunks_mut(nx).zip(&walls) {
                    row.copy_from_slice(&wall[z * nx..][..nx]);
                }
            });
        layers
    }

    /// Every sample in its own cell, of several the one nearest to the cell's centre.
    fn samples_of_cells(&self) -> Vec<u32> {
        let [nx, ny, nz] = self.shape;
        let mut cells = vec![EMPTY; nx * ny * nz];
        for (i, &GridFeature { point, .. }) in self.features.iter().enumerate() {
            let point = point.into();
            let cell = self.cell_at(point);
            let at = [cell % nx, cell / nx % ny, cell / (nx * ny)];
            let center: [f32; 3] = std::array::from_fn(|k| self.center_along(k, at[k]));
            let from_center =
                |sample: u32| distance_sq(self.features[sample as usize].point.into(), center);
            if cells[cell] == EMPTY || distance_sq(point, center) < from_center(cells[cell]) {
                cells[cell] = i as u32;
            }
        }
        cells
    }

    fn centers_along(&self, axis: usize) -> impl Iterator<Item = f32> + '_ {
        (0..self.shape[axis]).map(move |cell| self.center_along(axis, cell))
    }
}

/// Squared distance to one sample as a function of the place along a row.
#[derive(Clone, Copy)]
struct Parabola {
    name: u32,
    /// Where the sample lies along the row.
    place: f32,
    /// Its squared distance from the row, and the square of its place.
    reach: f32,
    /// From here on along the row no earlier sample is nearer.
    from: f32,
}

/// The lower envelope of the parabolas of a row (Felzenszwalb and Huttenlocher 2012).
#[derive(Default)]
struct Envelope {
    parts: Vec<Parabola>,
}

impl Envelope {
    /// That of the samples that the cells of a row along `axis` name; `at` are its cells along the other axes.
    fn take(
        &mut self,
        grid: &FeatureGrid,
        axis: usize,
        at: [usize; 2],
        names: impl Iterator<Item = u32>,
    ) {
        let (u, v) = [(1, 2), (0, 2), (0, 1)][axis];
        let (at_u, at_v) = (grid.center_along(u, at[0]), grid.center_along(v, at[1]));
        self.parts.clear();
        // The last one is kept at hand: most are compared with the one before, and many replace it.
        let mut last: Option<Parabola> = None;
        for name in names.filter(|&name| name != EMPTY) {
            let point = grid.features[name as usize].point;
            let (across_u, across_v) = (point[u] - at_u, point[v] - at_v);
            let height = across_u * across_u + across_v * across_v;
            let mut new = Parabola {
                name,
                place: point[axis],
                reach: height + point[axis] * point[axis],
                from: f32::NEG_INFINITY,
            };
            // Its place lies beyond those of all before: each cell of a row names a sample that lies, along the
            // row, within that cell.
            while let Some(before) = last {
                let from = (new.reach - before.reach) / (2.0 * (new.place - before.place));
                if from > before.from {
                    new.from = from;
                    self.parts.push(before);
                    break;
                }
                last = self.parts.pop();
            }
            last = Some(new);
        }
        self.parts.extend(last);
    }

    /// Names the nearest sample at each of the rising `places`.
    fn lowest_at<'n>(
        &self,
        places: impl Iterator<Item = f32>,
        names: impl Iterator<Item = &'n mut u32>,
    ) {
        let mut part = 0;
        for (place, name) in places.zip(names) {
            while self
                .parts
                .get(part + 1)
                .is_some_and(|next| next.from <= place)
            {
                part += 1;
            }
            *name = self.parts.get(part).map_or(EMPTY, |lowest| lowest.name);
        }
    }
}

fn narrow(v: Vector3) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}

fn distance_sq(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const LANES: usize = 4;

    /// Samples of a bent sheet with a wall, unevenly spread.
    fn samples(n: usize) -> Vec<(Point3, Vector3)> {
        (0..n)
            .map(|i| {
                let u = (i as f64 * 0.618_033_988_75).fract();
                let v = (i as f64 * 0.754_877_666_25).fract();
                if i % 5 == 0 {
                    (Point3::new(700.0 * u * u, 0.0, 90.0 * v), Vector3::y())
                } else {
                    let z = 40.0 * (4.0 * u).sin();
                    (Point3::new(700.0 * u, 300.0 * v * v, z), Vector3::z())
                }
            })
            .collect()
    }

    /// The plain loop that the sweeps are compared with.
    fn nearest_distance(grid: &FeatureGrid, query: [f32; 3]) -> f32 {
        let features = grid.features().iter();
        let distances = features.map(|f| distance_sq(f.point.into(), query));
        distances.fold(f32::INFINITY, f32::min).sqrt()
    }

    #[test]
    fn every_cell_names_a_sample_that_is_as_near_as_promised() {
        for n in [1, 2, 7, 300, 4000] {
            let grid = FeatureGrid::build(&samples(n + 1), &GridSettings::default()).unwrap();
            let mut excess = 0.0;
            let [nx, ny, nz] = grid.shape;
            for cell in (0..nx * ny * nz).step_by(7) {
                let at = [cell % nx, cell / nx % ny, cell / (nx * ny)];
                let center: [f32; 3] = std::array::from_fn(|k| grid.center_along(k, at[k]));
                let found = distance_sq(grid.nearest(center).point.into(), center).sqrt();
                let nearest = nearest_distance(&grid, center);
                assert!(found <= nearest + grid.slack(), "{found} for {nearest}");
                excess += (found - nearest) / grid.cell();
            }
            let asked = (nx * ny * nz).div_ceil(7);
            let mean_excess = excess / asked as f32;
            // What a cell loses to the sweeps is small beside its own width.
            assert!(mean_excess < 0.1, "{mean_excess} cells for {n} samples");
        }
    }

    #[test]
    fn four_queries_at_once_find_what_each_finds() {
        let grid = FeatureGrid::build(&samples(4000), &GridSettings::default()).unwrap();
        // All over the grid and beyond it, off the borders of cells.
        let query = |i: usize| {
            let share = |k: usize| ((i as f32 + 0.37) * [0.618, 0.754, 0.569][k]).fract() - 0.5;
            [0, 1, 2].map(|k| 1.5 * share(k))
        };
        for first in (0..4000).step_by(LANES) {
            let queries: [[f32; 3]; LANES] = std::array::from_fn(|l| query(first + l));
            let lanes = [0, 1, 2].map(|k| Vec4::from_array(queries.map(|query| query[k])));
            let expected = queries.map(|query| grid.nearest(query));
            assert_eq!(grid.nearest_four(lanes), expected, "{queries:?}");
        }
        let nowhere = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY].map(Vec4::splat);
        let found = grid.nearest_four(nowhere);
        assert!(found.iter().all(|feature| *feature == found[0]));
    }

    #[test]
    fn far_queries_ask_the_outermost_cell_and_nothing_panics() {
        let grid = FeatureGrid::build(&samples(500), &GridSettings::default()).unwrap();
        let far = grid.nearest([100.0, 0.0, 0.0]);
        assert!(far.point[0] > 0.3, "{far:?}");
        for odd in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let _ = grid.nearest([odd, odd, odd]);
        }
        assert!(FeatureGrid::build(&[], &GridSettings::default()).is_none());
        let one = [(Point3::origin(), Vector3::z())];
        assert!(FeatureGrid::build(&one, &GridSettings::default()).is_none());
    }

    #[test]
    fn the_number_of_threads_changes_nothing() {
        let build = |n_threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads);
            let grid = || FeatureGrid::build(&samples(2000), &GridSettings::default());
            pool.build().unwrap().install(grid).unwrap().cells
        };
        assert_eq!(build(1), build(3));
    }
}
