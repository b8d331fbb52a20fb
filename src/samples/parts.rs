//! The five parts of the car: surfaces, trims, holes. Lengths in millimetres, die axes: drawing along z.

use super::floor::floor;
use super::hard_parts::{channel, crossmember, cup, door, plate, sill};
use super::path::{Corner, Path};
use super::scatter::{Layout, Trim};
use super::sheet::{Emboss, Ramp, Sheet};
use super::{SamplePart, SampleVariant};

/// Everything that makes a part.
#[derive(Debug, Clone)]
pub(super) struct Design {
    pub(super) sheet: Sheet,
    pub(super) thickness: f64,
    /// Whether outlines and cut are given over the die plane; else in the sheet's own (u, v), for
    /// sections that turn back over themselves.
    pub(super) over_die: bool,
    /// Whether rows of holes must stay regular when the dimensions change.
    pub(super) is_regular: bool,
    /// Trim polygons.
    pub(super) outline: Vec<Corner>,
    pub(super) addendum: Vec<Corner>,
    pub(super) unflanged: Vec<Corner>,
    /// Where the crash part is cut: x·cos + y·sin ≤ d, as (angle, d).
    pub(super) cut: (f64, f64),
    /// Holes in (u, v).
    pub(super) holes: Vec<Path>,
    pub(super) crash: Layout,
    pub(super) stamped: Layout,
    /// Triangles of the stamped mesh where the number is part of the design.
    pub(super) n_stamped_triangles: Option<usize>,
}

impl Design {
    pub(super) fn of(part: SamplePart) -> Self {
        match part {
            SamplePart::Floor => floor(),
            SamplePart::Rail => rail(),
            SamplePart::Pillar => pillar(),
            SamplePart::Fender => fender(),
            SamplePart::Bracket => bracket(),
            SamplePart::Sill => sill(),
            SamplePart::Door => door(),
            SamplePart::Plate => plate(),
            SamplePart::Cup => cup(),
            SamplePart::Channel => channel(),
            SamplePart::Crossmember => crossmember(),
        }
    }

    /// The crash side's trim.
    pub(super) fn crash_trim(&self, variant: SampleVariant) -> Trim {
        match variant {
            SampleVariant::Cut | SampleVariant::AddendumAndCut => {
                let corners = clip(&self.outline, self.cut);
                self.trim(&corners, &self.holes)
            }
            _ => self.trim(&self.outline, &self.holes),
        }
    }

    /// The stamped side's trim.
    pub(super) fn stamped_trim(&self, variant: SampleVariant) -> Trim {
        match variant {
            SampleVariant::Addendum | SampleVariant::AddendumAndCut => {
                // Before trimming only every other hole is pierced.
                let pierced: Vec<Path> = self.holes.iter().step_by(2).cloned().collect();
                self.trim(&self.addendum, &pierced)
            }
            SampleVariant::MissingFlanges => self.trim(&self.unflanged, &self.holes),
            _ => self.trim(&self.outline, &self.holes),
        }
    }

    /// A closed trim through die-plane corners with the holes that lie well inside.
    pub(super) fn trim(&self, corners: &[Corner], holes: &[Path]) -> Trim {
        let unrolled = |&(x, y, r): &Corner| {
            let (u, v) = (unroll(&self.sheet.spine, x), unroll(&self.sheet.section, y));
            (u, v, r)
        };
        let outline = if self.over_die {
            Path::closed(&corners.iter().map(unrolled).collect::<Vec<_>>())
        } else {
            Path::closed(corners)
        };
        let border = super::scatter::Scatter {
            points: outline.nodes(2.0, 0),
            loops: vec![outline.nodes(2.0, 0).len()],
        };
        let fits = |hole: &&Path| {
            let nodes = hole.nodes(3.0, 0);
            nodes
                .iter()
                .all(|p| border.contains(p) && outline.distance(p) > 5.0)
        };
        let holes = holes.iter().filter(fits).cloned().collect();
        Trim { outline, holes }
    }
}

/// Arc length from the middle of a curve to where its first coordinate, which must grow along it,
/// is `x`. Sections and spines are laid out so.
pub(super) fn unroll(path: &Path, x: f64) -> f64 {
    let (mut low, mut high) = (-path.length(), 2.0 * path.length());
    // Eighty halvings leave nothing of any part's length.
    for _ in 0..80 {
        let middle = (low + high) / 2.0;
        if path.at(middle).0.x < x {
            low = middle;
        } else {
            high = middle;
        }
    }
    low - path.length() / 2.0
}

/// The part of a polygon on one side of a line (Sutherland and Hodgman 1974).
fn clip(corners: &[Corner], (angle, limit): (f64, f64)) -> Vec<Corner> {
    let (sin, cos) = angle.sin_cos();
    let beyond = |c: &Corner| c.0 * cos + c.1 * sin - limit;
    let mut kept = Vec::new();
    for (i, a) in corners.iter().enumerate() {
        let b = &corners[(i + 1) % corners.len()];
        let (da, db) = (beyond(a), beyond(b));
        if da <= 0.0 {
            kept.push(*a);
        }
        if (da < 0.0) != (db < 0.0) {
            let t = da / (da - db);
            kept.push((a.0 + t * (b.0 - a.0), a.1 + t * (b.1 - a.1), 0.0));
        }
    }
    kept
}

/// A section from its right half, y ≥ 0, outwards.
pub(super) fn mirrored(half: &[Corner]) -> Path {
    let mut corners: Vec<Corner> = half.iter().rev().map(|&(y, z, r)| (-y, z, r)).collect();
    corners.extend(half);
    Path::open(&corners)
}

pub(super) fn box_at(
    center: (f64, f64),
    half: (f64, f64),
    radius: f64,
    ramp: f64,
    height: f64,
) -> Emboss {
    Emboss {
        center,
        half,
        angle: 0.0,
        radius,
        ramp,
        height,
    }
}

pub(super) fn crash_layout(size: f64) -> Layout {
    Layout {
        size,
        levels: 0,
        angle: 0.0,
        shift: (0.31, 0.47),
        rings: true,
    }
}

pub(super) fn stamped_layout(size: f64, levels: u32, angle: f64) -> Layout {
    Layout {
        size,
        levels,
        angle,
        shift: (0.0, 0.0),
        rings: false,
    }
}

/// A front side member: open hat section with a kick and a depth that runs out.
fn rail() -> Design {
    let spine = Path::open(&[
        (-300.0, 0.0, 0.0),
        (-60.0, 0.0, 160.0),
        (80.0, 62.0, 160.0),
        (300.0, 70.0, 0.0),
    ]);
    let section = mirrored(&[
        (31.0, 78.0, 8.0),
        (40.0, 0.0, 6.0),
        (74.0, 0.0, 8.0),
        (86.0, -22.0, 8.0),
        (150.0, -22.0, 0.0),
    ]);
    let holes = vec![
        Path::circle(-205.0, 0.0, 13.0),
        Path::rectangle(-110.0, 0.0, 24.0, 9.0, 9.0),
        Path::circle(120.0, 3.0, 15.0),
        Path::circle(215.0, -4.0, 9.0),
        Path::circle(-30.0, 68.0, 11.0),
        Path::circle(170.0, -66.0, 9.0),
    ];
    Design {
        sheet: Sheet {
            height: Ramp(vec![(-120.0, 1.0), (280.0, 0.72)]),
            embosses: vec![
                box_at((-250.0, 0.0), (0.0, 26.0), 3.0, 9.0, -3.5),
                box_at((-160.0, 0.0), (0.0, 26.0), 3.0, 9.0, -3.5),
                box_at((30.0, 0.0), (55.0, 0.0), 7.0, 9.0, -4.0),
                box_at((60.0, 70.0), (45.0, 0.0), 5.0, 9.0, 3.0),
            ],
            ..Sheet::sweep(spine, section)
        },
        thickness: 1.8,
        over_die: true,
        is_regular: false,
        outline: vec![
            (262.0, -66.0, 5.0),
            (262.0, 66.0, 5.0),
            (40.0, 66.0, 6.0),
            (30.0, 56.0, 6.0),
            (-40.0, 56.0, 6.0),
            (-50.0, 66.0, 6.0),
            (-270.0, 66.0, 5.0),
            (-270.0, -66.0, 5.0),
        ],
        addendum: vec![
            (290.0, -128.0, 25.0),
            (290.0, 128.0, 25.0),
            (-295.0, 128.0, 25.0),
            (-295.0, -128.0, 25.0),
        ],
        unflanged: vec![
            (262.0, -42.5, 5.0),
            (262.0, 42.5, 5.0),
            (-270.0, 42.5, 5.0),
            (-270.0, -42.5, 5.0),
        ],
        cut: (0.0, 95.0),
        holes,
        crash: crash_layout(5.0),
        stamped: stamped_layout(4.6, 1, 0.12),
        n_stamped_triangles: None,
    }
}

/// A centre pillar: bowed hat section that flares to its foot.
fn pillar() -> Design {
    let spine = Path::open(&[
        (-470.0, -25.0, 0.0),
        (-170.0, 52.0, 620.0),
        (170.0, 66.0, 620.0),
        (470.0, 5.0, 0.0),
    ]);
    let section = mirrored(&[
        (52.0, 48.0, 9.0),
        (70.0, 0.0, 8.0),
        (106.0, 0.0, 9.0),
        (118.0, -20.0, 9.0),
        (190.0, -20.0, 0.0),
    ]);
    let holes = vec![
        Path::circle(-250.0, 0.0, 13.0),
        Path::rectangle(-120.0, 0.0, 42.0, 15.0, 9.0),
        Path::circle(10.0, 12.0, 7.0),
        Path::circle(10.0, -12.0, 7.0),
        Path::rectangle(120.0, 3.0, 50.0, 18.0, 12.0),
        Path::circle(240.0, -6.0, 15.0),
        Path::rectangle(345.0, 0.0, 24.0, 20.0, 10.0),
        Path::circle(395.0, 34.0, 8.0),
    ];
    Design {
        sheet: Sheet {
            height: Ramp(vec![
                (-430.0, 0.62),
                (-230.0, 1.0),
                (230.0, 1.0),
                (430.0, 0.7),
            ]),
            flare: Ramp(vec![
                (-420.0, -10.0),
                (-280.0, -20.0),
                (80.0, -18.0),
                (430.0, 34.0),
            ]),
            flare_band: 74.0,
            embosses: vec![
                box_at((-190.0, 0.0), (16.0, 0.0), 9.0, 9.0, -3.0),
                box_at((185.0, 0.0), (0.0, 14.0), 4.0, 9.0, 3.0),
                box_at((292.0, 6.0), (0.0, 22.0), 5.0, 10.0, -3.5),
                box_at((385.0, -20.0), (14.0, 0.0), 5.0, 10.0, 3.0),
            ],
            ..Sheet::sweep(spine, section)
        },
        thickness: 1.5,
        over_die: true,
        is_regular: false,
        outline: vec![
            (430.0, -96.0, 12.0),
            (430.0, 96.0, 12.0),
            (120.0, 96.0, 6.0),
            (110.0, 88.0, 6.0),
            (60.0, 88.0, 6.0),
            (50.0, 96.0, 6.0),
            (-420.0, 96.0, 10.0),
            (-420.0, -96.0, 10.0),
        ],
        addendum: vec![
            (462.0, -172.0, 30.0),
            (462.0, 172.0, 30.0),
            (-462.0, 172.0, 30.0),
            (-462.0, -172.0, 30.0),
        ],
        unflanged: vec![
            (430.0, -74.0, 12.0),
            (430.0, 74.0, 12.0),
            (-420.0, 74.0, 10.0),
            (-420.0, -74.0, 10.0),
        ],
        cut: (0.25, 170.0),
        holes,
        crash: crash_layout(5.0),
        stamped: stamped_layout(6.0, 1, 0.09),
        n_stamped_triangles: None,
    }
}

/// A fender: doubly curved skin with a feature line, the bonnet's flange and a wheel arch.
fn fender() -> Design {
    let spine = Path::open(&[
        (-440.0, -70.0, 0.0),
        (-150.0, 22.0, 800.0),
        (180.0, 34.0, 900.0),
        (440.0, -16.0, 0.0),
    ]);
    let section = Path::open(&[
        (-290.0, 26.0, 0.0),
        (-196.0, 26.0, 9.0),
        (-182.0, 62.0, 9.0),
        (-20.0, 52.0, 330.0),
        (160.0, -40.0, 240.0),
        (290.0, -250.0, 0.0),
    ]);
    let holes = vec![
        Path::circle(-250.0, -272.0, 6.0),
        Path::circle(-60.0, -272.0, 6.0),
        Path::rectangle(110.0, -272.0, 9.0, 6.0, 6.0),
        Path::circle(280.0, -272.0, 6.0),
        Path::rectangle(-320.0, 62.0, 30.0, 11.0, 11.0),
    ];
    Design {
        sheet: Sheet {
            embosses: vec![
                Emboss {
                    angle: 0.04,
                    ..box_at((40.0, -20.0), (330.0, 0.0), 2.0, 34.0, 6.0)
                },
                // The lip around the wheel arch.
                box_at((10.0, 330.0), (0.0, 0.0), 222.0, 20.0, -9.0),
            ],
            ..Sheet::sweep(spine, section)
        },
        thickness: 0.7,
        over_die: true,
        is_regular: false,
        outline: vec![
            (405.0, -214.0, 10.0),
            (405.0, 60.0, 50.0),
            (330.0, 212.0, 18.0),
            (222.0, 214.0, 12.0),
            (160.0, 128.0, 90.0),
            (60.0, 98.0, 90.0),
            (-50.0, 98.0, 90.0),
            (-140.0, 128.0, 90.0),
            (-200.0, 214.0, 12.0),
            (-330.0, 205.0, 25.0),
            (-410.0, 40.0, 80.0),
            (-395.0, -214.0, 10.0),
        ],
        addendum: vec![
            (432.0, -270.0, 40.0),
            (432.0, 262.0, 60.0),
            (-432.0, 262.0, 60.0),
            (-432.0, -270.0, 40.0),
        ],
        unflanged: vec![
            (390.0, -175.0, 10.0),
            (390.0, 60.0, 50.0),
            (320.0, 190.0, 18.0),
            (235.0, 190.0, 12.0),
            (175.0, 105.0, 90.0),
            (60.0, 70.0, 90.0),
            (-50.0, 70.0, 90.0),
            (-155.0, 105.0, 90.0),
            (-215.0, 190.0, 12.0),
            (-320.0, 185.0, 25.0),
            (-395.0, 40.0, 80.0),
            (-382.0, -175.0, 10.0),
        ],
        cut: (0.0, 20.0),
        holes,
        crash: crash_layout(7.0),
        stamped: stamped_layout(10.0, 2, 0.16),
        n_stamped_triangles: None,
    }
}

/// A bracket that a half turn almost lays on itself: one hole is a slot and one bead is missing.
fn bracket() -> Design {
    let spine = Path::open(&[(-120.0, 0.0, 0.0), (120.0, 0.0, 0.0)]);
    let section = mirrored(&[
        (26.0, 32.0, 7.0),
        (36.0, 0.0, 6.0),
        (74.0, 0.0, 6.0),
        (82.0, -14.0, 6.0),
        (120.0, -14.0, 0.0),
    ]);
    let holes = vec![
        Path::circle(0.0, 0.0, 11.0),
        Path::circle(58.0, 73.0, 5.5),
        Path::circle(-58.0, 73.0, 5.5),
        Path::circle(-58.0, -73.0, 5.5),
        Path::rectangle(58.0, -73.0, 9.0, 5.5, 5.5),
    ];
    Design {
        sheet: Sheet {
            embosses: vec![
                box_at((48.0, 0.0), (16.0, 0.0), 4.0, 8.0, -3.0),
                box_at((-48.0, 0.0), (16.0, 0.0), 4.0, 8.0, -3.0),
                box_at((0.0, 72.0), (18.0, 0.0), 4.0, 8.0, 2.5),
            ],
            ..Sheet::sweep(spine, section)
        },
        thickness: 2.0,
        over_die: true,
        is_regular: false,
        outline: vec![
            (85.0, -30.0, 6.0),
            (85.0, 30.0, 6.0),
            (78.0, 66.0, 12.0),
            (-78.0, 66.0, 12.0),
            (-85.0, 30.0, 6.0),
            (-85.0, -30.0, 6.0),
            (-78.0, -66.0, 12.0),
            (78.0, -66.0, 12.0),
        ],
        addendum: vec![
            (112.0, -108.0, 20.0),
            (112.0, 108.0, 20.0),
            (-112.0, 108.0, 20.0),
            (-112.0, -108.0, 20.0),
        ],
        unflanged: vec![
            (84.0, -38.5, 6.0),
            (84.0, 38.5, 6.0),
            (-84.0, 38.5, 6.0),
            (-84.0, -38.5, 6.0),
        ],
        cut: (0.3, 32.0),
        holes,
        crash: crash_layout(5.0),
        stamped: stamped_layout(4.6, 1, 0.3),
        n_stamped_triangles: None,
    }
}
