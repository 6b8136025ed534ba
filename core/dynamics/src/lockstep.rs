//! Questions of simulations that go on in lockstep, answered together.
//!
//! Sums over numbers that several simulations share take less time together: the numbers are read once. A simulation
//! by itself is answered at once; one in company waits until the others have asked too. Answers are the same bits in
//! both cases.
use std::any::Any;
use std::cell::RefCell;
use std::rc::Rc;
use std::time::{Duration, Instant};

/// A question with room for its answer.
pub trait Asked: Any + Send {
    /// Answers all, each with the bits that it has when it is asked alone.
    fn answer(all: &mut [&mut Self]);
}

/// A question of any kind.
pub type Question = Box<dyn Any + Send>;

/// The answer to questions of one kind.
pub type Answer = fn(&mut [Question]);

/// Simulations among which one goes on in lockstep, as that one sees them.
pub trait Company {
    /// Returns the question when it is answered.
    fn ask(&self, question: Question, answer: Answer) -> Question;

    /// Time in which others went on, and their share of the answers.
    fn apart(&self) -> Duration;
}

thread_local! {
    static COMPANY: RefCell<Option<Rc<dyn Company>>> = const { RefCell::new(None) };
}

/// Goes on with `simulation` in `company`.
pub fn accompanied<T>(company: Rc<dyn Company>, simulation: impl FnOnce() -> T) -> T {
    let before = COMPANY.replace(Some(company));
    let result = simulation();
    COMPANY.set(before);
    result
}

/// The company of the simulation that goes on in this thread.
fn company() -> Option<Rc<dyn Company>> {
    COMPANY.with_borrow(Clone::clone)
}

/// Has a question answered, by itself or in company.
#[must_use]
pub fn ask<Q: Asked>(mut question: Box<Q>) -> Box<Q> {
    let Some(company) = company() else {
        Q::answer(&mut [&mut question]);
        return question;
    };
    match company.ask(question, answer_all::<Q>).downcast() {
        Ok(question) => question,
        Err(_) => unreachable!("a company gives back what was asked"),
    }
}

fn answer_all<Q: Asked>(questions: &mut [Question]) {
    let mut all: Vec<&mut Q> = questions
        .iter_mut()
        .filter_map(|question| question.downcast_mut())
        .collect();
    Q::answer(&mut all);
}

/// Wall time of a simulation, without that of its company.
pub struct Stopwatch {
    begin: Instant,
    apart: Duration,
}

impl Stopwatch {
    /// Counts from now.
    #[must_use]
    pub fn start() -> Self {
        Self {
            begin: Instant::now(),
            apart: apart(),
        }
    }

    /// Time since the start.
    #[must_use]
    pub fn elapsed(&self) -> Duration {
        self.begin.elapsed().saturating_sub(apart().saturating_sub(self.apart))
    }
}

fn apart() -> Duration {
    company().map_or(Duration::ZERO, |company| company.apart())
}
