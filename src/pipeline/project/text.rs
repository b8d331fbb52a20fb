//! The text of a project: fields line by line, lists of numbers in one line.

use std::io;

use serde::Serialize;
use serde_json::Value;
use serde_json::ser::{Formatter, Serializer};

/// A value as text with a line for each field. Paths that are no Unicode text have none.
pub(super) fn pretty(value: &impl Serialize) -> serde_json::Result<String> {
    let mut bytes = Vec::new();
    let mut serializer = Serializer::with_formatter(&mut bytes, Lines::default());
    value.serialize(&mut serializer)?;
    bytes.push(b'\n');
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

#[derive(Default)]
struct Lines {
    depth: usize,
    has_fields: bool,
}

impl Lines {
    fn new_line<W: ?Sized + io::Write>(&self, writer: &mut W) -> io::Result<()> {
        writer.write_all(b"\n")?;
        (0..self.depth).try_for_each(|_| writer.write_all(b"  "))
    }
}

impl Formatter for Lines {
    fn begin_array_value<W: ?Sized + io::Write>(
        &mut self,
        writer: &mut W,
        first: bool,
    ) -> io::Result<()> {
        writer.write_all(if first { b"" } else { b", " })
    }

    fn begin_object<W: ?Sized + io::Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.depth += 1;
        self.has_fields = false;
        writer.write_all(b"{")
    }

    fn begin_object_key<W: ?Sized + io::Write>(
        &mut self,
        writer: &mut W,
        first: bool,
    ) -> io::Result<()> {
        writer.write_all(if first { b"" } else { b"," })?;
        self.new_line(writer)
    }

    fn begin_object_value<W: ?Sized + io::Write>(&mut self, writer: &mut W) -> io::Result<()> {
        writer.write_all(b": ")
    }

    fn end_object_value<W: ?Sized + io::Write>(&mut self, _writer: &mut W) -> io::Result<()> {
        self.has_fields = true;
        Ok(())
    }

    fn end_object<W: ?Sized + io::Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.depth -= 1;
        if self.has_fields {
            self.new_line(writer)?;
        }
        writer.write_all(b"}")
    }
}

/// Notes each field of `read` that `known`, the same value written again, does not have.
pub(super) fn tell_unknown(read: &Value, known: &Value, place: &str, notes: &mut Vec<String>) {
    match (read, known) {
        (Value::Object(read), Value::Object(known)) => {
            for (name, value) in read {
                let place = format!("{place}.{name}");
                match known.get(name) {
                    Some(known) => tell_unknown(value, known, &place, notes),
                    None if value.is_null() => {}
                    None => notes.push(format!("the field {place:?} is not known; it is left out")),
                }
            }
        }
        (Value::Array(read), Value::Array(known)) => {
            for (index, (read, known)) in read.iter().zip(known).enumerate() {
                tell_unknown(read, known, &format!("{place}[{index}]"), notes);
            }
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn fields_have_lines_and_lists_have_one() {
        let value = json!({"a": [1.5, [2, 3]], "b": {}, "c": [{"d": null}]});
        let text =
            "{\n  \"a\": [1.5, [2, 3]],\n  \"b\": {},\n  \"c\": [{\n    \"d\": null\n  }]\n}\n";
        assert_eq!(pretty(&value).unwrap(), text);
    }

    #[test]
    fn unknown_fields_are_told_with_their_place() {
        let (read, known) = (
            json!({"a": [{"b": 1, "c": 2}], "d": null}),
            json!({"a": [{"b": 1}]}),
        );
        let mut notes = Vec::new();
        tell_unknown(&read, &known, "recipe", &mut notes);
        assert_eq!(
            notes,
            ["the field \"recipe.a[0].c\" is not known; it is left out"]
        );
    }
}
