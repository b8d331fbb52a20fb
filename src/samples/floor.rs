//! The car floor: a wide panel with tunnel, embosses and flanges.

use super::parts::{Design, box_at, crash_layout, mirrored, stamped_layout};
use super::path::{Corner, Path};
use super::sheet::{Emboss, Ramp, Sheet};

/// A car floor: toe board, tunnel that sinks towards the rear, heel, side flanges, beads, seat
/// pads and twelve holes.
pub(super) fn floor() -> Design {
    let spine = Path::open(&[
        (-700.0, 150.0, 0.0),
        (-455.0, 0.0, 330.0),
        (400.0, 0.0, 160.0),
        (510.0, 55.0, 120.0),
        (690.0, 70.0, 0.0),
    ]);
    let section = mirrored(&[
        (62.0, 118.0, 26.0),
        (138.0, 0.0, 30.0),
        (500.0, 0.0, 12.0),
        (515.0, 42.0, 10.0),
        (620.0, 42.0, 0.0),
    ]);
    let holes = vec![
        Path::rectangle(-60.0, 0.0, 90.0, 34.0, 20.0),
        Path::rectangle(270.0, 0.0, 55.0, 14.0, 14.0),
        Path::circle(-290.0, 400.0, 22.0),
        Path::circle(-290.0, -320.0, 22.0),
        Path::circle(320.0, 410.0, 22.0),
        Path::circle(340.0, -330.0, 18.0),
        Path::circle(60.0, 480.0, 12.0),
        Path::circle(60.0, -300.0, 12.0),
        Path::circle(-560.0, 250.0, 14.0),
        Path::rectangle(-560.0, -250.0, 22.0, 12.0, 12.0),
        Path::circle(590.0, 300.0, 15.0),
        Path::circle(590.0, -330.0, 15.0),
    ];
    Design {
        sheet: Sheet {
            height: Ramp(vec![(-650.0, 1.0), (-200.0, 1.0), (560.0, 0.55)]),
            height_band: 240.0,
            embosses: floor_embosses(),
            ..Sheet::sweep(spine, section)
        },
        thickness: 0.8,
        over_die: true,
        is_regular: false,
        outline: floor_outline(),
        addendum: vec![
            (-690.0, -430.0, 90.0),
            (-480.0, -596.0, 120.0),
            (655.0, -596.0, 60.0),
            (655.0, 596.0, 60.0),
            (-480.0, 596.0, 120.0),
            (-690.0, 430.0, 90.0),
        ],
        unflanged: vec![
            (620.0, -485.0, 30.0),
            (620.0, 485.0, 30.0),
            (-380.0, 485.0, 60.0),
            (-500.0, 340.0, 60.0),
            (-630.0, 340.0, 25.0),
            (-630.0, -340.0, 25.0),
            (-500.0, -340.0, 60.0),
            (-380.0, -485.0, 60.0),
        ],
        cut: (0.12, 215.0),
        holes,
        crash: crash_layout(7.8),
        stamped: stamped_layout(20.98, 2, 0.22),
        n_stamped_triangles: Some(34_808),
    }
}

fn floor_outline() -> Vec<Corner> {
    let flange = 511.5;
    let root = 484.0;
    vec![
        (622.0, -470.0, 30.0),
        (622.0, 470.0, 30.0),
        (545.0, root, 12.0),
        (530.0, flange, 8.0),
        (120.0, flange, 6.0),
        (112.0, 504.0, 6.0),
        (76.0, 504.0, 6.0),
        (68.0, flange, 6.0),
        (-350.0, flange, 8.0),
        (-366.0, root, 12.0),
        (-415.0, 478.0, 40.0),
        (-500.0, 360.0, 50.0),
        (-634.0, 350.0, 25.0),
        (-634.0, 150.0, 20.0),
        (-600.0, 110.0, 30.0),
        (-600.0, -110.0, 30.0),
        (-634.0, -150.0, 20.0),
        (-634.0, -350.0, 25.0),
        (-500.0, -360.0, 50.0),
        (-415.0, -478.0, 40.0),
        (-366.0, -root, 12.0),
        (-350.0, -flange, 8.0),
        (-60.0, -flange, 6.0),
        (-52.0, -504.0, 6.0),
        (-16.0, -504.0, 6.0),
        (-8.0, -flange, 6.0),
        (530.0, -flange, 8.0),
        (545.0, -root, 12.0),
    ]
}

fn floor_embosses() -> Vec<Emboss> {
    let mut embosses = Vec::new();
    // Stiffening beads of the foot wells, three a side, and of the rear seat's footing.
    for v in [270.0, 345.0, 420.0] {
        embosses.push(box_at((-70.0, v), (110.0, 0.0), 7.0, 16.0, 7.0));
    }
    for v in [-250.0, -505.0] {
        embosses.push(box_at((-80.0, v), (120.0, 0.0), 7.0, 16.0, 7.0));
    }
    for v in [290.0, 350.0, 470.0, -400.0, -470.0] {
        embosses.push(box_at((320.0, v), (52.0, 0.0), 6.0, 15.0, -6.0));
    }
    // Seat cross member pads and the recess of a control unit on one side only.
    embosses.push(box_at((150.0, 380.0), (20.0, 105.0), 12.0, 22.0, 12.0));
    embosses.push(box_at((150.0, -385.0), (20.0, 105.0), 12.0, 22.0, 12.0));
    embosses.push(box_at((-90.0, -380.0), (75.0, 55.0), 14.0, 24.0, -10.0));
    // Beads up the toe board.
    for v in [215.0, 300.0, -200.0, -310.0] {
        embosses.push(box_at((-480.0, v), (55.0, 0.0), 7.0, 16.0, 6.0));
    }
    // Sunk rims of the drain holes.
    for (u, v, r) in [
        (-290.0, 400.0, 30.0),
        (-290.0, -320.0, 30.0),
        (320.0, 410.0, 28.0),
        (340.0, -330.0, 26.0),
    ] {
        embosses.push(box_at((u, v), (0.0, 0.0), r, 12.0, -4.0));
    }
    embosses.push(Emboss {
        angle: 0.5,
        ..box_at((570.0, 60.0), (60.0, 0.0), 7.0, 16.0, 5.0)
    });
    embosses
}
