//! Steps of both sides that are parted where the algorithm asks for it, and halved where they fail.

use system::run::{HALVINGS, halved_note};

use crate::algorithm::{Algorithm, CouplingError, Exchange, Sides};

/// Number of further tries of a part that cannot be halved any more, before the step is given up: an FMU may discard a
/// step for a reason of its own that does not come back.
const RETRIES: u32 = 8;

/// Stepper of both sides between two communication points.
pub struct Stepper<'a, 'b> {
    /// Line and pantographs.
    pub sides: &'a mut Sides<'b>,
    /// Coupling of the sides.
    pub algorithm: &'a mut dyn Algorithm,
    /// Outputs of the slaves.
    pub exchange: &'a mut Exchange,
    /// Times that they were taken back.
    pub rollbacks: u64,
    /// Steps and parts of them that failed and were tried again, and the words of the first failure.
    failed: u64,
    first_failure: Option<String>,
    /// True where every slave can go back and takes any step.
    can_roll_back: bool,
    can_vary_step: bool,
    /// True where going back takes a save before each step.
    must_save: bool,
}

impl<'a, 'b> Stepper<'a, 'b> {
    /// Sides that stand at the present point of `exchange`.
    pub fn new(sides: &'a mut Sides<'b>, algorithm: &'a mut dyn Algorithm, exchange: &'a mut Exchange) -> Self {
        let can_vary_step = sides.can_vary_step();
        let can_roll_back = sides.can_roll_back() && can_vary_step;
        Self {
            must_save: can_roll_back && !algorithm.saves(),
            can_roll_back,
            can_vary_step,
            sides,
            algorithm,
            exchange,
            rollbacks: 0,
            failed: 0,
            first_failure: None,
        }
    }

    /// Saves both sides where steps may be taken back: the first save finds room for their states, which takes longer
    /// than a step.
    ///
    /// # Errors
    /// Error reported by a slave.
    pub fn get_ready(&mut self) -> Result<(), CouplingError> {
        if self.can_roll_back {
            self.sides.save()?;
        }
        Ok(())
    }

    /// True where a step that ended with `error` can be taken back and done in shorter ones.
    #[must_use]
    pub fn can_retry(&self, error: &CouplingError) -> bool {
        self.can_roll_back && error.is_retryable()
    }

    /// Steps both sides by `h` s; what they reach is not accepted yet.
    ///
    /// # Errors
    /// See [`Algorithm::step`].
    pub fn attempt(&mut self, h: f64) -> Result<(), CouplingError> {
        if self.must_save {
            self.sides.save()?;
        }
        self.rollbacks += self.algorithm.step(self.sides, self.exchange, h)?;
        Ok(())
    }

    /// Counts a step that failed with `error` and is tried again.
    pub fn fail(&mut self, error: &CouplingError) {
        self.failed += 1;
        self.first_failure.get_or_insert_with(|| crate::chain(error));
    }

    /// Note on steps that failed and were done in shorter ones.
    #[must_use]
    pub fn failure_note(&self) -> Option<String> {
        let first = self.first_failure.as_ref()?;
        Some(halved_note(self.failed, first))
    }

    /// Takes both sides back to the present point.
    ///
    /// # Errors
    /// Error reported by a slave.
    pub fn take_back(&mut self) -> Result<(), CouplingError> {
        self.sides.restore()?;
        self.rollbacks += 1;
        Ok(())
    }

    /// Advances to `end` over `h` s, in as many parts as the algorithm asks for; `accepted` sees each point that is
    /// reached.
    ///
    /// # Errors
    /// That of the last try.
    pub fn advance(&mut self, end: f64, h: f64, accepted: &mut dyn FnMut(&Exchange)) -> Result<(), CouplingError> {
        let parts = if self.can_vary_step {
            self.algorithm.parts(self.exchange, h)
        } else {
            1
        };
        let part = h / parts as f64;
        for left in (1..parts).rev() {
            self.in_one(end - left as f64 * part, part, HALVINGS, accepted)?;
        }
        self.in_one(end, part, HALVINGS, accepted)
    }

    /// Advances to `end` over `h` s in two halves, and these in halves where they fail.
    ///
    /// # Errors
    /// That of the last try.
    pub fn advance_in_halves(
        &mut self,
        end: f64,
        h: f64,
        accepted: &mut dyn FnMut(&Exchange),
    ) -> Result<(), CouplingError> {
        self.in_halves(end, h, HALVINGS, accepted)
    }

    /// A step that fails is taken back and done in two halves, `halvings` times at most, where that is possible.
    fn in_one(
        &mut self,
        end: f64,
        h: f64,
        halvings: u32,
        accepted: &mut dyn FnMut(&Exchange),
    ) -> Result<(), CouplingError> {
        let mut retries = RETRIES;
        loop {
            match self.attempt(h) {
                Ok(()) => {
                    self.exchange.accept(end);
                    accepted(self.exchange);
                    return Ok(());
                }
                Err(error) if halvings > 0 && self.can_retry(&error) => {
                    self.fail(&error);
                    self.take_back()?;
                    return self.in_halves(end, h, halvings, accepted);
                }
                Err(error) if retries > 0 && self.can_retry(&error) => {
                    self.fail(&error);
                    self.take_back()?;
                    retries -= 1;
                }
                Err(error) => return Err(error),
            }
        }
    }

    fn in_halves(
        &mut self,
        end: f64,
        h: f64,
        halvings: u32,
        accepted: &mut dyn FnMut(&Exchange),
    ) -> Result<(), CouplingError> {
        self.in_one(end - 0.5 * h, 0.5 * h, halvings - 1, accepted)?;
        self.in_one(end, 0.5 * h, halvings - 1, accepted)
    }
}
