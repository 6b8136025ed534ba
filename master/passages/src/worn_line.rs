//! Wear of a run as a profile of the line, and the profile as its running surface.

use dynamics::RestingSpline;
use results::{Evaluation, Record, Wearing};
use scene::{Catenary, Line, Scene, Surface, WearApplied};
use wear::{Head, Passage, Profile, RoundSection, Terms};

use crate::PassagesError;

/// A line whose contact wire wears.
#[derive(Clone, Debug)]
pub struct WornLine {
    wearing: Wearing,
    /// Places of the supports, m.
    supports: Vec<f64>,
    /// Surface before any wear.
    surface: Option<RestingSpline>,
    unworn: Option<Surface>,
}

impl WornLine {
    /// The line of a scene.
    ///
    /// # Errors
    /// A scene without law or without a line of its own.
    pub fn new(scene: &Scene) -> Result<Self, PassagesError> {
        let refused = |what: &str| PassagesError::Scene(what.to_owned());
        let wearing = simulation::wearing::of(scene).ok_or_else(|| {
            refused(
                "wear is missing: must be a table with the current and the law of the wear, such as that of \
                 scenes/wear.toml",
            )
        })?;
        let Line::Modelled(catenary) = &scene.catenary else {
            return Err(refused(
                "catenary.fmu: a supplied line has no surface that could wear; must be a line of this program",
            ));
        };
        Ok(Self {
            wearing,
            supports: catenary.supports_x(),
            surface: catenary
                .surface
                .as_ref()
                .map(|surface| RestingSpline::new(surface.x.clone(), surface.height.clone())),
            unworn: catenary.surface.clone(),
        })
    }

    /// Section of the wire.
    #[must_use]
    pub fn section(&self) -> RoundSection {
        RoundSection {
            diameter: self.wearing.wear.wire.diameter,
        }
    }

    /// Lost area at which the wire is replaced, m².
    #[must_use]
    pub fn limit(&self) -> f64 {
        0.01 * self.wearing.wear.wire.limit_percent * self.section().whole()
    }

    /// Largest change of the unevenness of the depth in one block, m.
    #[must_use]
    pub fn depth_step(&self) -> f64 {
        self.wearing.wear.depth_step
    }

    fn applied_by_span(&self) -> bool {
        self.wearing.wear.applied == WearApplied::Span
    }

    /// Lost area at the beginning: of one span, or of the whole line where each place has its own wear.
    #[must_use]
    pub fn begin(&self) -> Profile {
        let (first, last) = (self.supports[0], self.supports[self.supports.len() - 1]);
        let end = if self.applied_by_span() { self.supports[1] } else { last };
        let mut profile = Profile::new(first, end, self.wearing.wear.grid);
        profile
            .area
            .fill(self.section().lost(self.wearing.wear.wire.worn_depth));
        profile
    }

    /// Area lost by one passage as a run has it, on the grid of [`WornLine::begin`], and its mean by terms, m².
    ///
    /// # Errors
    /// An evaluation that covers no whole span, or no place that all pantographs pass in it.
    pub fn lost(&self, evaluation: &Evaluation, record: &Record) -> Result<(Profile, Terms), PassagesError> {
        let passage = self.wearing.passage(evaluation);
        let heads = Wearing::heads(evaluation, record);
        let common = passage.common(&heads).ok_or_else(|| {
            let what = "run.evaluate: the pantographs have no evaluated place in common; must cover a whole span for \
                        each of them";
            PassagesError::Scene(what.to_owned())
        })?;
        if self.applied_by_span() {
            self.lost_by_span(&passage, &heads, common)
        } else {
            Ok(self.lost_by_place(&passage, &heads, common))
        }
    }

    fn lost_by_span(
        &self,
        passage: &Passage<'_>,
        heads: &[Head<'_>],
        (from, to): (f64, f64),
    ) -> Result<(Profile, Terms), PassagesError> {
        // An evaluation that ends at a support may end a sample before.
        let room = 2.0 * passage.stride();
        let whole = self.supports.iter().copied();
        let whole: Vec<f64> = whole.filter(|x| (from - room..=to + room).contains(x)).collect();
        let [first, .., last] = whole[..] else {
            return Err(PassagesError::Scene(format!(
                "run.evaluate covers no whole span between {from:.1} and {to:.1} m, whose wear every span could have; \
                 must cover one, or wear.applied = \"place\""
            )));
        };
        let spans = (whole.len() - 1) as f64;
        let mut profile = Profile::new(self.supports[0], self.supports[1], self.wearing.wear.grid);
        let mut volume = Terms::default();
        for (index, head) in heads.iter().enumerate() {
            passage.worn(index, head, (first, last), &mut |places, worn| {
                profile.deposit_periodic(places, worn.sum() / spans);
                volume += worn;
            });
        }
        let profile = profile.averaged(self.wearing.wear.contact_length, true);
        Ok((profile, volume * (1.0 / (last - first))))
    }

    fn lost_by_place(&self, passage: &Passage<'_>, heads: &[Head<'_>], (from, to): (f64, f64)) -> (Profile, Terms) {
        let mut profile = self.begin();
        profile.area.fill(0.0);
        let mut volume = Terms::default();
        for (index, head) in heads.iter().enumerate() {
            passage.worn(index, head, (from, to), &mut |places, worn| {
                profile.deposit(places, worn.sum());
                volume += worn;
            });
        }
        let mean = volume * (1.0 / (to - from));
        let half = 0.5 * profile.cell;
        for index in 0..profile.area.len() {
            let x = profile.x(index);
            if x - half < from || x + half > to {
                profile.area[index] = mean.sum();
            }
        }
        (profile.averaged(self.wearing.wear.contact_length, false), mean)
    }

    /// Worn depth in each cell of a profile of lost area, m.
    #[must_use]
    pub fn depths(&self, lost: &Profile) -> Vec<f64> {
        let section = self.section();
        lost.area.iter().map(|area| section.depth(*area)).collect()
    }

    /// Running surface of the whole line with a profile of lost area.
    #[must_use]
    pub fn running_surface(&self, lost: &Profile) -> Surface {
        let depths = self.depths(lost);
        let spans = if self.applied_by_span() {
            self.supports.len() - 1
        } else {
            1
        };
        let mut surface = Surface {
            x: Vec::new(),
            height: Vec::new(),
        };
        for span in 0..spans {
            let shift = self.supports[span] - self.supports[0];
            for (index, depth) in depths.iter().enumerate() {
                let x = shift + lost.x(index);
                let own = self.surface.as_ref().map_or(0.0, |surface| surface.at(x)[0]);
                surface.x.push(x);
                surface.height.push(own + depth);
            }
        }
        surface
    }

    /// The scene with the surface of a profile of lost area; the scene as it is where nothing is worn.
    #[must_use]
    pub fn scene(&self, scene: &Scene, lost: &Profile) -> Scene {
        let mut scene = scene.clone();
        if let Line::Modelled(Catenary { surface, .. }) = &mut scene.catenary {
            *surface = match lost.area.iter().all(|area| *area == 0.0) {
                true => self.unworn.clone(),
                false => Some(self.running_surface(lost)),
            };
        }
        scene
    }
}
