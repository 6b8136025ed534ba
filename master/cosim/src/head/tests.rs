use super::*;

/// Rises by the sum of the forces on its two strips; counts steps.
struct Beam {
    given: Vec<f64>,
    rate: Vec<f64>,
    height: f64,
    kept: f64,
    steps: u64,
}

impl Slave for Beam {
    fn name(&self) -> &str {
        "pantograph 1"
    }
    fn abilities(&self) -> Abilities {
        Abilities {
            rollback: true,
            input_derivatives: 3,
            variable_step: true,
        }
    }
    fn set_inputs(&mut self, values: &[f64]) -> Result<(), SlaveError> {
        self.given = values.to_vec();
        self.rate = vec![0.0; values.len()];
        Ok(())
    }
    fn set_input_derivatives(&mut self, order: usize, values: &[f64]) -> Result<(), SlaveError> {
        assert_eq!(order, 1);
        self.rate = values.to_vec();
        Ok(())
    }
    fn do_step(&mut self, _: f64, h: f64) -> Result<(), SlaveError> {
        self.steps += 1;
        for strip in 0..2 {
            let fz = strip * load::COUNT + load::FZ;
            self.height += h * (self.given[fz] + 0.5 * h * self.rate[fz]);
        }
        Ok(())
    }
    fn outputs(&mut self, values: &mut [f64]) -> Result<(), SlaveError> {
        for (number, values) in values.chunks_exact_mut(strip::OUTPUTS).enumerate() {
            values[strip::Z] = self.height + number as f64;
        }
        Ok(())
    }
    fn save(&mut self) -> Result<(), SlaveError> {
        self.kept = self.height;
        Ok(())
    }
    fn restore(&mut self) -> Result<(), SlaveError> {
        self.height = self.kept;
        Ok(())
    }
    fn work(&mut self) -> Work {
        Work {
            micro_steps: self.steps,
            ..Work::default()
        }
    }
}

fn strips() -> Vec<Box<dyn Slave>> {
    let beam = Beam {
        given: Vec::new(),
        rate: Vec::new(),
        height: 0.0,
        kept: 0.0,
        steps: 0,
    };
    strips_of(Box::new(beam), 2)
}

/// A step of both strips under vertical forces of 1 N and 2 N; the second rises by 4 N/s where it `rises`.
fn step(strips: &mut [Box<dyn Slave>], rises: f64) {
    for (number, strip) in strips.iter_mut().enumerate() {
        let mut load = [0.0; load::COUNT];
        load[load::FZ] = 1.0 + number as f64;
        strip.set_inputs(&load).unwrap();
        if number == 1 && rises > 0.0 {
            let mut rate = [0.0; load::COUNT];
            rate[load::FZ] = rises;
            strip.set_input_derivatives(1, &rate).unwrap();
        }
        strip.do_step(0.0, 0.5).unwrap();
    }
}

fn heights(strips: &mut [Box<dyn Slave>]) -> [f64; 2] {
    [0, 1].map(|number| {
        let mut values = [0.0; strip::OUTPUTS];
        strips[number].outputs(&mut values).unwrap();
        values[strip::Z]
    })
}

#[test]
fn the_strips_of_a_head_step_it_once_and_read_their_own_outputs() {
    let mut strips = strips();
    step(&mut strips, 4.0);
    // (1 + 2) N over 0.5 s, and 4 N/s over 0.5 s: 4 · 0.25/2 = 0.5.
    assert_eq!(heights(&mut strips), [2.0, 3.0]);
    assert_eq!(strips.iter_mut().map(|strip| strip.work().micro_steps).sum::<u64>(), 1);
    // Derivatives are those of the step for which they were set.
    step(&mut strips, 0.0);
    assert_eq!(heights(&mut strips), [3.5, 4.5]);
}

#[test]
fn a_step_that_is_taken_back_begins_anew() {
    let mut strips = strips();
    step(&mut strips, 0.0);
    strips.iter_mut().for_each(|strip| strip.save().unwrap());
    step(&mut strips, 4.0);
    // A second strip that was not asked to step leaves nothing behind.
    strips[0].do_step(0.5, 0.5).unwrap();
    strips.iter_mut().for_each(|strip| strip.restore().unwrap());
    assert_eq!(heights(&mut strips), [1.5, 2.5]);
    step(&mut strips, 4.0);
    assert_eq!(heights(&mut strips), [3.5, 4.5]);
}

#[test]
fn one_strip_is_the_pantograph_itself() {
    let [slave] = &strips_of(
        Box::new(Beam {
            given: Vec::new(),
            rate: Vec::new(),
            height: 0.0,
            kept: 0.0,
            steps: 0,
        }),
        1,
    )[..] else {
        panic!("one slave");
    };
    assert_eq!(slave.name(), "pantograph 1");
}
