//! Figures, causes of an error and parts of a note in words.

use serde::Serialize;

use super::bracketed;

/// A word of a result.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Word {
    /// Names, the first as in `summary.json`.
    pub names: &'static [&'static str],
    /// Unit; empty where there is none.
    pub unit: &'static str,
    /// Meaning.
    pub meaning: &'static str,
    /// Page of the documents.
    pub page: &'static str,
}

impl Word {
    /// True for one of its names, in letters of any case.
    pub(super) fn is_called(&self, typed: &str) -> bool {
        let plain = |name: &str| name.to_lowercase().replace(['_', '-'], " ");
        self.names.iter().any(|name| plain(name) == plain(typed))
    }

    /// As text.
    pub(super) fn text(&self) -> String {
        format!(
            "{}{}\n  {}\n  See {}.\n",
            self.names.join(", "),
            bracketed(self.unit),
            self.meaning,
            self.page
        )
    }
}

const STATISTICS: &str = "docs/theory/statistics.md";
const MESH: &str = "docs/theory/mesh.md";
const REDUCTIONS: &str = "docs/theory/reductions.md";
const COUPLING: &str = "docs/theory/coupling.md";
const FIRST_RUN: &str = "docs/guide/first-run.md";

const fn word(names: &'static [&'static str], unit: &'static str, meaning: &'static str, page: &'static str) -> Word {
    Word {
        names,
        unit,
        meaning,
        page,
    }
}

/// The word of that name, in letters of any case.
#[must_use]
pub fn named(name: &str) -> Option<&'static Word> {
    WORDS.iter().find(|word| word.is_called(name))
}

/// Every word that is explained.
#[must_use]
pub fn glossary() -> &'static [Word] {
    &WORDS
}

static WORDS: [Word; 44] = [
    word(
        &["measured", "measurement", "gains", "as measured"],
        "N",
        "Contact force as a measuring train takes it: force of the load cells under the strips and their mass times \
         the acceleration beside them, with the instruments of [measurement]. A strip that bends hides the \
         acceleration of its middle.",
        STATISTICS,
    ),
    word(
        &["mean", "mean contact force", "mean_lower", "Fm"],
        "N",
        "Mean of the filtered contact force over the evaluation range. Static force, aerodynamic lift and friction \
         set it; the line hardly does.",
        STATISTICS,
    ),
    word(
        &["std", "σ", "sigma", "standard deviation"],
        "N",
        "Population standard deviation of the filtered force: std² = 1/n Σ (Fᵢ − mean)². The usual measure of how well \
         line and pantograph go together.",
        STATISTICS,
    ),
    word(
        &["max", "maximum"],
        "N",
        "Largest filtered force of the evaluation range. The span where it stands is in the section By span.",
        STATISTICS,
    ),
    word(
        &["min", "minimum"],
        "N",
        "Smallest filtered force of the evaluation range.",
        STATISTICS,
    ),
    word(
        &["statistical_max", "statistical_min", "mean + 3σ", "mean - 3σ"],
        "N",
        "Mean ± 3 standard deviations [EN 50317].",
        STATISTICS,
    ),
    word(
        &["loss_of_contact_percent", "loss of contact", "loss"],
        "%",
        "Share of the evaluated time in which the raw force is zero. The raw force, as the filtered one passes zero \
        smoothly.",
        STATISTICS,
    ),
    word(
        &["arcing", "NQ", "arc"],
        "%",
        "Share of the time in losses of contact of 5 ms and longer. Each counts as an arc, as there is no electrical \
        model.",
        STATISTICS,
    ),
    word(
        &["losses", "loss_classes"],
        "",
        "Losses of contact one by one: time of the first sample without force, duration, place and span; and by \
        duration.",
        STATISTICS,
    ),
    word(
        &["bands", "band", "frequency bands"],
        "N",
        "Standard deviation of the force in the bands of run.bands_hz, by filters without delay. A band is the \
         low-pass at its upper end less that at its lower end of the rest, so that neighbouring bands add up to the \
         whole.",
        STATISTICS,
    ),
    word(
        &["quantiles"],
        "N",
        "Filtered force that a share of the samples lies below, linear between samples in order.",
        STATISTICS,
    ),
    word(
        &["filter", "filtered", "low_pass_hz", "other_filter"],
        "",
        "Butterworth low-pass of the force at run.low_pass_hz: zero_phase of order 4 forward and backward (no delay), \
         or causal of order 6 forward only, as on a measuring train [EN 50317].",
        STATISTICS,
    ),
    word(
        &["raw"],
        "N",
        "Contact force as computed, before the filter.",
        STATISTICS,
    ),
    word(
        &["spans", "tension_lengths", "by span"],
        "N",
        "Figures of the samples whose contact lies in one span or tension length of the evaluation range.",
        STATISTICS,
    ),
    word(
        &["following", "leading"],
        "",
        "Figures of each following pantograph less those of the leading one, which runs on a line at rest.",
        STATISTICS,
    ),
    word(
        &["uplift", "max_at_support_m", "uplift at support"],
        "m",
        "Largest rise of the contact wire above its height at t = 0 at the supports that bound the evaluated spans, \
         in the whole run.",
        STATISTICS,
    ),
    word(
        &["free_uplift", "space for the uplift"],
        "m",
        "Rise that the steady arm leaves room for, catenary.registration_arms.free_uplift.",
        STATISTICS,
    ),
    word(
        &["vertical_amplitude", "vertical_amplitude_m", "strip amplitude"],
        "m",
        "Highest less lowest height of the collector strip over the evaluation range.",
        STATISTICS,
    ),
    word(
        &["contact_height"],
        "m",
        "Height of the contact wire where the strip touches it, filtered like the force, and its largest gradient \
         along the track.",
        STATISTICS,
    ),
    word(
        &["speed_ratio", "wave speed"],
        "–",
        "Running speed by the speed of transverse waves of the contact wire, √(tension/mass per length). Near 1 the \
         waves ahead of the strip pile up.",
        "docs/theory/line.md",
    ),
    word(
        &["gradient", "gradient_change"],
        "‰",
        "Gradient of the contact wire against the track, by the chord between supports, and its change at a support.",
        "docs/guide/real-lines.md",
    ),
    word(
        &["lateral_deviation", "blow-off"],
        "m",
        "Largest lateral position of the contact wire about the track centre in the mean wind, the line at rest.",
        "docs/guide/weather.md",
    ),
    word(
        &["sampling_rate"],
        "Hz",
        "Samples of the record per second, 1/run.output_step.",
        STATISTICS,
    ),
    word(
        &["control_section", "evaluation"],
        "m",
        "Stretch of track that the statistics are of: run.evaluate.",
        STATISTICS,
    ),
    word(
        &["accuracy", "expected_percent", "expected error"],
        "%",
        "Sum of the expected errors of the filtered force, in percent of its standard deviation, against the converged \
         nonlinear line. Rules, good to a factor of about two; master study measures them.",
        MESH,
    ),
    word(
        &["mesh"],
        "%",
        "Error of the finite elements. Waves ahead of the strip are shortest, f/(1 − v/c): elements have to resolve \
         them. catenary.mesh.error_percent sets it.",
        MESH,
    ),
    word(
        &["step", "micro_step"],
        "%",
        "Error of the time integration, by the longest internal step. solver.micro_step sets it.",
        "docs/theory/integration.md",
    ),
    word(
        &["newton_tolerance", "newton_iterations", "tolerance"],
        "%",
        "Error of the equations left over by Newton's method at the end of each step; solver.newton_tolerance sets it.",
        "docs/theory/integration.md",
    ),
    word(
        &["planar"],
        "%",
        "Line in the vertical plane of the track: lateral motion is left out. Exact without stagger, curve and side \
        wind.",
        REDUCTIONS,
    ),
    word(
        &["linearised"],
        "%",
        "Wires linear about the line at rest; droppers still go slack. Errors grow with uplift.",
        REDUCTIONS,
    ),
    word(
        &["flat"],
        "%",
        "Linearised line without sag: wires are straight strings, as in two-dimensional programs. Another model, not a \
         close one.",
        REDUCTIONS,
    ),
    word(
        &["window"],
        "%",
        "Only the part of the line around the pantographs moves; the rest answers by its modes.",
        REDUCTIONS,
    ),
    word(
        &["modal"],
        "%",
        "Linearised line in its own modes up to a frequency, exact in time. Damping is mode by mode.",
        REDUCTIONS,
    ),
    word(
        &["linkage"],
        "%",
        "Linkage of the pantograph in one or two coordinates in place of all bodies.",
        REDUCTIONS,
    ),
    word(
        &["coupling", "algorithm"],
        "%",
        "Error of exchanging places and forces once per macro step in place of solving line and pantographs together; \
         0 in a run as one system.",
        COUPLING,
    ),
    word(
        &["energy_residual", "energy_residual_J"],
        "J",
        "Energy that the coupling added to line and pantographs. 0 is a perfect coupling.",
        COUPLING,
    ),
    word(
        &["rollbacks", "refused_steps"],
        "",
        "Macro steps that were taken back and repeated: to correct a prediction, or shorter, where their error was \
        too large.",
        COUPLING,
    ),
    word(
        &["macro_steps", "micro_steps"],
        "",
        "Exchanges between line and pantographs, and steps of the time integration between them.",
        COUPLING,
    ),
    word(
        &["real_time_factor", "RTF"],
        "–",
        "Wall time of the time loop by simulated time; below 1 is faster than real time.",
        FIRST_RUN,
    ),
    word(
        &["factorizations"],
        "",
        "Times that a matrix of the line was factorised anew.",
        "docs/theory/integration.md",
    ),
    word(
        &["verdict", "pass", "margin", "not decided", "not applicable"],
        "",
        "A limit holds or fails by a margin in percent of it. Not decided: a figure is missing. Not applicable: the \
         reason names the key that would make it apply.",
        FIRST_RUN,
    ),
    word(
        &["certainty", "[C]", "[R]", "[S]", "[H]"],
        "",
        "Certainty of a limit's figure: [C] read in a text that quotes the standard, [R] remembered and not verified, \
         [S] read in the standard by the one who entered it under [assessment], [H] chosen, in no standard. Texts \
         of the standards are not public.",
        STATISTICS,
    ),
    word(
        &["elasticity", "non-uniformity"],
        "m/N",
        "Rise of the contact wire under one newton at rest, and how much it varies along a span: u = (max − min)/(max \
        + min).",
        "docs/guide/real-lines.md",
    ),
    word(
        &["strip overrun", "overrun"],
        "m",
        "Places where a contact wire leaves the width of the strip; the contact is kept on its end there.",
        "docs/theory/contact.md",
    ),
];
