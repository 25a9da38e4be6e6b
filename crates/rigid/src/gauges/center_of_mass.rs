//! Centres of mass: C = Σ m c / Σ m.

use super::Told;
use super::frames::Frames;
use super::rows::{Notes, Rows};
use crate::tables::Filler;
use model::{BodyId, BodyKind, Model};
use numbers::{Machine, Vec3};

/// Bodies that are weighed.
#[derive(Default)]
pub(super) struct CenterNotes {
    centers: Notes<3, 0>,
    bodies: Notes<1, 4>,
}

/// Where they lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Centers {
    /// The first of `bodies`, one past the last, the first number told.
    centers: Rows<3, 0>,
    /// BODY; its share of the mass, and its centre of mass in its frame.
    bodies: Rows<1, 4>,
}

impl CenterNotes {
    /// Notes a body and all that it carries, or all bodies; `false` where nothing of it has mass.
    pub fn center(&mut self, model: &Model, of: Option<BodyId>, to: usize) -> bool {
        let mut carried = vec![of.is_none(); model.bodies.len()];
        for &id in model.order() {
            let parent = model.carrier(id).and_then(|j| model.joints[j.0].parent);
            carried[id.0] |= of == Some(id) || parent.is_some_and(|parent| carried[parent.0]);
        }
        let bodies = model.bodies.iter().zip(carried).enumerate();
        let heavy =
            bodies.filter(|(_, (body, carried))| *carried && body.kind == BodyKind::Dynamic);
        let heavy = Vec::from_iter(heavy.map(|(row, (body, _))| (row, body)));
        let mass: f64 = heavy.iter().map(|(_, body)| body.mass).sum();
        if mass <= 0.0 {
            return false;
        }
        let first = self.bodies.len();
        for (row, body) in heavy {
            let c = body.center;
            self.bodies.add([row], [body.mass / mass, c.x, c.y, c.z]);
        }
        self.centers.add([first, self.bodies.len(), to], []);
        true
    }
    /// How often loops go round.
    pub fn rounds(&self) -> usize {
        self.centers.len() + self.bodies.len()
    }
    pub fn place(&self, parameters: &mut usize, links: &mut usize) -> Centers {
        Centers {
            centers: self.centers.place(parameters, links),
            bodies: self.bodies.place(parameters, links),
        }
    }
}

impl Centers {
    pub fn fill(&self, notes: &CenterNotes, f: &mut Filler) {
        self.centers.fill(&notes.centers, f);
        self.bodies.fill(&notes.bodies, f);
    }
    #[inline(always)]
    pub fn tell<M: Machine>(&self, k: &mut M, frames: &Frames, told: Told) {
        for center in self.centers.all(k) {
            let [first, end, to] = self.centers.links(k, center);
            for row in k.range(first, end) {
                let [body] = self.bodies.links(k, row);
                let [share, x, y, z] = self.bodies.numbers(k, row);
                let point = frames.point(k, body, Vec3::new(x, y, z));
                k.add_vec3(told, to, 0, point * share);
            }
        }
    }
}
