//! `[measurement]`: the pantograph head as a measuring train instruments it.

use crate::check::{Found, refuse};
use crate::keys::{Entry, Keys, Number, Sentences};
use crate::write::shown_number;
use crate::{PantographModel, Scene};

/// `[measurement]`: load cells under the strips and accelerometers beside them. [EN 50317]
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// Mass above the load cells of one head, kg.
    pub strip_mass: f64,
    /// Frequency of the first bending mode of a strip on its cells, Hz; rigid where it is left out.
    pub bending_frequency: Option<f64>,
    /// Share of the mass above the cells that bends, –.
    pub bending_mass_share: f64,
    /// Damping ratio of this mode, –.
    pub bending_damping_ratio: f64,
    /// Samples per second; those of the time series where it is left out.
    pub sampling_hz: Option<f64>,
    /// Error of the gain of the cells, %.
    pub cell_error_percent: f64,
    /// Error of the mass that accelerations are multiplied by, %.
    pub mass_error_percent: f64,
    /// True adds the mean lift of the air above the cells, which they do not feel.
    pub aerodynamic_correction: bool,
}

/// Fastest bending that a strip can have, Hz.
const FASTEST_BENDING: f64 = 2000.0;

impl Entry for Measurement {
    const SENTENCES: Sentences = &[
        (
            "strip_mass",
            "Mass above the load cells of one head: strips with what lies on the cells.",
        ),
        (
            "bending_frequency",
            "Frequency of the first bending mode of a strip on its cells; rigid where it is left out.",
        ),
        (
            "bending_mass_share",
            "Share of the mass above the cells that bends, as a uniform beam on its cells; the rest moves with them.",
        ),
        ("bending_damping_ratio", "Damping ratio of the bending mode."),
        (
            "sampling_hz",
            "Samples per second, one of every whole number of rows of the time series; every row where it is left out.",
        ),
        ("cell_error_percent", "Error of the gain of the load cells."),
        (
            "mass_error_percent",
            "Error of the mass that measured accelerations are multiplied by.",
        ),
        (
            "aerodynamic_correction",
            "True adds the mean lift of the wind on the strips, which the cells below them do not feel.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            strip_mass: keys.number("strip_mass", was.map(|own| own.strip_mass), Number::positive("kg")),
            bending_frequency: keys.optional_number(
                "bending_frequency",
                was.map(|own| own.bending_frequency),
                Number::positive("Hz").at_most(FASTEST_BENDING),
            ),
            bending_mass_share: keys.number(
                "bending_mass_share",
                was.map(|own| own.bending_mass_share),
                Number::between(0.0, 1.0).default(1.0),
            ),
            bending_damping_ratio: keys.number(
                "bending_damping_ratio",
                was.map(|own| own.bending_damping_ratio),
                Number::between(0.0, 1.0).default(0.02),
            ),
            sampling_hz: keys.optional_number("sampling_hz", was.map(|own| own.sampling_hz), Number::positive("Hz")),
            cell_error_percent: keys.number(
                "cell_error_percent",
                was.map(|own| own.cell_error_percent),
                Number::between(-50.0, 50.0).default(0.0),
            ),
            mass_error_percent: keys.number(
                "mass_error_percent",
                was.map(|own| own.mass_error_percent),
                Number::between(-100.0, 100.0).default(0.0),
            ),
            aerodynamic_correction: keys.flag(
                "aerodynamic_correction",
                was.map(|own| own.aerodynamic_correction),
                true,
            ),
        }
    }
}

impl Measurement {
    /// Rows of the time series, `output_step` s apart, from one sample to the next.
    #[must_use]
    pub fn stride(&self, output_step: f64) -> usize {
        let rows = self.sampling_hz.map_or(1.0, |rate| 1.0 / (rate * output_step));
        (rows.round() as usize).max(1)
    }
}

impl Scene {
    /// Checks the instruments against time series and heads.
    pub(crate) fn check_measurement(&self, found: &mut Found) {
        let Some(own) = &self.measurement else { return };
        let step = self.run.output_step;
        if own
            .bending_frequency
            .is_some_and(|frequency| frequency > FASTEST_BENDING)
        {
            let expected = format!("must be at most {FASTEST_BENDING} Hz, beyond any strip");
            let shown = shown_number(own.bending_frequency.unwrap_or_default(), "Hz");
            refuse(found, "measurement.bending_frequency", shown, expected);
        }
        if let Some(rate) = own.sampling_hz {
            let rows = 1.0 / (rate * step);
            if rows < 1.0 - 1e-9 || (rows - rows.round()).abs() > 1e-6 * rows {
                let expected = format!(
                    "must be {} Hz, one sample for each run.output_step = {step} s, or that divided by a whole number",
                    1.0 / step
                );
                refuse(found, "measurement.sampling_hz", shown_number(rate, "Hz"), expected);
            } else if rate <= 2.0 * self.run.low_pass_hz {
                let expected = format!(
                    "must be more than {} Hz, twice run.low_pass_hz",
                    2.0 * self.run.low_pass_hz
                );
                refuse(found, "measurement.sampling_hz", shown_number(rate, "Hz"), expected);
            }
        }
        for (index, pantograph) in self.pantographs.iter().enumerate() {
            if let PantographModel::Lumped(lumped) = &pantograph.model
                && lumped.strips.is_empty()
                && own.strip_mass > lumped.masses[0]
            {
                let expected = format!(
                    "must be at most pantograph[{}].masses[1] = {} kg, the head that the cells are part of",
                    index + 1,
                    lumped.masses[0]
                );
                refuse(
                    found,
                    "measurement.strip_mass",
                    shown_number(own.strip_mass, "kg"),
                    expected,
                );
                return;
            }
        }
    }
}
