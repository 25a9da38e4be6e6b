//! What hangs together by loops and couplings, and how fast a gap in it is closed.
//!
//! A gap within a step's drift is closed at once. Of a wider one a step takes a tenth of what is more, so that what moves
//! stops softly, at no more than 1 m/s, and an eighth of the bodies' size:
//!
//! ```text
//! φ ← φ                                       |φ| ≤ s = min(ℓ/64, f)
//! φ ← φ/|φ| min(s + (|φ| − s)/10, f)           else, f = min(h · 1 m/s, ℓ/8)
//! ```
//!
//! Turns follow the same with ℓ = 1, and speeds that move the bodies' ends as fast. The bodies have that speed meanwhile;
//! where directions turn on the way, what is taken back in the end is less by a share of ½ m v².

use crate::locks::pace;
use model::{AxisKind, Joint};
use numbers::Real;

/// Share of a gap beyond the drift that a step closes.
const SHARE: f64 = 0.1;
/// Drift, and way of a step, as shares of the size of what moves.
const DRIFT: f64 = 1.0 / 64.0;
const WAY: f64 = 1.0 / 8.0;
/// Impulses that act on the size of what moves, in m ℓ/h: see [`locked`](super::locked).
const BENDS: f64 = 0.1;
/// A gap that nothing has [m or rad].
const FAR: f64 = 1e9;
/// Size of points [m].
const POINT: f64 = 1e-6;

/// Several bodies.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Bulk {
    count: f64,
    mass: f64,
    /// Moments of inertia.
    moment: f64,
    /// What motors add to both.
    geared_mass: f64,
    geared_moment: f64,
}

impl Bulk {
    /// Adds a body.
    pub fn add(&mut self, mass: f64, moment: f64) {
        self.count += 1.0;
        self.mass += mass;
        self.moment += moment;
    }
    /// Adds what a joint's motors reflect.
    pub fn reflect(&mut self, joint: &Joint) {
        for (axis, dof) in joint.axes.iter().zip(&joint.dofs) {
            match axis.kind {
                AxisKind::Linear => self.geared_mass += dof.armature,
                AxisKind::Angular => self.geared_moment += dof.armature,
            }
        }
    }
    pub fn tied(&self) -> Tied {
        let size = (self.moment / self.mass).sqrt().max(POINT);
        let mass = self.mass + self.geared_mass + self.geared_moment / (size * size);
        Tied {
            mass: mass / self.count,
            size,
        }
    }
}

/// A mean body of what hangs together.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tied {
    /// Mass [kg], with what motors reflect.
    mass: f64,
    /// Radius of gyration about its joint [m].
    size: f64,
}

impl Tied {
    /// The same, tied by what is so long [m].
    pub fn reaching(self, length: f64) -> Self {
        Self {
            size: self.size.max(length),
            ..self
        }
    }
    /// 1/m and 10 h/ℓ of shifts, in steps of `h` [s].
    pub fn shifts(&self, h: f64) -> [f64; 2] {
        [self.mass.recip(), h / (BENDS * self.size)]
    }
    /// The same of turns.
    pub fn turns(&self, h: f64) -> [f64; 2] {
        [(self.mass * self.size * self.size).recip(), h / BENDS]
    }
}

/// How far a step closes gaps.
pub(super) struct Pace {
    drift: f64,
    fastest: f64,
}

impl Pace {
    /// Of shifts [m], in steps of `h` [s].
    pub fn shifts(tied: &Tied, h: f64) -> Self {
        Self::new(tied.size, pace::SHIFTS * h)
    }
    /// Of turns [rad].
    pub fn turns(tied: &Tied, h: f64) -> Self {
        Self::new(1.0, pace::SHIFTS * h / tied.size)
    }
    fn new(size: f64, way: f64) -> Self {
        let fastest = way.min(WAY * size);
        let drift = fastest.min(DRIFT * size);
        Self { drift, fastest }
    }
    /// The same, or none for what is soft: that is a spring, which gapes as far as it is pulled.
    pub fn unless(self, soft: bool) -> Self {
        let [drift, fastest] = [self.drift, self.fastest].map(|x| if soft { FAR } else { x });
        Self { drift, fastest }
    }
    /// As [`share`] takes it.
    pub fn numbers(&self) -> [f64; 2] {
        [self.drift, self.fastest]
    }
}

/// Share of a gap that a step closes, given how far it gapes.
#[inline(always)]
pub(super) fn share<R: Real>(gap: R, [drift, fastest]: [R; 2]) -> R {
    let way = (gap - drift).fma(R::lit(SHARE), drift).min(fastest);
    let wide = gap.gt(drift);
    let over = R::select(wide, gap, R::one()).recip();
    R::select(wide, way * over, R::one())
}
