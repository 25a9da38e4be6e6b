//! Surfaces as numbers, and what two of them make of a contact.

use super::layout::Impulse;
use model::{Combine, Material, Softness};
use numbers::Float;

/// Fields of a surface.
pub(super) mod field {
    pub const FRICTION: usize = 0;
    pub const RESTITUTION: usize = 1;
    pub const MARGIN: usize = 4;
    pub const SOFTNESS: usize = 5;
    pub const COMBINE: usize = 9;
    pub const STICKING: usize = 10;
    pub const WIDTH: usize = 11;
}

/// What a contact of two shapes is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Surface {
    pub friction: f64,
    /// Friction of what sticks.
    pub sticking: f64,
    pub restitution: f64,
    pub torsion: f64,
    pub rolling: f64,
    /// Stiffness [N/m] and damping [N·s/m] where it gives way.
    pub spring: [f64; 2],
    /// Time constant [s] with which an overlap closes, where it does not.
    pub settling: f64,
}

impl Impulse {
    /// The surface of a colliding shape, as numbers: equal ones make equal contacts.
    pub fn surface_of<'a, T>(&self, shape: usize, parameters: &'a [T]) -> &'a [T] {
        &parameters[self.surface.at(shape, 0)..][..field::WIDTH]
    }

    /// Whether any surface gives back speed.
    pub fn bounces<T: Float>(&self, parameters: &[T]) -> bool {
        let mut rows = 0..self.shapes.len() + self.paired.len();
        rows.any(|row| parameters[self.surface.at(row, field::RESTITUTION)] > T::zero())
    }

    /// Whether any surface holds better than it slides.
    pub fn sticks<T: Float>(&self, parameters: &[T]) -> bool {
        let mut rows = 0..self.shapes.len() + self.paired.len();
        rows.any(|row| {
            let of = |field| parameters[self.surface.at(row, field)];
            of(field::FRICTION) < of(field::STICKING)
        })
    }

    /// What a colliding shape's surface adds to the [gap](Self::margin) [m] of its contacts.
    pub fn own_margin<T: Float>(&self, shape: usize, parameters: &[T]) -> T {
        self.surface_of(shape, parameters)[field::MARGIN]
    }

    /// Gap [m] that the surfaces of two colliding shapes keep.
    pub fn margin<T: Float>(&self, shapes: [u32; 2], parameters: &[T]) -> T {
        let of = |row| parameters[self.surface.at(row, field::MARGIN)];
        match self.named(shapes) {
            Some(row) => of(row),
            None => of(shapes[0] as usize) + of(shapes[1] as usize),
        }
    }

    /// Gaps [m] at which contacts with the colliding shapes begin at most, be it by themselves or by a pair's surface.
    pub fn widest_margins<T: Float>(&self, parameters: &[T], margins: &mut Vec<f64>) {
        let of = |row| parameters[self.surface.at(row, field::MARGIN)].to_f64();
        let shapes = self.shapes.len();
        margins.clear();
        margins.extend((0..shapes).map(|shape| of(shape).max(0.0)));
        for (pair, row) in &self.paired {
            let margin = 0.5 * of(shapes + row);
            for shape in pair {
                let widest = &mut margins[*shape as usize];
                *widest = widest.max(margin);
            }
        }
    }

    /// Row of the surface that the model gives to a pair.
    fn named(&self, [a, b]: [u32; 2]) -> Option<usize> {
        if self.paired.is_empty() {
            return None;
        }
        let row = self.paired.get(&[a.min(b), a.max(b)])?;
        Some(self.shapes.len() + row)
    }

    /// Whether two shapes have one surface, which makes of itself what it is, but for the margin.
    fn is_alike<T: Float>(&self, shapes: [u32; 2], parameters: &[T]) -> bool {
        let [a, b] = shapes.map(|s| {
            let at = self.surface.at(s as usize, 0);
            &parameters[at..at + field::WIDTH]
        });
        let multiplies = T::from_f64(f64::from(Combine::Multiply as u8));
        a == b && a[field::COMBINE] != multiplies
    }

    /// What a contact of two colliding shapes is made of.
    pub fn surface<T: Float>(&self, shapes: [u32; 2], parameters: &[T]) -> Surface {
        let of = |row| material(&parameters[self.surface.at(row, 0)..][..field::WIDTH]);
        let [a, b] = shapes.map(|s| s as usize);
        let material = match self.named(shapes) {
            Some(row) => of(row),
            None if self.is_alike(shapes, parameters) => of(a),
            None => of(a).with(&of(b)),
        };
        let (spring, settling) = match material.softness {
            Softness::Time { constant, .. } => ([0.0; 2], constant),
            Softness::Spring { stiffness, damping } => ([stiffness, damping], 0.0),
        };
        Surface {
            friction: material.friction,
            sticking: material.sticking(),
            restitution: material.restitution,
            torsion: material.torsional_friction,
            rolling: material.rolling_friction,
            spring,
            settling,
        }
    }
}

/// A surface as [`field`]s.
pub(super) fn numbers_of(m: &Material) -> [f64; field::WIDTH] {
    let (kind, a, b, c) = match m.softness {
        Softness::Time {
            constant,
            ratio,
            impedance,
            ..
        } => (0.0, constant, ratio, impedance),
        Softness::Spring { stiffness, damping } => (1.0, stiffness, damping, 0.0),
    };
    let combine = f64::from(m.combine as u8);
    let (torsion, rolling) = (m.torsional_friction, m.rolling_friction);
    [
        m.friction,
        m.restitution,
        torsion,
        rolling,
        m.margin,
        kind,
        a,
        b,
        c,
        combine,
        m.sticking(),
    ]
}

fn material<T: Float>(numbers: &[T]) -> Material {
    let x = |i: usize| numbers[i].to_f64();
    let [a, b, c] = [1, 2, 3].map(|i| x(field::SOFTNESS + i));
    let softness = if x(field::SOFTNESS) == 0.0 {
        Softness::Time {
            constant: a,
            ratio: b,
            impedance: c,
            mass: None, // what settles at once has none
        }
    } else {
        Softness::Spring {
            stiffness: a,
            damping: b,
        }
    };
    let rules = [
        Combine::Average,
        Combine::Minimum,
        Combine::Multiply,
        Combine::Maximum,
    ];
    Material {
        friction: x(0),
        static_friction: Some(x(field::STICKING)),
        restitution: x(1),
        torsional_friction: x(2),
        rolling_friction: x(3),
        margin: x(4),
        softness,
        combine: rules[x(field::COMBINE) as usize & 3],
    }
}
