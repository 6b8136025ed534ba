//! `[track]`: what the wheels run on.

use crate::Curve;
use crate::curve::curves;
use crate::keys::{Entry, Keys, Length, Number, Sentences};

/// `[track]`: level track, straight but for its curves.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// `track.rail`; only for `vehicle.model = "full"`.
    pub rail: Option<RailSection>,
    /// `track.curve`: in the order in which they follow each other; only for `vehicle.model = "full"`.
    pub curves: Vec<Curve>,
    /// How far the rails are from their ideal lines.
    pub irregularities: Irregularities,
}

/// `track.rail`: the cross-section of the rails, and how they stand.
#[derive(Clone, Debug, PartialEq)]
pub struct RailSection {
    /// Distance of the gauge faces, 14 mm below the top, m.
    pub gauge: f64,
    /// How far a rail leans inward, – (1/40, 1/20).
    pub inclination: f64,
    /// Cross-section from the gauge face outward: (outward, up) relative to the middle of its top, m, without the
    /// inclination.
    pub profile: Vec<[f64; 2]>,
}

/// `track.irregularities`.
#[derive(Clone, Debug, PartialEq)]
pub enum Irregularities {
    /// `"none"`.
    None,
    /// `{ model = "spectrum", … }`: made from power spectral densities.
    Spectrum(Spectrum),
    /// `{ model = "points", … }`: measured.
    Points(Points),
}

/// One realisation of irregularities with the spectra of ORE B176.
///
/// ```text
/// S_v(Ω) = A_v Ω_c² / ((Ω² + Ω_r²)(Ω² + Ω_c²))                       rise of the middle, alignment with A_a
/// S_c(Ω) = A_v Ω_c² Ω² / (b² (Ω² + Ω_r²)(Ω² + Ω_c²)(Ω² + Ω_s²))      cant angle, b half the distance of the rails
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// Which realisation.
    pub seed: usize,
    /// Shortest and longest wavelength, m.
    pub wavelengths: [f64; 2],
    /// `A_v`, rad m.
    pub vertical_roughness: f64,
    /// `A_a`, rad m.
    pub lateral_roughness: f64,
    /// `Ω_r`, `Ω_c`, `Ω_s`, rad/m.
    pub corners: [f64; 3],
    /// Length over which the irregularities grow from nothing, from the start of the wheel that is furthest ahead, m.
    pub fade: f64,
}

/// Irregularities at points along the track, interpolated by a cubic spline; constant beyond.
///
/// All lists have the same length; one that is left out is zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    /// m, ascending.
    pub x: Vec<f64>,
    /// Rise of the left rail, m.
    pub z_left: Vec<f64>,
    /// Rise of the right rail, m.
    pub z_right: Vec<f64>,
    /// Lateral displacement of the left rail, m.
    pub y_left: Vec<f64>,
    /// Lateral displacement of the right rail, m.
    pub y_right: Vec<f64>,
    /// File that the lists are still to be read from; its columns are called as the keys.
    pub file: Option<String>,
}

impl Track {
    /// Key of curve `index` (from 0) in messages and parameters: by number where there are several.
    #[must_use]
    pub fn curve_key(&self, index: usize) -> String {
        match self.curves.len() {
            1 => "track.curve".to_owned(),
            _ => format!("track.curve[{}]", index + 1),
        }
    }

    /// True where both rails are alike and stay in place sideways.
    #[must_use]
    pub fn is_symmetric(&self) -> bool {
        match &self.irregularities {
            Irregularities::None => true,
            Irregularities::Spectrum(_) => false,
            Irregularities::Points(points) => {
                let still = |values: &[f64]| values.iter().all(|value| *value == 0.0);
                points.z_left == points.z_right && still(&points.y_left) && still(&points.y_right)
            }
        }
    }
}

impl Entry for Track {
    const SENTENCES: Sentences = &[
        (
            "rail",
            "Cross-section of the rails; only for `vehicle.model = \"full\"`.",
        ),
        (
            "curve",
            "Curve, or a list of curves in their order along the track; only for `vehicle.model = \"full\"`.",
        ),
        ("irregularities", "Deviation of the rails from their ideal lines."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let rail = keys.optional_table("rail", was.map(|track| track.rail.as_ref()));
        let curves = curves(keys, was.map(|track| track.curves.as_slice()));
        let inline = was
            .map(|track| &track.irregularities)
            .filter(|given| **given != Irregularities::None);
        if keys.describes() {
            keys.inline_table::<Irregularities>("irregularities", None);
        }
        let irregularities = if keys.holds_table("irregularities") || inline.is_some() {
            keys.inline_table("irregularities", inline)
        } else {
            keys.word_among("irregularities", was.map(|_| ()), &[("none", ())], &[], Some(()));
            Irregularities::None
        };
        Self {
            rail,
            curves,
            irregularities,
        }
    }
}

impl Entry for RailSection {
    const SENTENCES: Sentences = &[
        ("gauge", "Distance of the gauge faces, 14 mm below the top."),
        ("inclination", "Inward inclination of a rail, such as 1/40."),
        (
            "profile",
            "Cross-section from the gauge face outward: (outward, up) from the middle of its top, without the \
             inclination.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            gauge: keys.number("gauge", was.map(|rail| rail.gauge), Number::positive("m")),
            inclination: keys.number("inclination", was.map(|rail| rail.inclination), Number::any("")),
            profile: keys.points(
                "profile",
                was.map(|rail| rail.profile.as_slice()),
                Number::of_cross_section(),
            ),
        }
    }
}

/// The words of `track.irregularities.model`.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Spectrum,
    Points,
}

impl Entry for Irregularities {
    const SENTENCES: Sentences = &[(
        "model",
        "Realisation of power spectral densities [ORE B176], or measured points.",
    )];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let kind = was.map(|given| match given {
            Self::Points(_) => Kind::Points,
            _ => Kind::Spectrum,
        });
        let names = [("spectrum", Kind::Spectrum), ("points", Kind::Points)];
        let kind = keys.word_among("model", kind, &names, &[], None);
        if keys.describes() {
            keys.only("`model = \"spectrum\"`", |keys| keys.part::<Spectrum>(None));
            let points = keys.only("`model = \"points\"`", |keys| keys.part(None));
            return Self::Points(points);
        }
        match kind {
            Some(Kind::Spectrum) => {
                let was = was.and_then(|given| match given {
                    Self::Spectrum(spectrum) => Some(spectrum),
                    _ => None,
                });
                Self::Spectrum(keys.part(was))
            }
            Some(Kind::Points) => {
                let was = was.and_then(|given| match given {
                    Self::Points(points) => Some(points),
                    _ => None,
                });
                Self::Points(keys.part(was))
            }
            None => {
                keys.abandon();
                Self::None
            }
        }
    }
}

impl Entry for Spectrum {
    const SENTENCES: Sentences = &[
        ("seed", "Number of the realisation."),
        ("wavelengths", "Shortest and longest wavelength."),
        ("vertical_roughness", "Roughness `A_v` of rise and cant."),
        ("lateral_roughness", "Roughness `A_a` of the alignment."),
        ("corners", "Corner frequencies `Ω_r`, `Ω_c`, `Ω_s`."),
        (
            "fade",
            "Length over which the irregularities grow from nothing, from the start of the foremost wheel.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let roughness = Number::not_negative("rad m");
        let corners = was.map(|spectrum| spectrum.corners);
        Self {
            seed: keys.count("seed", was.map(|spectrum| spectrum.seed), 0..=usize::MAX >> 1, None),
            wavelengths: keys.pair(
                "wavelengths",
                was.map(|spectrum| spectrum.wavelengths),
                Number::positive("m"),
            ),
            vertical_roughness: keys.number(
                "vertical_roughness",
                was.map(|spectrum| spectrum.vertical_roughness),
                roughness,
            ),
            lateral_roughness: keys.number(
                "lateral_roughness",
                was.map(|spectrum| spectrum.lateral_roughness),
                roughness,
            ),
            corners: keys.vector("corners", corners, Number::positive("rad/m")),
            fade: keys.number("fade", was.map(|spectrum| spectrum.fade), Number::positive("m")),
        }
    }
}

impl Entry for Points {
    const SENTENCES: Sentences = &[
        (
            "file",
            "Path of a CSV file with the lists as columns, relative to the scene file.",
        ),
        ("x", "Places along the track, ascending."),
        ("z_left", "Rise of the left rail; 0 where left out."),
        ("z_right", "Rise of the right rail; 0 where left out."),
        ("y_left", "Lateral displacement of the left rail; 0 where left out."),
        ("y_right", "Lateral displacement of the right rail; 0 where left out."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let file = was.map(|points| points.file.as_deref());
        if let file @ Some(_) = keys.column_file(file, &["x", "z_left", "z_right", "y_left", "y_right"]) {
            return Self {
                file,
                ..Self::default()
            };
        }
        let x = keys.numbers(
            "x",
            was.map(|points| points.x.as_slice()),
            Number::any("m"),
            Length::NotEmpty,
        );
        let n = x.len();
        let mut list = |name: &str, was: Option<&[f64]>| keys.column(name, was, "m", n);
        Self {
            z_left: list("z_left", was.map(|points| points.z_left.as_slice())),
            z_right: list("z_right", was.map(|points| points.z_right.as_slice())),
            y_left: list("y_left", was.map(|points| points.y_left.as_slice())),
            y_right: list("y_right", was.map(|points| points.y_right.as_slice())),
            x,
            file: None,
        }
    }
}
