//! `[[controller]]`: an FMU that gives the commands of a pantograph's drive.

use crate::check::{Found, refuse};
use crate::keys::{Entry, Keys, Sentences};
use crate::{ControlLaw, Scene, Supplied};

/// `[[controller]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct ControllerFmu {
    /// Index of its pantograph, from 0.
    pub pantograph: usize,
    /// The FMU with its wiring.
    pub side: Supplied,
}

impl Entry for ControllerFmu {
    const SENTENCES: Sentences = &[(
        "pantograph",
        "Number of the pantograph whose drive it commands, which has `control.law = \"given\"`.",
    )];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let number = was.map(|controller| controller.pantograph + 1);
        Self {
            pantograph: keys.count("pantograph", number, 1..=1000, Some(1)) - 1,
            side: Supplied::controller(keys, was.map(|controller| &controller.side)),
        }
    }
}

impl Scene {
    /// The controller FMU of pantograph `index` (from 0), with its own index.
    #[must_use]
    pub fn controller_of(&self, index: usize) -> Option<(usize, &ControllerFmu)> {
        let mut all = self.controllers.iter().enumerate();
        all.find(|(_, controller)| controller.pantograph == index)
    }

    /// Checks controller FMUs against the pantographs that they command.
    pub(crate) fn check_controllers(&self, found: &mut Found) {
        for (index, controller) in self.controllers.iter().enumerate() {
            let path = format!("controller[{}]", index + 1);
            controller.side.check_controller(&path, found);
            let number = controller.pantograph + 1;
            let key = format!("{path}.pantograph");
            let Some(pantograph) = self.pantographs.get(controller.pantograph) else {
                let expected = format!("must be at most {}, the number of pantographs", self.pantographs.len());
                refuse(found, key, number.to_string(), expected);
                continue;
            };
            if let Some((first, _)) = self
                .controller_of(controller.pantograph)
                .filter(|(first, _)| *first < index)
            {
                let expected = format!("must be another one: controller[{}] commands this one", first + 1);
                refuse(found, key, number.to_string(), expected);
            } else {
                let law = pantograph.control.as_ref().map(|control| control.law);
                if law != Some(ControlLaw::Given) {
                    let has = law.map_or_else(
                        || "has no control".to_owned(),
                        |law| format!("has law = \"{}\"", law.name()),
                    );
                    let expected = format!(
                        "must be a pantograph with control = {{ law = \"given\", sample_time = ... }}, which says \
                         when and through which drive the commands act; pantograph[{number}] {has}"
                    );
                    refuse(found, key, number.to_string(), expected);
                }
            }
        }
    }
}
