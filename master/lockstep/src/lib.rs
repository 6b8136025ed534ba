//! Simulations in lockstep: each has a stack of its own and goes on until it asks for something
//! ([`dynamics::lockstep`]); when all have asked, they are answered together.
#![forbid(unsafe_code)]

use std::cell::{Cell, RefCell};
use std::rc::Rc;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use dynamics::lockstep::{Answer, Company, Question, accompanied};
use generator::{Generator, Gn};

/// Words of a stack; memory is taken as it is used.
const STACK: usize = 0x4_0000;

/// Place of one simulation among the others.
struct Seat {
    question: RefCell<Option<(Question, Answer)>>,
    /// Time of the last question, or of its answer.
    asked: Cell<Instant>,
    apart: Cell<Duration>,
}

impl Company for Seat {
    fn ask(&self, question: Question, answer: Answer) -> Question {
        self.question.replace(Some((question, answer)));
        self.asked.set(Instant::now());
        wait();
        let answered = self.question.take();
        let (question, _) = answered.expect("a simulation goes on when it is answered");
        question
    }

    fn apart(&self) -> Duration {
        self.apart.get()
    }
}

/// Leaves the stack of a simulation until it is gone on with.
#[expect(deprecated, reason = "a scope would have to be handed down to whoever asks")]
fn wait() {
    generator::yield_with(());
}

/// A simulation under way.
struct Lane<'a, R> {
    simulation: Generator<'a, (), ()>,
    seat: Rc<Seat>,
    result: Arc<Mutex<Option<R>>>,
}

impl<'a, R: Send + 'a> Lane<'a, R> {
    fn new(simulation: impl FnOnce() -> R + Send + 'a) -> Self {
        let result = Arc::new(Mutex::new(None));
        let place = Arc::clone(&result);
        Self {
            simulation: Gn::new_opt(STACK, move || {
                let result = simulation();
                place.lock().unwrap_or_else(PoisonError::into_inner).replace(result);
            }),
            seat: Rc::new(Seat {
                question: RefCell::default(),
                asked: Cell::new(Instant::now()),
                apart: Cell::default(),
            }),
            result,
        }
    }

    /// Goes on until the next question, or to the end: the result.
    fn go_on(&mut self) -> Option<R> {
        let seat = &self.seat;
        seat.apart.set(seat.apart.get() + seat.asked.get().elapsed());
        let company = Rc::clone(&self.seat);
        accompanied(company, || self.simulation.resume());
        self.result.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// Makes jobs, as long as `draw` has some, `most` of them in lockstep; `done` is given each result, and returns `false`
/// where no further job is wanted. Simulations that ask nothing are made one after the other.
pub fn together<J: Send, R: Send>(
    most: usize,
    draw: &mut dyn FnMut() -> Option<J>,
    one: &(dyn Fn(J) -> R + Sync),
    done: &mut dyn FnMut(R) -> bool,
) {
    let mut wanted = true;
    while wanted {
        let mut lanes: Vec<Lane<'_, R>> = Vec::with_capacity(most);
        while wanted && lanes.len() < most {
            let Some(job) = draw() else {
                wanted = false;
                break;
            };
            if most == 1 {
                wanted &= done(one(job));
                continue;
            }
            let mut lane = Lane::new(move || one(job));
            match lane.go_on() {
                Some(result) => wanted &= done(result),
                None => lanes.push(lane),
            }
        }
        // Simulations go on side by side only from the same start: later ones would have other places.
        while !lanes.is_empty() {
            answer(&lanes);
            lanes.retain_mut(|lane| match lane.go_on() {
                Some(result) => {
                    wanted &= done(result);
                    false
                }
                None => true,
            });
        }
    }
}

/// Answers what all have asked.
fn answer<R>(lanes: &[Lane<'_, R>]) {
    let begin = Instant::now();
    let mut open: Vec<(&Seat, Question, Answer)> = Vec::with_capacity(lanes.len());
    for lane in lanes {
        let asked = lane.seat.question.take();
        open.extend(asked.map(|(question, answer)| (&*lane.seat, question, answer)));
    }
    while let Some((_, first, answer)) = open.first() {
        let (kind, answer) = ((**first).type_id(), *answer);
        let (alike, others): (Vec<_>, Vec<_>) = open
            .into_iter()
            .partition(|(_, question, _)| (**question).type_id() == kind);
        open = others;
        let (seats, mut questions): (Vec<&Seat>, Vec<Question>) =
            alike.into_iter().map(|(seat, question, _)| (seat, question)).unzip();
        answer(&mut questions);
        for (seat, question) in seats.into_iter().zip(questions) {
            seat.question.replace(Some((question, answer)));
        }
    }
    let end = Instant::now();
    let share = end.duration_since(begin) / lanes.len().max(1) as u32;
    for Lane { seat, .. } in lanes {
        let apart = end.duration_since(seat.asked.get()).saturating_sub(share);
        seat.apart.set(seat.apart.get() + apart);
        seat.asked.set(end);
    }
}

#[cfg(test)]
mod tests;
