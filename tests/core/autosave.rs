//! Sessions that are saved as one goes, and offered again after a crash.

use std::path::{Path, PathBuf};
use std::time::Duration;

use shapematch::pipeline::autosave::{Autosave, AutosaveEvent, RecoveredSession};
use shapematch::pipeline::preferences::PreferencesFile;
use shapematch::pipeline::project::{PartEntry, Project};
use shapematch::role::PerRole;

const LONG: Duration = Duration::from_secs(60);

fn project(name: &str) -> Box<Project> {
    let entry = PartEntry {
        file: Some(PathBuf::from(name)),
        ..PartEntry::default()
    };
    Box::new(Project {
        parts: PerRole::new(Some(entry), None),
        ..Project::default()
    })
}

fn run(folder: &Path, name: &str) -> Autosave<u8> {
    Autosave::start_named(folder.to_owned(), name, || {}).unwrap()
}

fn sessions(of: &Autosave<u8>) -> Vec<RecoveredSession> {
    match of.wait_for_event(LONG) {
        Some(AutosaveEvent::Sessions(sessions)) => sessions,
        other => panic!("{other:?}"),
    }
}

fn listed(of: &Autosave<u8>) -> Vec<RecoveredSession> {
    of.list();
    sessions(of)
}

/// What a killed program leaves behind: its file without a lock that is held.
fn leave_lost(folder: &Path, name: &str, part: &str) {
    std::fs::create_dir_all(folder).unwrap();
    let path = folder.join(format!("{name}.run.shapematch"));
    let mut project = project(part);
    project.saved_at = 1;
    project.write(&path).unwrap();
    std::fs::write(path.with_extension("lock"), "").unwrap();
}

#[test]
fn a_session_that_did_not_end_is_offered_until_it_is_dismissed() {
    let folder = tempfile::tempdir().unwrap();
    let deep = folder.path().join("deep");
    leave_lost(&deep, "000000000001-1", "/a/lost.k");
    let next = run(&deep, "000000000002-1");
    let found = listed(&next);
    assert_eq!(found.len(), 1);
    assert!(found[0].is_lost && found[0].saved_at == 1);
    assert_eq!(found[0].title, "lost.k");
    next.dismiss_recovery();
    let found = sessions(&next);
    assert_eq!(found, listed(&next));
    assert_eq!((found.len(), found[0].is_lost), (1, false));

    next.autosave(project("/a/ended.k"));
    drop(next);
    let found = listed(&run(&deep, "000000000003-1"));
    assert_eq!(found.iter().filter(|session| session.is_lost).count(), 0);
    assert_eq!(found[0].title, "ended.k");
}

#[test]
fn a_session_that_was_saved_is_offered_only_after_another_step() {
    let folder = tempfile::tempdir().unwrap();
    let kept = folder.path().join("kept");
    let of = run(&kept, "000000000001-1");
    let is_running = || kept.join("000000000001-1.run.shapematch").exists();
    of.autosave(project("/a/b.k"));
    let path = folder.path().join("saved.shapematch");
    of.save(path, None, project("/a/b.k"), 7);
    let event = of.wait_for_event(LONG);
    assert!(
        matches!(event, Some(AutosaveEvent::Saved(_, _, 7))),
        "{event:?}"
    );
    // As far as others see, its program may be killed now.
    assert!(!is_running());
    let found = listed(&run(&kept, "000000000002-1"));
    assert!(!found.iter().any(|session| session.is_lost), "{found:?}");
    assert_eq!(listed(&of), [], "it is not another run");
    of.autosave(project("/a/b.k"));
    assert_eq!(listed(&of), []);
    assert!(is_running());
}

#[test]
fn a_session_whose_program_still_runs_is_not_offered_and_looked_at_again() {
    let folder = tempfile::tempdir().unwrap();
    leave_lost(folder.path(), "000000000001-1", "/a/lost.k");
    let lock = folder.path().join("000000000001-1.run.lock");
    let held = std::fs::File::open(lock).unwrap();
    held.try_lock().unwrap();
    let next = run(folder.path(), "000000000002-1");
    assert_eq!(listed(&next), []);
    drop(held);
    assert!(sessions(&next)[0].is_lost, "without being asked again");
}

#[test]
fn only_the_last_five_sessions_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    for n in 0..9 {
        let of = run(folder.path(), &format!("{n:012}-1"));
        of.autosave(project(&format!("/{n}.k")));
    }
    let found = listed(&run(folder.path(), "last"));
    let titles: Vec<&str> = found.iter().map(|session| &*session.title).collect();
    assert_eq!(titles, ["8.k", "7.k", "6.k", "5.k", "4.k"]);
}

#[test]
fn of_many_autosaves_the_last_counts() {
    let folder = tempfile::tempdir().unwrap();
    let of = run(folder.path(), "000000000001-1");
    for n in 0..20 {
        of.autosave(project(&format!("/{n}.k")));
    }
    drop(of);
    let found = listed(&run(folder.path(), "000000000002-1"));
    assert_eq!(found.len(), 1);
    assert_eq!((found[0].title.as_str(), found[0].is_lost), ("19.k", false));
}

#[test]
fn a_project_is_never_saved_over_one_of_its_parts() {
    let folder = tempfile::tempdir().unwrap();
    let deck = folder.path().join("deck.shapematch");
    std::fs::write(&deck, "*KEYWORD\n*END\n").unwrap();
    let of = run(&folder.path().join("kept"), "000000000001-1");
    of.save(deck.clone(), None, project(deck.to_str().unwrap()), 7);
    let event = of.wait_for_event(LONG);
    assert!(
        matches!(&event, Some(AutosaveEvent::SaveFailed(reason)) if reason.contains("overwrite")),
        "{event:?}"
    );
    assert_eq!(std::fs::read(&deck).unwrap(), b"*KEYWORD\n*END\n");
    let beside = folder.path().join("beside.shapematch");
    of.save(beside.clone(), None, project(deck.to_str().unwrap()), 7);
    let event = of.wait_for_event(LONG);
    assert!(matches!(event, Some(AutosaveEvent::Saved(path, _, 7)) if path == beside));
}

/// Two windows with one project: the second one to save is told, and what the first saved stays.
#[test]
fn a_project_that_another_window_saved_is_not_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("work.shapematch");
    let titled = |name: &str, saved_at| {
        let mut project = project(name);
        project.saved_at = saved_at;
        project
    };
    titled("/opened.k", 1000).write(&path).unwrap();
    let [first, second] = ["1", "2"].map(|n| run(&folder.path().join("kept"), n));
    let title = || Project::read(&path).unwrap().0.title();
    // As often as it likes, a window writes over what it opened or saved itself.
    for name in ["/one.k", "/two.k"] {
        first.save(path.clone(), Some(1000), project(name), 7);
        let event = first.wait_for_event(LONG);
        assert!(matches!(event, Some(AutosaveEvent::Saved(..))), "{event:?}");
    }
    second.save(path.clone(), Some(1000), project("/other.k"), 7);
    let event = second.wait_for_event(LONG);
    assert!(
        matches!(&event, Some(AutosaveEvent::SavedElsewhere(reason)) if reason.contains("another window")),
        "{event:?}"
    );
    assert_eq!(title(), "two.k");
    // Where the dialog has asked, it does.
    second.save(path.clone(), None, project("/other.k"), 7);
    let event = second.wait_for_event(LONG);
    assert!(matches!(event, Some(AutosaveEvent::Saved(..))), "{event:?}");
    assert_eq!(title(), "other.k");
    // A file that is gone is written anew.
    std::fs::remove_file(&path).unwrap();
    first.save(path.clone(), Some(1000), project("/two.k"), 7);
    let event = first.wait_for_event(LONG);
    assert!(matches!(event, Some(AutosaveEvent::Saved(..))), "{event:?}");
}

/// What a later version saved may hold work, and so may a file that something has damaged.
#[test]
fn a_project_that_cannot_be_read_is_written_over_only_where_the_dialog_has_asked() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("work.shapematch");
    let window = run(&folder.path().join("kept"), "1");
    let save = |replaces| {
        window.save(path.clone(), replaces, project("/one.k"), 7);
        window.wait_for_event(LONG)
    };
    let event = save(Some(1000));
    assert!(matches!(event, Some(AutosaveEvent::Saved(..))), "{event:?}");
    let whole = std::fs::read_to_string(&path).unwrap();
    let (schema, later) = ("shapematch.project/", "shapematch.project/9");
    assert!(whole.contains(schema), "{whole}");
    for (text, says) in [
        (whole.replace(schema, later), "a newer version"),
        (whole[..whole.len() / 2].to_owned(), "cannot be read"),
        ("*KEYWORD\n*END\n".to_owned(), "cannot be read"),
    ] {
        std::fs::write(&path, &text).unwrap();
        let event = save(Some(1000));
        assert!(
            matches!(&event, Some(AutosaveEvent::SaveFailed(reason)) if reason.contains(says)),
            "{event:?}"
        );
        assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
        let event = save(None);
        assert!(matches!(event, Some(AutosaveEvent::Saved(..))), "{event:?}");
    }
    // An empty file holds nothing.
    std::fs::write(&path, "").unwrap();
    let event = save(Some(1000));
    assert!(matches!(event, Some(AutosaveEvent::Saved(..))), "{event:?}");
}

#[test]
fn preferences_come_back_and_rubbish_is_as_none() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("deep/settings.json");
    let mut file = PreferencesFile::at(&path);
    assert!(file.read::<Vec<u8>>().is_empty());
    file.write(&vec![1, 2]).unwrap();
    assert_eq!(file.read::<Vec<u8>>(), [1, 2]);
    std::fs::write(&path, "{ not json").unwrap();
    assert!(file.read::<Vec<u8>>().is_empty());
    PreferencesFile::none().write(&0).unwrap();
}

#[test]
fn programs_that_run_at_once_keep_what_the_others_prefer() {
    #[derive(Debug, Clone, PartialEq, Default, serde::Serialize, serde::Deserialize)]
    #[serde(default)]
    struct Wishes {
        theme: String,
        sizes: [Option<f32>; 2],
        recent: Vec<String>,
        opened: std::collections::BTreeMap<String, u64>,
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("settings.json");
    let [mut one, mut other] = [(), ()].map(|()| PreferencesFile::at(&path));
    let [mut first, mut second]: [Wishes; 2] = [one.read(), other.read()];
    first.theme = "light".to_owned();
    first.recent = vec!["a.k".to_owned(), "b.k".to_owned()];
    first.opened.insert("a.k".to_owned(), 1);
    one.write(&first).unwrap();
    second.sizes = [None, Some(200.0)];
    second.recent = vec!["c.k".to_owned()];
    second.opened.insert("c.k".to_owned(), 2);
    other.write(&second).unwrap();
    // The first ends, with nothing new to say.
    one.write(&first).unwrap();
    let both: Wishes = PreferencesFile::at(&path).read();
    assert_eq!(both.theme, "light");
    assert_eq!(both.sizes, second.sizes);
    assert_eq!(both.recent, ["c.k", "a.k", "b.k"]);
    assert_eq!(both.opened.len(), 2);
    // What one of them forgets is forgotten, and what it changes again holds.
    second.opened.clear();
    second.sizes = [None; 2];
    other.write(&second).unwrap();
    let both: Wishes = PreferencesFile::at(&path).read();
    assert_eq!(both.opened.into_keys().collect::<Vec<_>>(), ["a.k"]);
    assert_eq!(both.sizes, [None; 2]);
}
