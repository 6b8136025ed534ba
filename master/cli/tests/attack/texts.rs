//! Texts that are changed as bytes.

use fastrand::Rng;

/// Words that are odd in any format.
pub const ODD: [&str; 26] = [
    "",
    " ",
    "0",
    "-1",
    "1e300",
    "-1e300",
    "1e-300",
    "nan",
    "NaN",
    "inf",
    "-Infinity",
    "99999999999999999999",
    "0x10",
    "1,5",
    "1.5.2",
    "true",
    "auto",
    "none",
    "\u{7}\u{1b}[31mred",
    "\u{9b}2J",
    "../../../etc/passwd",
    "/dev/null",
    "π ü",
    "\"",
    "a\nb",
    "\u{feff}",
];

/// Changes a few bytes.
pub fn change_bytes(rng: &mut Rng, bytes: &mut Vec<u8>) {
    for _ in 0..rng.usize(1..4) {
        if bytes.is_empty() {
            return;
        }
        let place = rng.usize(..bytes.len());
        match rng.u8(..6) {
            0 => bytes[place] = rng.u8(..),
            1 => drop(bytes.drain(place..(place + rng.usize(1..40)).min(bytes.len()))),
            2 => bytes.truncate(place),
            3 => {
                let piece = bytes[place..(place + rng.usize(1..200)).min(bytes.len())].to_vec();
                let target = rng.usize(..bytes.len());
                bytes.splice(target..target, piece);
            }
            _ => {
                let odd = b"\0\x1b\"'[]{}=,.#\n-9e<>&;/\xff";
                bytes.insert(place, odd[rng.usize(..odd.len())]);
            }
        }
    }
}
