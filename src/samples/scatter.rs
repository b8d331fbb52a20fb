//! Where the nodes of a mesh go: along the trim curves, on rings around them, and on a lattice that
//! is finer in the radii, as in an adaptive forming simulation.

use std::collections::HashMap;

use nalgebra::{Rotation2, Vector2};

use super::path::{Flat, Path};
use super::sheet::Sheet;

/// A trimmed domain in (u, v).
#[derive(Debug, Clone)]
pub(super) struct Trim {
    /// Outer border, counter-clockwise.
    pub(super) outline: Path,
    /// Hole borders; their sense does not matter.
    pub(super) holes: Vec<Path>,
}

impl Trim {
    pub(super) fn paths(&self) -> impl Iterator<Item = &Path> {
        std::iter::once(&self.outline).chain(&self.holes)
    }

    pub(super) fn distance(&self, p: &Flat) -> f64 {
        self.paths()
            .map(|path| path.distance(p))
            .fold(f64::INFINITY, f64::min)
    }
}

/// How a mesh is laid out.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    /// Edge length of the lattice where it is coarsest.
    pub(super) size: f64,
    /// How many times cells may be halved in radii and at borders.
    pub(super) levels: u32,
    /// Turn of the lattice against (u, v), radians.
    pub(super) angle: f64,
    /// Shift of the lattice in units of `size`.
    pub(super) shift: (f64, f64),
    /// A row of elements along every border, as crash meshes have.
    pub(super) rings: bool,
}

/// Nodes in the plane: the border loops first, one after the other, then the free ones.
#[derive(Debug, Clone)]
pub(super) struct Scatter {
    pub(super) points: Vec<Flat>,
    /// Number of nodes of each border loop, outline first.
    pub(super) loops: Vec<usize>,
}

impl Scatter {
    pub(super) fn n_border(&self) -> usize {
        self.loops.iter().sum()
    }

    /// Triangles of any triangulation of these nodes, from Euler's formula.
    pub(super) fn n_triangles(&self) -> usize {
        let n_free = self.points.len() - self.n_border();
        2 * n_free + self.n_border() + 2 * (self.loops.len() - 1) - 2
    }

    /// True inside the outline and outside the holes: an odd number of crossings to the left.
    pub(super) fn contains(&self, p: &Flat) -> bool {
        let mut inside = false;
        let mut start = 0;
        for &n in &self.loops {
            let nodes = &self.points[start..start + n];
            for (i, a) in nodes.iter().enumerate() {
                let b = &nodes[(i + 1) % n];
                if (a.y > p.y) != (b.y > p.y) && p.x > a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
                {
                    inside = !inside;
                }
            }
            start += n;
        }
        inside
    }
}

/// Largest turn of the normal across one cell before it is halved, radians.
const TURN_LIMIT: f64 = 0.5;

/// Nodes for a mesh with `layout`; `extra` more border nodes make the triangle count even or odd.
pub(super) fn scatter(sheet: &Sheet, trim: &Trim, layout: &Layout, extra: usize) -> Scatter {
    let finest = layout.size / f64::from(1 << layout.levels);
    let border_size = layout.size / f64::from(1 << layout.levels.min(1));
    let mut points = Vec::new();
    let mut loops = Vec::new();
    for (i, path) in trim.paths().enumerate() {
        // A hole gets at least sixteen nodes if the finest cells allow it.
        let spacing = if i == 0 {
            border_size
        } else {
            (path.length() / 16.0).clamp(finest.min(0.6 * border_size), border_size)
        };
        let nodes = path.nodes(spacing, if i == 0 { extra } else { 0 });
        loops.push(nodes.len());
        points.extend(nodes);
    }
    let mut scatter = Scatter { points, loops };
    let mut taken = Neighbours::new(layout.size);
    for point in &scatter.points {
        taken.insert(*point);
    }
    if layout.rings {
        for ring in rings(&scatter, trim, layout.size) {
            taken.insert(ring);
            scatter.points.push(ring);
        }
    }
    let lattice = Lattice::new(sheet, trim, layout, &scatter);
    let clearance = if layout.rings { 0.7 } else { 0.6 };
    for (point, size, near_border) in lattice.points() {
        let free = !near_border
            || scatter.contains(&point)
                && trim.distance(&point) > clearance * size
                && !taken.any_within(&point, clearance * size);
        if free {
            scatter.points.push(point);
        }
    }
    scatter
}

/// Offsets of the border nodes into the sheet, left out where they would crowd.
fn rings(scatter: &Scatter, trim: &Trim, size: f64) -> Vec<Flat> {
    let mut taken = Neighbours::new(size);
    let mut rings = Vec::new();
    let mut start = 0;
    for &n in &scatter.loops {
        let nodes = &scatter.points[start..start + n];
        start += n;
        for i in 0..n {
            let (before, after) = (nodes[(i + n - 1) % n], nodes[(i + 1) % n]);
            let tangent = (after - before).normalize();
            let width = size.min(0.6 * (after - before).norm());
            let offset = Vector2::new(-tangent.y, tangent.x) * width;
            let inward = [nodes[i] + offset, nodes[i] - offset];
            let Some(&ring) = inward.iter().find(|p| scatter.contains(p)) else {
                continue;
            };
            if trim.distance(&ring) > 0.85 * width && !taken.any_within(&ring, 0.6 * width) {
                taken.insert(ring);
                rings.push(ring);
            }
        }
    }
    rings
}

/// Points sorted into square bins, to ask whether one is near.
struct Neighbours {
    bin: f64,
    bins: HashMap<(i64, i64), Vec<Flat>>,
}

impl Neighbours {
    fn new(bin: f64) -> Self {
        Self {
            bin,
            bins: HashMap::new(),
        }
    }

    fn key(&self, p: &Flat) -> (i64, i64) {
        (
            (p.x / self.bin).floor() as i64,
            (p.y / self.bin).floor() as i64,
        )
    }

    fn insert(&mut self, p: Flat) {
        self.bins.entry(self.key(&p)).or_default().push(p);
    }

    /// Whether a point lies nearer than `radius`, which must not exceed the bin.
    fn any_within(&self, p: &Flat, radius: f64) -> bool {
        let (x, y) = self.key(p);
        (x - 1..=x + 1).any(|x| {
            (y - 1..=y + 1).any(|y| {
                let bin = self.bins.get(&(x, y));
                bin.is_some_and(|bin| bin.iter().any(|q| (q - p).norm_squared() < radius * radius))
            })
        })
    }
}

/// A turned square lattice whose cells are halved 0 … `levels` times, neighbours differing by one.
struct Lattice {
    n: (usize, usize),
    corner: (i64, i64),
    size: f64,
    turn: Rotation2<f64>,
    shift: Vector2<f64>,
    levels: u32,
    cells: Vec<Cell>,
}

#[derive(Clone, Copy, PartialEq)]
enum Where {
    Outside,
    Border,
    Inside,
}

#[derive(Clone, Copy)]
struct Cell {
    at: Where,
    level: u32,
}

impl Lattice {
    fn new(sheet: &Sheet, trim: &Trim, layout: &Layout, border: &Scatter) -> Self {
        let turn = Rotation2::new(layout.angle);
        let shift = Vector2::new(layout.shift.0, layout.shift.1);
        let cell_of = |p: &Flat| (turn.inverse() * p.coords) / layout.size - shift;
        let outline = &border.points[..border.loops[0]];
        let (mut low, mut high) = (cell_of(&outline[0]), cell_of(&outline[0]));
        for p in outline {
            low = low.inf(&cell_of(p));
            high = high.sup(&cell_of(p));
        }
        let corner = (low.x.floor() as i64, low.y.floor() as i64);
        let n = (
            (high.x.ceil() as i64 - corner.0) as usize,
            (high.y.ceil() as i64 - corner.1) as usize,
        );
        let mut lattice = Self {
            n,
            corner,
            size: layout.size,
            turn,
            shift,
            levels: layout.levels,
            cells: Vec::with_capacity(n.0 * n.1),
        };
        for j in 0..n.1 {
            for i in 0..n.0 {
                let cell = lattice.classify(sheet, trim, border, i, j);
                lattice.cells.push(cell);
            }
        }
        lattice.balance();
        lattice
    }

    /// The plane position of lattice coordinates counted in cells from `corner`.
    fn plane(&self, x: f64, y: f64) -> Flat {
        let local = Vector2::new(x + self.corner.0 as f64, y + self.corner.1 as f64) + self.shift;
        Flat::from(self.turn * (local * self.size))
    }

    fn classify(&self, sheet: &Sheet, trim: &Trim, border: &Scatter, i: usize, j: usize) -> Cell {
        let (x, y) = (i as f64, j as f64);
        let middle = self.plane(x + 0.5, y + 0.5);
        let distance = trim.distance(&middle);
        // Rings reach one cell into the sheet, and rejection looks about as far again.
        let at = if distance < 2.6 * self.size {
            Where::Border
        } else if border.contains(&middle) {
            Where::Inside
        } else {
            Where::Outside
        };
        if self.levels == 0 || at == Where::Outside {
            return Cell { at, level: 0 };
        }
        let mut normals = Vec::with_capacity(9);
        for k in 0..9 {
            let p = self.plane(x + f64::from(k % 3) * 0.5, y + f64::from(k / 3) * 0.5);
            normals.push(sheet.normal(&p));
        }
        let turn = normals
            .iter()
            .map(|normal| normal.angle(&normals[4]))
            .fold(0.0, f64::max);
        let at_border = u32::from(distance < 0.75 * self.size);
        let level = (2.0 * turn / TURN_LIMIT).log2().ceil().max(0.0) as u32;
        Cell {
            at,
            level: level.max(at_border).min(self.levels),
        }
    }

    /// Raises levels until neighbours, diagonal ones included, differ by one at most.
    fn balance(&mut self) {
        let (nx, ny) = self.n;
        for _ in 0..self.levels {
            let before: Vec<u32> = self.cells.iter().map(|cell| cell.level).collect();
            for j in 0..ny {
                for i in 0..nx {
                    let mut highest = 0;
                    for y in j.saturating_sub(1)..(j + 2).min(ny) {
                        for x in i.saturating_sub(1)..(i + 2).min(nx) {
                            highest = highest.max(before[y * nx + x]);
                        }
                    }
                    let cell = &mut self.cells[j * nx + i];
                    cell.level = cell.level.max(highest.saturating_sub(1));
                }
            }
        }
    }

    /// Corners of all cells that may lie in the domain, with the local size and whether the border
    /// is near. Each comes once, row by row.
    fn points(&self) -> Vec<(Flat, f64, bool)> {
        let fine = 1_i64 << self.levels;
        let mut found: HashMap<(i64, i64), (u32, bool)> = HashMap::new();
        for (index, cell) in self.cells.iter().enumerate() {
            if cell.at == Where::Outside {
                continue;
            }
            let (i, j) = (index % self.n.0, index / self.n.0);
            let step = fine >> cell.level;
            for y in (0..=fine).step_by(step as usize) {
                for x in (0..=fine).step_by(step as usize) {
                    let key = (j as i64 * fine + y, i as i64 * fine + x);
                    let entry = found.entry(key).or_insert((cell.level, false));
                    entry.0 = entry.0.max(cell.level);
                    entry.1 |= cell.at == Where::Border;
                }
            }
        }
        let mut points: Vec<_> = found.into_iter().collect();
        points.sort_unstable_by_key(|&(key, _)| key);
        points
            .into_iter()
            .map(|((y, x), (level, near_border))| {
                let p = self.plane(x as f64 / fine as f64, y as f64 / fine as f64);
                (p, self.size / f64::from(1 << level), near_border)
            })
            .collect()
    }
}
