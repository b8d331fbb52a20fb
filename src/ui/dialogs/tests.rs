//! Questions before files are replaced and folders are made, and the keys they have for themselves.

use super::*;
use crate::pipeline::map::WriteKind;
use crate::pipeline::outputs::MeshOutput;
use crate::pipeline::project::EXTENSION;
use crate::ui::keyboard::{KeyOwner, Keyboard};

#[test]
fn a_file_is_replaced_only_after_a_question() {
    let folder = tempfile::tempdir().unwrap();
    let taken = folder.path().join("a.txt");
    std::fs::write(&taken, "old").unwrap();
    let ctx = egui::Context::default();
    let mut dialogs = Dialogs::default();
    let question = || Question::Save {
        kind: Output::Log,
        path: "log.txt".into(),
        inputs: Vec::new(),
    };
    let mut answer = |typed: &str| {
        dialogs.check(question(), folder.path().join(typed), false, &ctx);
        for _ in 0..500 {
            let commands = dialogs.answers(&ctx);
            if !commands.is_empty() || dialogs.overwrite.is_some() {
                return (
                    commands.len(),
                    dialogs.overwrite.take().map(|(_, path, _)| path),
                );
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        panic!("no answer");
    };
    assert_eq!(answer("b"), (1, None));
    // The ending is added before the question, not after it.
    assert_eq!(answer("a"), (0, Some(taken)));
}

#[test]
fn a_file_that_is_read_is_told_in_the_field_and_the_path_stays() {
    let folder = tempfile::tempdir().unwrap();
    let crash = folder.path().join("crash.k");
    std::fs::write(&crash, "old").unwrap();
    let ctx = egui::Context::default();
    let mut dialogs = Dialogs::default();
    let question = Question::Save {
        kind: Output::Mapped(WriteKind::Deck),
        path: folder.path().join("mapped.k"),
        inputs: vec![crash.clone()],
    };
    dialogs.check(question, crash.clone(), false, &ctx);
    assert!(wait(&mut dialogs, &ctx).is_empty());
    assert!(
        dialogs.overwrite.is_none(),
        "no question that ends in a refusal"
    );
    let prompt = dialogs.prompt.unwrap();
    assert_eq!(prompt.text, crash.display().to_string());
    let note = prompt.note.unwrap();
    assert!(note.starts_with("crash.k is one of the files"), "{note}");
}

#[test]
fn a_project_is_asked_for_under_the_name_that_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let taken = folder.path().join("door.v2.shapematch");
    std::fs::write(&taken, "old").unwrap();
    let ctx = egui::Context::default();
    let mut dialogs = Dialogs::default();
    let question = || Question::SaveProject(PathBuf::new());
    let typed = folder.path().join("door.v2");
    dialogs.check(question(), typed, false, &ctx);
    assert!(wait(&mut dialogs, &ctx).is_empty());
    let asked = dialogs.overwrite.take().map(|(_, path, _)| path);
    assert_eq!(asked, Some(taken.clone()));
    // The ending is known in any case of its letters.
    let same = taken.with_extension("ShapeMatch");
    assert_eq!(question().with_ending(same.clone()), same);
}

#[test]
fn a_question_that_is_not_asked_is_answered_as_a_closed_one() {
    let ctx = egui::Context::default();
    let mut dialogs = Dialogs {
        is_asking: true,
        ..Dialogs::default()
    };
    dialogs.ask_save_project(PathBuf::from("work.shapematch"), &ctx);
    let [command] = dialogs.answers(&ctx).try_into().unwrap();
    let is_meant = matches!(command, Command::Project(ProjectCommand::NotWritten));
    assert!(is_meant, "{command:?}");
    assert!(dialogs.answers(&ctx).is_empty(), "once");
}

/// Waits for the answer of a thread and gives the commands that follow.
fn wait(dialogs: &mut Dialogs, ctx: &egui::Context) -> Vec<Command> {
    for _ in 0..500 {
        let commands = dialogs.answers(ctx);
        if !commands.is_empty() || dialogs.is_open() {
            return commands;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    panic!("no answer");
}

#[test]
fn a_folder_is_made_only_when_that_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let ctx = egui::Context::default();
    let mut dialogs = Dialogs::default();
    let question = Question::SaveProject(PathBuf::new());
    let path = folder.path().join("new/deep/work");
    dialogs.check(question.clone(), path.clone(), false, &ctx);
    assert!(wait(&mut dialogs, &ctx).is_empty());
    let prompt = dialogs.prompt.take().unwrap();
    assert_eq!(prompt.missing, Some(folder.path().join("new/deep")));
    assert!(prompt.note.unwrap().ends_with("does not exist."));
    assert!(!folder.path().join("new").exists());
    dialogs.check(question, path.clone(), true, &ctx);
    let [command] = wait(&mut dialogs, &ctx).try_into().unwrap();
    let written = path.with_extension(EXTENSION);
    let is_meant = matches!(command, Command::Project(ProjectCommand::Write(at)) if at == written);
    assert!(is_meant);
    assert!(folder.path().join("new/deep").is_dir());
    // What is to be read has to be there.
    let none = folder.path().join("none.k");
    dialogs.check(Question::Open(Role::Crash), none, false, &ctx);
    assert!(wait(&mut dialogs, &ctx).is_empty());
    assert_eq!(dialogs.prompt.take().unwrap().missing, None);
    let question = Question::Open(Role::Crash);
    dialogs.check(question, folder.path().to_owned(), false, &ctx);
    assert!(wait(&mut dialogs, &ctx).is_empty());
    let prompt = dialogs.prompt.unwrap();
    assert!(prompt.note.unwrap().ends_with("is a folder."));
    assert_eq!(prompt.text, folder.path().display().to_string());
}

#[test]
fn a_question_has_the_keys_for_itself() {
    let ctx = egui::Context::default();
    let mut dialogs = Dialogs::default();
    let keyboard = Keyboard::default();
    assert_eq!(keyboard.owner(&ctx, dialogs.is_open()), KeyOwner::Window);
    dialogs.prompt = Some(Prompt::new(Question::OpenProject, String::new()));
    assert_eq!(keyboard.owner(&ctx, dialogs.is_open()), KeyOwner::Question);
}

#[test]
fn a_dropped_file_answers_the_question_for_a_file_to_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("other.k");
    std::fs::write(&path, "*KEYWORD").unwrap();
    let ctx = egui::Context::default();
    let mut dialogs = Dialogs::default();
    // Nothing is asked for, or where to write: the file is opened as ever.
    assert!(!dialogs.take_dropped(&path, &ctx));
    let save = Question::SaveProject(PathBuf::new());
    dialogs.prompt = Some(Prompt::new(save, String::new()));
    assert!(!dialogs.take_dropped(&path, &ctx) && dialogs.is_open());
    dialogs.prompt = Some(Prompt::new(Question::OtherMapping, String::new()));
    assert!(dialogs.take_dropped(&path, &ctx));
    let [command] = wait(&mut dialogs, &ctx).try_into().unwrap();
    let is_meant = matches!(command, Command::Map(MapCommand::CompareWith(at)) if at == path);
    assert!(is_meant && !dialogs.is_open());
}

#[test]
fn a_question_darkens_the_window_unless_a_processor_draws_it() {
    let whole = egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(1000.0, 700.0));
    for is_on_processor in [false, true] {
        let question = Question::Save {
            kind: Output::Log,
            path: "log.txt".into(),
            inputs: Vec::new(),
        };
        let path = PathBuf::from("/parts/log.txt");
        let mut dialogs = Dialogs {
            overwrite: Some((question, path.clone(), path)),
            ..Dialogs::default()
        };
        let ctx = egui::Context::default();
        let input = || egui::RawInput {
            screen_rect: Some(whole),
            ..egui::RawInput::default()
        };
        let mut frame = || {
            let mut output = ctx.run_ui(input(), |ui| {
                dialogs.show(ui.ctx(), is_on_processor, &mut Vec::new());
            });
            output.textures_delta.clear();
            output
        };
        // The first frame measures.
        frame();
        let output = frame();
        let is_dark = output.shapes.iter().any(|clipped| {
            matches!(&clipped.shape, egui::Shape::Rect(rect)
                if rect.rect.contains_rect(whole) && rect.fill != egui::Color32::TRANSPARENT)
        });
        assert_eq!(is_dark, !is_on_processor);
        assert!(dialogs.is_open());
    }
}

#[test]
fn typing_goes_on_after_a_completed_path() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("parts")).unwrap();
    let end = std::path::MAIN_SEPARATOR;
    let whole = format!("{}{end}parts{end}", folder.path().display());
    let typed = format!("{}{end}pa", folder.path().display());
    let ctx = egui::Context::default();
    let mut dialogs = Dialogs {
        prompt: Some(Prompt::new(Question::OpenProject, String::new())),
        ..Dialogs::default()
    };
    let frame = |dialogs: &mut Dialogs, events: Vec<egui::Event>| {
        let input = egui::RawInput {
            events,
            ..egui::RawInput::default()
        };
        let mut output = ctx.run_ui(input, |ui| {
            dialogs.answers(ui.ctx());
            dialogs.show(ui.ctx(), false, &mut Vec::new());
        });
        output.textures_delta.clear();
        dialogs.prompt.as_ref().unwrap().text.clone()
    };
    let tab = egui::Event::Key {
        key: egui::Key::Tab,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers: egui::Modifiers::NONE,
    };
    for _ in 0..3 {
        frame(&mut dialogs, Vec::new());
    }
    assert_eq!(
        frame(&mut dialogs, vec![egui::Event::Text(typed.clone())]),
        typed
    );
    frame(&mut dialogs, vec![tab]);
    for _ in 0..500 {
        if frame(&mut dialogs, Vec::new()) == whole {
            break;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    let door = egui::Event::Text("door.shapematch".to_owned());
    let text = frame(&mut dialogs, vec![door]);
    assert_eq!(text, format!("{whole}door.shapematch"));
}

#[test]
fn the_title_says_what_is_saved() {
    let question = |kind| Question::Save {
        kind,
        path: "door".into(),
        inputs: Vec::new(),
    };
    assert_eq!(titles(&question(Output::Report)).0, "Save: Report as HTML");
    let moved = Output::Mesh(MeshOutput::Moved);
    assert_eq!(titles(&question(moved)).0, "Save: Stamped part, moved");
}
