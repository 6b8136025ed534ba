//! The keys of `[wind]`.
use super::{
    AerodynamicMarker, GustExtent, Wind, WindGust, WindOnPantograph, WindOnWires, WindSurface, WindTurbulence,
    WirePolar,
};
use crate::error::What;
use crate::keys::{Entry, Keys, Length, Number, Sentences};
use crate::write::shown_entries;

/// Faster than any wind that was measured at the ground, m/s.
const FASTEST: f64 = 120.0;

impl Entry for Wind {
    const SENTENCES: Sentences = &[
        ("speed", "Speed of the mean wind over the ground; 0 is still air."),
        (
            "yaw_deg",
            "Direction the wind comes from: 0 is a head wind, 90 comes from the left.",
        ),
        ("air_density", "Density of the air."),
        ("gust", "Gust on top of the mean wind."),
        ("turbulence", "Seeded turbulence on top of the mean wind."),
        (
            "file",
            "Path of a CSV file of wind that is added to the mean wind, relative to the scene file.",
        ),
        (
            "record",
            "Rows of such a file: time, vx, vy, vz and, for several places, x.",
        ),
        ("pantograph", "Action of the air on pantographs; without it none."),
        ("wires", "Action of the air on the wires; without it none."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let speed = keys.number(
            "speed",
            was.map(|wind| wind.speed),
            Number::not_negative("m/s").at_most(FASTEST),
        );
        if speed > FASTEST {
            keys.refuse("speed", format!("must be a speed in m/s, at most {FASTEST} m/s"));
        }
        Self {
            speed,
            yaw_deg: keys.number("yaw_deg", was.map(|wind| wind.yaw_deg), Number::between(-180.0, 180.0)),
            air_density: keys.number(
                "air_density",
                was.map(|wind| wind.air_density),
                Number::positive("kg/m³"),
            ),
            gust: keys.optional_inline_table("gust", was.map(|wind| wind.gust.as_ref())),
            turbulence: keys.optional_inline_table("turbulence", was.map(|wind| wind.turbulence.as_ref())),
            file: keys.optional_text("file", was.map(|wind| wind.file.as_deref()), "the path of a CSV file"),
            record: keys.optional_rows("record", was.map(|wind| wind.record.as_slice())),
            pantograph: keys.optional_table("pantograph", was.map(|wind| wind.pantograph.as_ref())),
            wires: keys.optional_inline_table("wires", was.map(|wind| wind.wires.as_ref())),
        }
    }
}

impl Entry for WindGust {
    const SENTENCES: Sentences = &[
        ("velocity", "Velocity added at the peak (x, y, z)."),
        ("start", "Begin of a gust that is everywhere at once."),
        ("duration", "Duration of that gust."),
        (
            "start_x",
            "Begin of a gust that stands over the track, in place of `start` and `duration`.",
        ),
        ("length", "Length of that gust."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let velocity = keys.vector("velocity", was.map(|gust| gust.velocity), Number::any("m/s"));
        let extent = was.map(|gust| gust.extent);
        let (time, place) = match extent {
            Some(GustExtent::Time { start, duration }) => (Some((start, duration)), None),
            Some(GustExtent::Place { start_x, length }) => (None, Some((start_x, length))),
            None => (None, None),
        };
        if keys.describes() {
            for name in ["start", "duration", "length"] {
                keys.has(name, false);
            }
            keys.number("start", None, Number::any("s"));
            keys.number("duration", None, Number::positive("s"));
        }
        let extent = if keys.has("start_x", place.is_some()) {
            if keys.has("start", false) {
                let because = "start_x is given, where the gust stands".to_owned();
                keys.report("start", What::LeaveOut { because });
            }
            GustExtent::Place {
                start_x: keys.number("start_x", place.map(|place| place.0), Number::any("m")),
                length: keys.number("length", place.map(|place| place.1), Number::positive("m")),
            }
        } else {
            GustExtent::Time {
                start: keys.number("start", time.map(|time| time.0), Number::any("s")),
                duration: keys.number("duration", time.map(|time| time.1), Number::positive("s")),
            }
        };
        Self { velocity, extent }
    }
}

impl Entry for WindTurbulence {
    const SENTENCES: Sentences = &[
        ("spectrum", "Shape of the spectra."),
        (
            "intensities",
            "Standard deviation by the mean speed: along, across, vertical.",
        ),
        ("length_scales", "Length scales: along, across, vertical."),
        (
            "coherence_decays",
            "Decay `C` of the coherence `exp(-C f |Δx| / speed)`: along, across, vertical.",
        ),
        ("seed", "Number of the realisation."),
        ("time_step", "Step of the field in time."),
        ("steps", "Steps until the field repeats itself, a power of two."),
        (
            "spacing",
            "Distance of the places between which the field is interpolated.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let steps = keys.count("steps", was.map(|wind| wind.steps), 2..=1 << 20, Some(1024));
        if !steps.is_power_of_two() {
            keys.refuse(
                "steps",
                format!("must be a power of two, such as {}", steps.next_power_of_two()),
            );
        }
        Self {
            spectrum: keys.word("spectrum", was.map(|wind| wind.spectrum), None),
            intensities: keys.vector(
                "intensities",
                was.map(|wind| wind.intensities),
                Number::not_negative(""),
            ),
            length_scales: keys.vector(
                "length_scales",
                was.map(|wind| wind.length_scales),
                Number::positive("m"),
            ),
            coherence_decays: keys.vector(
                "coherence_decays",
                was.map(|wind| wind.coherence_decays),
                Number::not_negative(""),
            ),
            seed: keys.count("seed", was.map(|wind| wind.seed), 0..=i64::MAX as usize, None),
            time_step: keys.number(
                "time_step",
                was.map(|wind| wind.time_step),
                Number::positive("s").default(0.05),
            ),
            steps,
            spacing: keys.number(
                "spacing",
                was.map(|wind| wind.spacing),
                Number::positive("m").default(2.0),
            ),
        }
    }
}

impl Entry for WindOnPantograph {
    const SENTENCES: Sentences = &[
        (
            "uplift",
            "Quasi-steady uplift of the strip by the square of the air's relative speed along the track, one for \
             all pantographs or one for each.",
        ),
        (
            "surfaces",
            "Bodies of a linkage that the air acts on, in place of `uplift`.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let uplift = was.map(|wind| wind.uplift.as_slice());
        let surfaces = was.map(|wind| wind.surfaces.as_slice());
        let there = |values: Option<bool>| values == Some(false);
        let with_uplift = keys.has("uplift", there(uplift.map(<[f64]>::is_empty)));
        let with_surfaces = keys.has("surfaces", there(surfaces.map(<[WindSurface]>::is_empty)));
        if with_uplift && with_surfaces {
            let because = "surfaces are given, whose lift it would count again".to_owned();
            keys.report("uplift", What::LeaveOut { because });
        } else if !with_uplift && !with_surfaces && was.is_none() {
            let expected =
                "a number in N/(m/s)², or else surfaces: [[wind.pantograph.surfaces]], bodies that the air acts on";
            keys.report(
                "uplift",
                What::Missing {
                    expected: expected.to_owned(),
                },
            );
        }
        Self {
            uplift: if with_uplift {
                keys.one_or_more("uplift", uplift, Number::not_negative("N/(m/s)²"))
            } else {
                Vec::new()
            },
            surfaces: if with_surfaces {
                keys.tables("surfaces", surfaces)
            } else {
                Vec::new()
            },
        }
    }
}

impl Entry for WindSurface {
    const SENTENCES: Sentences = &[
        ("body", "Name of the body."),
        (
            "angles_deg",
            "Angles of attack of the coefficients, ascending; left out, they hold at all angles.",
        ),
        (
            "drag",
            "Drag coefficient, or drag area where the markers' areas are 1, one per angle.",
        ),
        ("lift", "Lift coefficient likewise."),
        (
            "markers",
            "Points that the force is spread over: rows of position, nine direction cosines and area.",
        ),
        (
            "marker_file",
            "Path of a CSV file of such rows, relative to the scene file.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let body = keys.text("body", was.map(|surface| surface.body.as_str()), "the name of a body");
        let angles = was.map(|surface| surface.angles_deg.as_slice());
        let angles_deg = if keys.has("angles_deg", angles.is_some_and(|angles| !angles.is_empty())) {
            keys.numbers("angles_deg", angles, Number::between(-180.0, 180.0), Length::NotEmpty)
        } else {
            Vec::new()
        };
        let drag = keys.one_or_more(
            "drag",
            was.map(|surface| surface.drag.as_slice()),
            Number::not_negative(""),
        );
        let lift = keys.one_or_more("lift", was.map(|surface| surface.lift.as_slice()), Number::any(""));
        let rows = was.map(|surface| {
            surface
                .markers
                .iter()
                .map(|marker| marker.row().to_vec())
                .collect::<Vec<_>>()
        });
        let rows = keys.optional_rows("markers", rows.as_deref());
        let markers = AerodynamicMarker::from_rows(&rows).unwrap_or_else(|error| {
            keys.refuse("markers", error.to_string());
            Vec::new()
        });
        let marker_file = keys.optional_text(
            "marker_file",
            was.map(|surface| surface.marker_file.as_deref()),
            "the path of a CSV file",
        );
        if marker_file.is_some() && !markers.is_empty() {
            let because = "markers are given".to_owned();
            keys.report("marker_file", What::LeaveOut { because });
        }
        if !angles_deg.windows(2).all(|pair| pair[0] < pair[1]) {
            keys.refuse("angles_deg", "must ascend");
        }
        let expected = angles_deg.len().max(1);
        for (name, values) in [("drag", &drag), ("lift", &lift)] {
            if values.len() != expected && !values.is_empty() {
                let of_what = if angles_deg.is_empty() {
                    "one number, or angles_deg be given".to_owned()
                } else {
                    format!("{expected} numbers, one per angle of angles_deg")
                };
                keys.refuse(name, format!("has {}, must be {of_what}", shown_entries(values.len())));
            }
        }
        Self {
            body,
            angles_deg,
            drag,
            lift,
            markers,
            marker_file,
        }
    }
}

impl Entry for WindOnWires {
    const SENTENCES: Sentences = &[
        (
            "drag_coefficient",
            "Drag coefficient of wires and droppers by the diameter.",
        ),
        (
            "contact_wire_diameter",
            "Diameter of the contact wire; left out, that of `catenary.contact_wire`.",
        ),
        (
            "messenger_wire_diameter",
            "Diameter of the messenger wire; left out, that of `catenary.messenger_wire`.",
        ),
        (
            "stitch_wire_diameter",
            "Diameter of the stitch wires; left out, that of `catenary.stitch_wires`, or else that of the \
             messenger wire.",
        ),
        (
            "dropper_diameter",
            "Diameter of the droppers; left out, they feel no wind.",
        ),
        (
            "registration_arm_drag_area",
            "Drag coefficient times area of a registration arm.",
        ),
        (
            "contact_wire_polar",
            "Drag and lift of a contact wire that is worn or bears ice, in place of the drag coefficient.",
        ),
        (
            "messenger_wire_polar",
            "Drag and lift of a messenger wire that bears ice, in place of the drag coefficient.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let mut diameter =
            |name: &str, was: Option<Option<f64>>| keys.optional_number(name, was, Number::positive("m"));
        let contact_wire_diameter = diameter("contact_wire_diameter", was.map(|wires| wires.contact_wire_diameter));
        let messenger_wire_diameter = diameter(
            "messenger_wire_diameter",
            was.map(|wires| wires.messenger_wire_diameter),
        );
        let stitch_wire_diameter = diameter("stitch_wire_diameter", was.map(|wires| wires.stitch_wire_diameter));
        let dropper_diameter = diameter("dropper_diameter", was.map(|wires| wires.dropper_diameter));
        Self {
            drag_coefficient: keys.number(
                "drag_coefficient",
                was.map(|wires| wires.drag_coefficient),
                Number::not_negative(""),
            ),
            contact_wire_diameter,
            messenger_wire_diameter,
            stitch_wire_diameter,
            dropper_diameter,
            registration_arm_drag_area: keys.number(
                "registration_arm_drag_area",
                was.map(|wires| wires.registration_arm_drag_area),
                Number::not_negative("m²").default(0.0),
            ),
            contact_wire_polar: keys
                .optional_inline_table("contact_wire_polar", was.map(|wires| wires.contact_wire_polar.as_ref())),
            messenger_wire_polar: keys.optional_inline_table(
                "messenger_wire_polar",
                was.map(|wires| wires.messenger_wire_polar.as_ref()),
            ),
        }
    }
}

impl Entry for WirePolar {
    const SENTENCES: Sentences = &[
        (
            "angles_deg",
            "Angles of attack of the coefficients, ascending: 0 from the side, positive from below.",
        ),
        ("drag", "Drag coefficient by the diameter with the ice, one per angle."),
        ("lift", "Lift coefficient likewise, positive upwards."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let angles_deg = keys.numbers(
            "angles_deg",
            was.map(|polar| polar.angles_deg.as_slice()),
            Number::between(-90.0, 90.0),
            Length::NotEmpty,
        );
        if !angles_deg.windows(2).all(|pair| pair[0] < pair[1]) || angles_deg.len() == 1 {
            keys.refuse("angles_deg", "must ascend, with at least two angles");
        }
        let drag = keys.numbers(
            "drag",
            was.map(|polar| polar.drag.as_slice()),
            Number::not_negative(""),
            Length::Exactly(angles_deg.len()),
        );
        let lift = keys.numbers(
            "lift",
            was.map(|polar| polar.lift.as_slice()),
            Number::any(""),
            Length::Exactly(angles_deg.len()),
        );
        Self { angles_deg, drag, lift }
    }
}
