//! A self-contained page.

use std::sync::LazyLock;

use super::pack;

/// Name of the project, on every page.
const PROJECT: &str = "Pantoline";

/// Style of all pages.
const STYLE: &str = include_str!("style.css");

/// Behaviour of all pages: draws figures, offers tables and figures as files.
const SCRIPT: &str = include_str!("page.js");

/// plotly.js for curves and bars, packed: see `assets/README.md`.
const CURVES: &[u8] = include_bytes!("assets/plotly-basic.min.js.gz");

/// plotly.js for every kind of figure, as a script element.
///
/// Only the first script element of the plotly crate, plotly.js itself, is kept: the other is MathJax, which no page
/// uses.
static WHOLE: LazyLock<String> = LazyLock::new(|| {
    const END: &str = "</script>";
    let mut sources = plotly::Plot::offline_js_sources();
    if let Some(end) = sources.find(END) {
        sources.truncate(end + END.len());
    }
    sources
});

/// Parts of plotly.js that a figure needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Library {
    /// Curves, points and bars.
    Curves,
    /// Every kind of figure, at four times the size of a page.
    Whole,
}

/// Mark of a figure that needs [`Library::Whole`].
const NEEDS_WHOLE: &str = "data-library=\"whole\"";
/// Mark of a figure.
const FIGURE: &str = "class=\"figure\"";

/// Replaces the characters that have a meaning in HTML.
#[must_use]
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            // A page shows what a terminal would obey.
            c if c.is_control() && !c.is_whitespace() => escaped.extend(c.escape_unicode()),
            c => escaped.push(c),
        }
    }
    escaped
}

/// Heading cells of a table, each of a name and a unit; numbers are set to the right.
pub fn head_cells<'a>(columns: impl IntoIterator<Item = (&'a str, &'a str, bool)>) -> String {
    let cell = |(name, unit, is_number): (&str, &str, bool)| {
        let class = if is_number { " class=\"n\"" } else { "" };
        let unit = if unit.is_empty() {
            String::new()
        } else {
            format!("<br>{unit}")
        };
        format!("<th{class}>{name}{unit}</th>")
    };
    columns.into_iter().map(cell).collect()
}

/// Remarks as a list; nothing where there are none.
#[must_use]
pub fn remarks(notes: &[String]) -> String {
    remarks_of(notes.iter().map(|note| escape(note)))
}

/// [`remarks`] that are HTML.
#[must_use]
pub fn remarks_of(notes: impl Iterator<Item = String>) -> String {
    let items: String = notes.map(|note| format!("<li>{note}</li>")).collect();
    match items.is_empty() {
        true => items,
        false => format!("<div class=\"notes\"><ul>{items}</ul></div>\n"),
    }
}

/// A figure as a piece of a [`Page`], in a box of `height` (CSS pixels): `figure` is the JSON object with `data`,
/// `layout` and `config` that plotly.js takes. `id` must be unique in the page and made of letters, digits and `-`;
/// `name` is read out where figures are not seen, and names the files that it is saved to.
#[must_use]
pub fn figure_html(figure: &str, (id, name): (&str, &str), height: u32, library: Library) -> String {
    let library = match library {
        Library::Curves => String::new(),
        Library::Whole => format!(" {NEEDS_WHOLE}"),
    };
    let box_of_it = format!(
        "<div class=\"plot\" id=\"{id}\" role=\"img\" aria-label=\"{}\" style=\"height:{height}px\"></div>\n",
        escape(name)
    );
    box_of_it + &pack::data(figure, &format!("{FIGURE} data-for=\"{id}\"{library}"))
}

/// A page that works offline: style, and plotly.js where a plot needs it, are inside.
#[derive(Clone, Debug)]
pub struct Page {
    title: String,
    body: String,
    style: &'static str,
}

impl Page {
    /// An empty page. `title` is plain text.
    #[must_use]
    pub fn new(title: &str) -> Self {
        let title = escape(title);
        Self {
            body: format!("<header><p class=\"brand\">{PROJECT}</p>\n<h1>{title}</h1>\n"),
            title,
            style: "",
        }
    }

    /// The page with rules of its own after those of all pages.
    #[must_use]
    pub fn with_style(mut self, style: &'static str) -> Self {
        self.style = style;
        self
    }

    /// Closes the head of the page with `html` below the title.
    pub fn lead(&mut self, html: &str) {
        self.body.push_str(html);
        self.body.push_str("</header>\n");
    }

    /// Appends a section; `heading` is plain text and may be empty, `html` is inserted as it is.
    /// An empty `html` adds nothing.
    pub fn section(&mut self, heading: &str, html: &str) {
        if html.is_empty() {
            return;
        }
        self.body.push_str("<section>\n");
        if !heading.is_empty() {
            self.body.push_str(&format!("<h2>{}</h2>\n", escape(heading)));
        }
        self.body.push_str(html);
        self.body.push_str("</section>\n");
    }

    /// The whole page with a script at its end.
    #[must_use]
    pub fn finish_with_script(mut self, script: &str) -> String {
        self.body.push_str(&format!("<script>\n{script}</script>\n"));
        self.finish()
    }

    /// The whole page.
    #[must_use]
    pub fn finish(self) -> String {
        let plotly = if self.body.contains(NEEDS_WHOLE) {
            WHOLE.clone()
        } else if self.body.contains(FIGURE) {
            format!(
                "<script type=\"text/plain\" id=\"plotly\">{}</script>",
                pack::letters(CURVES)
            )
        } else {
            String::new()
        };
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <title>{} – {PROJECT}</title>\n<style>\n{STYLE}{}</style>\n<script>\n{SCRIPT}</script>\n</head>\n<body>\n\
             <main>\n{}\
             </main>\n{plotly}\n</body>\n</html>\n",
            self.title, self.style, self.body
        )
    }
}
