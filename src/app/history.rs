use super::Document;

/// Undo steps that are kept; an old document costs little, but not nothing.
const MAX_STEPS: usize = 500;

/// Names a drag, a typed value or another series of commands that is undone as one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct GestureId(pub u64);

#[derive(Debug, Clone)]
struct Step {
    name: String,
    /// For a step that was done: the document before. For one that was undone: the one after.
    document: Document,
}

/// One ordered history of whole documents.
#[derive(Debug, Clone, Default)]
pub struct History {
    done: Vec<Step>,
    undone: Vec<Step>,
    open_gesture: Option<GestureId>,
}

impl History {
    /// Notes a step that led away from `before`. Further steps of the same gesture only rename it.
    pub fn push(&mut self, name: String, before: Document, gesture: Option<GestureId>) {
        self.undone.clear();
        if gesture.is_some()
            && gesture == self.open_gesture
            && let Some(last) = self.done.last_mut()
        {
            last.name = name;
            return;
        }
        self.open_gesture = gesture;
        if self.done.len() == MAX_STEPS {
            self.done.remove(0);
        }
        let document = before;
        self.done.push(Step { name, document });
    }

    /// True while the last step is that of this gesture and may still change.
    pub fn is_open(&self, gesture: GestureId) -> bool {
        self.open_gesture == Some(gesture)
    }

    /// Ends the open gesture; one that came back to where it began leaves no step.
    pub fn end_gesture(&mut self, current: &Document) {
        if self.open_gesture.take().is_some() {
            let is_idle = self.done.last().is_some_and(|s| s.document == *current);
            if is_idle {
                self.done.pop();
            }
        }
    }

    /// Takes the open gesture back: the document it began with, without a trace to redo.
    pub fn abandon_gesture(&mut self, gesture: GestureId) -> Option<Document> {
        if self.open_gesture != Some(gesture) {
            return None;
        }
        self.open_gesture = None;
        self.done.pop().map(|step| step.document)
    }

    /// Steps back: the name of the step and the document before it.
    pub fn undo(&mut self, current: Document) -> Option<(String, Document)> {
        self.open_gesture = None;
        shift(&mut self.done, &mut self.undone, current)
    }

    /// Steps forward again.
    pub fn redo(&mut self, current: Document) -> Option<(String, Document)> {
        self.open_gesture = None;
        shift(&mut self.undone, &mut self.done, current)
    }

    /// Name of the step that undo takes back.
    pub fn undo_name(&self) -> Option<&str> {
        self.done.last().map(|s| s.name.as_str())
    }

    /// Name of the step that redo brings back.
    pub fn redo_name(&self) -> Option<&str> {
        self.undone.last().map(|s| s.name.as_str())
    }

    /// All steps, oldest first; those from [`History::n_done`] on are undone.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        let undone = self.undone.iter().rev();
        self.done.iter().chain(undone).map(|s| s.name.as_str())
    }

    /// Steps that are in force.
    pub fn n_done(&self) -> usize {
        self.done.len()
    }

    /// Steps that can be brought back.
    pub fn n_undone(&self) -> usize {
        self.undone.len()
    }
}

fn shift(
    from: &mut Vec<Step>,
    to: &mut Vec<Step>,
    current: Document,
) -> Option<(String, Document)> {
    let step = from.pop()?;
    let name = step.name.clone();
    to.push(Step {
        name: step.name,
        document: current,
    });
    Some((name, step.document))
}
