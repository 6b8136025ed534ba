//! The table of a component: each signal once, with the functions that read and write its value.
use crate::{Causality, DeclaredSignal, Signal};
use scene::Scene;

/// Functions behind a signal of a component `C`. The arguments `member` and `entry` count from 0: the member of the
/// group and the entry of the group's table. In a group with parts `member` counts the parts of all members.
pub enum Access<C> {
    /// Real input.
    Input {
        /// Start value in a scene, from `(scene, member)`.
        start: fn(&Scene, usize) -> f64,
        /// Present value, from `(component, member, entry)`.
        get: fn(&C, usize, usize) -> f64,
        /// Sets `(component, member, entry, value)`; the derivatives become zero.
        set: fn(&mut C, usize, usize, f64),
        /// Sets the derivative at the start of the next step, `(component, member, entry, order, value)`.
        set_derivative: fn(&mut C, usize, usize, usize, f64),
    },
    /// Output.
    Output {
        /// Value with the inputs set since the last step, from `(component, member)`.
        get: fn(&mut C, usize) -> f64,
        /// First derivative with respect to time, from `(component, member)`; 0 if unknown to the component.
        rate: fn(&mut C, usize) -> f64,
        /// Partial derivative with respect to input `entry` of the same member, states frozen, from
        /// `(component, member, entry)`; `None` for an output without direct feedthrough.
        partial: Option<fn(&mut C, usize, usize) -> f64>,
    },
    /// Switch that is set before the start.
    Parameter {
        /// Start value.
        start: f64,
        /// Present value.
        get: fn(&C) -> f64,
        /// Sets the value.
        set: fn(&mut C, f64),
    },
}

/// One signal of a component: its declaration and the access to its value.
pub struct SignalEntry<C> {
    /// Name, unit and meaning.
    pub declared: DeclaredSignal,
    /// Value.
    pub access: Access<C>,
}

impl<C> SignalEntry<C> {
    /// An output without known rate and without direct feedthrough.
    pub const fn output(declared: DeclaredSignal, get: fn(&mut C, usize) -> f64) -> Self {
        Self::output_with_rate(declared, get, |_, _| 0.0)
    }

    /// An output without direct feedthrough.
    pub const fn output_with_rate(
        declared: DeclaredSignal,
        get: fn(&mut C, usize) -> f64,
        rate: fn(&mut C, usize) -> f64,
    ) -> Self {
        let access = Access::Output {
            get,
            rate,
            partial: None,
        };
        Self { declared, access }
    }

    /// Direction of the signal.
    pub const fn causality(&self) -> Causality {
        match self.access {
            Access::Input { .. } => Causality::Input,
            Access::Output { .. } => Causality::Output,
            Access::Parameter { .. } => Causality::Parameter,
        }
    }
}

/// Signals that each member of a group has: `strip[1].…`, `strip[2].…`.
pub struct SignalGroup<C: 'static> {
    /// Name of the group, `strip`; `None` for signals of the component itself, whose names carry no number.
    pub name: Option<&'static str>,
    /// Signals of a member, in order.
    pub entries: &'static [SignalEntry<C>],
    /// Number of members.
    pub members: usize,
    /// Parts of each member that have the signals, by name and number, as in `contact[1].wire[2].force`; `None` for
    /// signals of the member itself. Of groups of one name the one without parts comes first.
    pub parts: Option<(&'static str, usize)>,
}

impl<C> SignalGroup<C> {
    /// Number of parts of a member that have the signals; 1 for the member itself.
    fn parts_of_member(&self) -> usize {
        self.parts.map_or(1, |(_, count)| count)
    }

    /// Number of signals.
    fn len(&self) -> usize {
        self.entries.len() * self.members * self.parts_of_member()
    }

    /// Full name of a signal of a part (from 0), counted through all members.
    fn name_of(&self, part: usize, declared: &DeclaredSignal) -> String {
        match (self.name, self.parts) {
            (None, _) => declared.name.to_owned(),
            (Some(name), None) => declared.of(name, part + 1),
            (Some(name), Some((of_part, count))) => {
                let whole = format!("{name}[{}].{of_part}", part / count + 1);
                declared.of(&whole, part % count + 1)
            }
        }
    }
}

/// Signal at a position: entry, and where the entry belongs.
pub(crate) struct Located<C: 'static> {
    pub entry: &'static SignalEntry<C>,
    /// Member of the group.
    pub member: usize,
    /// Argument `member` of the functions of [`Access`]: the part, or the member itself.
    pub part: usize,
    pub index: usize,
}

/// The signal at `position`, counted through all groups, their members and the entries of each member.
pub(crate) fn located<C>(groups: &[SignalGroup<C>], position: usize) -> Located<C> {
    let mut offset = position;
    for group in groups {
        if offset < group.len() {
            let (part, index) = (offset / group.entries.len(), offset % group.entries.len());
            return Located {
                entry: &group.entries[index],
                member: part / group.parts_of_member(),
                part,
                index,
            };
        }
        offset -= group.len();
    }
    panic!("position {position} of a table that ends {offset} signals before");
}

/// All signals of `groups` in order, with the start values of `scene`.
pub(crate) fn signals<C>(groups: &[SignalGroup<C>], scene: &Scene) -> Vec<Signal> {
    let mut signals = Vec::with_capacity(groups.iter().map(SignalGroup::len).sum());
    for group in groups {
        let parts = group.parts_of_member();
        for part in 0..group.members * parts {
            let member = part / parts;
            let number = group.parts.map_or(member, |(_, count)| part % count) + 1;
            for SignalEntry { declared, access } in group.entries {
                let (causality, start, direct) = match access {
                    Access::Input { start, .. } => (Causality::Input, start(scene, member), false),
                    Access::Output { partial, .. } => (Causality::Output, 0.0, partial.is_some()),
                    Access::Parameter { start, .. } => (Causality::Parameter, *start, false),
                };
                signals.push(Signal {
                    name: group.name_of(part, declared),
                    causality,
                    kind: declared.kind,
                    description: declared.description.replace("{}", &number.to_string()),
                    start,
                    feedthrough: if direct { inputs_of(groups, member) } else { Vec::new() },
                });
            }
        }
    }
    signals
}

/// Positions of the inputs of member `member` (from 0) of every group.
fn inputs_of<C>(groups: &[SignalGroup<C>], member: usize) -> Vec<usize> {
    let mut inputs = Vec::new();
    let mut first = 0;
    for group in groups {
        if member < group.members && group.parts.is_none() {
            let own = (first + member * group.entries.len()..).zip(group.entries);
            inputs.extend(
                own.filter(|(_, entry)| entry.causality() == Causality::Input)
                    .map(|(position, _)| position),
            );
        }
        first += group.len();
    }
    inputs
}

/// Positions of `declared` in each of `members` (from 0) of the group of this name, in order.
///
/// # Panics
/// A component without such a member or signal.
pub fn positions<C>(
    groups: &[SignalGroup<C>],
    name: &str,
    members: impl IntoIterator<Item = usize>,
    declared: &[DeclaredSignal],
) -> Vec<usize> {
    let before = groups.iter().take_while(|group| group.name != Some(name));
    let first: usize = before.map(SignalGroup::len).sum();
    let group = groups.iter().find(|group| group.name == Some(name));
    let (entries, count) = group.map_or((&[][..], 0), |group| (group.entries, group.members));
    let own: Vec<usize> = declared
        .iter()
        .map(|declared| {
            // Units may be others: a drive on a joint has those of a moment.
            let found = entries.iter().position(|entry| entry.declared.name == declared.name);
            found.unwrap_or_else(|| panic!("no {name}[].{} in the table", declared.name))
        })
        .collect();
    let members = members.into_iter();
    members
        .inspect(|member| assert!(*member < count, "{name}[{}] of {count}", member + 1))
        .flat_map(|member| own.iter().map(move |index| first + member * entries.len() + index))
        .collect()
}
