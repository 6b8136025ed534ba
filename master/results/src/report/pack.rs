//! Data of a page in the page itself.

use std::io::Write as _;

use base64::Engine as _;
use flate2::{Compression, write::GzEncoder};

/// Length of data from which packing pays, bytes.
const WORTH: usize = 20_000;

/// JSON as a script element that `page.js` reads, with these attributes: packed where it is long.
pub(super) fn data(json: &str, attributes: &str) -> String {
    match (json.len() >= WORTH).then(|| packed(json)).flatten() {
        Some(packed) => format!("<script type=\"text/plain\" {attributes}>{packed}</script>\n"),
        None => {
            // `<` could end the script element; JSON may write it as an escape.
            let json = json.replace('<', "\\u003c");
            format!("<script type=\"application/json\" {attributes}>{json}</script>\n")
        }
    }
}

/// Text as letters of its gzip file; nothing where it cannot be packed.
fn packed(text: &str) -> Option<String> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::new(5));
    encoder.write_all(text.as_bytes()).ok()?;
    Some(letters(&encoder.finish().ok()?))
}

/// Bytes as letters that may stand in a page.
pub(super) fn letters(bytes: &[u8]) -> String {
    base64::engine::general_purpose::STANDARD.encode(bytes)
}
