//! Nothing is cut and nothing lies on something else: what was painted is looked at, not a picture.

use std::time::{Duration, Instant};

use egui::{Pos2, Rect, Shape, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use shapematch::app::{
    Action, BottomTab, ColorBy, Command, MoveCommand, NoticeCommand, Preview, PreviewCommand,
    Theme, ViewCommand,
};
use shapematch::geometry::camera::ScreenSize;
use shapematch::report::number;
use shapematch::role::Role;
use shapematch::text::capital;
use shapematch::ui::Shell;

use super::story::{click, finish, matched, window};

pub(super) type Window = Harness<'static, Shell>;

/// A text as it was painted.
pub(super) struct Painted {
    pub(super) text: String,
    pub(super) rect: Rect,
    pub(super) clip: Rect,
}

/// Every text of the last frame that can be seen.
pub(super) fn texts<S>(window: &Harness<'static, S>) -> Vec<Painted> {
    let mut found = Vec::new();
    for clipped in &window.output().shapes {
        collect(&clipped.shape, clipped.clip_rect, &mut found);
    }
    found
}

fn collect(shape: &Shape, clip: Rect, found: &mut Vec<Painted>) {
    match shape {
        Shape::Vec(shapes) => shapes.iter().for_each(|shape| collect(shape, clip, found)),
        // The name of an upright axis is turned, and its letters are not where its layout has them.
        Shape::Text(text) if text.angle == 0.0 => {
            for row in &text.galley.rows {
                let (Some(first), Some(last)) = (row.glyphs.first(), row.glyphs.last()) else {
                    continue;
                };
                let x = first.pos.x..=last.max_x();
                let rect = Rect::from_x_y_ranges(x, 0.0..=row.size.y);
                let rect = rect.translate(row.pos.to_vec2() + text.pos.to_vec2());
                let seen = rect.intersect(clip);
                let text = row.text();
                if seen.width() > 1.0 && seen.height() > 4.0 && !text.trim().is_empty() {
                    found.push(Painted { text, rect, clip });
                }
            }
        }
        _ => {}
    }
}

/// What is wrong unless every text lies within its clip sideways and on no other text.
pub(super) fn faults<S>(window: &Harness<'static, S>) -> Vec<String> {
    let mut texts = texts(window);
    // Stands in the place of the picture, and so under everything.
    texts.retain(|text| text.text != "no graphics adapter");
    assert!(texts.len() > 10, "nothing was painted");
    let mut faults = Vec::new();
    for one in &texts {
        let is_cut =
            one.rect.left() < one.clip.left() - 1.0 || one.rect.right() > one.clip.right() + 1.0;
        if is_cut {
            faults.push(format!("cut: {:?} {} of {}", one.text, one.rect, one.clip));
        }
    }
    for (index, one) in texts.iter().enumerate() {
        for other in &texts[index + 1..] {
            let both = one
                .rect
                .intersect(one.clip)
                .intersect(other.rect.intersect(other.clip));
            if both.width() > 1.5 && both.height() > 3.0 {
                faults.push(format!(
                    "on each other: {:?} {} and {:?} {}",
                    one.text, one.rect, other.text, other.rect
                ));
            }
        }
    }
    faults.extend(overlapping_buttons(window));
    faults.extend(over_cubes(window, &texts));
    faults
}

/// Texts that lie over a view cube, whose own are letters.
fn over_cubes<S>(window: &Harness<'static, S>, texts: &[Painted]) -> Vec<String> {
    let mut faults = Vec::new();
    for role in Role::ALL {
        let name = format!("View cube ({})", role.word());
        let Some(cube) = window.query_by_label(&name).map(|cube| cube.rect()) else {
            continue;
        };
        for text in texts.iter().filter(|text| text.text.chars().count() > 1) {
            let both = cube.intersect(text.rect.intersect(text.clip));
            if both.width() > 1.0 && both.height() > 1.0 {
                faults.push(format!("over the view cube: {:?} {}", text.text, text.rect));
            }
        }
    }
    faults
}

/// Buttons and fields that lie partly on one another; one within the other is meant.
fn overlapping_buttons<S>(window: &Harness<'static, S>) -> Vec<String> {
    use egui::accesskit::Role;
    let screen = Rect::from_min_size(Pos2::ZERO, window.ctx.content_rect().size());
    let mut all: Vec<(String, Rect)> = Vec::new();
    let mut queue = vec![window.root()];
    while let Some(node) = queue.pop() {
        queue.extend(node.children());
        let inner = node.accesskit_node();
        let is_meant = matches!(
            inner.role(),
            Role::Button
                | Role::CheckBox
                | Role::TextInput
                | Role::SpinButton
                | Role::ComboBox
                | Role::Tab
        );
        if is_meant && inner.raw_bounds().is_some() && screen.contains_rect(node.rect()) {
            all.push((inner.label().unwrap_or_default(), node.rect()));
        }
    }
    let mut faults = Vec::new();
    for (index, (name, rect)) in all.iter().enumerate() {
        for (other, at) in &all[index + 1..] {
            let both = rect.intersect(*at);
            let is_within =
                rect.expand(0.5).contains_rect(*at) || at.expand(0.5).contains_rect(*rect);
            if both.width() > 1.0 && both.height() > 1.0 && !is_within {
                faults.push(format!(
                    "buttons on each other: {name:?} {rect} and {other:?} {at}"
                ));
            }
        }
    }
    faults
}

/// Changes theme and scale as the preferences do.
pub(super) fn set(window: &mut Window, theme: Theme, ui_scale: f32) {
    let ctx = window.ctx.clone();
    let mut settings = window.state().state().settings.clone();
    settings.theme = theme;
    settings.ui_scale = ui_scale;
    window
        .state_mut()
        .run_commands(vec![Command::Settings(Box::new(settings))], &ctx);
    window.run_steps(2);
}

/// Toasts lie over the windows on purpose.
pub(super) fn dismiss_toasts(window: &mut Window) {
    // Those that had no room come in their place.
    loop {
        let toasts = window.state().state().log.notices.toasts();
        let ids: Vec<_> = toasts.map(|notice| notice.id).collect();
        if ids.is_empty() {
            break;
        }
        let commands = ids.into_iter().map(|id| NoticeCommand::Dismiss(id).into());
        act(window, commands.collect());
    }
}

fn act(window: &mut Window, commands: Vec<Command>) {
    let ctx = window.ctx.clone();
    window.state_mut().run_commands(commands, &ctx);
    window.run_steps(2);
}

/// Windows in pixels, and the scales of text and controls.
const SIZES: [[f32; 2]; 5] = [
    [800.0, 540.0],
    [1024.0, 700.0],
    [1280.0, 720.0],
    [1920.0, 1080.0],
    [3840.0, 2160.0],
];
const SCALES: [f32; 5] = [0.75, 1.0, 1.5, 2.0, 2.5];

#[test]
fn nothing_is_cut_at_any_size_and_scale_in_any_theme() {
    let mut window = window();
    let mut all = Vec::new();
    let mut look = |window: &mut Window, state: &str| {
        dismiss_toasts(window);
        for scale in SCALES {
            for theme in [Theme::Dark, Theme::Light] {
                set(window, theme, scale);
                for [width, height] in SIZES {
                    window.set_size(Vec2::new(width, height) / scale);
                    window.run_steps(2);
                    let place = format!("{state}, {width} × {height}, {scale}, {theme:?}");
                    let found = faults(window).into_iter();
                    all.extend(found.map(|fault| format!("{place}: {fault}")));
                }
            }
        }
        set(window, Theme::Dark, 1.0);
        window.set_size(Vec2::new(1400.0, 900.0));
        window.run_steps(2);
    };
    look(&mut window, "empty");
    click(&mut window, "Open the example pair");
    finish(&mut window);
    look(&mut window, "loaded");
    click(&mut window, "Reduce");
    finish(&mut window);
    look(&mut window, "reduced");
    click(&mut window, "Match the parts");
    finish(&mut window);
    look(&mut window, "matched");
    let over = Action::ToggleMoveOver.command(window.state().state());
    act(&mut window, over.into_iter().collect());
    finish(&mut window);
    look(&mut window, "moved over");
    let map = Action::MapOrCancel.command(window.state().state());
    act(&mut window, map.into_iter().collect());
    finish(&mut window);
    look(&mut window, "mapped");
    let n = all.len();
    assert!(all.is_empty(), "{n} faults\n{}", all.join("\n"));
}

/// What the tabs below the windows show, at every size and scale: the starts' table ran out of its pane.
#[test]
fn nothing_is_cut_in_any_tab() {
    let mut window = matched();
    let map = Action::MapOrCancel.command(window.state().state());
    act(&mut window, map.into_iter().collect());
    finish(&mut window);
    let mut all = Vec::new();
    for tab in BottomTab::ALL {
        act(&mut window, vec![ViewCommand::SetTab(tab).into()]);
        finish(&mut window);
        dismiss_toasts(&mut window);
        for scale in SCALES {
            set(&mut window, Theme::Light, scale);
            for [width, height] in SIZES {
                window.set_size(Vec2::new(width, height) / scale);
                window.run_steps(3);
                let place = format!("{tab:?}, {width} × {height}, {scale}");
                let found = faults(&window).into_iter();
                all.extend(found.map(|fault| format!("{place}: {fault}")));
            }
        }
    }
    let n = all.len();
    assert!(all.is_empty(), "{n} faults\n{}", all.join("\n"));
}

/// The banner of a pose that is only looked at, or of one of several, has a place beside the view cube or above it.
#[test]
fn a_banner_lies_beside_the_view_cube() {
    let mut window = matched();
    let pin = PreviewCommand::Pin(Some(Preview::Start(0)));
    act(&mut window, vec![pin.into()]);
    dismiss_toasts(&mut window);
    let is_banner = |text: &Painted| text.text.starts_with("Preview of start 1");
    let mut n_shown = 0;
    for is_folded in [true, false] {
        for width in [800.0, 900.0, 1024.0, 1180.0, 1400.0, 1920.0] {
            window.set_size(Vec2::new(width, 720.0));
            window.run_steps(2);
            act(&mut window, vec![ViewCommand::FoldColumn(is_folded).into()]);
            window.run_steps(2);
            let found = faults(&window);
            assert!(
                found.is_empty(),
                "{width}, {is_folded}: {}",
                found.join("\n")
            );
            n_shown += usize::from(texts(&window).iter().any(is_banner));
        }
    }
    assert!(n_shown >= 10, "{n_shown}");
}

/// Names and numbers of the deviation are read whole beside each other in the narrowest window, with pinned labels
/// and without.
#[test]
fn the_columns_of_the_deviation_are_whole_in_a_narrow_window() {
    let mut window = matched();
    act(
        &mut window,
        vec![ViewCommand::SetTab(BottomTab::Deviation).into()],
    );
    finish(&mut window);
    dismiss_toasts(&mut window);
    let names = [
        "mean",
        "RMS (compared)",
        "P95 (compared)",
        "min",
        "max",
        "standard deviation",
    ];
    for width in [800.0, 900.0, 1024.0, 1280.0] {
        for is_folded in [true, false] {
            window.set_size(Vec2::new(width, 900.0));
            window.run_steps(2);
            act(&mut window, vec![ViewCommand::FoldColumn(is_folded).into()]);
            window.run_steps(3);
            let texts = texts(&window);
            let place = format!("{width}, {is_folded}");
            let find = |name: &str| {
                let mut all = texts.iter().filter(|text| text.text == name);
                all.find(|text| text.clip.expand(0.5).contains_rect(text.rect))
            };
            let title = find("▲ → ■").unwrap_or_else(|| panic!("{place}: no column"));
            for name in names {
                let row = find(name).unwrap_or_else(|| panic!("{place}: {name:?} is cut"));
                let middle = row.rect.center().y;
                let numbers = texts.iter().filter(|text| {
                    let is_beside = (text.rect.center().y - middle).abs() < 3.0;
                    let right = text.rect.right();
                    is_beside && right > row.rect.right() && right < title.rect.right() + 120.0
                });
                let whole = numbers.filter(|text| {
                    !text.text.contains('…') && text.clip.expand(0.5).contains_rect(text.rect)
                });
                assert!(whole.count() >= 2, "{place}: the numbers of {name:?}");
            }
            let nodes = texts.iter().filter(|text| text.text.starts_with("node"));
            let cut: Vec<_> = nodes.filter(|text| text.text.contains('…')).collect();
            assert!(cut.is_empty(), "{place}: {:?}", cut[0].text);
        }
    }
}

/// The first start of a small window after files were opened: the question about the mouse is seen whole.
#[test]
fn the_question_about_the_mouse_is_seen_whole_below_recent_files() {
    let mut window = window();
    let ctx = window.ctx.clone();
    let mut settings = window.state().state().settings.clone();
    settings.is_mouse_asked = false;
    settings.recent = [
        "crash.k",
        "a_rather_long_name_of_a_stamped_part.dynain",
        "w.shapematch",
    ]
    .map(std::path::PathBuf::from)
    .to_vec();
    let just_now = settings.recent.iter().map(|path| (path.clone(), 1));
    settings.opened = just_now.collect();
    let commands = vec![Command::Settings(Box::new(settings))];
    window.state_mut().run_commands(commands, &ctx);
    for [width, height] in [
        [1024.0, 700.0],
        [1280.0, 720.0],
        [1280.0, 640.0],
        [1600.0, 900.0],
    ] {
        window.set_size(Vec2::new(width, height));
        window.run_steps(4);
        let choice = window.get_by_role(egui::accesskit::Role::ComboBox).rect();
        assert!(choice.right() < width - 24.0, "{width}: {choice}");
        let ok = window.get_by_label("OK").rect();
        let texts = texts(&window);
        let text = texts.iter().find(|text| text.text == "OK").expect("drawn");
        let foot = Rect::from_min_max(ok.left_bottom(), ok.right_bottom() + Vec2::new(0.0, 9.0));
        assert!(
            text.clip.contains_rect(foot),
            "{width}: {foot} of {}",
            text.clip
        );
        let listed = texts.iter().filter(|text| text.text == "crash.k").count();
        assert!(listed >= 1, "{width}: no recent file");
        // Names short and long begin at the same place.
        let [short, long] = ["crash.k", "a_rather"].map(|start| {
            let name = texts.iter().find(|text| text.text.starts_with(start));
            name.expect("listed").rect.left().round()
        });
        assert_eq!(short, long, "{width}");
    }
    // Where it has no room it is asked another time.
    window.set_size(Vec2::new(640.0, 360.0));
    window.run_steps(4);
    assert!(window.query_by_label("OK").is_none());
}

/// A column that was unfolded in a small window is a rail again where larger text leaves still less room; unfolded
/// there, it cuts no name of a part.
#[test]
fn an_unfolded_column_folds_again_where_room_is_lost() {
    let mut window = matched();
    dismiss_toasts(&mut window);
    for scale in [2.0, 2.5] {
        set(&mut window, Theme::Light, scale);
        window.set_size(Vec2::new(1280.0, 720.0) / scale);
        window.run_steps(4);
        assert!(window.state().state().view.is_column_folded(), "{scale}");
        act(&mut window, vec![ViewCommand::FoldColumn(false).into()]);
        window.run_steps(4);
        assert!(!window.state().state().view.is_column_folded(), "{scale}");
        for text in texts(&window) {
            if ["CRASH", "STAMPED", "fixed", "moves"].contains(&&*text.text) {
                let end = text.clip.right() + 1.0;
                assert!(text.rect.right() <= end, "{scale}: {}", text.text);
            }
        }
    }
}

/// The classes of the overlap and their shares of both parts stand beside each other.
#[test]
fn the_overlap_of_two_parts_has_room_for_its_shares() {
    let mut window = matched();
    click(&mut window, "Move over");
    finish(&mut window);
    let overlap = Action::ToggleOverlap.command(window.state().state());
    act(&mut window, overlap.into_iter().collect());
    finish(&mut window);
    dismiss_toasts(&mut window);
    for size in [[1400.0, 900.0], [1280.0, 720.0], [1100.0, 720.0]] {
        window.set_size(Vec2::from(size));
        window.run_steps(20);
        let found = faults(&window);
        assert!(found.is_empty(), "{size:?}: {}", found.join("\n"));
        let is_class = |text: &Painted| text.text == "on this part only";
        let is_shown = texts(&window).iter().any(is_class);
        assert!(is_shown || size[0] < 1200.0, "{size:?}: no legend");
    }
}

/// The unfolded legend of a mapped quantity says more than the folded one.
#[test]
fn the_legend_of_a_mapped_quantity_has_its_figures() {
    let mut window = matched();
    let map = Action::MapOrCancel.command(window.state().state());
    act(&mut window, map.into_iter().collect());
    finish(&mut window);
    click(&mut window, "Values");
    finish(&mut window);
    dismiss_toasts(&mut window);
    wait_for(&mut window, "Unfold the legend (crash)");
    let figures = |window: &Window| {
        let starts = ["max ", "mean ", "min "];
        let texts = texts(window);
        let is_one = |start: &&str| texts.iter().any(|text| text.text.starts_with(*start));
        starts.iter().filter(|start| is_one(start)).count()
    };
    assert_eq!(figures(&window), 0);
    click(&mut window, "Unfold the legend (crash)");
    window.run_steps(4);
    assert_eq!(figures(&window), 3);
    let counts = |text: &Painted| text.text.ends_with(" elements");
    assert!(texts(&window).iter().any(counts));
    let found = faults(&window);
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// Every label of a row of choices keeps off the edges of its own.
#[test]
fn the_uses_of_the_right_window_have_room_around_their_names() {
    let mut window = matched();
    click(&mut window, "Move over");
    finish(&mut window);
    for width in [1400.0, 1280.0, 1180.0] {
        window.set_size(Vec2::new(width, 720.0));
        window.run_steps(4);
        for name in ["Full mesh", "Alternative"] {
            let Some(cell) = window.query_by_label(name) else {
                continue;
            };
            let (cell, texts) = (cell.rect(), texts(&window));
            let text = texts.iter().find(|text| text.text == name).expect("drawn");
            let room = (text.rect.left() - cell.left()).min(cell.right() - text.rect.right());
            assert!(room >= 4.0, "{name} at {width}: {room}");
        }
    }
}

#[test]
fn a_fitted_part_lies_beside_what_lies_over_the_window() {
    let mut window = matched();
    click(&mut window, "Move over");
    finish(&mut window);
    wait_for(&mut window, "Unfold the legend (stamped)");
    window.run_steps(20);
    covers_nothing(&window, "free window", Role::Stamped);
    let deviation = Action::ToggleDeviation.command(window.state().state());
    act(&mut window, deviation.into_iter().collect());
    finish(&mut window);
    wait_for(&mut window, "Unfold the legend (crash)");
    window.run_steps(20);
    assert!(window.state().state().view.is_fitted(Role::Crash));
    for size in [[1400.0, 900.0], [1280.0, 720.0]] {
        window.set_size(Vec2::from(size));
        window.run_steps(40);
        covers_nothing(&window, &format!("{size:?}, folded"), Role::Crash);
    }
    window.set_size(Vec2::new(1400.0, 900.0));
    window.run_steps(3);
    click(&mut window, "Unfold the legend (crash)");
    window.run_steps(40);
    covers_nothing(&window, "unfolded", Role::Crash);
    // Large text in a small window has the names and notes of both parts beside it too.
    click(&mut window, "Fold the legend (crash)");
    set(&mut window, Theme::Light, 2.0);
    window.set_size(Vec2::new(640.0, 360.0));
    window.run_steps(40);
    covers_nothing(&window, "1280 × 720 at 200 %", Role::Crash);
    set(&mut window, Theme::Dark, 1.0);
    window.set_size(Vec2::new(1400.0, 900.0));
    window.run_steps(40);
    click(&mut window, "Unfold the legend (crash)");
    window.run_steps(40);
    // A camera that the user moved stays where it is.
    let mut camera = window.state().state().view.cameras.crash;
    camera.height *= 0.5;
    act(
        &mut window,
        vec![ViewCommand::SetCamera(Role::Crash, camera).into()],
    );
    click(&mut window, "Fold the legend (crash)");
    window.run_steps(4);
    assert_eq!(window.state().state().view.cameras.crash, camera);
}

fn color_by(window: &mut Window, by: ColorBy) {
    let mut display = window.state().state().view.display.clone();
    display.color_by = by;
    act(
        window,
        vec![ViewCommand::SetDisplay(Box::new(display)).into()],
    );
}

/// What a map covers is the part's again as soon as its legend is gone, as often as it comes and goes.
#[test]
fn a_part_has_the_room_of_a_closed_legend_again() {
    let mut window = matched();
    dismiss_toasts(&mut window);
    window.run_steps(20);
    let height = |window: &Window| window.state().state().view.cameras.crash.height;
    let bare = height(&window);
    for _ in 0..2 {
        color_by(&mut window, ColorBy::Thickness);
        finish(&mut window);
        wait_for(&mut window, "Unfold the legend (crash)");
        window.run_steps(20);
        assert!(height(&window) > bare * 1.02, "the legend covers nothing");
        color_by(&mut window, ColorBy::default());
        window.run_steps(20);
        let now = height(&window);
        assert!((now - bare).abs() < 0.02 * bare, "{now} {bare}");
    }
}

#[test]
fn the_largest_deviations_are_seen_whole_without_scrolling() {
    let mut window = matched();
    click(&mut window, "Deviation");
    finish(&mut window);
    window.run_steps(4);
    let texts = texts(&window);
    for name in ["RMS (compared)", "P95 (compared)", "min", "max"] {
        let mut rows = texts.iter().filter(|text| text.text == name);
        let is_whole = |row: &Painted| {
            row.rect.top() >= row.clip.top() && row.rect.bottom() <= row.clip.bottom()
        };
        assert!(rows.any(is_whole), "{name} is cut");
    }
}

/// The verdict as it is drawn after the match of what is open.
fn verdict_after_match(window: &mut Window) -> Painted {
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Enter);
    window.run_steps(2);
    finish(window);
    window.run_steps(40);
    let is_verdict = |text: &Painted| text.text.ends_with("GOOD") && text.rect.height() > 18.0;
    let mut texts = texts(window).into_iter();
    texts.find(is_verdict).expect("the verdict is drawn")
}

/// A result that comes into sight in a column lower than its card shows its verdict.
#[test]
fn the_verdict_is_seen_where_its_card_is_higher_than_the_column() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    window.set_size(Vec2::new(1000.0, 360.0));
    window.run_steps(4);
    let verdict = verdict_after_match(&mut window);
    assert!(
        verdict.rect.top() >= verdict.clip.top(),
        "the verdict is cut"
    );
}

/// The sections above fold in the frame after the result has come; the verdict stays in sight.
#[test]
fn the_verdict_is_in_sight_once_the_sections_above_have_folded() {
    for height in [540.0, 640.0, 760.0] {
        let mut window = window();
        window.set_size(Vec2::new(1280.0, height));
        click(&mut window, "Open the example pair");
        finish(&mut window);
        let verdict = verdict_after_match(&mut window);
        let column = verdict.clip.expand(0.5).y_range();
        let is_seen = column.contains(verdict.rect.top()) && column.contains(verdict.rect.bottom());
        assert!(is_seen, "{height}: {} of {}", verdict.rect, verdict.clip);
    }
}

/// Every digit of the pose is seen whole, in the usual column and in the narrowest one, which a window of the usual
/// size has with texts of twice the size.
#[test]
fn the_matrix_shows_every_digit_without_scrolling() {
    let mut window = matched();
    window.set_size(Vec2::new(1280.0, 1600.0));
    window.run_steps(4);
    click(&mut window, "Matrix, stamped → crash");
    for width in [1280.0, 800.0] {
        window.set_size(Vec2::new(width, 1600.0));
        window.run_steps(8);
        let pose = *window.state().state().document.crash_from_stamped();
        let texts = texts(&window);
        for value in pose.to_rows()[..3].iter().flatten() {
            let digits = number(*value);
            let is_whole = |text: &Painted| {
                text.text.trim() == digits && text.clip.expand(0.5).contains_rect(text.rect)
            };
            let n_whole = texts.iter().filter(|text| is_whole(text)).count();
            assert!(n_whole > 0, "{width}: {digits}");
        }
    }
}

/// In the narrowest column every figure of the verdict stands beside its name.
#[test]
fn figures_of_the_verdict_take_one_line_each_in_the_smallest_window() {
    let mut window = matched();
    dismiss_toasts(&mut window);
    for (width, name) in [(1400.0, "Overlap ▲ stamped"), (800.0, "Overlap ▲")] {
        window.set_size(Vec2::new(width, 900.0));
        window.run_steps(4);
        let texts = texts(&window);
        let find = |is_it: &dyn Fn(&str) -> bool| {
            let found: Vec<f32> = texts
                .iter()
                .filter(|text| is_it(&text.text))
                .map(|text| text.rect.center().y)
                .collect();
            found
        };
        let name = find(&|text| text == name);
        let values = find(&|text| text.contains(" % within "));
        assert_eq!((name.len(), values.len()), (1, 2), "{width}");
        assert!(
            (name[0] - values[0]).abs() < 3.0,
            "{width}: {name:?} {values:?}"
        );
    }
}

/// The mapping's difference in a small window: what its colours mean, and what lies under the pointer,
/// whole and beside everything else.
#[test]
fn a_small_window_says_what_its_colours_mean_and_what_is_pointed_at() {
    let mut window = matched();
    let map = Action::MapOrCancel.command(window.state().state());
    act(&mut window, map.into_iter().collect());
    finish(&mut window);
    click(&mut window, "Difference");
    finish(&mut window);
    // As it is from the start in a window this small.
    act(&mut window, vec![ViewCommand::FoldColumn(true).into()]);
    for (scale, [width, height]) in [(1.0, [1024.0, 700.0]), (2.0, [1280.0, 720.0])] {
        set(&mut window, Theme::Light, scale);
        window.set_size(Vec2::new(width, height) / scale);
        let place = format!("{width} × {height} at {scale}");
        let begin = Instant::now();
        let is_title = |text: &Painted| text.text.trim().ends_with("thickness");
        while !texts(&window).iter().any(is_title) {
            assert!(
                begin.elapsed() < Duration::from_secs(120),
                "{place}: no legend"
            );
            std::thread::sleep(Duration::from_millis(10));
            window.run_steps(1);
        }
        window.run_steps(20);
        let hovered = point_at_crash_part(&mut window, |rows| {
            rows.iter()
                .any(|row| row.contains("node\u{a0}"))
                .then_some(())
        });
        assert!(hovered.is_some(), "{place}: nothing under the pointer");
        let seen: String = texts(&window).into_iter().map(|text| text.text).collect();
        for word in ["difference", "node", "element"] {
            assert!(seen.contains(word), "{place}: no {word:?}");
        }
        let cube = window
            .query_by_label("View cube (crash)")
            .map(|cube| cube.rect());
        for text in texts(&window) {
            let is_over = cube.is_some_and(|cube| cube.intersects(text.rect));
            assert!(!is_over || text.text.len() == 1, "{place}: {:?}", text.text);
        }
        let found = faults(&window);
        assert!(found.is_empty(), "{place}: {}", found.join("\n"));
    }
}

/// Between the verdict and the tolerance there is little room where everything is large.
#[test]
fn the_tolerance_has_a_name_at_every_scale() {
    let mut window = matched();
    for scale in SCALES {
        set(&mut window, Theme::Light, scale);
        window.set_size(Vec2::new(1600.0, 1000.0) / scale);
        act(&mut window, vec![ViewCommand::FoldColumn(false).into()]);
        window.run_steps(4);
        let names = ["Shape tolerance", "tolerance", "tol."];
        let texts = texts(&window);
        let is_name = |text: &&Painted| names.contains(&&*text.text);
        assert!(texts.iter().any(|text| is_name(&text)), "{scale}");
    }
}

/// The line at the foot of a window and what lies under the pointer.
#[test]
fn a_readout_keeps_off_the_line_at_the_foot() {
    let mut window = matched();
    window.set_size(Vec2::new(1280.0, 720.0));
    let pin = PreviewCommand::Pin(Some(Preview::Start(0)));
    act(&mut window, vec![pin.into()]);
    finish(&mut window);
    dismiss_toasts(&mut window);
    assert!(window.query_by_label("Show the real pose").is_some());
    let hovered = point_at_crash_part(&mut window, |rows| {
        rows.iter()
            .any(|row| row.contains("node\u{a0}"))
            .then_some(())
    });
    assert!(hovered.is_some(), "nothing under the pointer");
    let button = window.get_by_label("Show the real pose").rect();
    for text in texts(&window) {
        let is_readout = ["node", "element"]
            .iter()
            .any(|word| text.text.contains(word));
        let is_over = is_readout && button.expand(4.0).intersects(text.rect);
        assert!(!is_over, "{:?} {} on {button}", text.text, text.rect);
    }
    let found = faults(&window);
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// As the other legends.
#[test]
fn the_legend_of_the_overlap_speaks_of_its_age_only_when_it_is_old() {
    let mut window = matched();
    let action = Action::ToggleOverlap.command(window.state().state());
    act(&mut window, action.into_iter().collect());
    finish(&mut window);
    let says = |window: &Window, words: &str| texts(window).iter().any(|t| t.text == words);
    let begin = Instant::now();
    while !says(&window, "shares of each part's area") {
        assert!(begin.elapsed() < Duration::from_secs(120), "no legend");
        std::thread::sleep(Duration::from_millis(10));
        window.run_steps(1);
    }
    assert!(!says(&window, "up to date"));
}

/// Points at places across the middle of the crash part until something is found in the texts that are painted, each
/// row of them one. What is drawn is worked out in the background.
pub(super) fn point_at_crash_part<T>(
    window: &mut Window,
    find: impl Fn(&[String]) -> Option<T>,
) -> Option<T> {
    let area = window
        .get_by(|node| {
            node.label()
                .is_some_and(|label| label.starts_with("Crash part, "))
        })
        .rect();
    let step = Vec2::new(0.05 * area.width(), 0.0);
    let from = area.center() - 6.0 * step;
    for n in (0..12).cycle().take(1200) {
        window.hover_at(from + n as f32 * step);
        window.run_steps(3);
        let rows: Vec<String> = texts(window).into_iter().map(|row| row.text).collect();
        let found = find(&rows);
        if found.is_some() {
            return found;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    None
}

/// Matched parts in one window, the other one with the deviation and its whole legend.
pub(super) fn with_legend() -> Window {
    let mut window = matched();
    click(&mut window, "Move over");
    finish(&mut window);
    wait_for(&mut window, "Unfold the legend (stamped)");
    click(&mut window, "Unfold the legend (stamped)");
    window.run_steps(4);
    window
}

/// The colours of a window are worked out in the background.
fn wait_for(window: &mut Window, label: &str) {
    let begin = Instant::now();
    while window.query_by_label(label).is_none() {
        assert!(begin.elapsed() < Duration::from_secs(120), "no {label}");
        std::thread::sleep(Duration::from_millis(10));
        window.run_steps(1);
    }
}

/// No point of either part is seen below the legend or the names of a window.
fn covers_nothing(window: &Window, what: &str, role: Role) {
    let state = window.state().state();
    let area = window
        .get_by(|node| {
            let label = node.label();
            label
                .is_some_and(|label| label.starts_with(&format!("{} part, ", capital(role.word()))))
        })
        .rect();
    // A low window has the legend without its button.
    let button = window.query_by(|node| {
        let label = node.label();
        let button = format!("old the legend ({})", role.word());
        label.is_some_and(|label| label.ends_with(&button))
    });
    let button = button.map_or(area.right_top(), |button| button.rect().left_top());
    let both = state.document.both().expect("both parts");
    let pose = state.document.crash_from_stamped();
    let screen = ScreenSize {
        width: f64::from(area.width()),
        height: f64::from(area.height()),
    };
    let stamped = both.stamped.loaded.mesh.positions().iter();
    let points = stamped.map(|point| pose.apply(point));
    let points = points.chain(both.crash.loaded.mesh.positions().iter().copied());
    let seen = points.map(|point| {
        let at = state
            .view
            .cameras
            .crash
            .project(&point, screen)
            .expect("before the eye");
        area.min + Vec2::new(at.x as f32, at.y as f32)
    });
    let seen: Vec<Pos2> = seen.collect();
    let bounds = Rect::from_points(&seen);
    // The part lies beside the legend or below its foot.
    let is_of_legend = |text: &&Painted| {
        let is_behind = text.text == "no graphics adapter";
        area.contains_rect(text.rect) && text.rect.center().x > button.x && !is_behind
    };
    let painted = texts(window);
    let legend = painted.iter().filter(is_of_legend);
    let foot = legend.fold(area.top(), |foot, text| foot.max(text.rect.bottom()));
    let is_under = |at: &&Pos2| at.x >= button.x && at.y <= foot;
    let n_under = seen.iter().filter(is_under).count();
    assert_eq!(n_under, 0, "{what}: {bounds} {button} {foot}");
    let names = if area.height() < 300.0 { 22.0 } else { 50.0 };
    assert!(bounds.top() > area.top() + names, "{what}: {bounds} {area}");
    assert!(
        area.shrink(4.0).contains_rect(bounds),
        "{what}: {bounds} {area}"
    );
    // Nor below any other text that lies over the window.
    for text in texts(window) {
        let is_over = area.contains_rect(text.rect) && text.clip.intersects(area);
        let is_behind = text.text == "no graphics adapter";
        if is_over && !is_behind {
            let covered = seen.iter().filter(|at| text.rect.contains(**at)).count();
            assert_eq!(covered, 0, "{what}: {:?} {}", text.text, text.rect);
        }
    }
    // And it is not needlessly small.
    let fills = (bounds.width() / area.width()).max(bounds.height() / area.height());
    let least = if area.height() < 300.0 { 0.35 } else { 0.55 };
    assert!(fills > least, "{what}: {bounds} {area}");
}

/// That a deviation is out of date is said where it moves neither the fields nor the bar.
#[test]
fn the_legend_stays_in_place_while_the_deviation_is_measured_again() {
    let mut window = with_legend();
    let role = egui::accesskit::Role::SpinButton;
    let field = |window: &Window| {
        let field = window.get_by_role_and_label(role, "Upper limit (stamped)");
        field.rect().top()
    };
    let at = field(&window);
    assert!(window.query_by_label("up to date").is_some());
    let mut crash_from_stamped = *window.state().state().document.crash_from_stamped();
    crash_from_stamped.translation.x += 1.0;
    let name = "by hand".to_owned();
    let moved = MoveCommand::SetPose {
        crash_from_stamped,
        name,
    };
    let ctx = window.ctx.clone();
    window.state_mut().run_commands(vec![moved.into()], &ctx);
    // While it is measured and after it.
    window.run_steps(1);
    assert_eq!(field(&window), at);
    finish(&mut window);
    window.run_steps(4);
    assert_eq!(field(&window), at);
    assert!(window.query_by_label("up to date").is_some());
}

#[test]
fn the_legend_says_whose_colours_and_whose_numbers_it_shows() {
    let mut window = window();
    for button in ["Open the example pair", "Reduce", "Match the parts"] {
        click(&mut window, button);
        finish(&mut window);
    }
    click(&mut window, "Move over");
    finish(&mut window);
    let deviation = Action::ToggleDeviation.command(window.state().state());
    act(&mut window, deviation.into_iter().collect());
    finish(&mut window);
    wait_for(&mut window, "Unfold the legend (crash)");
    let n_saying = |window: &Window, words: &str| window.query_all_by_label(words).count();
    assert!(n_saying(&window, "reduced part") > 0);
    click(&mut window, "Unfold the legend (crash)");
    window.run_steps(4);
    let words = "colours of the reduced part,\nnumbers of the full one";
    assert_eq!(n_saying(&window, words), 1);
    click(&mut window, "Detailed");
    finish(&mut window);
    window.run_steps(4);
    assert_eq!(n_saying(&window, words), 0);
}
