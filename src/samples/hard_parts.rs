//! Parts that are hard to match on purpose: normals that cancel, few features, surfaces that slide on
//! themselves, rows that repeat, hands that differ by a hole. Millimetres, die axes.

use super::parts::{Design, box_at, crash_layout, mirrored, stamped_layout};
use super::path::{Corner, Path};
use super::sheet::{Emboss, Ramp, Sheet};

/// A rectangle as a trim polygon, ±x by ±y with corners of radius `r`.
fn rectangle(x: f64, y: f64, r: f64) -> Vec<Corner> {
    vec![(x, -y, r), (x, y, r), (-x, y, r), (-x, -y, r)]
}

/// A disc as a polygon with so many sides that it is round at the size of an element.
fn disc(radius: f64) -> Vec<Corner> {
    const SIDES: u32 = 48;
    let corner = |i: u32| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(SIDES)).sin_cos();
        (radius * cos, radius * sin, 5.0)
    };
    (0..SIDES).map(corner).collect()
}

/// A sill: a closed hat profile with a slit along its foot, whose normals cancel.
pub(super) fn sill() -> Design {
    let spine = Path::open(&[(-290.0, 0.0, 0.0), (-40.0, 16.0, 900.0), (290.0, 4.0, 0.0)]);
    let section = Path::open(&[
        (-4.0, 0.0, 0.0),
        (-40.0, 0.0, 6.0),
        (-31.0, 58.0, 8.0),
        (34.0, 66.0, 8.0),
        (45.0, 0.0, 6.0),
        (5.0, 0.0, 0.0),
    ]);
    let holes = vec![
        Path::circle(-170.0, -5.0, 14.0),
        Path::rectangle(-40.0, 2.0, 34.0, 11.0, 11.0),
        Path::circle(95.0, -4.0, 9.0),
        Path::circle(180.0, 3.0, 13.0),
        Path::circle(-110.0, 62.0, 10.0),
        Path::rectangle(140.0, -63.0, 16.0, 8.0, 8.0),
    ];
    Design {
        sheet: Sheet {
            embosses: vec![
                box_at((-105.0, 0.0), (0.0, 16.0), 3.0, 9.0, -3.0),
                box_at((30.0, 66.0), (50.0, 0.0), 5.0, 9.0, 3.0),
                box_at((-60.0, -64.0), (40.0, 0.0), 4.0, 8.0, -2.5),
            ],
            ..Sheet::sweep(spine, section)
        },
        thickness: 1.4,
        over_die: false,
        is_regular: false,
        outline: rectangle(235.0, 124.0, 6.0),
        addendum: rectangle(287.0, 129.0, 12.0),
        unflanged: rectangle(232.0, 98.0, 6.0),
        cut: (0.0, 80.0),
        holes,
        crash: crash_layout(5.0),
        stamped: stamped_layout(5.2, 1, 0.1),
        n_stamped_triangles: None,
    }
}

/// A door's outer panel: large, gently curved, with a handle recess and one feature line.
pub(super) fn door() -> Design {
    let spine = Path::open(&[
        (-600.0, -20.0, 0.0),
        (0.0, 0.0, 8000.0),
        (600.0, -28.0, 0.0),
    ]);
    let section = Path::open(&[
        (-420.0, -56.0, 0.0),
        (-60.0, 0.0, 1500.0),
        (400.0, -76.0, 0.0),
    ]);
    Design {
        sheet: Sheet {
            embosses: vec![
                box_at((350.0, -130.0), (44.0, 12.0), 14.0, 26.0, -11.0),
                Emboss {
                    angle: 0.02,
                    ..box_at((-20.0, 70.0), (440.0, 0.0), 2.0, 40.0, 4.5)
                },
            ],
            ..Sheet::sweep(spine, section)
        },
        thickness: 0.7,
        over_die: true,
        is_regular: false,
        outline: vec![
            (505.0, -270.0, 45.0),
            (535.0, 120.0, 120.0),
            (480.0, 300.0, 40.0),
            (-430.0, 312.0, 60.0),
            (-500.0, 180.0, 90.0),
            (-515.0, -285.0, 30.0),
        ],
        addendum: vec![
            (575.0, -345.0, 60.0),
            (575.0, 372.0, 60.0),
            (-560.0, 372.0, 60.0),
            (-560.0, -345.0, 60.0),
        ],
        unflanged: vec![
            (488.0, -255.0, 40.0),
            (515.0, 120.0, 110.0),
            (465.0, 284.0, 35.0),
            (-420.0, 295.0, 55.0),
            (-482.0, 175.0, 85.0),
            (-497.0, -268.0, 25.0),
        ],
        cut: (0.1, 210.0),
        holes: vec![
            Path::circle(425.0, -128.0, 10.0),
            Path::rectangle(-440.0, -230.0, 14.0, 7.0, 7.0),
        ],
        crash: crash_layout(9.0),
        stamped: stamped_layout(14.0, 2, 0.14),
        n_stamped_triangles: None,
    }
}

/// A flat plate: only borders and holes say where it lies.
pub(super) fn plate() -> Design {
    let line = |half: f64| Path::open(&[(-half, 0.0, 0.0), (half, 0.0, 0.0)]);
    Design {
        sheet: Sheet::sweep(line(160.0), line(120.0)),
        thickness: 2.0,
        over_die: true,
        is_regular: false,
        outline: vec![
            (120.0, -80.0, 8.0),
            (120.0, 52.0, 8.0),
            (92.0, 80.0, 8.0),
            (-120.0, 80.0, 8.0),
            (-120.0, -80.0, 8.0),
        ],
        addendum: rectangle(140.0, 98.0, 20.0),
        unflanged: rectangle(112.0, 72.0, 8.0),
        cut: (0.2, 42.0),
        holes: vec![
            Path::circle(-88.0, -50.0, 9.0),
            Path::circle(-88.0, 52.0, 9.0),
            Path::circle(0.0, -20.0, 24.0),
            Path::rectangle(68.0, -44.0, 22.0, 8.0, 8.0),
            Path::circle(54.0, 42.0, 14.0),
            Path::circle(-40.0, 40.0, 6.0),
        ],
        crash: crash_layout(5.0),
        stamped: stamped_layout(4.4, 1, 0.25),
        n_stamped_triangles: None,
    }
}

/// A drawn cup: turned about its axis; one small hole in its flange says how.
pub(super) fn cup() -> Design {
    let profile = Path::open(&[
        (0.0, 0.0, 0.0),
        (64.0, 0.0, 10.0),
        (72.0, 46.0, 8.0),
        (140.0, 46.0, 0.0),
    ]);
    Design {
        sheet: Sheet::turned(profile),
        thickness: 1.2,
        over_die: false,
        is_regular: false,
        outline: disc(130.0),
        addendum: disc(147.0),
        unflanged: disc(112.0),
        cut: (0.4, 50.0),
        holes: vec![Path::circle(0.0, 0.0, 14.0), Path::circle(115.0, 30.5, 4.5)],
        crash: crash_layout(4.6),
        stamped: stamped_layout(5.0, 1, 0.2),
        n_stamped_triangles: None,
    }
}

/// A U-rail with a regular row of holes: shifted by one pitch, nearly everything fits again.
pub(super) fn channel() -> Design {
    let spine = Path::open(&[(-360.0, 0.0, 0.0), (360.0, 0.0, 0.0)]);
    let section = mirrored(&[(31.0, 0.0, 6.0), (35.0, 70.0, 0.0)]);
    let mut holes: Vec<Path> = (-5..=5)
        .map(|i| Path::circle(50.0 * f64::from(i), 0.0, 9.0))
        .collect();
    holes.push(Path::circle(225.0, 56.0, 7.0));
    Design {
        sheet: Sheet::sweep(spine, section),
        thickness: 2.5,
        over_die: true,
        is_regular: true,
        outline: rectangle(290.0, 34.0, 5.0),
        addendum: rectangle(350.0, 34.8, 8.0),
        unflanged: rectangle(288.0, 33.6, 5.0),
        cut: (0.0, 125.0),
        holes,
        crash: crash_layout(5.0),
        stamped: stamped_layout(5.4, 1, 0.15),
        n_stamped_triangles: None,
    }
}

/// A cross member whose left-hand and right-hand parts differ by one hole.
pub(super) fn crossmember() -> Design {
    let spine = Path::open(&[
        (-300.0, -14.0, 0.0),
        (-130.0, 0.0, 260.0),
        (130.0, 0.0, 260.0),
        (300.0, -14.0, 0.0),
    ]);
    let section = Path::open(&[
        (-140.0, -10.0, 0.0),
        (-64.0, -10.0, 8.0),
        (-40.0, 0.0, 8.0),
        (-30.0, 46.0, 8.0),
        (26.0, 40.0, 8.0),
        (38.0, 0.0, 6.0),
        (140.0, 0.0, 0.0),
    ]);
    let holes = vec![
        Path::circle(-150.0, 0.0, 11.0),
        Path::circle(150.0, 0.0, 11.0),
        Path::rectangle(0.0, 2.0, 26.0, 10.0, 10.0),
        Path::circle(-90.0, 92.0, 7.0),
        Path::circle(90.0, 92.0, 7.0),
        // The one that the other hand has on its other side.
        Path::circle(62.0, -2.0, 8.0),
    ];
    Design {
        sheet: Sheet {
            height: Ramp(vec![(-250.0, 0.8), (-60.0, 1.0), (60.0, 1.0), (250.0, 0.8)]),
            ..Sheet::sweep(spine, section)
        },
        thickness: 1.2,
        over_die: true,
        is_regular: false,
        outline: rectangle(230.0, 78.0, 10.0),
        addendum: rectangle(272.0, 108.0, 20.0),
        unflanged: rectangle(224.0, 62.0, 10.0),
        cut: (0.1, 75.0),
        holes,
        crash: crash_layout(5.0),
        stamped: stamped_layout(5.6, 1, 0.11),
        n_stamped_triangles: None,
    }
}
