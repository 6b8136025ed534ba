//! The modes of a linearised line, and what the modes left out add.
use super::base::Wish;
use super::store::{key, known_or};
use super::stretch::stretches;
use crate::{CurveColumns, DropperLaw, Line, LinearLine, StaticsError, WireCurve};
use dynamics::eigen::{BandedFactor, BandedMatrix, Eigenpairs, attachment_pairs, eigenpairs_below};
use dynamics::modal::Aligned;
use dynamics::modal::kernels::{self, LANES};
use dynamics::{Blocks, Force, Layout, SparseMatrix, Weights};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Rows of a contact wire on either side between which modes left out are taken as connected: two elements.
const NEAR: usize = 12;
/// Rows of a contact wire that are near a place.
const WIDTH: usize = 2 * NEAR + 1;
/// Frequency of slow modes, Hz: others move wires by less than a line's width in a picture, and stretch them unevenly.
const SLOW: f64 = 30.0;
/// Frequency of modes that feel the creep of droppers far from strips, Hz: faster ones do not last.
const CREEPING: f64 = 15.0;
/// Largest rate at which dampers along wires may brake slow modes, 1/s: forces take these back once in a step.
const BRAKED: f64 = 100.0;
/// Marks a coordinate without a row.
const NONE: u32 = u32::MAX;

/// Largest stiffness of rods that stand for droppers which creep, N/m.
const ROD: f64 = 1e7;
/// Frequency up to which a dropper that creeps has its own law, Hz.
const FELT: f64 = 20.0;
/// Its part there that is lost, –: softer rods are worse, and stiffer ones are for shorter steps.
const LOST: f64 = 0.05;
/// Stiffness of a dropper above which its damper does not tell, N/m: its spring is a rod.
const STIFF: f64 = 0.1 * ROD;

/// Law of droppers in the modes, and that of spring and damper end to end with rods where droppers creep: together they
/// have the law of the dropper at rest and in slow motion.
///
/// Rod, spring and damper end to end are the spring `k` beside the damper `c` end to end with a spring `K − k`. The
/// latter takes `(ω c)²/(K − k)` from `k + i ω c`, which makes `K` (*derived here*).
fn laws(law: DropperLaw, wish: Wish) -> (DropperLaw, Option<DropperLaw>) {
    let rod = |stiffness| DropperLaw {
        stiffness,
        damping: wish.beta * stiffness,
    };
    if !wish.creeping {
        (law, None)
    } else if law.stiffness > STIFF {
        (rod(law.stiffness), None)
    } else {
        let damper = TAU * FELT * law.damping;
        let stiffness = law.stiffness + damper * damper / (LOST * (law.stiffness + damper));
        let stiffness = stiffness.min(ROD);
        let more = stiffness / (stiffness - law.stiffness);
        let creeping = DropperLaw {
            stiffness: more * law.stiffness,
            damping: more * more * law.damping,
        };
        (rod(stiffness), Some(creeping))
    }
}

/// Modes `φₖ` with `φₖᵀ M φₖ = 1`, as far as contact, droppers and pictures see them.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Modes {
    /// Frequency up to which modes of the line are kept, Hz.
    pub highest: f64,
    /// `ωₖ²`, 1/s².
    pub stiffness: Vec<f64>,
    /// `cₖ`, 1/s.
    pub damping: Vec<f64>,
    /// Row of each coordinate of the linearised line.
    row_of: Vec<u32>,
    /// Entries of all modes at the coordinates with rows: those of the contact wires along them, then the vertical ones
    /// of the other nodes. Single precision halves the memory; what the modes left out add makes up for the rounding at
    /// rest.
    rows: Aligned,
    /// Number of contact wires, whose rows follow on each other.
    contact_wires: usize,
    /// First of the [`WIDTH`] rows of each contact wire that are near a row of any of them, row after row.
    near: Vec<u32>,
    /// Residual compliance between a row of contact wires and those near it, m/N.
    residual: Vec<f64>,
    /// Law of the droppers, with the dampers that the modes give them.
    pub law: DropperLaw,
    /// Spring and damper of droppers that creep, end to end with the rods of `law`.
    pub creeping: Option<DropperLaw>,
    /// Number of slow modes that feel the creep of droppers far from strips.
    pub creeping_modes: usize,
    /// Dampers that the modes have beyond those of the line and forces take back, first of the droppers and then of
    /// supports, N·s/m.
    pub borrowed: Vec<f64>,
    /// x of the supports with such dampers, m.
    pub support_x: Vec<f64>,
    /// Tension of each dropper at rest, N; negative for what a slack one lacks.
    pub at_rest: Vec<f64>,
    /// x of the lower end of each dropper, m.
    pub dropper_x: Vec<f64>,
    /// `gⱼᵀ φₖ`, dropper after dropper, then the deflections of the supports with dampers. Single precision, which is
    /// a hundredth of a newton, halves the time that droppers take.
    joint_rows: Aligned,
    /// The same of droppers that creep and slow modes that feel it: rows side by side are read faster.
    creeping_rows: Aligned,
    /// Number of slow modes.
    pub slow: usize,
    /// Elongation of each length of a wire by slow modes, length after length.
    stretch_rows: Aligned,
    /// Dampers of each length that slow modes have and forces take back, N·s/m.
    pub stretch_dampers: Vec<f64>,
    /// Residual deflection of the rows of contact wires by a unit force along each dropper, dropper after dropper, m/N.
    dropper_residual: Vec<f64>,
    /// Residual elongation of droppers by unit forces along each other one, m/N.
    between_droppers: Vec<f64>,
}

/// The free coordinates of a line, and its matrices on them.
struct Pencil {
    /// Number of each coordinate among those that are not held.
    free: Vec<Option<usize>>,
    stiffness: BandedMatrix,
    damping: BandedMatrix,
    mass: BandedMatrix,
    /// Row of each coordinate.
    row_of: Vec<u32>,
    /// Place along the track of each row of the contact wires, wire after wire, m.
    contact_x: Vec<Vec<f64>>,
}

impl Modes {
    /// The modes of a line that are asked for, found now or before.
    ///
    /// Forces of droppers have attachment modes unless their own dampers would make these swing; then more modes are
    /// kept.
    pub fn of(linear: &mut LinearLine, layout: &Layout, wish: Wish) -> Result<Arc<Self>, StaticsError> {
        let (law, creeping) = laws(linear.droppers().law(), wish);
        let pencil = Pencil::of(linear, layout, law);
        let linear: &LinearLine = linear;
        let mut key = key();
        key.add(wish.highest);
        key.add([wish.beta, wish.bearable, f64::from(u8::from(wish.stretching))]);
        key.add(
            pencil
                .free
                .iter()
                .map(|number| number.map_or(-1.0, |number| number as f64)),
        );
        for matrix in [&pencil.stiffness, &pencil.damping, &pencil.mass] {
            key.add(matrix.entries().iter().copied());
        }
        let of_line = linear.droppers().law();
        key.add([of_line.stiffness, of_line.damping]);
        for dropper in linear.droppers().as_slice() {
            key.add([dropper.elongation]);
            key.add(dropper.gradient.iter().flat_map(|&(at, g)| [at as f64, g]));
        }
        key.add(pencil.row_of.iter().map(|row| f64::from(*row)));
        known_or(key, || Self::found(linear, &pencil, (law, creeping), wish))
    }

    fn found(
        linear: &LinearLine,
        pencil: &Pencil,
        (law, creeping): (DropperLaw, Option<DropperLaw>),
        wish: Wish,
    ) -> Result<Self, StaticsError> {
        let free = &pencil.free;
        let droppers = linear.droppers().as_slice();
        let gradient = |dropper: &crate::LinearDropper| -> Vec<(usize, f64)> {
            let entries = dropper.gradient.iter();
            entries.filter_map(|&(at, g)| Some((free[at]?, g))).collect()
        };
        let gradients: Vec<Vec<(usize, f64)>> = droppers.iter().map(gradient).collect();
        let factor = BandedFactor::new(&pencil.stiffness);
        // Dampers that the modes give droppers beyond their own: where the own ones are the larger ones, attachment
        // modes would swing.
        let excess = wish.beta * law.stiffness - law.damping;
        let is_attached = excess >= -wish.bearable;
        let [with_attachments, without] = wish.highest;
        let highest = if is_attached { with_attachments } else { without };
        let known = eigenpairs_below(&pencil.stiffness, &pencil.mass, (TAU * highest).powi(2));
        let known = known.map_err(|error| {
            let reason = error.to_string();
            StaticsError::Modes { reason }
        })?;
        let known = worth_keeping(linear, free, known, highest);
        let pairs = if is_attached {
            let attachments = attachment_pairs((&factor, &SparseMatrix::from(&pencil.mass)), &known, &gradients);
            known.merged(attachments)
        } else {
            known
        };
        let modes = pairs.values.len().next_multiple_of(LANES);
        let rows_in_all = pencil.row_of.iter().filter(|row| **row != NONE).count();
        let mut at_row = vec![0; rows_in_all];
        for (&row, free) in pencil.row_of.iter().zip(free) {
            if let (true, Some(free)) = (row != NONE, free) {
                at_row[row as usize] = *free;
            }
        }
        let mut rows = Aligned::zeros(at_row.len() * modes);
        for (row, &free) in at_row.iter().enumerate() {
            for (entry, vector) in rows[row * modes..][..modes].iter_mut().zip(&pairs.vectors) {
                *entry = vector[free] as f32;
            }
        }
        let supports = supports(linear, free);
        let held = supports.iter().map(|support| vec![(support.free, 1.0)]);
        let joints: Vec<Vec<(usize, f64)>> = gradients.iter().cloned().chain(held).collect();
        let joint_rows = rows_along(&joints, &pairs.vectors, modes);
        let [slow, creeping_modes] = [SLOW, if creeping.is_some() { CREEPING } else { 0.0 }].map(|frequency| {
            let below = pairs.values.partition_point(|value| *value < (TAU * frequency).powi(2));
            below.next_multiple_of(LANES).min(modes)
        });
        let braked = wish.beta * (TAU * SLOW).powi(2);
        let stretches = if wish.stretching && braked <= BRAKED {
            stretches(linear, free)
        } else {
            Vec::new()
        };
        let (gradients_of_lengths, stretch_dampers): (Vec<_>, Vec<_>) = stretches
            .into_iter()
            .map(|stretch| (stretch.gradient, wish.beta * stretch.stiffness))
            .unzip();
        let stretch_rows = rows_along(&gradients_of_lengths, &pairs.vectors, slow);
        let of_supports = supports.iter().map(|support| wish.beta * support.stiffness);
        let of_droppers = std::iter::repeat_n(excess, droppers.len());
        let mut borrowed: Vec<f64> = of_droppers.chain(of_supports).collect();
        let of_line = SparseMatrix::from(&pencil.damping);
        let of_modes = pairs.vectors.iter().enumerate().map(|(mode, vector)| {
            let joints = joints.iter().zip(&borrowed);
            let by_joints = joints.map(|(gradient, damper)| damper * along(gradient, vector).powi(2));
            let stretches = stretch_rows.chunks_exact(slow.max(1)).zip(&stretch_dampers);
            let stretches = stretches.filter(|_| mode < slow);
            let by_stretches = stretches.map(|(row, damper)| damper * f64::from(row[mode]).powi(2));
            of_line.quadratic_form(vector) + by_joints.sum::<f64>() + by_stretches.sum::<f64>()
        });
        let damping: Vec<f64> = of_modes.collect();
        // Forces cannot take back what gives more than they can bear: droppers that stiff hardly give, and keep it.
        if excess > wish.bearable {
            borrowed[..droppers.len()].fill(0.0);
        }
        // Vectors end with modes that nothing excites.
        let padded = |mut values: Vec<f64>, rest: f64| {
            values.resize(modes, rest);
            values
        };
        let topology = linear.shape().map(Line::topology);
        let dropper_x = topology.map_or_else(Vec::new, |topology| {
            let lower = topology.droppers().iter().map(|place| topology.x_of(place.lower));
            lower.collect()
        });
        let mut found = Self {
            highest,
            damping: padded(damping, 0.0),
            stiffness: padded(pairs.values, 1.0),
            row_of: pencil.row_of.clone(),
            rows,
            contact_wires: pencil.contact_x.len(),
            near: near_rows(&pencil.contact_x),
            residual: Vec::new(),
            at_rest: droppers
                .iter()
                .map(|dropper| linear.droppers().law().stiffness * dropper.elongation)
                .collect(),
            law: DropperLaw {
                damping: wish.beta * law.stiffness,
                ..law
            },
            creeping,
            creeping_modes,
            borrowed,
            support_x: supports.iter().map(|support| support.x).collect(),
            dropper_x,
            creeping_rows: rows_along(&gradients, &pairs.vectors, creeping_modes),
            joint_rows,
            slow,
            stretch_rows,
            stretch_dampers,
            dropper_residual: Vec::new(),
            between_droppers: Vec::new(),
        };
        found.add_residuals(&factor, &at_row, &gradients);
        Ok(found)
    }

    /// `K⁻¹ − Σ φ φᵀ/ω²` between droppers and rows of contact wires; `at_row` has the numbers of these among the
    /// coordinates that are not held.
    fn add_residuals(&mut self, factor: &BandedFactor, at_row: &[usize], gradients: &[Vec<(usize, f64)>]) {
        const BATCH: usize = 4;
        let soft: Vec<f64> = self.stiffness.iter().map(|stiffness| 1.0 / stiffness).collect();
        let arch = pulp::Arch::new();
        let rows = self.near.len() / self.contact_wires.max(1);
        for (number, batch) in at_row[..rows].chunks(BATCH).enumerate() {
            let mut answers = vec![[0.0; BATCH]; factor.size()];
            for (k, &at) in batch.iter().enumerate() {
                answers[at][k] = 1.0;
            }
            factor.solve_many(&mut answers);
            for (row, k) in (number * BATCH..rows).zip(0..batch.len()) {
                let own = times(self.row(row), &soft);
                let near = self.near[row * self.contact_wires..][..self.contact_wires].iter();
                let others = near.flat_map(|&first| first as usize..first as usize + WIDTH);
                let residual = |other: usize| match at_row[..rows].get(other) {
                    Some(&at) => answers[at][k] - kernels::dot(arch, self.row(other), &own),
                    None => 0.0,
                };
                let residuals: Vec<f64> = others.map(residual).collect();
                self.residual.extend(residuals);
            }
        }
        let (mut on_contact, mut between) = (Vec::new(), Vec::new());
        for (dropper, gradient) in gradients.iter().enumerate() {
            let answer = factor.solve(gradient.iter().copied());
            let own = times(self.joint(dropper), &soft);
            for (row, &at) in at_row[..rows].iter().enumerate() {
                on_contact.push(answer[at] - kernels::dot(arch, self.row(row), &own));
            }
            for (other, gradient) in gradients.iter().enumerate() {
                let of_modes = kernels::dot(arch, self.joint(other), &own);
                between.push(along(gradient, &answer) - of_modes);
            }
        }
        (self.dropper_residual, self.between_droppers) = (on_contact, between);
    }

    /// Number of modes, those that fill the last register included.
    pub fn count(&self) -> usize {
        self.stiffness.len()
    }

    /// Number of droppers.
    pub fn droppers(&self) -> usize {
        self.at_rest.len()
    }

    /// Force that a dropper lacks at rest, N: that of a spring that pushes.
    pub fn lacks_at_rest(&self, dropper: usize) -> f64 {
        (-self.at_rest[dropper]).max(0.0)
    }

    /// Entries of all modes at a row.
    fn row(&self, row: usize) -> &[f32] {
        &self.rows[row * self.count()..][..self.count()]
    }

    /// Entries of all modes at a coordinate of the linearised line; none at one that is held or has no row.
    pub fn at(&self, coordinate: usize) -> Option<&[f32]> {
        let row = self.row_of[coordinate];
        (row != NONE).then(|| self.row(row as usize))
    }

    /// `gⱼᵀ φₖ` of a dropper, or of a support with a damper: these follow the droppers.
    pub fn joint(&self, joint: usize) -> &[f32] {
        &self.joint_rows[joint * self.count()..][..self.count()]
    }

    /// Elongation of a dropper by the slow modes that feel it creep.
    pub fn creeping_row(&self, dropper: usize) -> &[f32] {
        &self.creeping_rows[dropper * self.creeping_modes..][..self.creeping_modes]
    }

    /// Elongation of a length of a wire by slow modes.
    pub fn stretch(&self, length: usize) -> &[f32] {
        &self.stretch_rows[length * self.slow..][..self.slow]
    }

    /// Residual elongation of a dropper by a unit force along another one, m/N.
    pub fn residual_between(&self, dropper: usize, other: usize) -> f64 {
        self.between_droppers[other * self.droppers() + dropper]
    }

    /// Residual vertical deflection at a point of a contact wire by a unit force along a dropper, m/N.
    pub fn residual_by_dropper(&self, point: &CurveColumns, dropper: usize) -> f64 {
        let rows = self.dropper_residual.len() / self.droppers();
        let of_dropper = &self.dropper_residual[dropper * rows..][..rows];
        self.vertical(point).map(|(row, n)| n * of_dropper[row]).sum()
    }

    /// Residual vertical deflection at a point of a contact wire by a unit force at another one, m/N.
    pub fn residual_between_points(&self, point: &CurveColumns, other: &CurveColumns) -> f64 {
        let of_pair = |(row, n): (usize, f64)| {
            let windows = row * self.contact_wires..(row + 1) * self.contact_wires;
            let residual = |other: usize| {
                let at = windows.clone().find_map(|window| {
                    let at = other.checked_sub(self.near[window] as usize)?;
                    (at < WIDTH).then_some(window * WIDTH + at)
                });
                at.map_or(0.0, |at| self.residual[at])
            };
            n * self.vertical(other).map(|(other, m)| m * residual(other)).sum::<f64>()
        };
        self.vertical(point).map(of_pair).sum()
    }

    /// Rows of a point with their weights in its vertical deflection.
    fn vertical<'a>(&'a self, point: &'a CurveColumns) -> impl Iterator<Item = (usize, f64)> + 'a {
        let columns = point.as_slice().iter();
        columns.filter_map(|column| {
            let row = self.row_of[column.index];
            (row != NONE && column.n.z != 0.0).then_some((row as usize, column.n.z))
        })
    }
}

/// Products of the entries.
fn times(row: &[f32], values: &[f64]) -> Vec<f64> {
    let entries = row.iter().zip(values);
    entries.map(|(entry, value)| f64::from(*entry) * value).collect()
}

/// `gᵀ φ` of the first `count` vectors for each gradient, gradient after gradient; zeros where there are fewer vectors.
fn rows_along(gradients: &[Vec<(usize, f64)>], vectors: &[Vec<f64>], count: usize) -> Aligned {
    let mut rows = Aligned::zeros(gradients.len() * count);
    for (row, gradient) in rows.chunks_exact_mut(count.max(1)).zip(gradients) {
        for (entry, vector) in row.iter_mut().zip(vectors) {
            *entry = along(gradient, vector) as f32;
        }
    }
    rows
}

/// `gᵀ x`.
fn along(gradient: &[(usize, f64)], vector: &[f64]) -> f64 {
    gradient.iter().map(|&(at, g)| g * vector[at]).sum()
}

/// Modes that contact wires feel: the answer of the others is that of modes beyond `highest` Hz, or less.
///
/// A mode adds `φ²/ω²` to a compliance, of which the residual compliance has all but a part that goes with `1/ω²`. A
/// mode of the whole contact wire of mass `m` has `φ² = 2/m` and is kept up to `highest`; fainter ones up to where that
/// part is the same.
fn worth_keeping(linear: &LinearLine, free: &[Option<usize>], pairs: Eigenpairs, highest: f64) -> Eigenpairs {
    let Some(line) = linear.shape() else {
        return pairs;
    };
    let (mut felt, mut mass) = (Vec::new(), 0.0_f64);
    for wire in 0..line.contact_wires() {
        let wire = line.contact_wire(wire);
        let nodes = wire.geometry().nodes().iter();
        felt.extend(nodes.filter_map(|node| free[node.map.position(2)?]));
        mass = mass.max(wire.section().mass_per_length * wire.geometry().length());
    }
    let least = 2.0 / mass / (TAU * highest).powi(4);
    let kept = pairs.values.into_iter().zip(pairs.vectors).filter(|(value, vector)| {
        let most = felt.iter().fold(0.0_f64, |most, &at| most.max(vector[at].powi(2)));
        most / value.powi(2) >= least
    });
    let (values, vectors) = kept.unzip();
    Eigenpairs { values, vectors }
}

/// Number of each coordinate among those that are not held, and how many there are.
fn numbered(layout: &Layout) -> (Vec<Option<usize>>, usize) {
    let mut held = vec![false; layout.coordinates()];
    layout.fixed().iter().for_each(|&index| held[index] = true);
    let mut count = 0;
    let number = |held: bool| {
        let number = (!held).then_some(count);
        count += usize::from(!held);
        number
    };
    let free = held.into_iter().map(number).collect();
    (free, count)
}

impl Pencil {
    /// `K`, `D` and `M` of a line whose droppers are all taut, with this `law`.
    fn of(linear: &mut LinearLine, layout: &Layout, law: DropperLaw) -> Self {
        let (free, count) = numbered(layout);
        let rest = layout.state_at_rest();
        let motion = rest.motion(&[]);
        let mut collect = |add: &dyn Fn(&mut dyn Force, &mut Blocks<'_>)| {
            Blocks::collect(|blocks| {
                linear.parts(&mut |name, part| {
                    if name != "droppers" {
                        add(part, blocks);
                    }
                });
            })
        };
        let mut stiffness = collect(&|part, blocks| part.add_tangent(&motion, Weights { q: 1.0, v: 0.0 }, blocks));
        let mut damping = collect(&|part, blocks| part.add_tangent(&motion, Weights { q: 0.0, v: 1.0 }, blocks));
        let mass = collect(&|part, blocks| part.add_mass(blocks));
        for dropper in linear.droppers().as_slice() {
            for &(row, g_row) in &dropper.gradient {
                for &(column, g_column) in &dropper.gradient {
                    let both = g_row * g_column;
                    stiffness.push((row as u32, column as u32, law.stiffness * both));
                    damping.push((row as u32, column as u32, law.damping * both));
                }
            }
        }
        let all = [stiffness, damping, mass].map(|entries| {
            let entries = entries.into_iter().filter_map(|(row, column, value)| {
                let (row, column) = (free[row as usize]?, free[column as usize]?);
                Some((row as u32, column as u32, value))
            });
            entries.collect::<Vec<_>>()
        });
        let places = all.iter().flatten();
        let band = places.map(|(row, column, _)| row.abs_diff(*column)).max();
        let band = band.unwrap_or(0) as usize;
        let [stiffness, damping, mass] = all.map(|entries| BandedMatrix::from_entries(count, band, &entries));
        let (row_of, contact_x) = rows(linear, &free);
        Self {
            free,
            stiffness,
            damping,
            mass,
            row_of,
            contact_x,
        }
    }
}

/// A spring to the ground.
struct Support {
    /// Its coordinate among those that are not held.
    free: usize,
    stiffness: f64,
    x: f64,
}

/// Springs that hold the heights of wires at supports.
fn supports(linear: &LinearLine, free: &[Option<usize>]) -> Vec<Support> {
    let Some(line) = linear.shape() else {
        return Vec::new();
    };
    let anchors = line
        .supports()
        .as_slice()
        .iter()
        .chain(line.registration_arms().as_slice());
    let springs = anchors.filter_map(|anchor| {
        let support = Support {
            free: free[anchor.node.coordinate(2)?]?,
            stiffness: anchor.stiffness.z,
            x: anchor.node.reference.x,
        };
        (support.stiffness > 0.0).then_some(support)
    });
    springs.collect()
}

/// First of the rows of each contact wire that are near a row of any, row after row, from the places of all rows along
/// the track, wire after wire.
fn near_rows(contact_x: &[Vec<f64>]) -> Vec<u32> {
    let mut near = Vec::new();
    for x in contact_x.iter().flatten() {
        let mut first = 0;
        for wire in contact_x {
            let closest = wire.partition_point(|other| other < x);
            let most = wire.len().saturating_sub(WIDTH);
            near.push((first + closest.saturating_sub(NEAR).min(most)) as u32);
            first += wire.len();
        }
    }
    near
}

/// The row of each coordinate, and the place of each row of the contact wires along the track, wire after wire, m.
fn rows(linear: &LinearLine, free: &[Option<usize>]) -> (Vec<u32>, Vec<Vec<f64>>) {
    let (mut row_of, mut next) = (vec![NONE; free.len()], 0);
    let mut contact_x = Vec::new();
    let Some(line) = linear.shape() else {
        return (row_of, contact_x);
    };
    let mut add = |coordinate: Option<usize>| {
        let new = coordinate.filter(|&at| free[at].is_some() && row_of[at] == NONE);
        if let Some(coordinate) = new {
            row_of[coordinate] = next;
            next += 1;
        }
        new.is_some()
    };
    for wire in 0..line.contact_wires() {
        let geometry = line.contact_wire(wire).geometry();
        let mut layers = geometry.enrichments().iter().peekable();
        let mut places = Vec::new();
        for (number, node) in geometry.nodes().iter().enumerate() {
            let mut own = [node.map.position(2), node.map.slope(2)]
                .map(&mut add)
                .into_iter()
                .filter(|new| *new)
                .count();
            while let Some(layer) = layers.next_if(|layer| layer.node == number) {
                if layer.direction.z != 0.0 {
                    own += usize::from(add(Some(layer.index)));
                }
            }
            places.resize(places.len() + own, node.position.x);
        }
        contact_x.push(places);
    }
    for wire in line.wires() {
        for node in wire.geometry().nodes() {
            add(node.map.position(2));
        }
    }
    (row_of, contact_x)
}
