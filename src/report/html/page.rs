//! Small pieces of HTML.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

/// Text that came from outside, safe between tags and in quoted attributes.
pub fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => safe += "&amp;",
            '<' => safe += "&lt;",
            '>' => safe += "&gt;",
            '"' => safe += "&quot;",
            '\'' => safe += "&#39;",
            // Control characters are not allowed in HTML at all.
            c if c.is_control() && c != '\n' && c != '\t' => safe.push('\u{fffd}'),
            c => safe.push(c),
        }
    }
    safe
}

/// A PNG inside the page.
pub fn image(png: &[u8], [width, height]: [usize; 2], alt: &str) -> String {
    let (data, alt) = (STANDARD.encode(png), escaped(alt));
    format!(
        "<img src=\"data:image/png;base64,{data}\" width=\"{width}\" height=\"{height}\" alt=\"{alt}\">"
    )
}

/// A fixed-width text with a button to copy it, which the script adds.
pub fn block(name: &str, text: &str, wraps: bool) -> String {
    let class = if wraps { " class=\"wrap\"" } else { "" };
    let (name, text) = (escaped(name), escaped(text.trim_end()));
    format!(
        "<div class=\"block\" data-name=\"{name}\"><pre{class} tabindex=\"0\">{text}</pre></div>\n"
    )
}

/// A block that is folded away.
pub fn folded(title: &str, text: &str) -> String {
    let summary = escaped(title);
    let block = block(title, text, false);
    format!("<details><summary>{summary}</summary>{block}</details>\n")
}

/// A heading with an anchor.
pub fn section(id: &str, title: &str, content: &str) -> String {
    format!(
        "<section aria-labelledby=\"{id}\">\n<h2 id=\"{id}\">{title}</h2>\n{content}</section>\n"
    )
}

/// Rows of a name and a value; the values are HTML already.
pub fn fact_table(caption: &str, rows: &[(&str, String)]) -> String {
    let mut table = format!("<table><caption>{}</caption><tbody>\n", escaped(caption));
    for (name, value) in rows {
        table += &format!(
            "<tr><th scope=\"row\">{}</th><td>{value}</td></tr>\n",
            escaped(name)
        );
    }
    table + "</tbody></table>\n"
}

/// A table with a head. Columns whose title ends in `#` hold numbers. Cells are HTML already; the first of
/// each row is its heading.
pub fn table(caption: &str, columns: &[&str], rows: &[Vec<String>]) -> String {
    let class = |column: &str| {
        if column.ends_with('#') {
            " class=\"n\""
        } else {
            ""
        }
    };
    let mut text = format!(
        "<div class=\"scroll\" role=\"region\" aria-label=\"{0}\" tabindex=\"0\"><table><caption>{0}</caption><thead><tr>",
        escaped(caption)
    );
    for column in columns {
        let (class, title) = (class(column), escaped(column.trim_end_matches('#')));
        text += &format!("<th scope=\"col\"{class}>{title}</th>");
    }
    text += "</tr></thead><tbody>\n";
    for row in rows {
        text += "<tr>";
        for (i, (cell, column)) in row.iter().zip(columns).enumerate() {
            let class = class(column);
            text += &if i == 0 {
                format!("<th scope=\"row\"{class}>{cell}</th>")
            } else {
                format!("<td{class}>{cell}</td>")
            };
        }
        text += "</tr>\n";
    }
    text + "</tbody></table></div>\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_from_a_file_becomes_markup() {
        let text = escaped("<b a='x' c=\"y\">&\u{1}");
        assert_eq!(text, "&lt;b a=&#39;x&#39; c=&quot;y&quot;&gt;&amp;\u{fffd}");
        assert!(!block("<i>", "</pre>", true).contains("<i>"));
        assert_eq!(block("n", "</pre>", true).matches("</pre>").count(), 1);
    }
}
