//! Variables and derivatives of an instance.

use super::instance::{Instance, c_text};
use crate::Error;
use crate::abi::{FALSE, GetFn, SetFn, TRUE, fmi2String};
use std::ffi::CStr;

/// # Panics
///
/// All panic if references and values differ in number.
impl Instance {
    fn get<T>(
        &mut self,
        name: &'static str,
        function: GetFn<T>,
        references: &[u32],
        values: &mut [T],
    ) -> Result<(), Error> {
        assert_eq!(references.len(), values.len(), "one value per reference");
        // SAFETY: the component is alive; both arrays have as many elements as is said.
        self.call(name, |component| unsafe {
            function(component, references.as_ptr(), references.len(), values.as_mut_ptr())
        })
    }

    fn set<T>(
        &mut self,
        name: &'static str,
        function: SetFn<T>,
        references: &[u32],
        values: &[T],
    ) -> Result<(), Error> {
        assert_eq!(references.len(), values.len(), "one value per reference");
        // SAFETY: the component is alive; both arrays have as many elements as is said.
        self.call(name, |component| unsafe {
            function(component, references.as_ptr(), references.len(), values.as_ptr())
        })
    }

    /// Reads real variables, in their units.
    ///
    /// # Errors
    ///
    /// The FMU refuses.
    pub fn get_real(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), Error> {
        self.get("fmi2GetReal", self.functions().get_real, references, values)
    }

    /// Sets real variables, in their units.
    ///
    /// # Errors
    ///
    /// The FMU refuses.
    pub fn set_real(&mut self, references: &[u32], values: &[f64]) -> Result<(), Error> {
        self.set("fmi2SetReal", self.functions().set_real, references, values)
    }

    /// Reads whole-number and enumeration variables.
    ///
    /// # Errors
    ///
    /// The FMU refuses.
    pub fn get_integer(&mut self, references: &[u32], values: &mut [i32]) -> Result<(), Error> {
        self.get("fmi2GetInteger", self.functions().get_integer, references, values)
    }

    /// Sets whole-number and enumeration variables.
    ///
    /// # Errors
    ///
    /// The FMU refuses.
    pub fn set_integer(&mut self, references: &[u32], values: &[i32]) -> Result<(), Error> {
        self.set("fmi2SetInteger", self.functions().set_integer, references, values)
    }

    /// Reads yes-or-no variables.
    ///
    /// # Errors
    ///
    /// The FMU refuses.
    pub fn get_boolean(&mut self, references: &[u32], values: &mut [bool]) -> Result<(), Error> {
        let mut integers = vec![FALSE; values.len()];
        self.get(
            "fmi2GetBoolean",
            self.functions().get_boolean,
            references,
            &mut integers,
        )?;
        for (value, integer) in values.iter_mut().zip(integers) {
            *value = integer != FALSE;
        }
        Ok(())
    }

    /// Sets yes-or-no variables.
    ///
    /// # Errors
    ///
    /// The FMU refuses.
    pub fn set_boolean(&mut self, references: &[u32], values: &[bool]) -> Result<(), Error> {
        let integers: Vec<_> = values.iter().map(|value| if *value { TRUE } else { FALSE }).collect();
        self.set("fmi2SetBoolean", self.functions().set_boolean, references, &integers)
    }

    /// Reads text variables.
    ///
    /// # Errors
    ///
    /// The FMU refuses.
    pub fn get_string(&mut self, references: &[u32]) -> Result<Vec<String>, Error> {
        let mut pointers: Vec<fmi2String> = vec![std::ptr::null(); references.len()];
        self.get("fmi2GetString", self.functions().get_string, references, &mut pointers)?;
        let text = |pointer: fmi2String| {
            if pointer.is_null() {
                return String::new();
            }
            // SAFETY: a text of the FMU lives until its next call [FMI 2.0, 2.1.7]; it is copied at once.
            unsafe { CStr::from_ptr(pointer) }.to_string_lossy().into_owned()
        };
        Ok(pointers.into_iter().map(text).collect())
    }

    /// Sets text variables.
    ///
    /// # Errors
    ///
    /// A text with a NUL character, or the FMU refuses.
    pub fn set_string(&mut self, references: &[u32], values: &[&str]) -> Result<(), Error> {
        let texts = values
            .iter()
            .map(|text| c_text("value", text))
            .collect::<Result<Vec<_>, _>>()?;
        let pointers: Vec<_> = texts.iter().map(|text| text.as_ptr()).collect();
        self.set("fmi2SetString", self.functions().set_string, references, &pointers)
    }

    /// Sets time derivatives of inputs, of orders ≥ 1, at the start of the coming step.
    ///
    /// # Errors
    ///
    /// The FMU cannot, or refuses.
    pub fn set_real_input_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        values: &[f64],
    ) -> Result<(), Error> {
        assert!(
            references.len() == orders.len() && orders.len() == values.len(),
            "one of each per reference"
        );
        let name = "fmi2SetRealInputDerivatives";
        let function = self.optional(name, self.functions().set_input_derivatives)?;
        // SAFETY: the component is alive; the arrays have as many elements as is said.
        self.call(name, |component| unsafe {
            function(
                component,
                references.as_ptr(),
                references.len(),
                orders.as_ptr(),
                values.as_ptr(),
            )
        })
    }

    /// Reads time derivatives of outputs, of orders ≥ 1.
    ///
    /// # Errors
    ///
    /// The FMU cannot, or refuses.
    pub fn get_real_output_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        values: &mut [f64],
    ) -> Result<(), Error> {
        assert!(
            references.len() == orders.len() && orders.len() == values.len(),
            "one of each per reference"
        );
        let name = "fmi2GetRealOutputDerivatives";
        let function = self.optional(name, self.functions().output_derivatives)?;
        // SAFETY: the component is alive; the arrays have as many elements as is said.
        self.call(name, |component| unsafe {
            function(
                component,
                references.as_ptr(),
                references.len(),
                orders.as_ptr(),
                values.as_mut_ptr(),
            )
        })
    }

    /// Jacobian of `unknowns` with respect to `knowns` at the present point, states held, times `seed`.
    ///
    /// # Errors
    ///
    /// The FMU cannot, or refuses.
    pub fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        derivatives: &mut [f64],
    ) -> Result<(), Error> {
        assert!(
            unknowns.len() == derivatives.len() && knowns.len() == seed.len(),
            "one value per reference"
        );
        let name = "fmi2GetDirectionalDerivative";
        let function = self.optional(name, self.functions().directional_derivative)?;
        // SAFETY: the component is alive; the arrays have as many elements as is said.
        self.call(name, |component| unsafe {
            function(
                component,
                unknowns.as_ptr(),
                unknowns.len(),
                knowns.as_ptr(),
                knowns.len(),
                seed.as_ptr(),
                derivatives.as_mut_ptr(),
            )
        })
    }
}
