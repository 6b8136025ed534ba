//! Text from foreign files, such as names and descriptions of variables, for people.

use std::borrow::Cow;
use std::fmt::Write as _;

/// `text` with every control character but line feed and tabulator as an escape, `\u{1b}`: a name must not move the
/// cursor, ring the bell or colour what follows.
#[must_use]
pub fn visible(text: &str) -> Cow<'_, str> {
    let hidden = |c: char| c.is_control() && !matches!(c, '\n' | '\t');
    if !text.contains(hidden) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        if hidden(c) {
            let _ = write!(shown, "{}", c.escape_unicode());
        } else {
            shown.push(c);
        }
    }
    Cow::Owned(shown)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_shown_as_escapes_and_all_else_stays() {
        let shown = visible("a\u{7}\u{1b}[31mred\r\u{9b}2J\u{7f}\tµ °\n");
        assert_eq!(shown, "a\\u{7}\\u{1b}[31mred\\u{d}\\u{9b}2J\\u{7f}\tµ °\n");
        assert!(matches!(visible("kN/m² [1]\n"), Cow::Borrowed(_)));
    }
}
