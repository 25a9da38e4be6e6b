//! Constants of a scene: those that all worlds have in common, and of which each may have its own.

use crate::card::NUMBER;
use crate::scene::{Scene, unsupported};
use crate::{Card, Need, PilesError};
use rigid::impulse::pair::solid;
use rigid::impulse::{FREE_TURN, HELD_TURN, NEARBY, WORLD, global, grip, mass};
use std::collections::HashMap;
use std::ops::Range;

/// The constants of the solver.
#[derive(Debug)]
pub(crate) struct Parameters {
    /// Those of the model.
    common: Vec<f32>,
    /// Those of each world, where worlds have their own.
    own: Vec<Vec<f32>>,
}

impl Parameters {
    /// The same in all worlds.
    pub fn of_all(common: Vec<f32>) -> Self {
        Self {
            common,
            own: Vec::new(),
        }
    }
    /// Those of a world. Where a batch has more room than worlds, of one that is not, too.
    pub fn of(&self, world: usize) -> &[f32] {
        self.own.get(world).unwrap_or(&self.common)
    }
    /// Whether worlds have their own.
    pub fn differ(&self) -> bool {
        !self.own.is_empty()
    }
    /// Gives worlds their own, the first time all of them; returns what they had.
    fn give(&mut self, mut sets: Vec<(usize, Vec<f32>)>) -> Vec<(usize, Vec<f32>)> {
        if self.own.is_empty() {
            self.own.resize(sets.len(), Vec::new());
        }
        for (world, set) in &mut sets {
            std::mem::swap(&mut self.own[*world], set);
        }
        sets
    }
    fn all(&self) -> impl Iterator<Item = &Vec<f32>> + Clone {
        std::iter::once(&self.common).chain(&self.own)
    }
}

/// Numbers of what two surfaces make of a contact.
pub(crate) const SURFACE: usize = 9;
/// Surfaces that differ, at most.
const SURFACES: usize = 1024;

impl Scene {
    /// Gives worlds constants of their own, the first time all of them. Whether those of all worlds are to be written anew:
    /// they lie elsewhere, or tell of other kinds of surfaces.
    ///
    /// # Errors
    /// Surfaces differ in too many ways.
    pub fn differ(&mut self, sets: Vec<(usize, Vec<f32>)>) -> Result<bool, PilesError> {
        let differed = self.parameters.differ();
        let before = self.parameters.give(sets);
        match self.surfaces() {
            Ok(others) => {
                let anew = others || !differed;
                if anew {
                    self.place_constants();
                }
                Ok(anew)
            }
            Err(error) => {
                self.parameters.give(before);
                if !differed {
                    self.parameters.own.clear();
                }
                Err(error)
            }
        }
    }
    /// Whether worlds may have these constants, besides those that they have.
    ///
    /// # Errors
    /// They may not: contacts know of one gravity; surfaces differ in too many ways, or take too much room.
    pub fn takes(&self, card: &impl Card, sets: &[Vec<f32>]) -> Result<(), PilesError> {
        let usual = self.impulse.weight(&self.parameters.common);
        for set in sets {
            let differs = (self.impulse.weight(set) - usual).abs() > 1e-5 * usual;
            if differs && (self.impulse.bounces(set) || self.impulse.sticks(set)) {
                return Err(unsupported(
                    "gravity of another strength in a world in which things bounce, or stick better than they slide",
                    "give all worlds the same, or run on the processor",
                ));
            }
        }
        let [_, kinds] = self.kinds(self.parameters.all().chain(sets))?;
        let surfaces = u64::from(self.plan.surfaces.pow(2));
        let more = ((kinds.len() as u64).pow(2) - surfaces) * SURFACE as u64;
        let own = u64::from(self.own_length()) + more;
        let bytes = (self.constants.len() as u64 + own * u64::from(self.plan.worlds)) * NUMBER;
        Ok(Need::Parameters.check(bytes, card.most_bytes(), card.name())?)
    }

    /// Constants of which each world may have its own, one kind after the other.
    fn own_constants(&self, parameters: &[f32]) -> [Vec<f32>; 5] {
        let impulse = &self.impulse;
        let shapes = 0..impulse.shapes().len();
        let corners = shapes.map(|i| impulse.corners_of(i, parameters));
        let mut margins = Vec::new();
        impulse.widest_margins(parameters, &mut margins);
        let grown = margins.iter().map(|margin| (margin + NEARBY) as f32);
        [
            corners.flatten().copied().collect(),
            impulse.solids(parameters).to_vec(),
            grown.collect(),
            self.surface_table(parameters),
            self.turns(parameters),
        ]
    }
    /// Where these lie: behind what all worlds have in common.
    pub fn place_constants(&mut self) {
        let own = self.own_constants(self.parameters.of(0));
        let mut end = self.constants.len() as u32;
        let places = own.each_ref().map(|numbers| {
            end += numbers.len() as u32;
            end - numbers.len() as u32
        });
        let plan = &mut self.plan;
        [
            plan.corners,
            plan.solids,
            plan.grown,
            plan.surface,
            plan.turn,
        ] = places;
        let length = end - self.constants.len() as u32;
        plan.own_constants = if self.parameters.differ() { length } else { 0 };
    }

    /// Which kind of surface each shape has, and a shape of each kind: those of one kind are alike in all of these sets. A
    /// shape of a pair that has a surface of its own is of no other's kind.
    fn kinds<'a>(
        &self,
        sets: impl Iterator<Item = &'a Vec<f32>> + Clone,
    ) -> Result<[Vec<u32>; 2], PilesError> {
        let mut of_shape = Vec::new();
        let mut examples: Vec<u32> = Vec::new();
        let mut known = HashMap::new();
        for (shape, collider) in self.impulse.shapes().iter().enumerate() {
            let numbers = sets.clone();
            let numbers = numbers.flat_map(|set| self.impulse.surface_of(shape, set));
            let mut bits: Vec<_> = numbers.map(|x| x.to_bits()).collect();
            if self.paired.contains(&collider.shape) {
                bits.push(shape as u32);
            }
            of_shape.push(*known.entry(bits).or_insert_with(|| {
                examples.push(shape as u32);
                examples.len() as u32 - 1
            }));
        }
        if examples.len() > SURFACES {
            return Err(unsupported(
                "so many surfaces",
                "give more shapes the same one, or run on the processor",
            ));
        }
        Ok([of_shape, examples])
    }
    /// Finds the kinds of surfaces; whether shapes are of others than before.
    pub fn surfaces(&mut self) -> Result<bool, PilesError> {
        let [of_shape, examples] = self.kinds(self.parameters.all())?;
        let mut all = self.parameters.all();
        self.bounces = all.any(|set| self.impulse.bounces(set));
        self.plan.surfaces = examples.len() as u32;
        let at = self.plan.shape_surface as usize;
        let known = &mut self.whole[at..][..of_shape.len()];
        let others = *known != of_shape[..];
        known.copy_from_slice(&of_shape);
        self.surfaces = examples;
        Ok(others)
    }

    /// What each two surfaces make of a contact.
    fn surface_table(&self, parameters: &[f32]) -> Vec<f32> {
        let mut table = Vec::new();
        for a in &self.surfaces {
            for b in &self.surfaces {
                let s = self.impulse.surface([*a, *b], parameters);
                let [stiffness, damping] = s.spring;
                table.extend([s.friction, s.restitution, s.torsion, s.rolling]);
                table.extend([stiffness, damping, s.settling, s.sticking]);
                table.push(self.impulse.margin([*a, *b], parameters).into());
            }
        }
        table.into_iter().map(|x| x as f32).collect()
    }

    /// What a body's spin [rad/s] is multiplied by that it may be 1 before a step is cut into parts.
    fn turns(&self, parameters: &[f32]) -> Vec<f32> {
        let impulse = &self.impulse;
        let length = impulse.settings().substep();
        let mut turns = vec![0.0; impulse.rows()];
        for (i, shape) in impulse.shapes().iter().enumerate() {
            if shape.row != WORLD && !impulse.is_centred(i, parameters) {
                turns[shape.row as usize] = (length / FREE_TURN) as f32;
            }
        }
        let held = self.joints.iter().flat_map(|joints| &joints.seats);
        for row in held {
            turns[*row as usize] = (length / HELD_TURN) as f32;
        }
        // Without what does not move.
        turns.split_off(1)
    }

    /// The constants of a step that is cut into so many parts: those of the model, which contacts and joints read.
    pub fn common_globals(&self, parts: usize) -> [f32; global::WIDTH] {
        self.impulse.globals(&self.parameters.common, parts)
    }
    /// Those of each of these worlds.
    pub fn globals(&self, worlds: Range<usize>, parts: usize) -> Vec<[f32; global::WIDTH]> {
        let of = |world| self.impulse.globals(self.parameters.of(world), parts);
        worlds.map(of).collect()
    }
    /// Constants of the bodies of worlds as their kernels read them, but for what does not move.
    pub fn body_constants(&self, worlds: Range<usize>) -> Vec<[f32; BODY - global::WIDTH]> {
        let impulse = &self.impulse;
        let rows = worlds.flat_map(|world| {
            let parameters = self.parameters.of(world);
            let mut rows = vec![[0.0; BODY - global::WIDTH]; impulse.rows()];
            for (row, own) in rows.iter_mut().enumerate() {
                own[..mass::WIDTH].copy_from_slice(impulse.mass_of(row, parameters));
            }
            for (row, grip) in impulse.grips(parameters) {
                let own = rows[row][mass::WIDTH..].iter_mut();
                own.zip(grip).for_each(|(own, x)| *own = x as f32);
            }
            rows.split_off(1)
        });
        rows.collect()
    }
    /// The same of shapes.
    pub fn shape_constants(&self, worlds: Range<usize>) -> Vec<[f32; SHAPE - global::WIDTH]> {
        let impulse = &self.impulse;
        let rows = worlds.flat_map(|world| {
            let parameters = self.parameters.of(world);
            (0..impulse.shapes().len()).map(|shape| {
                let mut own = [0.0; solid::WIDTH];
                own.copy_from_slice(impulse.solid_of(shape, parameters));
                own
            })
        });
        rows.collect()
    }
    /// Constants of which a world may have its own.
    fn own_length(&self) -> u32 {
        self.plan.turn + self.plan.own_bodies - self.constants.len() as u32
    }
    /// Numbers of all constants of a batch.
    pub fn constants_length(&self) -> u32 {
        let sets = if self.parameters.differ() {
            self.plan.worlds
        } else {
            1
        };
        self.constants.len() as u32 + sets * self.own_length()
    }
    /// Those of worlds, behind what all have in common; or the one set of all.
    pub fn constants(&self, worlds: Range<usize>) -> Vec<f32> {
        let differ = self.parameters.differ();
        let sets = if differ { worlds } else { 0..1 };
        let own = sets.flat_map(|world| self.own_constants(self.parameters.of(world)).concat());
        own.collect()
    }
}

/// Whether worlds are so few of all that each is written by itself, rather than all together.
pub(crate) fn are_few(worlds: usize, all: usize) -> bool {
    8 * worlds < all
}

/// Constants of a body and of a shape, behind those of the step.
pub(crate) const BODY: usize = global::WIDTH + mass::WIDTH + grip::WIDTH;
pub(crate) const SHAPE: usize = global::WIDTH + solid::WIDTH;
