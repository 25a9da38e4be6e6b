//! A world's step in dual numbers, several directions side by side.
//!
//! A register of lanes holds one direction a lane: `Dual<lanes>` has the world's numbers as its value, the
//! same in all lanes, and a slope in each. So the value is to the bit what the simulation steps to, and all
//! lanes take the branches that it takes.

use crate::tangent::Coordinate;
use crate::touching;
use numbers::dispatch::{Isa, Job, run_registers};
use numbers::{Cpu, Dual, Lanes, Shared};
use rigid::{Featherstone, Kernels, Lengths, TouchingFeatherstone};
use sim::WorldNumbers;
use std::any::Any;

/// One direction: offsets in state and input, and the slopes there; zero elsewhere.
#[derive(Clone, Debug)]
pub(crate) struct Direction {
    /// Where its derivatives belong.
    pub column: usize,
    pub state: Vec<(usize, f64)>,
    pub input: Vec<(usize, f64)>,
}

impl Direction {
    pub fn of_state(column: usize, state: Vec<(usize, f64)>) -> Self {
        Self {
            column,
            state,
            input: Vec::new(),
        }
    }
    pub fn of_input(column: usize, offset: usize) -> Self {
        Self {
            column,
            state: Vec::new(),
            input: vec![(offset, 1.0)],
        }
    }
}

/// Where the state of the joints lies.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    pub position: usize,
    pub velocity: usize,
    /// What each degree of freedom moves.
    pub coordinates: Vec<Coordinate>,
    pub alive: usize,
}

/// The memories of one world.
pub(crate) struct Memories<R> {
    state: Vec<Dual<R>>,
    input: Vec<Dual<R>>,
    output: Vec<Dual<R>>,
    scratch: Vec<Dual<R>>,
}

/// The memories of one world, in whichever registers the instruction set has.
///
/// Where bodies touch, those are of AVX2 at most: the kernels for pairs are large, and AVX-512 would add
/// half to the time in which this crate is compiled, for steps that are a third faster.
pub(crate) struct World<const CONTACTS: bool> {
    isa: Isa,
    memories: Box<dyn Any>,
}

impl<const CONTACTS: bool> World<CONTACTS> {
    pub fn new(isa: Isa, lengths: Lengths) -> Self {
        let memories = run_registers(isa, Allocate::<CONTACTS>(lengths));
        Self { isa, memories }
    }
    /// How many directions are taken at once.
    pub fn directions(&self) -> usize {
        self.isa.width::<f64>()
    }
    /// Puts the world's numbers in, with a direction in each lane.
    pub fn begin(&mut self, numbers: &WorldNumbers, directions: &[Direction]) {
        let begin = Begin::<CONTACTS> {
            numbers,
            directions,
            memories: &mut *self.memories,
        };
        run_registers(self.isa, begin);
    }
    /// Changes of the state of the joints, a row of [`directions`](Self::directions) for each of its
    /// numbers; none where the world has diverged.
    pub fn end(&self, layout: &Layout) -> Option<Vec<f64>> {
        let end = End::<CONTACTS> {
            layout,
            memories: &*self.memories,
        };
        run_registers(self.isa, end)
    }
}

impl World<false> {
    /// Advances by a substep.
    pub fn step(&mut self, kernels: &Featherstone) {
        let memories = &mut *self.memories;
        run_registers(self.isa, Step { kernels, memories });
    }
}

impl World<true> {
    /// Advances by a substep, each kernel for pairs a function of its own: see [`Kernels`].
    pub fn step(&mut self, kernels: &TouchingFeatherstone) {
        let (isa, memories) = (self.isa, &mut *self.memories);
        for stage in 0..kernels.stages() {
            touching::begin(isa, kernels, memories, stage);
            if let Some(contacts) = kernels.contacts() {
                for route in contacts.routes() {
                    touching::meet(isa, (kernels, contacts), memories, route);
                }
            }
            touching::finish(isa, kernels, memories, stage);
        }
    }
}

impl<R: Lanes<Scalar = f64>> Memories<R> {
    #[inline(always)]
    pub fn cpu<'a>(
        &'a mut self,
        kernels: &'a impl Kernels,
    ) -> Cpu<'a, Dual<R>, Shared<'a, Dual<R>>> {
        Cpu {
            state: &mut self.state,
            input: &self.input,
            output: &mut self.output,
            scratch: &mut self.scratch,
            parameters: Shared(kernels.parameters()),
            links: kernels.links(),
        }
    }
}

struct Allocate<const CONTACTS: bool>(Lengths);

impl<const CONTACTS: bool> Job for Allocate<CONTACTS> {
    type Scalar = f64;
    const WIDEST: bool = !CONTACTS;
    type Output = Box<dyn Any>;
    #[inline(always)]
    fn run<R: Lanes<Scalar = f64>>(self) -> Box<dyn Any> {
        let zeros = |n| vec![Dual::constant(R::zero()); n];
        Box::new(Memories {
            state: zeros(self.0.state),
            input: zeros(self.0.input),
            output: zeros(self.0.output),
            scratch: zeros(self.0.scratch),
        })
    }
}

struct Begin<'a, const CONTACTS: bool> {
    numbers: &'a WorldNumbers,
    directions: &'a [Direction],
    memories: &'a mut dyn Any,
}

impl<const CONTACTS: bool> Job for Begin<'_, CONTACTS> {
    type Scalar = f64;
    const WIDEST: bool = !CONTACTS;
    type Output = ();
    #[inline(always)]
    fn run<R: Lanes<Scalar = f64>>(self) {
        let memories = registers_mut::<R>(self.memories);
        write(&mut memories.state, &self.numbers.state);
        write(&mut memories.input, &self.numbers.input);
        for (lane, direction) in self.directions.iter().enumerate() {
            seed(&mut memories.state, &direction.state, lane);
            seed(&mut memories.input, &direction.input, lane);
        }
    }
}

struct Step<'a> {
    kernels: &'a Featherstone,
    memories: &'a mut dyn Any,
}

impl Job for Step<'_> {
    type Scalar = f64;
    type Output = ();
    #[inline(always)]
    fn run<R: Lanes<Scalar = f64>>(self) {
        let memories = registers_mut::<R>(self.memories);
        self.kernels.step(&mut memories.cpu(self.kernels));
    }
}

struct End<'a, const CONTACTS: bool> {
    layout: &'a Layout,
    memories: &'a dyn Any,
}

impl<const CONTACTS: bool> Job for End<'_, CONTACTS> {
    type Scalar = f64;
    const WIDEST: bool = !CONTACTS;
    type Output = Option<Vec<f64>>;
    #[inline(always)]
    fn run<R: Lanes<Scalar = f64>>(self) -> Self::Output {
        let memories: Option<&Memories<R>> = self.memories.downcast_ref();
        let state = &memories.expect(SAME_REGISTERS).state;
        let Layout {
            position,
            velocity,
            ref coordinates,
            alive,
        } = *self.layout;
        let mut rows = Vec::with_capacity(2 * coordinates.len() * R::WIDTH);
        for coordinate in coordinates {
            rows.extend_from_slice(lanes(&coordinate.change(&state[position..])));
        }
        for speed in &state[velocity..][..coordinates.len()] {
            rows.extend_from_slice(lanes(&speed.slope));
        }
        (lanes(&state[alive].value)[0] != 0.0).then_some(rows)
    }
}

const SAME_REGISTERS: &str = "memories are of the instruction set that they were made for";

#[inline(always)]
pub(crate) fn registers_mut<R: Lanes>(memories: &mut dyn Any) -> &mut Memories<R> {
    memories.downcast_mut().expect(SAME_REGISTERS)
}

/// Numbers that do not vary.
#[inline(always)]
fn write<R: Lanes<Scalar = f64>>(memory: &mut [Dual<R>], numbers: &[f64]) {
    for (place, &x) in memory.iter_mut().zip(numbers) {
        *place = Dual::constant(R::splat(x));
    }
}

/// The slopes of one lane.
#[inline(always)]
fn seed<R: Lanes<Scalar = f64>>(memory: &mut [Dual<R>], slopes: &[(usize, f64)], lane: usize) {
    for &(offset, slope) in slopes {
        let register = std::slice::from_mut(&mut memory[offset].slope);
        bytemuck::cast_slice_mut::<R, f64>(register)[lane] = slope;
    }
}

/// The numbers of a register, lane by lane.
#[inline(always)]
fn lanes<R: Lanes<Scalar = f64>>(register: &R) -> &[f64] {
    bytemuck::cast_slice(std::slice::from_ref(register))
}
