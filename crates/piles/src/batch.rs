//! Worlds of many bodies that are stepped together, in a card's memory.

use crate::Card;
use crate::actuators::Actuators;
use crate::card::sized;
use crate::constants::{BODY, SHAPE, are_few};
use crate::pace::Pace;
use crate::scene::Scene;
use numbers::Memory;
use rigid::impulse::global;
use sim::DeviceError;
use std::iter::repeat_n;
use std::ops::Range;

/// Some worlds. There is room for as many as in the largest batch.
#[derive(Debug)]
pub(crate) struct Batch<C: Card> {
    pub worlds: Range<usize>,
    /// Their states, and behind these what acts on their bodies, constants of their joints, and what acts along their axes.
    pub state: C::Buffer,
    /// Whether anything acts on their bodies from outside.
    pub pushed: bool,
    /// Of each contact that they remember, the colour that it had: where colouring begins, which changes nothing.
    pub colours: C::Buffer,
    /// Their constants; those of bodies and of shapes as kernels read them, behind those of the step.
    pub constants: C::Buffer,
    pub bodies: C::Buffer,
    pub shapes: C::Buffer,
    /// Worlds whose constants have changed since, and into how many parts steps are cut that they are ready for.
    stale: Vec<usize>,
    cut: usize,
    pub pace: Pace,
    /// Of each world, the steps that it has yet to take, and into how many parts the last one had to be cut.
    pub left: Vec<usize>,
    pub parts: Vec<usize>,
    /// Which have not diverged: a card takes no step that they would diverge by.
    runs: Vec<bool>,
    /// Their controls, and whether the card has not been told of them.
    input: Vec<Vec<f32>>,
    controlled: bool,
    staging: C::Staging,
}

impl<C: Card> Batch<C> {
    pub fn new(card: &C, scene: &Scene, worlds: Range<usize>) -> Result<Self, DeviceError> {
        let plan = &scene.plan;
        let count = worlds.len();
        let of = |things: u32, width: usize| u64::from(things) * width as u64;
        Ok(Self {
            state: sized(card, plan.numbers().into())?,
            colours: sized(card, plan.places().into())?,
            constants: sized(card, scene.constants_length().into())?,
            bodies: sized(card, of(plan.bodies, BODY))?,
            shapes: sized(card, of(plan.shapes, SHAPE))?,
            stale: worlds.clone().collect(),
            cut: 0,
            worlds,
            pushed: false,
            pace: Pace::new(count),
            left: vec![0; count],
            parts: vec![1; count],
            runs: vec![false; count],
            input: vec![vec![0.0; scene.impulse.lengths().input]; count],
            controlled: false,
            staging: C::Staging::default(),
        })
    }

    /// The numbers of the state of a world, counted from the first.
    pub fn numbers(&self, scene: &Scene, nth: usize) -> Range<usize> {
        let length = scene.impulse.lengths().state;
        nth * length..(nth + 1) * length
    }
    /// Sets the states of worlds that follow each other; one that has diverged takes no more steps.
    pub fn write(
        &mut self,
        card: &C,
        scene: &Scene,
        first: usize,
        states: &[f32],
    ) -> Result<(), DeviceError> {
        let first = first - self.worlds.start;
        self.write_at(card, self.numbers(scene, first).start, states)?;
        let length = scene.impulse.lengths().state;
        for (nth, state) in (first..).zip(states.chunks_exact(length)) {
            self.runs[nth] = state[scene.impulse.alive()] != 0.0;
            if !self.runs[nth] {
                self.left[nth] = 0;
            }
        }
        Ok(())
    }
    fn write_at(&self, card: &C, at: usize, numbers: &[f32]) -> Result<(), DeviceError> {
        card.write(&self.state, at as u64, bytemuck::cast_slice(numbers))
    }

    /// These of its worlds have other constants.
    pub fn differ(&mut self, worlds: Vec<usize>) {
        // What controls make of joints depends on them.
        self.controlled |= !worlds.is_empty();
        self.stale.extend(worlds);
    }
    /// Writes constants that have changed, and those of a step that is cut into so many parts. Whether they are in another
    /// buffer now.
    pub fn ready(&mut self, card: &C, scene: &Scene, parts: usize) -> Result<bool, DeviceError> {
        let stale = std::mem::take(&mut self.stale);
        let first = self.worlds.start;
        let all = first..first + scene.plan.worlds as usize;
        let (mut moved, mut changed) = (false, vec![all.clone()]);
        if are_few(stale.len(), self.worlds.len()) {
            changed = stale.into_iter().map(|world| world..world + 1).collect();
        } else {
            let length = scene.constants_length().into();
            if C::room(&self.constants) < length {
                self.constants = sized(card, length)?;
                moved = true;
            }
            card.write(&self.constants, 0, bytemuck::cast_slice(&scene.constants))?;
        }
        for worlds in changed.iter().cloned() {
            self.give(card, scene, worlds)?;
        }
        if self.cut != parts {
            (self.cut, changed) = (parts, vec![all]);
        }
        for worlds in changed {
            self.give_step(card, scene, worlds)?;
        }
        Ok(moved)
    }
    /// Writes constants of some worlds.
    fn give(&self, card: &C, scene: &Scene, worlds: Range<usize>) -> Result<(), DeviceError> {
        let (plan, nth) = (&scene.plan, worlds.start - self.worlds.start);
        let own = scene.constants(worlds.clone());
        let at = scene.constants.len() + nth * plan.own_constants as usize;
        card.write(&self.constants, at as u64, bytemuck::cast_slice(&own))?;
        let [bodies, shapes] = self.columns(scene);
        let number = global::WIDTH;
        bodies.write(card, number, nth, &scene.body_constants(worlds.clone()))?;
        shapes.write(card, number, nth, &scene.shape_constants(worlds.clone()))?;
        let Some(joints) = &scene.joints else {
            return Ok(());
        };
        // Behind the states.
        let at = plan.given as usize + nth * plan.given_numbers as usize;
        let own = worlds.filter(|world| self.worlds.contains(world));
        let own = own.flat_map(|world| {
            let parameters = scene.parameters.of(world);
            joints.constants_of(&scene.impulse, parameters)
        });
        self.write_at(card, at, &Vec::from_iter(own))
    }
    /// The same of a step, as it is cut.
    fn give_step(&self, card: &C, scene: &Scene, worlds: Range<usize>) -> Result<(), DeviceError> {
        let nth = worlds.start - self.worlds.start;
        let globals = scene.globals(worlds, self.cut);
        for columns in self.columns(scene) {
            // A number of each world, for each of its things.
            let own = globals.iter().flat_map(|set| repeat_n(*set, columns.each));
            columns.write(card, 0, nth, &Vec::from_iter(own))?;
        }
        Ok(())
    }
    /// Where constants of bodies and of shapes lie.
    fn columns(&self, scene: &Scene) -> [Columns<'_, C>; 2] {
        let plan = &scene.plan;
        let of = |buffer, each: u32, things: u32| Columns {
            buffer,
            fixed: (things - plan.worlds * each) as usize,
            each: each as usize,
            things: things as usize,
        };
        [
            of(&self.bodies, plan.own_bodies, plan.bodies),
            of(&self.shapes, plan.own_shapes, plan.shapes),
        ]
    }

    /// Takes controls. What is made of them goes to the card before the next step: they may change once more.
    pub fn control(&mut self, numbers: Range<usize>, input: &Memory<f32>) {
        for (world, own) in self.worlds.clone().zip(&mut self.input) {
            let numbers = numbers.clone();
            numbers.for_each(|i| own[i] = input.get(world, i));
        }
        self.controlled = true;
    }
    /// Tells the card what controls make of forces on bodies, and of joints, if they have changed.
    pub fn tell(
        &mut self,
        card: &C,
        scene: &Scene,
        actuators: Option<&mut Actuators<C>>,
    ) -> Result<(), DeviceError> {
        if !std::mem::take(&mut self.controlled) {
            return Ok(());
        }
        let (impulse, inputs) = (&scene.impulse, &self.input);
        if let (Some(joints), Some(actuators)) = (&scene.joints, actuators) {
            let inputs = (self.worlds.start, &**inputs);
            actuators.act(card, scene, joints, inputs, &self.state)?;
        }
        let pushed = inputs.iter().any(|input| impulse.is_pushed(input));
        if pushed || self.pushed {
            let bodies = impulse.rows() - 1;
            let mut forces = vec![0.0; 6 * bodies * inputs.len()];
            for (input, own) in inputs.iter().zip(forces.chunks_exact_mut(6 * bodies)) {
                for (row, given) in impulse.pushes(input) {
                    (0..6).for_each(|i| own[i * bodies + row - 1] = given[i]);
                }
            }
            self.write_at(card, scene.plan.forces as usize, &forces)?;
        }
        self.pushed = pushed;
        Ok(())
    }

    /// Whether any world has steps to take.
    pub fn is_behind(&self) -> bool {
        self.left.iter().any(|left| *left > 0)
    }
    /// Asks for so many steps of all worlds.
    pub fn ask(&mut self, steps: usize) {
        for (left, runs) in self.left.iter_mut().zip(&self.runs) {
            *left = if *runs { steps } else { 0 };
        }
    }

    /// Reads these ranges of the states' numbers.
    pub fn read(
        &mut self,
        card: &C,
        ranges: impl Iterator<Item = Range<usize>> + Clone,
        read: impl FnOnce(&[f32]),
    ) -> Result<(), DeviceError> {
        let (staging, state) = (&mut self.staging, &self.state);
        card.fetch(card.commands(None), staging, state, ranges, read)
    }
    /// Reads these numbers of the states of all worlds.
    pub fn read_all(
        &mut self,
        card: &C,
        scene: &Scene,
        numbers: &[Range<usize>],
        state: &mut Memory<f32>,
    ) -> Result<(), DeviceError> {
        let (length, alive) = (scene.impulse.lengths().state, scene.impulse.alive());
        let worlds = self.worlds.clone();
        if matches!(numbers, [range] if *range == (alive..alive + 1)) {
            for (world, runs) in worlds.zip(&self.runs) {
                state.set(world, alive, f32::from(u8::from(*runs)));
            }
            return Ok(());
        }
        let mut set = |world: usize, row: &Range<usize>, own: &[f32]| {
            let own = row.clone().zip(own);
            own.for_each(|(i, x)| state.set(world, i, *x));
        };
        // Each range of a world is a copy: rather one of all states than so many.
        if numbers.len() * worlds.len() > COPIES {
            let all = std::iter::once(0..length * worlds.len());
            return self.read(card, all, |read| {
                for (world, own) in worlds.zip(read.chunks_exact(length)) {
                    let rows = numbers.iter();
                    rows.for_each(|row| set(world, row, &own[row.clone()]));
                }
            });
        }
        let of_world = |nth: usize| {
            let rows = numbers.iter();
            rows.map(move |row| nth * length + row.start..nth * length + row.end)
        };
        self.read(card, (0..worlds.len()).flat_map(of_world), |mut read| {
            for world in worlds {
                for row in numbers {
                    let (own, rest) = read.split_at(row.len());
                    set(world, row, own);
                    read = rest;
                }
            }
        })
    }
}

/// Numbers of things, `[number][thing]`: of those that do not move, zeros; then of so many of each world, world after world.
struct Columns<'a, C: Card> {
    buffer: &'a C::Buffer,
    fixed: usize,
    each: usize,
    things: usize,
}

impl<C: Card> Columns<'_, C> {
    /// Writes numbers, from one on, of the things of worlds from the nth on: all together where those are all worlds.
    fn write<const N: usize>(
        &self,
        card: &C,
        number: usize,
        nth: usize,
        rows: &[[f32; N]],
    ) -> Result<(), DeviceError> {
        let column = |n: usize| rows.iter().map(move |row| row[n]);
        let write = |number: usize, first: usize, numbers: &[f32]| {
            let at = number * self.things + first;
            card.write(self.buffer, at as u64, bytemuck::cast_slice(numbers))
        };
        if self.fixed + rows.len() == self.things {
            let of = |n| repeat_n(0.0, self.fixed).chain(column(n));
            return write(number, 0, &Vec::from_iter((0..N).flat_map(of)));
        }
        let first = self.fixed + nth * self.each;
        (0..N).try_for_each(|n| write(number + n, first, &Vec::from_iter(column(n))))
    }
}

/// Most ranges that are copied one by one.
const COPIES: usize = 256;
