//! Slaves that step on a thread of their own.
//!
//! A [`Parallel`] slave hands itself to its thread when it is asked to step, and is waited for when it is next asked
//! for anything: an algorithm that steps several slaves before it reads them has them step side by side without
//! knowing. Every slave does the same operations in the same order as without threads, so that results are the same bit
//! for bit.

#[cfg(test)]
mod tests;

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle, Thread};

use crate::slave::{Abilities, Slave, SlaveError};
use component::Frame;
use component::Work;

/// Looks at the other thread before this one sleeps: some 50 µs, the length of a short step.
const LOOKS: u32 = 4000;

const IDLE: u8 = 0;
const ASKED: u8 = 1;
const DONE: u8 = 2;
const ENDED: u8 = 3;

/// Data that goes to the thread and comes back.
enum Parcel {
    Step(Box<dyn Slave>, f64, f64, Thread),
    Stepped(Box<dyn Slave>, Result<(), SlaveError>),
    Panicked(Box<dyn Any + Send>),
}

#[derive(Default)]
struct Post {
    state: AtomicU8,
    parcel: Mutex<Option<Parcel>>,
}

impl Post {
    fn put(&self, parcel: Parcel, state: u8) {
        *self.parcel.lock().unwrap_or_else(PoisonError::into_inner) = Some(parcel);
        self.state.store(state, Ordering::Release);
    }

    fn take(&self) -> Option<Parcel> {
        self.parcel.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// Waits for a state that `is_it`, first awake, then asleep until another thread wakes this one.
    fn wait(&self, is_it: impl Fn(u8) -> bool) -> u8 {
        let mut looks = 0;
        loop {
            let state = self.state.load(Ordering::Acquire);
            if is_it(state) {
                return state;
            }
            looks += 1;
            if looks < LOOKS {
                std::hint::spin_loop();
            } else {
                thread::park();
            }
        }
    }
}

/// A slave whose steps run on a thread of their own.
///
/// An error of a step is reported by the call after [`Slave::do_step`].
pub struct Parallel {
    name: String,
    abilities: Abilities,
    /// Here unless it is stepping.
    slave: Option<Box<dyn Slave>>,
    failed: Option<SlaveError>,
    post: Arc<Post>,
    thread: Option<JoinHandle<()>>,
}

impl Parallel {
    /// Gives `slave` a thread; gives it back where the system has none left.
    ///
    /// # Errors
    /// The slave itself.
    pub fn new(slave: Box<dyn Slave>) -> Result<Self, Box<dyn Slave>> {
        let post = Arc::new(Post::default());
        let its = Arc::clone(&post);
        let Ok(thread) = thread::Builder::new()
            .name(slave.name().to_owned())
            .spawn(move || serve(&its))
        else {
            return Err(slave);
        };
        Ok(Self {
            name: slave.name().to_owned(),
            abilities: slave.abilities(),
            slave: Some(slave),
            failed: None,
            post,
            thread: Some(thread),
        })
    }

    /// The slave, after the step under way.
    fn here(&mut self) -> &mut dyn Slave {
        if self.slave.is_none() {
            self.post.wait(|state| state == DONE);
            self.post.state.store(IDLE, Ordering::Relaxed);
            match self.post.take() {
                Some(Parcel::Stepped(slave, result)) => {
                    self.slave = Some(slave);
                    self.failed = result.err();
                }
                Some(Parcel::Panicked(panic)) => resume_unwind(panic),
                _ => unreachable!("the thread answers a step with what became of it"),
            }
        }
        &mut **self.slave.as_mut().expect("it has just come back")
    }

    /// The slave, unless its last step has failed.
    fn sound(&mut self) -> Result<&mut dyn Slave, SlaveError> {
        self.here();
        match self.failed.take() {
            Some(error) => Err(error),
            None => Ok(self.here()),
        }
    }
}

/// Loop of the thread.
fn serve(post: &Post) {
    loop {
        if post.wait(|state| state == ASKED || state == ENDED) == ENDED {
            return;
        }
        let Some(Parcel::Step(mut slave, t, h, asker)) = post.take() else {
            unreachable!("a step is asked for with a slave");
        };
        let done = catch_unwind(AssertUnwindSafe(move || {
            let result = slave.do_step(t, h);
            Parcel::Stepped(slave, result)
        }));
        post.put(done.unwrap_or_else(Parcel::Panicked), DONE);
        asker.unpark();
    }
}

impl Slave for Parallel {
    fn name(&self) -> &str {
        &self.name
    }

    fn abilities(&self) -> Abilities {
        self.abilities
    }

    fn set_inputs(&mut self, values: &[f64]) -> Result<(), SlaveError> {
        self.sound()?.set_inputs(values)
    }

    fn set_input_derivatives(&mut self, order: usize, values: &[f64]) -> Result<(), SlaveError> {
        self.sound()?.set_input_derivatives(order, values)
    }

    fn do_step(&mut self, t: f64, h: f64) -> Result<(), SlaveError> {
        self.sound()?;
        if let (Some(slave), Some(thread)) = (self.slave.take(), &self.thread) {
            self.post.put(Parcel::Step(slave, t, h, thread::current()), ASKED);
            thread.thread().unpark();
        }
        Ok(())
    }

    fn outputs(&mut self, values: &mut [f64]) -> Result<(), SlaveError> {
        self.sound()?.outputs(values)
    }

    fn save(&mut self) -> Result<(), SlaveError> {
        self.sound()?.save()
    }

    fn restore(&mut self) -> Result<(), SlaveError> {
        // Whatever became of the step is taken back.
        self.here();
        self.failed = None;
        self.here().restore()
    }

    fn work(&mut self) -> Work {
        self.here().work()
    }

    fn draw(&mut self, frame: &mut Frame) {
        self.here().draw(frame);
    }

    fn finish_drawing(&mut self, frames: &mut [Frame]) {
        self.here().finish_drawing(frames);
    }
}

impl Drop for Parallel {
    fn drop(&mut self) {
        // After a panic the slave is gone and nothing is under way.
        if self.slave.is_none() && self.post.state.load(Ordering::Acquire) != IDLE {
            self.post.wait(|state| state == DONE);
        }
        self.post.state.store(ENDED, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            thread.thread().unpark();
            // A panic of the slave was caught; there is nothing else to hear from it.
            let _ = thread.join();
        }
    }
}

/// Gives those pantographs threads that `pays` names and that can step beside another slave; says what was done.
///
/// `beside_the_line`: whether the line steps at the same time; where it does not, one of the pantographs stays with it.
pub fn arrange(pantographs: &mut Vec<Box<dyn Slave>>, pays: &[bool], beside_the_line: bool) -> Option<String> {
    let mut chosen: Vec<usize> = (0..pantographs.len()).filter(|&i| pays[i]).collect();
    if !beside_the_line {
        chosen.pop();
    }
    let mut names = Vec::new();
    let all = std::mem::take(pantographs);
    for (i, slave) in all.into_iter().enumerate() {
        if !chosen.contains(&i) {
            pantographs.push(slave);
            continue;
        }
        pantographs.push(match Parallel::new(slave) {
            Ok(parallel) => {
                names.push(parallel.name.clone());
                Box::new(parallel)
            }
            Err(slave) => slave,
        });
    }
    (!names.is_empty()).then(|| format!("on threads of their own: {}", names.join(", ")))
}
