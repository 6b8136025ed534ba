//! Scalar functions of the relative position of two anchors, with first and second derivatives.
//!
//! Every joint equation and the length of every guided spring is a measure. Derivatives are taken in the directions of
//! the generalised velocities: with the column (translation `t`, rotation `c`) of velocity k, a point moves by `t_k`, a
//! direction `a` by `c_k × a`. A column changes with a rotation l of the same body by `c_l × t_k`, `c_l × c_k`, if k is
//! a rotation too; displacements have constant columns. [Haug 1989, chapters 9 and 11]
use super::Anchor;
use dynamics::{Blocks, Column, Motion};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

/// Largest number of generalised velocities that two rigid bodies have.
pub(crate) const WIDTH: usize = 12;

/// Two anchors.
#[derive(Clone, Debug, PartialEq)]
pub struct Pair {
    /// Anchor whose axes are the directions along which positions are measured.
    pub first: Anchor,
    /// Other anchor.
    pub second: Anchor,
}

/// A scalar function of a [`Pair`]; directions are numbered columns of the anchors' axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// `e_i · (r_B − r_A)`, m: distance along a world axis.
    Point(usize),
    /// `a · (r_B − r_A)`, m: distance along an axis of the first anchor.
    Along(usize),
    /// `a · b`, –: cosine between an axis of the first and one of the second anchor.
    Direction(usize, usize),
}

/// A pair at one instant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PairView {
    /// Axes of the first and of the second anchor.
    axes: [Matrix3<f64>; 2],
    distance: Vector3<f64>,
    columns: [Column; WIDTH],
    indices: [usize; WIDTH],
    first_count: usize,
    count: usize,
}

impl Pair {
    /// Values of `measures`, one after the other.
    pub(crate) fn values(&self, motion: &Motion<'_>, measures: &[Measure], values: &mut [f64]) {
        let [(first, first_axes), (second, second_axes)] = [self.first.place(motion), self.second.place(motion)];
        let (axes, distance) = ([first_axes, second_axes], second - first);
        for (value, &measure) in values.iter_mut().zip(measures) {
            *value = measure.value(&axes, &distance);
        }
    }

    /// Places and columns of both anchors.
    pub(crate) fn view(&self, motion: &Motion<'_>) -> PairView {
        const NONE: Column = Column {
            index: 0,
            translation: Vector3::new(0.0, 0.0, 0.0),
            rotation: Vector3::new(0.0, 0.0, 0.0),
        };
        let (mut columns, mut indices, mut count) = ([NONE; WIDTH], [0; WIDTH], 0);
        let mut push = |column: Column| {
            columns[count] = column;
            indices[count] = column.index;
            count += 1;
        };
        let (first, first_axes) = self.first.columns_of(motion, &mut push);
        let first_count = self.first.pose().map_or(0, |_| WIDTH / 2);
        let (second, second_axes) = self.second.columns_of(motion, &mut push);
        PairView {
            axes: [first_axes, second_axes],
            distance: second - first,
            columns,
            indices,
            first_count,
            count,
        }
    }
}

impl Measure {
    /// Value between two anchors with these axes, the second one at `distance` from the first.
    fn value(self, axes: &[Matrix3<f64>; 2], distance: &Vector3<f64>) -> f64 {
        match self {
            Self::Point(axis) => distance[axis],
            Self::Along(axis) => axes[0].column(axis).dot(distance),
            Self::Direction(a, b) => axes[0].column(a).dot(&axes[1].column(b)),
        }
    }
}

impl PairView {
    /// Indices of the generalised velocities, those of the first anchor before those of the second.
    pub(crate) fn indices(&self) -> &[usize] {
        &self.indices[..self.count]
    }

    fn axis(&self, anchor: usize, number: usize) -> Vector3<f64> {
        self.axes[anchor].column(number).into_owned()
    }

    /// Value of a measure.
    pub(crate) fn value(&self, measure: Measure) -> f64 {
        measure.value(&self.axes, &self.distance)
    }

    fn is_first(&self, k: usize) -> bool {
        k < self.first_count
    }

    /// `c_k`, `t_k` with the sign of their part in `r_B − r_A`.
    fn column(&self, k: usize) -> (Vector3<f64>, Vector3<f64>) {
        let column = &self.columns[k];
        let sign = if self.is_first(k) { -1.0 } else { 1.0 };
        (column.rotation, column.translation * sign)
    }

    /// Derivatives of a measure, one per entry of [`PairView::indices`], zero behind.
    #[inline]
    pub(crate) fn gradient(&self, measure: Measure) -> SVector<f64, WIDTH> {
        let mut gradient = SVector::zeros();
        match measure {
            Measure::Point(axis) => {
                for (k, column) in self.columns[..self.count].iter().enumerate() {
                    let sign = if self.is_first(k) { -1.0 } else { 1.0 };
                    gradient[k] = column.translation[axis] * sign;
                }
            }
            Measure::Along(axis) => {
                let a = self.axis(0, axis);
                for k in 0..self.count {
                    let (c, t) = self.column(k);
                    let turn = if self.is_first(k) {
                        c.cross(&a).dot(&self.distance)
                    } else {
                        0.0
                    };
                    gradient[k] = a.dot(&t) + turn;
                }
            }
            Measure::Direction(a, b) => {
                let normal = self.axis(0, a).cross(&self.axis(1, b));
                for k in 0..self.count {
                    let sign = if self.is_first(k) { 1.0 } else { -1.0 };
                    gradient[k] = sign * self.columns[k].rotation.dot(&normal);
                }
            }
        }
        gradient
    }

    /// Derivative of entry k (row) of the gradient in the direction of velocity l (column).
    ///
    /// Not symmetric: rotations do not commute.
    pub(crate) fn hessian(&self, measure: Measure) -> SMatrix<f64, WIDTH, WIDTH> {
        SMatrix::from_fn(|k, l| {
            if k < self.count && l < self.count {
                self.second_derivative(measure, k, l)
            } else {
                0.0
            }
        })
    }

    /// Rates of the turn of the second anchor against the first one about the third axis of the first, rad, one per
    /// entry of [`PairView::indices`], zero behind.
    pub(crate) fn turning(&self) -> SVector<f64, WIDTH> {
        let axis = self.axis(0, 2);
        SVector::from_fn(|k, _| {
            if k < self.count {
                self.turn_of(k) * axis.dot(&self.column(k).0)
            } else {
                0.0
            }
        })
    }

    /// Derivative of entry k (row) of [`PairView::turning`] in the direction of velocity l (column).
    pub(crate) fn turning_change(&self) -> SMatrix<f64, WIDTH, WIDTH> {
        let axis = self.axis(0, 2);
        SMatrix::from_fn(|k, l| {
            if k >= self.count || l >= self.count {
                return 0.0;
            }
            let (c_k, c_l) = (self.column(k).0, self.column(l).0);
            let axis_l = if self.is_first(l) {
                c_l.cross(&axis)
            } else {
                Vector3::zeros()
            };
            let (c_kl, _) = self.column_change(k, l);
            self.turn_of(k) * (axis_l.dot(&c_k) + axis.dot(&c_kl))
        })
    }

    /// Sign of a rotation in the turn of the second anchor against the first one.
    fn turn_of(&self, k: usize) -> f64 {
        if self.is_first(k) { -1.0 } else { 1.0 }
    }

    /// Changes of the column k itself in the direction of velocity l: of `c_k`, and of `t_k` with the sign of its part.
    fn column_change(&self, k: usize, l: usize) -> (Vector3<f64>, Vector3<f64>) {
        let ((c_k, t_k), (c_l, _)) = (self.column(k), self.column(l));
        let same_body = self.is_first(k) == self.is_first(l);
        if same_body && c_k != Vector3::zeros() {
            (c_l.cross(&c_k), c_l.cross(&t_k))
        } else {
            (Vector3::zeros(), Vector3::zeros())
        }
    }

    fn second_derivative(&self, measure: Measure, k: usize, l: usize) -> f64 {
        let ((c_k, t_k), (c_l, t_l)) = (self.column(k), self.column(l));
        let (c_kl, t_kl) = self.column_change(k, l);
        match measure {
            Measure::Point(axis) => t_kl[axis],
            Measure::Along(axis) => {
                let a = self.axis(0, axis);
                let a_l = if self.is_first(l) {
                    c_l.cross(&a)
                } else {
                    Vector3::zeros()
                };
                let mut sum = a_l.dot(&t_k) + a.dot(&t_kl);
                if self.is_first(k) {
                    sum += (c_kl.cross(&a) + c_k.cross(&a_l)).dot(&self.distance) + c_k.cross(&a).dot(&t_l);
                }
                sum
            }
            Measure::Direction(a, b) => {
                let (a, b) = (self.axis(0, a), self.axis(1, b));
                let normal_l = if self.is_first(l) {
                    c_l.cross(&a).cross(&b)
                } else {
                    a.cross(&c_l.cross(&b))
                };
                let sign = if self.is_first(k) { 1.0 } else { -1.0 };
                sign * (c_kl.dot(&a.cross(&b)) + c_k.dot(&normal_l))
            }
        }
    }
}

/// Adds the leading part of `matrix` on the coordinates `indices`.
pub(crate) fn add_square(blocks: &mut Blocks<'_>, indices: &[usize], matrix: &SMatrix<f64, WIDTH, WIDTH>) {
    let n = indices.len();
    let mut values = [0.0; WIDTH * WIDTH];
    for row in 0..n {
        for column in 0..n {
            values[row * n + column] = matrix[(row, column)];
        }
    }
    blocks.add(indices, indices, &values[..n * n]);
}
