//! Small pieces of HTML. Every text that is laid into a template is escaped by it.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use maud::{Markup, PreEscaped, html};

/// Text from outside without control characters, which HTML does not allow at all.
pub fn printable(text: &str) -> String {
    let is_allowed = |c: char| !c.is_control() || c == '\n' || c == '\t';
    let letters = text.chars();
    letters
        .map(|c| if is_allowed(c) { c } else { '\u{fffd}' })
        .collect()
}

/// A whole page: head with the style, what is inside the body, and the script that adds buttons to it.
pub fn document(title: &Markup, build: &str, body: &Markup) -> String {
    let page = html! {
        (PreEscaped("<!DOCTYPE html>\n"))
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="generator" content=(build);
                title { (title) }
                style { (PreEscaped(include_str!("style.css"))) }
            }
            body {
                (body)
                script { (PreEscaped(include_str!("script.js"))) }
            }
        }
        "\n"
    };
    page.into_string()
}

/// A PNG inside the page.
pub fn image(png: &[u8], [width, height]: [usize; 2], alt: &str) -> Markup {
    let source = format!("data:image/png;base64,{}", STANDARD.encode(png));
    html! { img src=(source) width=(width) height=(height) alt=(printable(alt)); }
}

/// A fixed-width text with a button to copy it, which the script adds.
pub fn block(name: &str, text: &str, wraps: bool) -> Markup {
    html! {
        div.block data-name=(printable(name)) {
            pre class=[wraps.then_some("wrap")] tabindex="0" { (printable(text.trim_end())) }
        }
    }
}

/// A block that is folded away.
pub fn folded(title: &str, text: &str) -> Markup {
    html! { details { summary { (title) } (block(title, text, false)) } }
}

/// A part of the page with a heading that links lead to.
pub fn section(id: &str, title: &str, content: &Markup) -> Markup {
    html! {
        section aria-labelledby=(id) { h2 id=(id) { (title) } (content) }
        "\n"
    }
}

/// A column of a table.
#[derive(Debug, Clone, Copy)]
pub struct Column {
    title: &'static str,
    class: Option<&'static str>,
}

impl Column {
    /// Words, to the left.
    pub const fn text(title: &'static str) -> Self {
        Self { title, class: None }
    }

    /// Numbers, to the right.
    pub const fn number(title: &'static str) -> Self {
        let class = Some("n");
        Self { title, class }
    }

    /// Small pictures.
    pub const fn picture(title: &'static str) -> Self {
        let class = Some("thumb");
        Self { title, class }
    }
}

/// Rows of a name and a value.
pub fn fact_table(caption: &str, rows: &[(&str, Markup)]) -> Markup {
    html! {
        table {
            caption { (caption) }
            tbody {
                @for (name, value) in rows {
                    tr { th scope="row" { (name) } td { (value) } }
                }
            }
        }
    }
}

/// A table with a head; the first cell of each row is its heading.
pub fn table(caption: &str, columns: &[Column], rows: &[Vec<Markup>]) -> Markup {
    html! {
        div.scroll role="region" aria-label=(caption) tabindex="0" {
            table {
                caption { (caption) }
                thead {
                    tr {
                        @for column in columns {
                            th scope="col" class=[column.class] { (column.title) }
                        }
                    }
                }
                tbody {
                    @for row in rows {
                        tr {
                            @for (i, (cell, column)) in row.iter().zip(columns).enumerate() {
                                @if i == 0 {
                                    th scope="row" class=[column.class] { (cell) }
                                } @else {
                                    td class=[column.class] { (cell) }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// A text as a cell or a value.
pub fn cell(text: impl AsRef<str>) -> Markup {
    html! { (text.as_ref()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_from_a_file_becomes_markup() {
        let text = block("\"<i>", "<b a='x'>&</pre>\u{1}", true).into_string();
        let expected = "<div class=\"block\" data-name=\"&quot;&lt;i&gt;\">\
                        <pre class=\"wrap\" tabindex=\"0\">\
                        &lt;b a='x'&gt;&amp;&lt;/pre&gt;\u{fffd}</pre></div>";
        assert_eq!(text, expected);
    }
}
