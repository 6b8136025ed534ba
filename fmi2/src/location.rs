//! Paths of resource folders as URIs [FMI 2.0, 2.1.5].

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_decode_str, utf8_percent_encode};
use std::path::{Path, PathBuf};

/// All characters except those that a path of a URI may hold [RFC 3986, 3.3].
const ENCODED: &AsciiSet = &NON_ALPHANUMERIC
    .remove(b'/')
    .remove(b'-')
    .remove(b'.')
    .remove(b'_')
    .remove(b'~')
    .remove(b':');

/// `file:///…`, percent-encoded, without a trailing slash.
pub(crate) fn uri(path: &Path) -> String {
    let text = path.to_string_lossy().replace('\\', "/");
    let text = text.trim_end_matches('/');
    format!("file:///{}", utf8_percent_encode(text.trim_start_matches('/'), ENCODED))
}

/// The paths a location may mean, best first: decoded, then as written (a folder may really be called `100%`).
/// Understands `file:/p`, `file:///p`, `file:////p`, `file://localhost/p`, `file:///C:/p` and bare paths.
pub(crate) fn candidates(location: &str) -> Vec<PathBuf> {
    let location = location.trim();
    if location.is_empty() {
        return Vec::new();
    }
    let scheme = location
        .get(..5)
        .is_some_and(|start| start.eq_ignore_ascii_case("file:"));
    let mut path = if scheme { &location[5..] } else { location };
    if scheme {
        if let Some(rest) = path.strip_prefix("//") {
            // an authority up to the next slash; an empty one and `localhost` are this machine
            path = rest
                .strip_prefix("localhost")
                .filter(|p| p.starts_with('/'))
                .unwrap_or(rest);
        }
        while path.starts_with("//") {
            path = &path[1..];
        }
        let drive = path.as_bytes();
        if drive.len() > 2 && drive[0] == b'/' && drive[1].is_ascii_alphabetic() && drive[2] == b':' {
            path = &path[1..];
        }
    }
    let path = if path.len() > 1 {
        path.trim_end_matches('/')
    } else {
        path
    };
    let decoded = percent_decode_str(path).decode_utf8_lossy();
    let mut paths = vec![PathBuf::from(&*decoded)];
    if decoded != path {
        paths.push(PathBuf::from(path));
    }
    paths
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_spelling_of_a_location_gives_the_path() {
        for location in [
            "file:/tmp/a b/resources",
            "file:///tmp/a%20b/resources",
            "file:////tmp/a b/resources/",
            "file://localhost/tmp/a%20b/resources",
            "FILE:///tmp/a%20b/resources/",
            "/tmp/a b/resources",
        ] {
            assert_eq!(candidates(location)[0], Path::new("/tmp/a b/resources"), "{location}");
        }
        assert_eq!(candidates("file:///C:/x/resources")[0], Path::new("C:/x/resources"));
        assert!(candidates("  ").is_empty());
    }

    #[test]
    fn a_percent_sign_that_is_no_code_is_tried_as_written() {
        let paths = candidates("file:////tmp/100%25/resources");
        assert_eq!(
            paths,
            [Path::new("/tmp/100%/resources"), Path::new("/tmp/100%25/resources")]
        );
    }

    #[test]
    fn our_location_is_encoded_and_reads_back() {
        let path = Path::new("/tmp/ü 100%#/resources");
        let location = uri(path);
        assert_eq!(location, "file:///tmp/%C3%BC%20100%25%23/resources");
        assert_eq!(candidates(&location)[0], path);
    }
}
